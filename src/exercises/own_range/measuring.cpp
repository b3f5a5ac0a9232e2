#include "exercises/own_range/measuring.hpp"

#include <cmath>
#include <span>

namespace wholehand::own_range {

void Measuring::beginAt(int direction) noexcept {
  direction_ = direction;
  measured_.fill({});
  left_ = {};
  toAskedDirection();
}

void Measuring::toAskedDirection() noexcept {
  while (!done() && now().axis < 0) ++direction_;
  tries_ = 0;
  relax();
}

void Measuring::relax() noexcept {
  moving_ = false;
  waited_s_ = rested_s_ = 0.0;
}

void Measuring::dropTry() noexcept {
  relax();
}

void Measuring::skip() noexcept {
  if (!done()) endDirection();
}

void Measuring::endDirection() noexcept {
  const std::span<const RangeTry> tries(try_.data(), static_cast<std::size_t>(tries_));
  measured_[direction_] = {ownEnd(tries), true};
  ++direction_;
  toAskedDirection();
}

bool Measuring::rests(const AxisPosition& q, double elapsed_s) noexcept {
  const double at = q[now().axis];
  if (std::abs(at - rest_at_) > 0.5 * now().rules.least) {
    rest_at_ = at;
    rested_s_ = 0.0;
  }
  rested_s_ += elapsed_s;
  const bool back = left_.axis < 0 || left_.sign * (left_at_ - q[left_.axis]) >= left_.rules.least;
  return back && rested_s_ >= rules_.rest_s;
}

MeasuringChange Measuring::tick(const AxisPosition& q, double elapsed_s) noexcept {
  MeasuringChange news;
  if (done()) return news;
  const double at = q[now().axis];
  waited_s_ += elapsed_s;
  if (!moving_) {
    if (!rests(q, elapsed_s) && waited_s_ < rules_.return_s) return news;
    moving_ = true;
    waited_s_ = since_sample_s_ = 0.0;
    meter_.begin(now().rules, now().sign, at);
    return news;
  }
  since_sample_s_ += elapsed_s;
  if (since_sample_s_ < RangeMeter::kSample_s) return news;
  since_sample_s_ = 0.0;
  meter_.add(at);
  if (waited_s_ < rules_.try_s && meter_.sinceAdvance_s() < rules_.held_s) return news;
  news.tried = direction_;
  news.result = try_[tries_++] = meter_.judge();
  left_ = now();
  left_at_ = at;
  if (tries_ < rules_.tries) {
    relax();
    return news;
  }
  news.direction_done = direction_;
  endDirection();
  news.done = done();
  return news;
}

int Measuring::instruction() const noexcept {
  if (done()) return kFinished;
  if (!moving_) return kRelax;
  constexpr double kHolds_s = 0.3;
  return meter_.sinceAdvance_s() > kHolds_s ? static_cast<int>(kHold)
                                            : kFirstDirection + direction_;
}

}  // namespace wholehand::own_range
