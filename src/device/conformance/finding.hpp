#pragma once

#include <string>

namespace wholehand {

/// Outcome of a check.
enum class Outcome {
  kPassed,
  kFailed,
  kSkipped  ///< not allowed or not possible; the finding says why
};

struct CheckFinding {
  Outcome outcome = Outcome::kSkipped;
  std::string text;  ///< observation; may be empty for a passed check
};

[[nodiscard]] inline CheckFinding passed(std::string text = {}) {
  return {Outcome::kPassed, std::move(text)};
}
[[nodiscard]] inline CheckFinding failed(std::string text) {
  return {Outcome::kFailed, std::move(text)};
}
[[nodiscard]] inline CheckFinding skipped(std::string text) {
  return {Outcome::kSkipped, std::move(text)};
}
/// Passed if `wrong` is empty, else failed with that text.
[[nodiscard]] inline CheckFinding unless(std::string wrong) {
  return wrong.empty() ? passed() : failed(std::move(wrong));
}

}  // namespace wholehand
