#pragma once

#include "core/real_time.hpp"
#include "exercise/kitchen/kitchen_task.hpp"

namespace wholehand::kitchen {

/// What a tick shows of the present step's thing.
struct Seen {
  double palm_m = 0.0;     ///< distance of the palm
  double squeeze_n = 0.0;  ///< grip force
  double handle_n = 0.0;   ///< force of the hand
  double q = 0.0;          ///< of its joint [m or rad]
  Eigen::Vector3d center_m = Eigen::Vector3d::Zero();
};

/// State machine of a task: the present step, the time held in it, the score. Pure; real-time safe.
class TaskSteps {
 public:
  /// @pre task outlives this and has a step
  explicit TaskSteps(const KitchenTask& task) : task_(task) {}

  void reset() noexcept;
  /// @return true: the present step ended
  WHOLEHAND_RT bool tick(const Seen& seen, double elapsed_s) noexcept;

  [[nodiscard]] bool done() const noexcept { return step_ == static_cast<int>(task_.steps.size()); }
  /// Index; the number of steps when done.
  [[nodiscard]] int step() const noexcept { return step_; }
  /// The present step; the last one when done.
  [[nodiscard]] const Step& now() const noexcept;
  [[nodiscard]] double held_s() const noexcept { return held_s_; }
  /// Time since the start, without pauses; stands when done.
  [[nodiscard]] double time_s() const noexcept { return time_s_; }
  /// 0 .. 100: mean over all steps, each whole within par_s and nothing from 3 par_s on. Later
  /// steps count 0.
  [[nodiscard]] double score() const noexcept;

 private:
  [[nodiscard]] bool holds(const Step& step, const Seen& seen) const noexcept;

  const KitchenTask& task_;
  int step_ = 0;
  double held_s_ = 0.0, step_s_ = 0.0, time_s_ = 0.0;
  double earned_ = 0.0;  ///< sum over the steps, each 0 .. 1
};

}  // namespace wholehand::kitchen
