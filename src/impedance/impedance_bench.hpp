#pragma once

#include "assembly/rig.hpp"
#include "control/impedance.hpp"
#include "impedance/impedance_measurement.hpp"
#include "patient/player.hpp"

#include <complex>
#include <memory>
#include <vector>

namespace wholehand {

/// Frequencies with whole periods in a window, which a Fourier transform separates exactly: line i
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

/// Phasors of the lines from successive samples, over the windows since the start.
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

/// A person who pushes one axis with a sum of sines and holds the others. The push acts through an
/// arm so soft that only its target matters.
class MultisinePlayer final : public Player {
 public:
  /// @param amplitude effort per line of the grid  @param stiffness of the arm on the axis
  MultisinePlayer(AxisPosition rest, int axis, const LineGrid& grid,
                  const std::vector<double>& amplitude, double stiffness);

  [[nodiscard]] AxisPosition start() const override { return rest_; }
  void reset() override { periods_ = 0; }
  WHOLEHAND_RT void advance(double period_s, AxisPosition& q, AxisVelocity& qd) noexcept override;
  WHOLEHAND_RT void see(const TickRecord&) noexcept override {}

 private:
  AxisPosition rest_;
  int axis_;
  std::vector<double> aim_;  ///< target over one window, repeated
  std::size_t periods_ = 0;
};

/// Test bench of a device's impedance at one constant share Φ of the adaptive damping: the complete
/// renderer.
struct ImpedanceBench {
  Models models;
  std::unique_ptr<Rig> rig;  ///< in an empty world
  AxisPosition rest;         ///< the middle of every axis
  AxisMatrix inertia;        ///< inertia of the avatar there
  LineGrid grid;
  double phi = 0.0;
};

/// Device as in its file, or linearised: without dry friction and encoder steps.
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

/// Time until the transient of the push has decayed [s]; negative: never, or too long to wait.
[[nodiscard]] double settleTime(const AxisLoop& loop, ContactCase contact);

/// A world with a rigid stop or a spring at the axis's position. @pre not kFree
[[nodiscard]] std::unique_ptr<PhysicsWorld> contactWorld(const ImpedanceBench& bench, int axis,
                                                         ContactCase contact, double stiffness);

}  // namespace wholehand
