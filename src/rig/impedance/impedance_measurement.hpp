#pragma once

#include "certify/impedance.hpp"
#include "loop/patient/player.hpp"
#include "rig/engines.hpp"
#include "rig/models.hpp"
#include "rig/rig.hpp"

#include <complex>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace wholehand {

/// Band in which prediction and measurement are compared, and the largest allowed differences.
inline constexpr double kComparedFrom_hz = 1.0, kComparedTo_hz = 100.0;
inline constexpr double kMost_db = 1.0, kMost_deg = 5.0;

/// Z of one axis at one frequency.
struct ImpedancePoint {
  double frequency_hz = 0.0;
  FeltImpedance predicted, measured;
};

/// Largest deviation of measurements from predictions.
struct ImpedanceDeviation {
  double decibel = 0.0, degrees = 0.0;
  void include(std::complex<double> measured, std::complex<double> predicted);
  void include(const ImpedanceDeviation& other);
  [[nodiscard]] bool within() const { return decibel <= kMost_db && degrees <= kMost_deg; }
};

/// One axis in one contact at one share of the adaptive damping.
struct ImpedanceCurve {
  ContactCase contact = ContactCase::kFree;
  double phi = 0.0;
  double stiffness = 0.0;    ///< stiffness of the spring [N/m or N·m/rad]
  std::string engine;        ///< engine of the world
  std::string not_measured;  ///< reason why there is no measurement; empty: measured
  std::vector<ImpedancePoint> points;
  /// Predicted curve, with values between the points: frequency [Hz] and Z.
  std::vector<std::pair<double, std::complex<double>>> line;
  ImpedanceDeviation felt;  ///< deviation in the compared band
  ImpedanceDeviation
      alone;  ///< deviation of the model without inertial coupling from the prediction
};

/// Effect of dry friction and encoder steps, which are nonlinear; measured in free motion at Φ = 0
/// with one sine.
struct ImpedanceAsBuilt {
  double frequency_hz = 1.0;
  double speed = 0.0;  ///< target amplitude [m/s or rad/s]
  std::complex<double> linear, measured;
  std::string not_measured;  ///< reason why it was not measured; empty: measured
};

struct AxisImpedance {
  DeviceAxis axis;
  double position = 0.0;  ///< centre of the motion [m or rad]
  std::vector<ImpedanceCurve> curves;
  ImpedanceAsBuilt as_built;
};

struct ImpedanceReport {
  std::string device, rendering, hand;
  double period_s = 1e-3;
  double contact_stiffness_n_m = 0.0;
  std::string engine;  ///< engine of the free motion
  std::vector<AxisImpedance> axes;

  /// True if every curve was measured and agrees with its prediction.
  [[nodiscard]] bool asPredicted() const;
};

struct ImpedanceOptions {
  double period_s = 1e-3;
  /// Contact stiffness at the avatar; for a rotation multiplied by the square of its lever arm
  /// (0.08 m without one).
  double contact_stiffness_n_m = 1000.0;
  std::string engine = defaultEngine();  ///< engine of the free motion
};

/// Called with the name of the next measurement, the number of finished curves and their total
/// number.
using ImpedanceProgress = std::function<void(const std::string& what, int done, int all)>;

/// Predicts and measures the impedance rendered on every axis: in free motion, on a spring and
/// against a rigid stop, at Φ = 0 and 1. The measurement runs the renderer on the simulated clock
/// with the simulated device under a multisine effort. Free motion uses the requested engine,
/// contact uses the analytic world. Dry friction and encoder steps, which are nonlinear, are left
/// out except in `as_built`.
/// @pre device, rendering and hand of the models are loaded; other models are not used
[[nodiscard]] Expected<ImpedanceReport> measureImpedance(const Models& models,
                                                         const ImpedanceOptions& options,
                                                         const ImpedanceProgress& progress);

/// Frequencies with whole periods in a window, which a Fourier transform separates exactly. Line i
/// has lines[i] periods in `window` ticks.
struct LineGrid {
  int window = 0;
  double period_s = 1e-3;
  std::vector<int> lines;
  [[nodiscard]] double frequency_hz(std::size_t line) const {
    return lines[line] / (window * period_s);
  }
};

/// Logarithmically spaced lines from 0.1 Hz to just below half the rate.
[[nodiscard]] LineGrid lineGrid(double period_s);
/// A single line of four periods. @param frequency_hz approximate
[[nodiscard]] LineGrid oneLine(double frequency_hz, double period_s);

/// Computes the phasors of the lines from successive samples over the windows since the start.
class LineTransform {
 public:
  explicit LineTransform(const LineGrid& grid);
  void add(double sample);
  /// Amplitude (peak) and phase. @pre a whole number of windows was added
  [[nodiscard]] std::complex<double> phasor(std::size_t line) const;

 private:
  const LineGrid* grid_;
  std::vector<std::complex<double>> turn_, sum_;
  int added_ = 0;
};

/// A player that pushes one axis with a sum of sines and holds the others. The arm is so soft that
/// its force depends only on its target.
class MultisinePlayer final : public Player {
 public:
  /// @param amplitude effort per line of the grid @param stiffness stiffness of the arm on the axis
  MultisinePlayer(AxisPosition rest, int axis, const LineGrid& grid,
                  const std::vector<double>& amplitude, double stiffness);

  [[nodiscard]] AxisPosition start() const override { return rest_; }
  void reset() override { periods_ = 0; }
  WHOLEHAND_RT void advance(double period_s, AxisPosition& q, AxisVelocity& qd) noexcept override;
  WHOLEHAND_RT void onRecord(const TickRecord&) noexcept override {}

 private:
  AxisPosition rest_;
  int axis_;
  std::vector<double> aim_;  ///< target over one window, repeated
  std::size_t periods_ = 0;
};

/// Test bench for a device's impedance at one constant share Φ of the adaptive damping. It contains
/// the complete renderer.
struct ImpedanceBench {
  Models models;
  std::unique_ptr<Rig> rig;  ///< rig in an empty world
  AxisPosition rest;         ///< the middle of every axis
  AxisMatrix inertia;        ///< inertia of the avatar at `rest`
  LineGrid grid;
  double phi = 0.0;
};

/// Device model: kAsBuilt as in its file, kLinear without dry friction and encoder steps.
enum class BenchDevice { kLinear, kAsBuilt };

/// @param phi 0 or 1  @pre device, rendering and hand of the models are loaded
[[nodiscard]] Expected<ImpedanceBench> makeImpedanceBench(const Models& models, double phi,
                                                          const ImpedanceOptions& how,
                                                          BenchDevice device);

/// The middle of every axis's range.
[[nodiscard]] AxisPosition middleOf(const DeviceModel& device);

/// Model of the bench's axis for the prediction, with a spring [N/m or N·m/rad] if not 0.
[[nodiscard]] FeltLoop feltLoop(const ImpedanceBench& bench, int axis, double stiffness);

/// A person with negligible impedance on one axis, who clamps the others.
[[nodiscard]] PatientConfig armFor(const DeviceModel& device, int axis, double lowest_hz);

/// Time until the transient of the push has decayed [s]; negative: it never decays, or takes too
/// long.
[[nodiscard]] double settleTime(const AxisLoop& loop, ContactCase contact);

/// A world with a rigid stop or a spring at the axis's position. @pre not kFree
[[nodiscard]] std::unique_ptr<PhysicsWorld> contactWorld(const ImpedanceBench& bench, int axis,
                                                         ContactCase contact, double stiffness);

}  // namespace wholehand
