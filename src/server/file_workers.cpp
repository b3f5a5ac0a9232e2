#include "server/file_workers.hpp"

#include <new>
#include <utility>

namespace wholehand {

FileWorkers::FileWorkers(unsigned threads, std::size_t most_jobs) : most_jobs_(most_jobs) {
  for (unsigned i = 0; i < threads; ++i) threads_.emplace_back([this] { work(); });
}

FileWorkers::~FileWorkers() {
  stop();
}

namespace {

// A job for which no memory is left cannot even say so; whoever waits for it gives up.
void carryOut(const FileWorkers::Job& job) {
  try {
    job();
  } catch (const std::bad_alloc&) {  // NOLINT(bugprone-empty-catch): cannot be reported
  }
}

}  // namespace

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
    return;  // closed here
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
