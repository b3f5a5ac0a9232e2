#include "loop/safety/force_limiter.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace wholehand {

LimitedEffort limitEffort(const AxisEffort& effort, const AxisEffort& limit) noexcept {
  LimitedEffort out{AxisEffort(limit.size()), Fault::kNone};
  const int n = std::min(effort.size(), limit.size());
  for (int i = 0; i < n; ++i) {
    if (!std::isfinite(effort[i])) {
      // Names this axis even if another was limited.
      if (!any(out.faults & Fault::kNonFiniteEffort)) out.axis = i;
      out.faults |= Fault::kNonFiniteEffort;
      continue;
    }
    const double bound = limit[i] > 0.0 ? limit[i] : 0.0;  // a NaN limit counts as 0
    out.effort[i] = std::clamp(effort[i], -bound, bound);
    if (out.effort[i] == effort[i]) continue;
    out.faults |= Fault::kEffortLimit;
    if (out.axis < 0) out.axis = i;
  }
  return out;
}

namespace {

using Powers = std::array<double, kMaxAxes>;

// The share p̂. Axes that need less than an equal share leave the rest to the others; this is
// repeated until no axis is below its share.
double shareOf(const Powers& power_w, int axes, double limit_w) noexcept {
  double share_w = limit_w / axes;
  for (int round = 0; round < axes; ++round) {
    double small_w = 0.0;
    int large = 0;
    for (int i = 0; i < axes; ++i) {
      const double p = power_w[i];
      if (p > share_w) {
        ++large;
      } else {
        small_w += p;
      }
    }
    if (large == 0) return share_w;
    const double next_w = (limit_w - small_w) / large;
    if (next_w <= share_w) return share_w;
    share_w = next_w;
  }
  return share_w;
}

}  // namespace

LimitedEffort limitPower(const AxisEffort& effort, const AxisEffort& neutral,
                         const AxisVelocity& qd, double limit_w) noexcept {
  LimitedEffort out{effort};
  Powers power_w{};
  double given_w = 0.0;
  for (int i = 0; i < effort.size(); ++i) {
    const double p = (effort[i] - neutral[i]) * qd[i];
    if (!(p > 0.0)) continue;
    power_w[i] = p;
    given_w += p;
  }
  if (!(given_w > limit_w)) return out;
  const double share_w = shareOf(power_w, effort.size(), limit_w);
  for (int i = 0; i < effort.size(); ++i) {
    const double p = power_w[i];
    if (!(p > share_w)) continue;
    out.effort[i] = neutral[i] + (effort[i] - neutral[i]) * (share_w / p);
    if (out.axis < 0) out.axis = i;
  }
  out.faults = Fault::kPowerLimit;
  return out;
}

int slewTicks(double period_s) noexcept {
  constexpr double kRounding = 1e-9;  // keeps a whole quotient from rounding down
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
    // A device that refused efforts may hold one that is further away than the limit.
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
