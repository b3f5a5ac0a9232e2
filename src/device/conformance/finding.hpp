#pragma once

#include <string>

namespace wholehand {

/// What came of a check of a driver.
enum class Outcome {
  kPassed,
  kFailed,
  kNotRun  ///< not allowed, or nothing to judge by: the finding says which
};

struct CheckFinding {
  Outcome outcome = Outcome::kNotRun;
  std::string text;  ///< what was seen; may be empty where a check has passed
};

[[nodiscard]] inline CheckFinding passed(std::string text = {}) {
  return {Outcome::kPassed, std::move(text)};
}
[[nodiscard]] inline CheckFinding failed(std::string text) {
  return {Outcome::kFailed, std::move(text)};
}
[[nodiscard]] inline CheckFinding skipped(std::string text) {
  return {Outcome::kNotRun, std::move(text)};
}
/// Passed where nothing is wrong: `wrong` is empty.
[[nodiscard]] inline CheckFinding unless(std::string wrong) {
  return wrong.empty() ? passed() : failed(std::move(wrong));
}

}  // namespace wholehand
