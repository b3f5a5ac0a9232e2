#include "core/expected.hpp"

#include "core/printable.hpp"

#include <algorithm>
#include <string_view>

namespace wholehand {

namespace {

// Our own sentences may have several lines. Text quoted from input may not.
std::string lines(const std::string& text) {
  constexpr std::size_t kLongest = 4000;
  std::string out;
  for (std::size_t from = 0; from <= text.size();) {
    const std::size_t end = std::min(text.find('\n', from), text.size());
    if (from > 0) out += '\n';
    out += printable(std::string_view(text).substr(from, end - from), kLongest);
    from = end + 1;
  }
  return out;
}

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
  out += lines(d.problem);
  if (!d.remedy.empty()) out += "; " + lines(d.remedy);
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
  faults.push_back({path, 0, "", "",
                    "has " + std::to_string(more) + (more == 1 ? " more fault" : " more faults"),
                    "mend these first"});
  return faults;
}

}  // namespace wholehand
