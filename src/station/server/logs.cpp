#include "station/server/logs.hpp"

#include "loop/core/printable.hpp"

#include <algorithm>
#include <utility>

namespace wholehand {

AsyncLog::AsyncLog(Sink sink) : sink_(std::move(sink)) {
  if (sink_) thread_ = std::thread([this] { run(); });
}

AsyncLog::~AsyncLog() {
  {
    const std::lock_guard lock(mutex_);
    closing_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void AsyncLog::write(std::string line) {
  if (!sink_) return;
  {
    const std::lock_guard lock(mutex_);
    if (waiting_.size() >= kMostWaiting) {
      ++left_out_;
      return;
    }
    if (left_out_ > 0) {
      line += " (lines left out before: " + std::to_string(left_out_) + ")";
      left_out_ = 0;
    }
    waiting_.push_back(std::move(line));
  }
  changed_.notify_all();
}

void AsyncLog::flush(std::chrono::milliseconds within) {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, within, [this] { return waiting_.empty() && !writing_; });
}

void AsyncLog::run() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return closing_ || !waiting_.empty(); });
    if (waiting_.empty()) return;
    const std::string line = std::move(waiting_.front());
    waiting_.pop_front();
    writing_ = true;
    lock.unlock();
    deliver(line);
    lock.lock();
    writing_ = false;
    changed_.notify_all();
  }
}

// A failing log must not end the process, and with it the loop.
void AsyncLog::deliver(const std::string& line) noexcept {
  try {
    sink_(line);
  } catch (...) {  // NOLINT(bugprone-empty-catch): cannot be reported
  }
}

void RateLimitedLog::write(const std::string& line, std::int64_t now_ns) {
  if (!sink_) return;
  if (last_ns_ != 0) {
    allowance_ += kPerSecond * 1e-9 * static_cast<double>(now_ns - last_ns_);
    allowance_ = std::min(allowance_, kBurst);
  }
  last_ns_ = now_ns;
  if (allowance_ < 1.0) {
    ++left_out_;
    return;
  }
  allowance_ -= 1.0;
  std::string text = printable(line, 400);
  if (left_out_ > 0) text += " (lines left out before: " + std::to_string(left_out_) + ")";
  left_out_ = 0;
  sink_(text);
}

}  // namespace wholehand
