#pragma once

#include <cstdint>
#include <string>

namespace wholehand {

/// Before each answer of the process that reads a recording, on its standard output.
struct AnswerHead {
  static constexpr std::uint32_t kMark = 0x31415257;  ///< "WRA1"
  std::uint32_t mark = kMark;
  std::uint16_t status = 200;
  std::uint16_t is_json = 1;
  std::uint64_t bytes = 0;  ///< of the body that follows
};
static_assert(sizeof(AnswerHead) == 16);

/// What that process does: opens the recording, and answers the questions that come line by line on
/// its standard input, until that ends. A file that is refused is refused with every answer.
void answerQuestions(const std::string& recording_path);

}  // namespace wholehand
