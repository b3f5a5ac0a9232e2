#pragma once

#include "process/talking_child.hpp"
#include "replay/replay_question.hpp"
#include "server/replay_service.hpp"

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <list>
#include <memory>
#include <mutex>
#include <string>

namespace wholehand {

/// Answers what pages ask of recordings, each file read in processes of its own: HDF5 may be
/// writing in this one, and a stranger's file may end its reader. A recording has two, so that a
/// state need not wait for a stretch of the plots. They stay for the next question, at most so
/// many; the one that was asked longest ago goes first. Any thread.
class ReplayChildren {
 public:
  struct Options {
    std::string program = "/proc/self/exe";  ///< run as `program replay RECORDING --answer`
    bool idle = true;                        ///< beside a loop they have the lowest priority
    std::size_t most = 8;                    ///< that stay: four recordings
    std::chrono::milliseconds patience = std::chrono::seconds(60);  ///< for an answer
  };

  explicit ReplayChildren(Options options) : options_(std::move(options)) {}

  /// Waits for the answer, or for what ends it: the patience, end(), the end of the reader. For
  /// ReplayService.
  [[nodiscard]] ReplayAnswer answer(const std::string& path, const std::string& question);
  /// Ends the waiting that is under way; nothing is asked any more.
  void end() noexcept { ending_.store(true); }

 private:
  /// The file that a child has open, and how long it was: what was added later it does not see.
  struct Stamp {
    std::uint64_t device = 0, inode = 0, bytes = 0;
    std::int64_t changed_ns = 0;
    bool operator==(const Stamp&) const = default;
  };
  struct Reader {
    std::string path;
    bool plots = false;
    Stamp stamp;
    std::mutex mutex;  ///< of the child: one question at a time
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
  std::mutex mutex_;  ///< of the list
  Readers readers_;   ///< the one asked last first
};

}  // namespace wholehand
