#pragma once

#include "core/real_time.hpp"
#include "core/world_query.hpp"
#include "exercise/cocktail_bar/bar.hpp"
#include "exercise/cocktail_bar/bar_patient.hpp"
#include "exercise/cocktail_bar/bar_senses.hpp"
#include "exercise/cocktail_bar/slide.hpp"

#include <array>

namespace wholehand {

/// Brings the dispenser whose turn it is within reach and the glass under its nozzle: only while
/// the hand is drawn back and touches nothing. Brings free dispensers home that lie or are out of
/// reach: only while the hand is drawn back, grips nothing and is clear of where they go.
class Serving {
 public:
  explicit Serving(const Bar& bar) : bar_(bar) {}

  /// Bodies stay where they are.
  void reset() noexcept;
  /// Every dispenser goes home as soon as the hand allows it. Real-time safe.
  WHOLEHAND_RT void bringHome() noexcept;
  /// @param target whose turn it is; -1: nobody's, all stays @param reach where the row may be
  /// @param running false: paused
  WHOLEHAND_RT void tick(const BarSenses& senses, const HandPosture& hand, int target,
                         const RowReach& reach, bool running, BodyPlacements& placements) noexcept;

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
  void startRow(int target) noexcept;
  void slideRow(const BarSenses& senses, int target, bool may_move,
                BodyPlacements& placements) noexcept;
  void slideGlass(const BarSenses& senses, int target, bool may_move,
                  BodyPlacements& placements) noexcept;
  void standUp(const BarSenses& senses, const HandPosture& hand, bool may_move,
               BodyPlacements& placements) noexcept;
  void noteLying(const BarSenses& senses, std::size_t i, bool may_move) noexcept;
  [[nodiscard]] bool atHome(const BarSenses& senses, std::size_t dispenser) const noexcept;
  [[nodiscard]] double wantedRowY_m(int target) const noexcept;
  [[nodiscard]] bool isNear(const HandPosture& hand, const BarSenses& senses) const noexcept;
  [[nodiscard]] bool blocksHome(const BarSenses& senses, std::size_t other,
                                std::size_t dispenser) const noexcept;

  const Bar& bar_;
  bool placed_ = false;  ///< row and glass are known
  bool pending_ = false;
  double row_y_m_ = 0.0, row_from_m_ = 0.0, row_to_m_ = 0.0;
  double nearer_m_ = 0.0, nearer_from_m_ = 0.0, nearer_to_m_ = 0.0;  ///< the row, than in the scene
  RowReach reach_;
  Slide row_;
  Eigen::Vector3d glass_m_, glass_from_m_, glass_to_m_;
  Slide glass_;
  bool row_home_ = false;                        ///< the row is to go home, too
  std::array<bool, kMaxDispensers> lying_{};     ///< or standing where nobody can reach them
  std::array<bool, kMaxDispensers> called_{};    ///< home, wherever they are
  std::array<double, kMaxDispensers> away_s_{};  ///< how long it lies with the hand away
  unsigned leaking_ = 0;
  unsigned knocked_over_ = 0, stood_up_ = 0;
};

}  // namespace wholehand
