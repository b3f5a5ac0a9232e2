#pragma once

#include "core/real_time.hpp"
#include "exercise/cocktail_bar/bar.hpp"

#include <array>
#include <cstdint>

namespace wholehand {

/// Balance of all liquid. Counts whole picolitres (10⁻¹² l), so that poured + spilt + left equals
/// the initial volume exactly, however long the play.
class Ledger {
 public:
  /// Refills the dispensers and resets the balance.
  void fill(const std::vector<BarDispenser>& dispensers) noexcept;

  /// Takes up to `volume_l` out of a dispenser. It goes into the glass as layer `step`, as far as
  /// the glass and `room_l` of the step allow; the rest is spilt. @return volume that left the
  /// dispenser [l]
  WHOLEHAND_RT double pour(int dispenser, double volume_l, int step, double room_l,
                           double capacity_l) noexcept;
  /// Takes up to `volume_l` out of a dispenser and spills it. @return volume that left it [l]
  WHOLEHAND_RT double spill(int dispenser, double volume_l) noexcept;
  /// Replaces the glass. Its content still counts as poured.
  WHOLEHAND_RT void newGlass() noexcept;

  [[nodiscard]] double left_l(int dispenser) const noexcept;
  [[nodiscard]] double layer_l(int step) const noexcept;
  [[nodiscard]] double glass_l() const noexcept;
  [[nodiscard]] double poured_l() const noexcept;  ///< in all glasses
  [[nodiscard]] double spilt_l() const noexcept;
  [[nodiscard]] double start_l() const noexcept;

 private:
  using Picolitres = std::int64_t;
  Picolitres take(int dispenser, double volume_l) noexcept;

  std::array<Picolitres, kMaxDispensers> left_{};
  std::array<Picolitres, kMaxSteps> layer_{};
  Picolitres start_ = 0, glass_ = 0, poured_ = 0, spilt_ = 0;
};

}  // namespace wholehand
