#include "replay/grip_log.hpp"

#include <algorithm>
#include <cmath>

namespace wholehand {
namespace {

constexpr double kShortest_s = 1.0, kRise_s = 0.25;

}  // namespace

void GripLog::add(double time_s, double force_n, const MovedTime& before, const MovedTime& now) {
  if (!(force_n >= kLeastGrip_n)) return end();
  if (!gripping_) {
    gripping_ = true;
    grip_ = Grip{};
    grip_.from_s = time_s;
    begin_ = before;
    count_ = mean_n_ = squares_n2_ = 0.0;
  }
  grip_.to_s = time_s;
  grip_.moved = now - begin_;
  grip_.largest_n = std::max(grip_.largest_n, force_n);
  if (time_s - grip_.from_s >= kRise_s) waiting_.push_back({time_s, force_n});
  while (!waiting_.empty() && time_s - waiting_.front().time_s >= kRise_s) {
    count(waiting_.front().force_n);
    waiting_.pop_front();
  }
}

void GripLog::count(double force_n) {
  count_ += 1.0;
  const double off_n = force_n - mean_n_;
  mean_n_ += off_n / count_;
  squares_n2_ += off_n * (force_n - mean_n_);
}

void GripLog::end() {
  if (!gripping_) return;
  gripping_ = false;
  waiting_.clear();
  if (grip_.to_s - grip_.from_s < kShortest_s) return;
  grip_.mean_n = mean_n_;
  grip_.deviation_n = count_ > 0.0 ? std::sqrt(squares_n2_ / count_) : 0.0;
  grips_.push_back(grip_);
}

}  // namespace wholehand
