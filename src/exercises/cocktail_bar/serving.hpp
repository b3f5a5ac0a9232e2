#pragma once

#include "exercises/cocktail_bar/bar.hpp"
#include "exercises/cocktail_bar/pouring.hpp"
#include "loop/core/real_time.hpp"
#include "loop/core/world_query.hpp"

#include <algorithm>
#include <array>

namespace wholehand {

/// A minimum-jerk slide from 0 to 1 that can be frozen: it stops at once and restarts smoothly.
struct Slide {
  double duration_s = 0.0;  ///< 0: no slide
  double time_s = 0.0;      ///< time along the slide, stopped while frozen
  double pace = 0.0;        ///< 0 frozen, 1 as planned

  [[nodiscard]] bool active() const noexcept { return duration_s > 0.0 && time_s < duration_s; }
  /// 10 u³ − 15 u⁴ + 6 u⁵
  [[nodiscard]] WHOLEHAND_RT double share() const noexcept {
    const double u = duration_s > 0.0 ? std::clamp(time_s / duration_s, 0.0, 1.0) : 1.0;
    return u * u * u * (10.0 + u * (6.0 * u - 15.0));
  }
  /// Present rate of share() [1/s].
  [[nodiscard]] WHOLEHAND_RT double rate_per_s() const noexcept {
    if (!active()) return 0.0;
    const double u = time_s / duration_s;
    return pace * 30.0 * u * u * (1.0 - u) * (1.0 - u) / duration_s;
  }
  WHOLEHAND_RT void advance(bool may_move, double elapsed_s) noexcept {
    constexpr double kStart_s = 0.15;
    pace = may_move ? std::min(1.0, pace + elapsed_s / kStart_s) : 0.0;
    if (active()) time_s = std::min(duration_s, time_s + pace * elapsed_s);
  }
};

/// Moves the target dispenser within reach and the glass under its nozzle, only while the hand is
/// withdrawn and touches nothing. Returns free dispensers that lie or are out of reach to their
/// places; this happens only while the hand is withdrawn, grips nothing and is clear of those
/// places.
class Serving {
 public:
  explicit Serving(const Bar& bar) : bar_(bar) {}

  /// Resets the state; bodies stay in place.
  void reset() noexcept;
  /// Returns every dispenser to its place as soon as the hand allows. Real-time safe.
  WHOLEHAND_RT void bringHome() noexcept;
  /// @param target target dispenser; -1: none, nothing moves @param reach range of the row
  /// @param running false: paused
  WHOLEHAND_RT void tick(const BarObservation& senses, const HandPosture& hand, int target,
                         const RowReach& reach, bool running, BodyPlacements& placements) noexcept;

  /// True while the target is not in place: row or glass moves or waits for the hand to withdraw.
  [[nodiscard]] bool pending() const noexcept { return pending_; }
  /// y of the first dispenser.
  [[nodiscard]] double rowY_m() const noexcept { return row_y_m_; }
  /// Bit masks of the dispensers that fell over and that were put upright since the last tick.
  [[nodiscard]] unsigned knockedOver() const noexcept { return knocked_over_; }
  [[nodiscard]] unsigned stoodUp() const noexcept { return stood_up_; }
  /// Bit mask of the lying dispensers that leak; a bit is cleared when the dispenser is picked up
  /// or put upright.
  [[nodiscard]] unsigned leaking() const noexcept { return leaking_; }

 private:
  void startRow(int target) noexcept;
  void slideRow(const BarObservation& senses, int target, bool may_move,
                BodyPlacements& placements) noexcept;
  void slideGlass(const BarObservation& senses, int target, bool may_move,
                  BodyPlacements& placements) noexcept;
  void standUp(const BarObservation& senses, const HandPosture& hand, bool may_move,
               BodyPlacements& placements) noexcept;
  void noteLying(const BarObservation& senses, std::size_t i, bool may_move) noexcept;
  [[nodiscard]] bool atHome(const BarObservation& senses, std::size_t dispenser) const noexcept;
  [[nodiscard]] double wantedRowY_m(int target) const noexcept;
  [[nodiscard]] bool isNear(const HandPosture& hand, const BarObservation& senses) const noexcept;
  [[nodiscard]] bool blocksHome(const BarObservation& senses, std::size_t other,
                                std::size_t dispenser) const noexcept;

  const Bar& bar_;
  bool placed_ = false;  ///< positions of row and glass are known
  bool pending_ = false;
  double row_y_m_ = 0.0, row_from_m_ = 0.0, row_to_m_ = 0.0;
  /// Shift of the row towards the hand: now, at the start and at the end of a slide.
  double nearer_m_ = 0.0, nearer_from_m_ = 0.0, nearer_to_m_ = 0.0;
  RowReach reach_;
  Slide row_;
  Eigen::Vector3d glass_m_, glass_from_m_, glass_to_m_;
  Slide glass_;
  bool row_home_ = false;                     ///< the row also returns to its place
  std::array<bool, kMaxDispensers> lying_{};  ///< lying, or standing out of reach
  std::array<bool, kMaxDispensers>
      called_{};  ///< dispensers that return to their place from anywhere
  std::array<double, kMaxDispensers> away_s_{};  ///< time lying with the hand withdrawn
  unsigned leaking_ = 0;
  unsigned knocked_over_ = 0, stood_up_ = 0;
};

}  // namespace wholehand
