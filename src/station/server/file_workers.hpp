#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace wholehand {

/// Reads a regular file in pieces. Every call, also closing, may wait for the disk: use it on a
/// worker (FileWorkers), never on the thread that handles stops.
class FileReader {
 public:
  /// Largest piece [bytes].
  static constexpr std::size_t kPiece = 64 * 1024;

  /// Opens a file; null when there is none.
  [[nodiscard]] static std::unique_ptr<FileReader> open(const std::string& path);
  ~FileReader();
  FileReader(const FileReader&) = delete;
  FileReader& operator=(const FileReader&) = delete;

  /// Size of the file when it was opened [bytes].
  [[nodiscard]] std::uint64_t size() const noexcept { return size_; }
  /// Bytes not read yet.
  [[nodiscard]] std::uint64_t left() const noexcept { return left_; }
  /// Reads the next piece. Empty at the end, or when the file was shortened or cannot be read.
  [[nodiscard]] std::string next();

 private:
  FileReader(int fd, std::uint64_t size) : fd_(fd), size_(size), left_(size) {}

  int fd_;
  std::uint64_t size_, left_;
};

/// Worker threads that do all file access, so that only they wait for a hanging disk. Their queue
/// is bounded and refuses further jobs. post() and close() may be called from any thread and never
/// wait for a job.
class FileWorkers {
 public:
  /// A unit of work. It may throw only std::bad_alloc, and is dropped then.
  using Job = std::function<void()>;

  /// @param most_jobs limit of queued and running jobs
  FileWorkers(unsigned threads, std::size_t most_jobs);
  ~FileWorkers();
  FileWorkers(const FileWorkers&) = delete;
  FileWorkers& operator=(const FileWorkers&) = delete;

  /// Queues a job for a worker; false when the limit is reached.
  [[nodiscard]] bool post(Job job);
  /// Closes a file on a worker.
  void close(std::unique_ptr<FileReader> file);

  /// Stops the threads. Waits for running jobs and drops queued ones. Must not be called from a
  /// job.
  void stop();

 private:
  /// A job, or a file to close.
  struct Task {
    Job job;
    std::unique_ptr<FileReader> file;
  };

  void work();

  const std::size_t most_jobs_;
  std::mutex mutex_;  ///< guards the next three
  std::condition_variable more_;
  std::deque<Task> tasks_;
  std::size_t jobs_ = 0;  ///< queued and running jobs
  bool stopped_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace wholehand
