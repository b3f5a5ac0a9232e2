#include "core/expected.hpp"

namespace wholehand {

std::string format(const Diagnostic& d) {
  std::string out = d.file;
  if (d.line > 0) out += ":" + std::to_string(d.line);
  if (!d.key.empty()) {
    if (!out.empty()) out += ": ";
    out += d.key;
    if (!d.value.empty()) out += " = " + d.value;
  }
  if (!out.empty()) out += ": ";
  out += d.problem;
  if (!d.remedy.empty()) out += "; " + d.remedy;
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

}  // namespace wholehand
