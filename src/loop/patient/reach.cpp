#include "loop/patient/reach.hpp"

#include <algorithm>
#include <cmath>

namespace wholehand {

void Reach::begin(const AxisPosition& q, const AxisVelocity& qd, const AxisPosition& goal,
                  double duration_s) noexcept {
  start_ = q;
  start_speed_ = qd;
  goal_ = goal;
  duration_s_ = duration_s;
  time_s_ = 0.0;
  windows_.fill({0.0, duration_s});
}

void Reach::during(int axis, double from, double to) noexcept {
  const double begin = start_speed_[axis] == 0.0 ? from : 0.0;
  windows_[axis] = {begin * duration_s_, to * duration_s_};
}

void Reach::limitSpeed(int axis, double speed) noexcept {
  const double needed_s = kMinimumJerkPeak * std::abs(goal_[axis] - start_[axis]) / speed;
  const double longer = needed_s / (windows_[axis].to_s - windows_[axis].from_s);
  if (!(longer > 1.0)) return;
  duration_s_ *= longer;
  for (Window& window : windows_) {
    window.from_s *= longer;
    window.to_s *= longer;
  }
}

void Reach::advance(double period_s, AxisPosition& q, AxisVelocity& qd) noexcept {
  time_s_ += period_s;
  q = goal_;
  qd = AxisVelocity(goal_.size());
  for (int i = 0; i < goal_.size(); ++i) {
    const Window& window = windows_[i];
    const double span_s = window.to_s - window.from_s;
    const double u = std::max((time_s_ - window.from_s) / span_s, 0.0);
    if (u >= 1.0) continue;
    // q = q0 + v u + c3 u³ + c4 u⁴ + c5 u⁵ with q' = q'' = 0 at u = 1
    const double d = goal_[i] - start_[i];
    const double v = start_speed_[i] * span_s;
    const double c3 = 10.0 * d - 6.0 * v, c4 = -15.0 * d + 8.0 * v, c5 = 6.0 * d - 3.0 * v;
    q[i] = start_[i] + u * (v + u * u * (c3 + u * (c4 + u * c5)));
    qd[i] = (v + u * u * (3.0 * c3 + u * (4.0 * c4 + u * 5.0 * c5))) / span_s;
    if (u == 0.0) qd[i] = start_speed_[i];
  }
}

}  // namespace wholehand
