#include "loop/core/expected.hpp"

#include "loop/core/printable.hpp"

#include <cstddef>

namespace wholehand {

namespace {

// Problems and remedies quote names from files; printable() keeps each of them on one line. Longer
// sentences are cut.
constexpr std::size_t kLongestSentence = 4000;

}  // namespace

std::string format(const Diagnostic& d) {
  std::string out = printable(d.file);
  if (d.line > 0) out += ":" + std::to_string(d.line);
  if (!d.key.empty()) {
    if (!out.empty()) out += ": ";
    out += printable(d.key);
    if (!d.value.empty()) out += " = " + printable(d.value);
  }
  if (!out.empty()) out += ": ";
  out += printable(d.problem, kLongestSentence);
  if (!d.remedy.empty()) out += "; " + printable(d.remedy, kLongestSentence);
  return out;
}

std::string format(const Diagnostics& ds) {
  std::string out;
  for (const Diagnostic& d : ds) {
    if (!out.empty()) out += '\n';
    out += format(d);
  }
  return out;
}

Diagnostics firstFaults(Diagnostics faults, const std::string& path) {
  constexpr std::size_t kMost = 20;
  if (faults.size() <= kMost) return faults;
  const std::size_t more = faults.size() - kMost;
  faults.resize(kMost);
  faults.push_back(
      fileFault(path, "has " + std::to_string(more) + (more == 1 ? " more fault" : " more faults"),
                "correct these first"));
  return faults;
}

}  // namespace wholehand
