#include "exercises/kitchen/kitchen_task.hpp"

#include <algorithm>

namespace wholehand::kitchen {
namespace {

// A thing counts as taken or released after kMoment_s, because contacts flicker at first touch. A
// trembling grip keeps its time while its force exceeds kOpens times the required force.
constexpr double kMoment_s = 0.2, kOpens = 0.25;
constexpr double kFree_n = 0.05;

}  // namespace

void TaskSteps::reset() noexcept {
  step_ = 0;
  held_s_ = step_s_ = time_s_ = earned_ = 0.0;
}

const Step& TaskSteps::now() const noexcept {
  return task_.steps[std::min(step_, static_cast<int>(task_.steps.size()) - 1)];
}

bool TaskSteps::holds(const Step& step, const ThingObservation& seen) const noexcept {
  switch (step.verb) {
    case Verb::kReach:
      return seen.palm_m <= step.within_m;
    case Verb::kTake:
      return seen.squeeze_n >= step.force_n;
    case Verb::kMove:
    case Verb::kHold:
      return std::abs(seen.q - step.to) <= step.tolerance;
    case Verb::kPress:
      return seen.handle_n >= step.force_n;
    case Verb::kPut:
      return ((seen.center_m - step.center_m).cwiseAbs().array() <= step.half_size_m.array()).all();
    case Verb::kLetGo:
      return seen.handle_n <= kFree_n;
  }
  return false;
}

bool TaskSteps::tick(const ThingObservation& seen, double elapsed_s) noexcept {
  if (done()) return false;
  const Step& step = now();
  time_s_ += elapsed_s;
  step_s_ += elapsed_s;
  const bool timed = step.verb == Verb::kHold || step.verb == Verb::kPress;
  const bool once = step.verb == Verb::kReach || step.verb == Verb::kMove;
  const double wanted_s = timed ? step.for_s : once ? 0.0 : kMoment_s;
  if (holds(step, seen)) {
    held_s_ += elapsed_s;
  } else if (!timed && !(step.verb == Verb::kTake && seen.squeeze_n > kOpens * step.force_n)) {
    held_s_ = 0.0;
  }
  if (!(held_s_ > 0.0) || held_s_ < wanted_s) return false;
  earned_ += std::clamp(1.5 - 0.5 * step_s_ / task_.par_s, 0.0, 1.0);
  held_s_ = step_s_ = 0.0;
  ++step_;
  return true;
}

double TaskSteps::score() const noexcept {
  return 100.0 * earned_ / static_cast<double>(task_.steps.size());
}

}  // namespace wholehand::kitchen
