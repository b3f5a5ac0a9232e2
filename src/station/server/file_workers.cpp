#include "station/server/file_workers.hpp"

#include <algorithm>
#include <cerrno>
#include <fcntl.h>
#include <new>
#include <sys/stat.h>
#include <unistd.h>
#include <utility>

namespace wholehand {

namespace {

// Runs a job. A job that runs out of memory cannot report it; its caller gives up after its
// timeout.
void carryOut(const FileWorkers::Job& job) {
  try {
    job();
  } catch (const std::bad_alloc&) {  // NOLINT(bugprone-empty-catch): cannot be reported
  }
}

}  // namespace

std::unique_ptr<FileReader> FileReader::open(const std::string& path) {
  const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd < 0) return nullptr;
  struct stat status {};
  if (::fstat(fd, &status) != 0 || !S_ISREG(status.st_mode)) {
    ::close(fd);
    return nullptr;
  }
  return std::unique_ptr<FileReader>(
      new FileReader(fd, static_cast<std::uint64_t>(status.st_size)));
}

FileReader::~FileReader() {
  ::close(fd_);
}

std::string FileReader::next() {
  std::string piece(std::min<std::uint64_t>(kPiece, left_), '\0');
  std::size_t have = 0;
  while (have < piece.size()) {
    const ssize_t n = ::read(fd_, piece.data() + have, piece.size() - have);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) break;
    have += n;
  }
  piece.resize(have);
  left_ -= have;
  return piece;
}

FileWorkers::FileWorkers(unsigned threads, std::size_t most_jobs) : most_jobs_(most_jobs) {
  for (unsigned i = 0; i < threads; ++i) threads_.emplace_back([this] { work(); });
}

FileWorkers::~FileWorkers() {
  stop();
}

bool FileWorkers::post(Job job) {
  {
    const std::lock_guard lock(mutex_);
    if (jobs_ >= most_jobs_) return false;
    ++jobs_;
    tasks_.push_back({std::move(job), nullptr});
  }
  more_.notify_one();
  return true;
}

void FileWorkers::close(std::unique_ptr<FileReader> file) {
  if (!file) return;
  try {
    const std::lock_guard lock(mutex_);
    tasks_.push_back({nullptr, nullptr});
    tasks_.back().file = std::move(file);
  } catch (const std::bad_alloc&) {
    return;  // the file closes here
  }
  more_.notify_one();
}

void FileWorkers::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopped_ = true;
  }
  more_.notify_all();
  for (std::thread& thread : threads_) {
    if (thread.joinable()) thread.join();
  }
}

void FileWorkers::work() {
  std::unique_lock lock(mutex_);
  while (true) {
    more_.wait(lock, [this] { return stopped_ || !tasks_.empty(); });
    if (stopped_) return;
    Task task = std::move(tasks_.front());
    tasks_.pop_front();
    lock.unlock();
    const bool is_job = task.job != nullptr;
    if (is_job) carryOut(task.job);
    task = Task{};  // destroys the job outside the lock
    lock.lock();
    if (is_job) --jobs_;
  }
}

}  // namespace wholehand
