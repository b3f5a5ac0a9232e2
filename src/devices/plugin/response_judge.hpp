#pragma once

#include "loop/core/axis_array.hpp"

#include <array>
#include <cstddef>

namespace wholehand {

/// Figures of an axis that commissioning measured, for the judges of a session. SI; per radian for
/// a rotation.
struct MeasuredAxis {
  double mass = 0.0;         ///< [kg or kg·m²]
  double damping = 0.0;      ///< viscous [N·s/m or N·m·s/rad]
  double delay_s = 0.0;      ///< from an effort to its effect, lag of the drive included
  double drive_lag_s = 0.0;  ///< time constant of the drive's measured effort; 0: it measures none
};

/// One axis as commissioning measured it. SI; per radian for a rotation.
struct ResponseModel {
  double mass = 0.0;          ///< [kg or kg·m²]; 0: not measured, the axis is not judged
  double damping = 0.0;       ///< viscous [N·s/m or N·m·s/rad]
  double delay_s = 0.0;       ///< from an effort to its effect, lag of the drive included
  double effort_limit = 1.0;  ///< [N or N·m]
};

/// Band of the judge: four equal high-pass poles at 15 Hz and four low-pass poles at 40 Hz.
/// Single poles, because a sharper filter rings for longer after a knock. Real-time safe.
class ResponseBand {
 public:
  ResponseBand() = default;
  /// @param high_hz frequency of the high-pass poles
  ResponseBand(double high_hz, double period_s) noexcept;
  [[nodiscard]] double pass(double value) noexcept;

 private:
  double high_share_ = 0.0, low_share_ = 0.0;
  std::array<double, 4> high_{};
  std::array<double, 4> low_{};
};

/// Judges above 15 Hz whether axes respond to our own changes of effort as commissioning measured.
///
/// Of an axis of mass m and damping b, held by a person with the impedance Z and pushed by h,
///   y := m q̈ + b q̇ = u(t - d) - Z q̇ + h.
/// y follows from the positions, u from the efforts sent; both pass the band. There a limb is a
/// mass M and a damper, muscles are too slow to act, and so without knocks
///   y = s u,  s = m / (m + M),  0 < s <= 1,  whatever the person wants.
/// An episode lasts until u has changed enough to be judged, and has 70 ms of change at least. With
/// the correlation r of u and y and the share s = Σ u y / Σ u², an episode
///   - contradicts if r < -0.7: the sign is wrong, or the delay is longer by half a period;
///   - contradicts if r < 0.3 and another axis, which was sent little, follows u with r > 0.8;
///   - exceeds if r > 0.9 and s > 2: more effort acts than was sent;
///   - agrees if r > 0.3 and s < 2.
/// It accuses nobody if u changed below 16 Hz for the most part: that may be a tremor.
/// A knock may do either for an episode or two. So a contradiction counts 2, an excess 1; an
/// agreement takes 1 from the contradictions and 2 from the excesses. 6 of the one or 20 of the
/// other are astray.
///
/// Pure, deterministic, of fixed size; real-time safe.
class ResponseJudge {
 public:
  static constexpr int kMostContradictions = 6, kMostExcesses = 20;
  static constexpr double kLeastEpisode_s = 0.07;

  using Models = std::array<ResponseModel, kMaxAxes>;

  ResponseJudge() = default;
  ResponseJudge(const Models& models, int axes, double period_s) noexcept;

  /// Begins after a gap or when the device was enabled: forgets everything but what was counted.
  void begin() noexcept;
  /// The effort in force until the next one.
  void send(const AxisEffort& effort) noexcept;
  /// Judges a period. @return true if the response of an axis is astray
  /// @param position read at the end of the period
  [[nodiscard]] bool isAstray(const AxisPosition& position) noexcept;

  /// Counts of an axis, for tests.
  [[nodiscard]] int contradictions(int axis) const noexcept { return at(axis).contradictions; }
  [[nodiscard]] int excesses(int axis) const noexcept { return at(axis).excesses; }

 private:
  static constexpr int kMostDelay = 32;  ///< longest delay that is judged [periods]

  struct Axis {
    ResponseModel model;
    std::array<double, 3> weights{};  ///< of the efforts `whole` periods back and before
    int whole = 0;
    ResponseBand efforts, responses, faster;
    std::array<double, kMostDelay> sent{};          ///< a ring
    std::array<double, 2> before{};                 ///< the last two positions
    double u = 0.0, y = 0.0;                        ///< in the band
    double change = 0.0;                            ///< mean square of u
    double u_faster = 0.0;                          ///< u beyond a higher high-pass
    double above_tremor = 0.0;                      ///< ∫ u_faster² dt of the episode
    std::array<double, kMaxAxes> uy{}, yy{}, uu{};  ///< sums of the episode with every axis
    int length = 0;                                 ///< of the episode [periods]
    int contradictions = 0, excesses = 0;
  };
  Axis& at(int axis) noexcept { return judged_[static_cast<std::size_t>(axis)]; }
  [[nodiscard]] const Axis& at(int axis) const noexcept {
    return judged_[static_cast<std::size_t>(axis)];
  }
  void filter(Axis& axis, double position, double effort) noexcept;
  void add(int axis) noexcept;
  void close(int axis) noexcept;
  [[nodiscard]] bool anotherFollows(int axis) const noexcept;

  int axes_ = 0;
  double period_s_ = 1e-3, kept_ = 0.0;
  int settles_ = 0, newest_ = 0;
  bool fresh_ = true;  ///< no position since begin()
  AxisEffort effort_;
  std::array<Axis, kMaxAxes> judged_{};
};

}  // namespace wholehand
