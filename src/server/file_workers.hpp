#pragma once

#include "server/beast.hpp"
#include "server/file_reader.hpp"

#include <atomic>
#include <cstddef>
#include <memory>
#include <utility>

namespace wholehand {

/// Threads that own all work with files: while a disk hangs, they wait for it, and nobody else. So
/// much may wait for them; what is beyond is refused. Part of server.cpp.
class FileWorkers {
 public:
  FileWorkers(unsigned threads, std::size_t most_jobs) : most_jobs_(most_jobs), pool_(threads) {}

  /// Runs a job on a worker; false where too many wait already. Any thread.
  template <class Job>
  [[nodiscard]] bool post(Job job) {
    if (jobs_.fetch_add(1) >= most_jobs_) {
      --jobs_;
      return false;
    }
    net::post(pool_, [this, job = std::move(job)]() mutable {
      job();
      --jobs_;
    });
    return true;
  }
  /// Closes a file that nobody reads on.
  void close(std::unique_ptr<FileReader> file) {
    if (file) net::post(pool_, [file = std::move(file)] {});
  }

  /// Ends the threads: waits for what is under way, drops what waits.
  void stop() {
    pool_.stop();
    pool_.join();
  }

 private:
  const std::size_t most_jobs_;
  std::atomic<std::size_t> jobs_{0};
  net::thread_pool pool_;
};

}  // namespace wholehand
