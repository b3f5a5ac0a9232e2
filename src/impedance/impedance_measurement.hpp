#pragma once

#include "assembly/engines.hpp"
#include "assembly/models.hpp"
#include "control/impedance.hpp"

#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace wholehand {

/// Band in which prediction and measurement are compared, and the allowed difference.
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
  std::string not_measured;  ///< why there is no measurement; empty: there is
  std::vector<ImpedancePoint> points;
  /// Prediction, also between the points: frequency [Hz] and Z.
  std::vector<std::pair<double, std::complex<double>>> line;
  ImpedanceDeviation felt;   ///< deviation in the compared band
  ImpedanceDeviation alone;  ///< of the model without inertial coupling, from the prediction
};

/// Effect of dry friction and encoder steps, which are nonlinear: free motion, Φ = 0, one sine.
struct ImpedanceAsBuilt {
  double frequency_hz = 1.0;
  double speed = 0.0;  ///< target amplitude [m/s or rad/s]
  std::complex<double> linear, measured;
  std::string not_measured;  ///< why not measured; empty: it was
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
  std::string engine;  ///< of free motion
  std::vector<AxisImpedance> axes;

  /// True if every curve was measured and agrees with its prediction.
  [[nodiscard]] bool asPredicted() const;
};

struct ImpedanceOptions {
  double period_s = 1e-3;
  /// At the avatar; on a rotation times the square of its lever arm (0.08 m without one).
  double contact_stiffness_n_m = 1000.0;
  std::string engine = defaultEngine();  ///< of free motion
};

/// Called with the next measurement and the number of curves done and in total.
using ImpedanceProgress = std::function<void(const std::string& what, int done, int all)>;

/// Predicts and measures the impedance felt on every axis: free, on a spring, against a rigid stop,
/// at Φ = 0 and 1. The measurement runs the renderer on the simulated clock with the simulated
/// device, under a multisine effort: free motion in the requested engine, contact in the analytic
/// world. Dry friction and encoder steps, which are nonlinear, are left out except in `as_built`.
/// @pre device, rendering and hand of the models are loaded; the rest is not used
[[nodiscard]] Expected<ImpedanceReport> measureImpedance(const Models& models,
                                                         const ImpedanceOptions& options,
                                                         const ImpedanceProgress& progress);

}  // namespace wholehand
