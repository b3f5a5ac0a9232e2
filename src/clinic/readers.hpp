#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <string>
#include <vector>

/// Readers of a clinic's database. A reader keeps the write-ahead log from being emptied, and with
/// it the bytes of what was erased.
namespace wholehand::clinic {

/// Readers of this process beside the clinic's own connection, e.g. an export. Any thread.
class Readers {
 public:
  /// Turn of one reader, until it is destroyed.
  class Turn {
   public:
    explicit Turn(Readers& readers);
    ~Turn();
    Turn(const Turn&) = delete;
    Turn& operator=(const Turn&) = delete;
    /// True when an erasure waits for the end of this turn.
    [[nodiscard]] bool isOver() const { return readers_.round_ != round_; }

   private:
    Readers& readers_;
    const std::uint64_t round_;
  };

  /// Ends all turns, and waits until their readers have seen it.
  void end();

 private:
  std::mutex mutex_;
  std::condition_variable all_gone_;
  std::atomic<std::uint64_t> round_{0};
  int turns_ = 0;
};

/// Other processes that hold a lock of a database's write-ahead log, e.g. "sqlite3 (process 812)".
/// Empty: there are none, or the kernel does not show them.
[[nodiscard]] std::vector<std::string> otherReaders(const std::string& database);

}  // namespace wholehand::clinic
