#pragma once

#include "loop/exercise/exercise.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>

namespace wholehand::test {

/// Fault of the exercise from one tick on.
enum class Push {
  kWell,      ///< no fault: it sways
  kNan,       ///< NaN on one axis
  kInfinite,  ///< infinity on one axis
  kTooHard,   ///< ten times the limit on one axis
  kStep,      ///< a step from one side to the other on one axis
  kAlong      ///< with the motion on every axis, at nine tenths of the limits
};

/// Pushes every axis back and forth by a fifth of its limit and fades out where it may not push. A
/// test sets its fault.
class PushingExercise final : public Exercise {
 public:
  PushingExercise(AxisEffort limit, Push fault, int tick, int axis)
      : limit_(limit), fault_(fault), at_(tick), axis_(axis) {
    description_.name = "pushing";
  }
  void reset() override {
    tick_ = -1;
    share_ = 1.0;
  }
  [[nodiscard]] WorldQuery query() const noexcept override { return {}; }

  void tick(const ExerciseInput& input, ExerciseRecord& out, BodyPlacements&) noexcept override {
    ++tick_;
    const double step = input.period_s / description_.fade_out_s;
    share_ = std::clamp(share_ + (input.may_push ? step : -step), 0.0, 1.0);
    const double angle = 2.0 * std::numbers::pi * 1.7 * input.period_s * tick_;
    for (int a = 0; a < limit_.size(); ++a) {
      out.effort[a] = 0.2 * share_ * limit_[a] * std::sin(angle + a);
    }
    if (tick_ >= at_) goWrong(*input.observed, out.effort);
  }

  /// Removes the fault.
  void clear() noexcept { fault_ = Push::kWell; }

  [[nodiscard]] std::unique_ptr<Player> makePlayer(const PlayerTraits&) const override {
    return nullptr;
  }

 private:
  void goWrong(const TickRecord& observed, AxisEffort& effort) const noexcept {
    switch (fault_) {
      case Push::kWell:
        break;
      case Push::kNan:
        effort[axis_] = std::numeric_limits<double>::quiet_NaN();
        break;
      case Push::kInfinite:
        effort[axis_] = -std::numeric_limits<double>::infinity();
        break;
      case Push::kTooHard:
        effort[axis_] = 10.0 * limit_[axis_];
        break;
      case Push::kStep:
        effort[axis_] = (tick_ - at_) / 20 % 2 == 0 ? 0.6 * limit_[axis_] : -0.6 * limit_[axis_];
        break;
      case Push::kAlong:
        for (int a = 0; a < effort.size(); ++a) {
          effort[a] = std::copysign(0.9 * limit_[a], observed.qd_mf[a]);
        }
        break;
    }
  }

  AxisEffort limit_;
  Push fault_;
  int at_, axis_;
  int tick_ = -1;
  double share_ = 1.0;
};

}  // namespace wholehand::test
