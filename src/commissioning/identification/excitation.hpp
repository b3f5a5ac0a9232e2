#pragma once

#include <array>
#include <cstddef>

namespace wholehand {

/// Prior knowledge of an axis before its measurement. SI; per radian for a rotation.
struct ExcitationPlan {
  double period_s = 1e-3;
  double lower = 0.0, upper = 0.0;  ///< usable travel [m or rad]
  double mass = 1.0;          ///< approximate moving mass, from the device file [kg or kg·m²]
  double effort_limit = 1.0;  ///< never exceeded [N or N·m]
  double offset = 0.0;        ///< effort that balances gravity [N or N·m]
  double duration_s = 20.0;
};

/// Excites one axis so that its mass, friction and delay become identifiable. In each of three
/// postures: a slow sweep to and fro, then a soft spring that follows a multisine of 0.3 to 5 Hz,
/// plus a multisine of efforts of 6 to 40 Hz. The frequencies do not depend on the axis; the
/// amplitudes follow from its travel and effort limit.
class Excitation {
 public:
  explicit Excitation(const ExcitationPlan& plan);

  /// Effort of this tick, within ± effort_limit [N or N·m].
  /// @param position as read in this tick [m or rad]
  [[nodiscard]] double next(double position);
  [[nodiscard]] bool done() const { return tick_ >= ticks_; }
  [[nodiscard]] std::size_t ticks() const { return ticks_; }
  /// Posture of the tick that next() returns next: 0, 1, 2.
  [[nodiscard]] int posture() const;
  static constexpr int kPostures = 3;

 private:
  struct Wanted {
    double position = 0.0, velocity = 0.0;
  };
  [[nodiscard]] Wanted reference(double time_s, double centre) const;

  ExcitationPlan plan_;
  std::size_t ticks_ = 0, tick_ = 0;
  double stiffness_ = 0.0, damping_ = 0.0;
  double amplitude_ = 0.0;  ///< amplitude of the reference [m or rad]
  double effort_ = 0.0;     ///< amplitude of the multisine of efforts, its RMS times √2
  double last_ = 0.0, velocity_ = 0.0, wanted_ = 0.0;
};

}  // namespace wholehand
