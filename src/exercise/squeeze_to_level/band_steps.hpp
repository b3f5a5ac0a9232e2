#pragma once

#include "core/real_time.hpp"

#include <vector>

namespace wholehand::squeeze_to_level {

/// A band of force to be held, both ends belong to it.
struct Band {
  double low_n = 0.0, high_n = 0.0;
};

struct BandRules {
  std::vector<Band> bands;
  double hold_s = 2.0;    ///< so long in all in each band
  double let_go_n = 0.3;  ///< below this the object is let go
};

/// What the person is to do now: index of [[panel.instructions]].
enum class Instruction { kReach, kMore, kHold, kLess, kLetGo, kDone };

/// What a tick brought.
struct BandNews {
  int held = -1;  ///< a band that is done now, -1: none
  bool entered = false, done = false;
};

/// Which band is to be held, for how long it was, and the score. A pure state machine: force in,
/// state out; real-time safe.
class BandSteps {
 public:
  /// @pre rules outlives this and has a band
  explicit BandSteps(const BandRules& rules) : rules_(rules) {}

  void reset() noexcept;

  /// @param near the hand is at the object @param ratio of every band's force, > 0
  WHOLEHAND_RT BandNews tick(double squeeze_n, bool near, double ratio, double elapsed_s) noexcept;

  [[nodiscard]] Instruction instruction() const noexcept { return instruction_; }
  [[nodiscard]] int band() const noexcept { return band_; }
  [[nodiscard]] int bandsDone() const noexcept { return bands_done_; }
  [[nodiscard]] double held_s() const noexcept { return held_s_; }
  [[nodiscard]] bool done() const noexcept { return instruction_ == Instruction::kDone; }
  /// Of the band that is to be held, at that ratio; 0 .. let_go_n while letting go or done [N].
  [[nodiscard]] WHOLEHAND_RT Band goal(double ratio) const noexcept;
  /// 0 .. 100: mean over all bands of the share of the time from first coming into the band until
  /// it was held that the force was within it. Bands to come count 0.
  [[nodiscard]] WHOLEHAND_RT double score() const noexcept;

 private:
  [[nodiscard]] bool lettingGo() const noexcept { return instruction_ == Instruction::kLetGo; }
  BandNews hold(double squeeze_n, bool near, const Band& goal, double elapsed_s) noexcept;

  const BandRules& rules_;
  Instruction instruction_ = Instruction::kReach;
  int band_ = 0, bands_done_ = 0;
  double held_s_ = 0.0;
  double since_entered_s_ = -1.0;  ///< below 0: not entered yet
  double earned_ = 0.0;            ///< sum over bands of 0 .. 1
};

}  // namespace wholehand::squeeze_to_level
