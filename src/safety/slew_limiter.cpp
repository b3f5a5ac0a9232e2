#include "safety/slew_limiter.hpp"

#include <algorithm>

namespace wholehand {

int slewTicks(double period_s) noexcept {
  constexpr double kRounding = 1e-9;
  return std::clamp(static_cast<int>(kSlewWindow_s / period_s + kRounding), 1, kMostSlewTicks);
}

void SlewWindow::note(const AxisEffort& sent) noexcept {
  newest_ = (newest_ + 1) % ticks_;
  sent_[newest_] = sent;
  count_ = std::min(count_ + 1, ticks_);
}

double SlewWindow::least(int axis) const noexcept {
  double least = newest(axis);
  for (int k = 1; k < count_; ++k) {
    least = std::min(least, sent_[(newest_ + ticks_ - k) % ticks_][axis]);
  }
  return least;
}

double SlewWindow::most(int axis) const noexcept {
  double most = newest(axis);
  for (int k = 1; k < count_; ++k) {
    most = std::max(most, sent_[(newest_ + ticks_ - k) % ticks_][axis]);
  }
  return most;
}

LimitedEffort limitSlew(const AxisEffort& effort, const SlewWindow& last,
                        const AxisEffort& most_change) noexcept {
  LimitedEffort out{effort};
  for (int i = 0; i < effort.size(); ++i) {
    // A device that refused efforts may have held one further away than the limit.
    const double low = std::min(last.most(i) - most_change[i], last.newest(i));
    const double high = std::max(last.least(i) + most_change[i], last.newest(i));
    out.effort[i] = std::clamp(effort[i], low, high);
    if (out.effort[i] == effort[i]) continue;
    out.faults = Fault::kEffortSlew;
    if (out.axis < 0) out.axis = i;
  }
  return out;
}

}  // namespace wholehand
