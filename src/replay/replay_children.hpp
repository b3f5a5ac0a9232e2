#pragma once

#include "files/process/child_process.hpp"
#include "replay/replay_question.hpp"
#include "vocabulary/backend.hpp"

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <list>
#include <memory>
#include <mutex>
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
/// standard input, until the input ends. If the file is refused, every answer is the refusal.
void answerQuestions(const std::string& recording_path);

/// Answers pages' questions about recordings in child processes, because HDF5 may be writing in
/// this process and a malicious file may crash its reader. Each recording has two children, so that
/// a request for a state does not wait for one for plot data. A limited number of children stay for
/// further questions; the least recently used one ends first. Any thread.
class ReplayChildren {
 public:
  struct Options {
    std::string program = "/proc/self/exe";  ///< run as `program replay RECORDING --answer`
    bool idle_disk = true;                   ///< lowest disk priority, for use next to a recorder
    std::size_t most = 8;                    ///< limit of idle children: two for each of four
                                             ///< recordings
    std::chrono::milliseconds patience = std::chrono::seconds(60);  ///< timeout of an answer
  };

  explicit ReplayChildren(Options options) : options_(std::move(options)) {}

  /// Waits for the answer, or until the timeout, end(), or the end of the child. A ReplayService.
  [[nodiscard]] ReplayAnswer answer(const std::string& path, const std::string& question);
  /// Cancels the waiting calls; refuses later questions.
  void end() noexcept { ending_.store(true); }

 private:
  /// Identity and size of the file that a child has open. The child does not see data that were
  /// added later.
  struct Stamp {
    std::uint64_t device = 0, inode = 0, bytes = 0;
    std::int64_t changed_ns = 0;
    bool operator==(const Stamp&) const = default;
  };
  struct Reader {
    std::string path;
    bool plots = false;
    Stamp stamp;
    std::mutex mutex;  ///< guards the child: one question at a time
    std::unique_ptr<TalkingChild> child;
  };
  using Readers = std::list<std::shared_ptr<Reader>>;

  [[nodiscard]] static Stamp stampOf(const std::string& path);
  [[nodiscard]] std::shared_ptr<Reader> readerOf(const std::string& path,
                                                 const ReplayQuestion& question);
  [[nodiscard]] ReplayAnswer ask(Reader& reader, const std::string& question);
  [[nodiscard]] ReplayAnswer failed(Reader& reader);

  const Options options_;
  std::atomic<bool> ending_{false};
  std::mutex mutex_;  ///< guards the list
  Readers readers_;   ///< most recently used first
};

}  // namespace wholehand
