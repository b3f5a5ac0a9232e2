#pragma once

#include "exercises/cocktail_bar/bar.hpp"
#include "loop/core/real_time.hpp"
#include "loop/core/tick_record.hpp"
#include "loop/exercise/grip.hpp"

#include <Eigen/Core>

#include <array>
#include <cstdint>

namespace wholehand {

/// Evaluated observation of a tick. Indices refer to Bar::dispensers; -1: none.
struct BarObservation {
  double elapsed_s = 0.0;
  std::array<double, kMaxDispensers> force_n{};    ///< summed normal contact force on each
  std::array<double, kMaxDispensers> squeeze_n{};  ///< filled in after the walls are known
  std::array<bool, kMaxDispensers> touched{};
  std::array<Eigen::Vector3d, kMaxDispensers> at_m;      ///< centre of mass
  std::array<Eigen::Vector3d, kMaxDispensers> nozzle_m;  ///< world
  std::array<double, kMaxDispensers> tilt_rad{};         ///< angle of its axis from vertical
  Eigen::Vector3d glass_m = Eigen::Vector3d::Zero();     ///< centre of mass
  bool touches_any = false;  ///< contact with a dispenser of the row or the glass
  int nearest = -1;          ///< dispenser nearest to the palm, on any side
  double palm_m = 0.0;     ///< distance from the palm's surface to it; +inf: none, or it is not in
                           ///< front of the palm
  bool grips_any = false;  ///< the palmar side holds a dispenser
  bool behind = false;     ///< the hand's x is below the limit of a withdrawn hand
  /// The hand is withdrawn, touches nothing and does not obstruct a sliding row.
  bool drawn_back = false;

  /// True when flow from the nozzle would fall into the glass, whatever its level.
  [[nodiscard]] WHOLEHAND_RT bool overGlass(int dispenser, const BarGlass& glass) const noexcept;
};

/// Evaluates a record. @param hand hand in the record's posture. Real-time safe.
[[nodiscard]] WHOLEHAND_RT BarObservation observeBar(const Bar& bar, const TickRecord& record,
                                                     const HandPosture& hand,
                                                     double period_s) noexcept;

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

/// The current pouring task.
struct PourOrder {
  int dispenser = -1;  ///< target; -1: none, any flow is spilt
  int step = 0;
  double amount_l = 0.0, tolerance_l = 0.0;
};

/// Effect of the cushions on the held dispenser in one tick.
struct Stroke {
  double out_l = 0.0;      ///< liquid that left the nozzle
  double pressed_l = 0.0;  ///< volume by which the shell is pressed in
};

/// Computes squeeze, flow and the destination of the flow. The squeeze is the low-passed force
/// rendered at the fingertips (feltSqueeze_n). The flow is what leaves the held dispenser's
/// cushions. It goes into the glass if the dispenser is the target and its nozzle is over the
/// glass, up to the step's tolerance and the glass's capacity; the rest is spilt.
class Pouring {
 public:
  explicit Pouring(const Bar& bar) : bar_(bar), thinnest_pa_s_(thinnest_pa_s(bar.liquids)) {
    reset();
  }

  void reset() noexcept;
  void newGlass() noexcept { ledger_.newGlass(); }

  /// @param engaged held dispenser, -1: none @param leaking bit mask of lying, leaking dispensers
  /// @param threshold_ratio factor on the squeeze's thresholds @param running false: nothing flows
  WHOLEHAND_RT void tick(const BarObservation& senses, const PourOrder& order, int engaged,
                         const Stroke& stroke, unsigned leaking, double threshold_ratio,
                         bool running, ExerciseRecord& out) noexcept;

  [[nodiscard]] const Ledger& ledger() const noexcept { return ledger_; }
  [[nodiscard]] double squeeze_n(int dispenser) const noexcept;
  /// Flow of the held dispenser, to any destination.
  [[nodiscard]] double flow_l_s() const noexcept { return flow_l_s_; }
  [[nodiscard]] bool intoGlass() const noexcept { return into_glass_; }
  [[nodiscard]] bool empty(int dispenser) const noexcept {
    return !(ledger_.left_l(dispenser) > 0.0);
  }
  /// True when the held dispenser is squeezed but hardly flows any more; stays true until air has
  /// refilled its shell.
  [[nodiscard]] bool spent() const noexcept { return spent_; }
  /// True when the dispenser does not flow and the hand does not press it. A hanging dispenser also
  /// counts as released when the hand has rested on it below the squeeze's threshold.
  [[nodiscard]] bool letGo(int dispenser) const noexcept;

 private:
  void follow(const Stroke& stroke, bool squeezes, double elapsed_s) noexcept;
  void addEvents(const PourOrder& order, double before_l, double spilt_before_l,
                 bool was_into_glass, ExerciseRecord& out) noexcept;

  const Bar& bar_;
  const double thinnest_pa_s_;
  Ledger ledger_;
  std::array<double, kMaxDispensers> squeeze_n_{};
  int flowing_ = -1;  ///< dispenser whose flow is flow_l_s_
  double flow_l_s_ = 0.0;
  bool into_glass_ = false;
  bool spilling_ = false;
  bool spent_ = false;
  double fastest_l_s_ = 0.0, slow_s_ = 0.0,
         rested_s_ = 0.0;    ///< fastest flow, time of slow flow, time at rest, in this stroke
  double spent_at_l_ = 0.0;  ///< volume pressed in when the stroke was spent
};

}  // namespace wholehand
