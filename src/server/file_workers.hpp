#pragma once

#include "server/file_reader.hpp"

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

namespace wholehand {

/// Threads that own all work with files: while a disk hangs, they wait for it, and nobody else. So
/// much may wait for them; what is beyond is refused. post() and close() from any thread: neither
/// waits for a job.
class FileWorkers {
 public:
  /// A job must not throw.
  using Job = std::function<void()>;

  /// @param most_jobs that wait or are under way
  FileWorkers(unsigned threads, std::size_t most_jobs);
  ~FileWorkers();
  FileWorkers(const FileWorkers&) = delete;
  FileWorkers& operator=(const FileWorkers&) = delete;

  /// Runs a job on a worker; false where too many wait already.
  [[nodiscard]] bool post(Job job);
  /// Closes a file that nobody reads on.
  void close(std::unique_ptr<FileReader> file);

  /// Ends the threads: waits for what is under way, drops what waits. Not from a job.
  void stop();

 private:
  /// A job, or a file to close.
  struct Task {
    Job job;
    std::unique_ptr<FileReader> file;
  };

  void work();

  const std::size_t most_jobs_;
  std::mutex mutex_;  ///< of the next three
  std::condition_variable more_;
  std::deque<Task> tasks_;
  std::size_t jobs_ = 0;  ///< that wait or are under way
  bool stopped_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace wholehand
