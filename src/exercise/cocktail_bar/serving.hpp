#pragma once

#include "core/real_time.hpp"
#include "core/world_query.hpp"
#include "exercise/cocktail_bar/bar.hpp"
#include "exercise/cocktail_bar/bar_senses.hpp"
#include "exercise/cocktail_bar/slide.hpp"

#include <array>

namespace wholehand {

/// Brings the dispenser whose turn it is within reach and the glass under its nozzle, and stands
/// free dispensers up again. Moves only while the hand is drawn back and touches nothing.
class Serving {
 public:
  explicit Serving(const Bar& bar) : bar_(bar) {}

  void reset() noexcept;
  /// @param target whose turn it is; -1: nobody's, all stays @param running false: paused
  WHOLEHAND_RT void tick(const BarSenses& senses, int target, bool running,
                         BodyPlacements& placements) noexcept;

  /// The target is not yet served: row or glass is on its way, or waits for the hand to draw back.
  [[nodiscard]] bool pending() const noexcept { return pending_; }
  /// y of the first dispenser.
  [[nodiscard]] double rowY_m() const noexcept { return row_y_m_; }
  /// Dispensers that fell over since the last tick, and that were stood up: bits.
  [[nodiscard]] unsigned knockedOver() const noexcept { return knocked_over_; }
  [[nodiscard]] unsigned stoodUp() const noexcept { return stood_up_; }
  /// Dispensers that fell on their side, until they are picked up or stood up: bits.
  [[nodiscard]] unsigned leaking() const noexcept { return leaking_; }

 private:
  void slideRow(const BarSenses& senses, int target, bool may_move,
                BodyPlacements& placements) noexcept;
  void slideGlass(const BarSenses& senses, int target, bool may_move,
                  BodyPlacements& placements) noexcept;
  void standUp(const BarSenses& senses, bool may_move, BodyPlacements& placements) noexcept;
  [[nodiscard]] double wantedRowY_m(int target) const noexcept;
  [[nodiscard]] bool homeIsFree(const BarSenses& senses, std::size_t dispenser) const noexcept;

  const Bar& bar_;
  bool placed_ = false;  ///< row and glass are known
  bool pending_ = false;
  double row_y_m_ = 0.0, row_from_m_ = 0.0, row_to_m_ = 0.0;
  Slide row_;
  Eigen::Vector3d glass_m_, glass_from_m_, glass_to_m_;
  Slide glass_;
  std::array<bool, kMaxDispensers> lying_{};     ///< or standing where nobody can reach them
  std::array<double, kMaxDispensers> away_s_{};  ///< how long it lies with the hand away
  unsigned leaking_ = 0;
  unsigned knocked_over_ = 0, stood_up_ = 0;
};

}  // namespace wholehand
