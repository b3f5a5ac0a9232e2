#pragma once

#include <cstdint>
#include <string>

namespace wholehand {

/// Header of each answer that the reader process writes to its standard output.
struct AnswerHead {
  static constexpr std::uint32_t kMark = 0x31415257;  ///< "WRA1"
  std::uint32_t mark = kMark;
  std::uint16_t status = 200;
  std::uint16_t is_json = 1;
  std::uint64_t bytes = 0;  ///< size of the body that follows
};
static_assert(sizeof(AnswerHead) == 16);

/// Main loop of the reader process: opens the recording and answers one question per line of
/// standard input, until its end. When the file is refused, every answer is the refusal.
void answerQuestions(const std::string& recording_path);

}  // namespace wholehand
