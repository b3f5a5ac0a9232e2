#include "replay/answering.hpp"

#include "replay/replayed_recording.hpp"

#include <cerrno>
#include <cstddef>
#include <fstream>
#include <iostream>
#include <new>
#include <string_view>
#include <type_traits>
#include <unistd.h>

namespace wholehand {
namespace {

static_assert(std::is_trivially_copyable_v<AnswerHead>);

bool writeAll(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t n = ::write(STDOUT_FILENO, bytes.data(), bytes.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    bytes.remove_prefix(n);
  }
  return true;
}

bool send(const ReplayAnswer& answer) {
  AnswerHead head;
  head.status = static_cast<std::uint16_t>(answer.status);
  head.is_json = answer.content_type == "application/json" ? 1 : 0;
  head.bytes = answer.body.size();
  return writeAll({reinterpret_cast<const char*>(&head), sizeof head}) && writeAll(answer.body);
}

ReplayAnswer answerOne(ReplayedRecording& recording, const std::string& words) {
  try {
    const auto question = parseReplayQuestion(words);
    if (!question) return replayRefusal(400, format(question.errors()));
    return recording.answer(*question);
  } catch (const std::bad_alloc&) {
    return replayRefusal(422, "it claims more than there is memory for");
  }
}

}  // namespace

void answerQuestions(const std::string& recording_path) {
  // When memory runs out, the kernel kills this process first instead of the one with the loop.
  std::ofstream("/proc/self/oom_score_adj") << 1000;
  ReplayedRecording recording(recording_path);
  for (std::string words; std::getline(std::cin, words);) {
    if (!send(answerOne(recording, words))) return;
  }
}

}  // namespace wholehand
