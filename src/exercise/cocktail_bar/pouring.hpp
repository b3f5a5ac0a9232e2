#pragma once

#include "core/exercise_record.hpp"
#include "core/real_time.hpp"
#include "exercise/cocktail_bar/bar.hpp"
#include "exercise/cocktail_bar/bar_senses.hpp"
#include "exercise/cocktail_bar/ledger.hpp"

#include <array>

namespace wholehand {

/// What is to be poured now.
struct PourOrder {
  int dispenser = -1;  ///< whose turn it is; -1: nothing is asked for, whatever flows is spilt
  int step = 0;
  double amount_l = 0.0, tolerance_l = 0.0;
};

/// Squeeze, flow and where it goes. Flow of the dispenser that is held, thinnest liquid:
///   clamp(l_per_s_n · (squeeze − threshold), 0, max_l_s) / viscosity,
/// squeeze what is felt of it at the fingertips (feltSqueeze_n), low-passed. Into the glass when it
/// is asked for and the nozzle is over the glass, as far as tolerance and glass take it; spilt
/// otherwise.
class Pouring {
 public:
  explicit Pouring(const Bar& bar) : bar_(bar) { reset(); }

  void reset() noexcept;
  void newGlass() noexcept { ledger_.newGlass(); }

  /// @param engaged the dispenser that is held, -1: none @param leaking those that lie and leak:
  /// bits
  /// @param threshold_ratio of the squeeze's thresholds @param running false: nothing flows
  WHOLEHAND_RT void tick(const BarSenses& senses, const PourOrder& order, int engaged,
                         unsigned leaking, double threshold_ratio, bool running,
                         ExerciseRecord& out) noexcept;

  [[nodiscard]] const Ledger& ledger() const noexcept { return ledger_; }
  [[nodiscard]] double squeeze_n(int dispenser) const noexcept;
  /// Of the dispenser that is held, wherever it goes.
  [[nodiscard]] double flow_l_s() const noexcept { return flow_l_s_; }
  [[nodiscard]] bool intoGlass() const noexcept { return into_glass_; }
  [[nodiscard]] bool empty(int dispenser) const noexcept {
    return !(ledger_.left_l(dispenser) > 0.0);
  }
  /// Nothing flows from the dispenser and the hand does not press it.
  [[nodiscard]] bool letGo(int dispenser) const noexcept;

 private:
  [[nodiscard]] double wanted_l_s(int dispenser, double threshold_ratio) const noexcept;
  void tellOf(const PourOrder& order, double before_l, double spilt_before_l, bool was_into_glass,
              ExerciseRecord& out) noexcept;

  const Bar& bar_;
  Ledger ledger_;
  std::array<double, kMaxDispensers> squeeze_n_{};
  int flowing_ = -1;  ///< dispenser that flow_l_s_ is of
  double flow_l_s_ = 0.0;
  bool into_glass_ = false;
  bool spilling_ = false;
};

}  // namespace wholehand
