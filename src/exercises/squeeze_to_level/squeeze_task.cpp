#include "exercises/squeeze_to_level/squeeze_task.hpp"

#include <cstddef>

namespace wholehand::squeeze_to_level {

void BandSteps::reset() noexcept {
  instruction_ = Instruction::kReach;
  band_ = bands_done_ = 0;
  held_s_ = 0.0;
  since_entered_s_ = -1.0;
  earned_ = 0.0;
}

Band BandSteps::goal(double ratio) const noexcept {
  if (lettingGo() || done()) return {0.0, rules_.let_go_n};
  const Band& band = rules_.bands[band_];
  return {ratio * band.low_n, ratio * band.high_n};
}

double BandSteps::score() const noexcept {
  return 100.0 * earned_ / static_cast<double>(rules_.bands.size());
}

BandChange BandSteps::tick(double squeeze_n, bool near, double ratio, double elapsed_s) noexcept {
  if (done()) return {};
  if (!lettingGo()) return hold(squeeze_n, near, goal(ratio), elapsed_s);
  if (squeeze_n >= rules_.let_go_n) return {};
  BandChange news;
  ++band_;
  held_s_ = 0.0;
  since_entered_s_ = -1.0;
  news.done = band_ == static_cast<int>(rules_.bands.size());
  if (news.done) --band_;  // the last band stays selected
  instruction_ = news.done ? Instruction::kDone : Instruction::kMore;
  return news;
}

BandChange BandSteps::hold(double squeeze_n, bool near, const Band& goal,
                           double elapsed_s) noexcept {
  BandChange news;
  const bool inside = squeeze_n >= goal.low_n && squeeze_n <= goal.high_n;
  news.entered = inside && since_entered_s_ < 0.0;
  if (news.entered) since_entered_s_ = 0.0;
  if (since_entered_s_ >= 0.0) since_entered_s_ += elapsed_s;
  if (inside) held_s_ += elapsed_s;
  if (held_s_ >= rules_.hold_s) {
    news.held = band_;
    ++bands_done_;
    earned_ += held_s_ / since_entered_s_;
    instruction_ = Instruction::kLetGo;
  } else if (inside) {
    instruction_ = Instruction::kHold;
  } else if (squeeze_n > goal.high_n) {
    instruction_ = Instruction::kLess;
  } else {
    instruction_ = near ? Instruction::kMore : Instruction::kReach;
  }
  return news;
}

}  // namespace wholehand::squeeze_to_level
