#pragma once

#include "assembly/engines.hpp"
#include "assembly/models.hpp"
#include "control/impedance.hpp"

#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace wholehand {

/// The band in which prediction and measurement are held against each other, and by how much they
/// may differ.
inline constexpr double kComparedFrom_hz = 1.0, kComparedTo_hz = 100.0;
inline constexpr double kMost_db = 1.0, kMost_deg = 5.0;

/// Z of one axis at one frequency.
struct ImpedancePoint {
  double frequency_hz = 0.0;
  FeltImpedance predicted, measured;
};

/// How far measurements are from predictions, at worst.
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
  double stiffness = 0.0;    ///< kObject: of the spring [N/m or N·m/rad]
  std::string engine;        ///< of the world in which it was measured
  std::string not_measured;  ///< why there are no measurements; empty: there are
  std::vector<ImpedancePoint> points;
  /// The prediction between the points, too: frequency [Hz] and Z.
  std::vector<std::pair<double, std::complex<double>>> line;
  ImpedanceDeviation felt;   ///< from kComparedFrom_hz to kComparedTo_hz
  ImpedanceDeviation alone;  ///< of the model in which inertia couples no axes, from the prediction
};

/// What dry friction and encoder steps, which are not linear, make of it: free, Φ = 0, one sine.
struct ImpedanceAsBuilt {
  double frequency_hz = 1.0;
  double speed = 0.0;  ///< amplitude that was aimed at [m/s or rad/s]
  std::complex<double> linear, measured;
  std::string not_measured;  ///< why not; empty: it was
};

struct AxisImpedance {
  DeviceAxis axis;
  double position = 0.0;  ///< around which it was moved [m or rad]
  std::vector<ImpedanceCurve> curves;
  ImpedanceAsBuilt as_built;
};

struct ImpedanceReport {
  std::string device, rendering, hand;
  double period_s = 1e-3;
  double contact_stiffness_n_m = 0.0;
  std::string engine;  ///< of free motion
  std::vector<AxisImpedance> axes;

  /// Every curve was measured and is as predicted.
  [[nodiscard]] bool asPredicted() const;
};

struct ImpedanceOptions {
  double period_s = 1e-3;
  /// At the avatar; on a rotation times the square of its lever arm (0.08 m where it has none).
  double contact_stiffness_n_m = 1000.0;
  std::string engine = defaultEngine();  ///< of free motion
};

/// Told what is measured next and how many curves of how many are done.
using ImpedanceProgress = std::function<void(const std::string& what, int done, int all)>;

/// Predicts and measures what the person feels on every axis: free, on a spring, against a rigid
/// stop, at Φ = 0 and 1. Measured is the running renderer on the simulated clock with the simulated
/// device, under an effort of many sines at once; free motion in the engine that was asked for,
/// contact in the analytic world. Dry friction and encoder steps are left out but in `as_built`:
/// they are not linear.
/// @pre device, rendering and hand of the models are loaded; the rest is not looked at
[[nodiscard]] Expected<ImpedanceReport> measureImpedance(const Models& models,
                                                         const ImpedanceOptions& options,
                                                         const ImpedanceProgress& progress);

}  // namespace wholehand
