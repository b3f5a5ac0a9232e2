#pragma once

#include "commissioning/identification/axis_trace.hpp"
#include "commissioning/identification/identify_axis.hpp"

#include <Eigen/Core>

#include <array>
#include <vector>

namespace wholehand {

struct RegressionConfig {
  double low_pass_hz = 4.0;  ///< of the common filter, two equal poles
  double smooth_s = 0.004;   ///< Gauss, for the direction of motion
  double fade_s = 0.02;      ///< of the equation about a standstill
};

/// Which friction the equation has besides viscous and dry: sign(q̇) e^(−(q̇/v)²) (Stribeck), v these
/// shares of the root mean square speed.
inline constexpr std::array<double, 4> kStribeckSpeeds = {0.07, 0.17, 0.4, 0.8};
/// An index into them; kPlain: none.
using FrictionModel = int;
inline constexpr FrictionModel kPlain = -1;

/// The filtered equation of one axis, summed over parts of the data: a fit of any sum of parts
/// costs nothing. Not for the tick.
class Regression {
 public:
  static constexpr int kTerms = 9;     ///< q̈, q̇, sign q̇, 1, q, kStribeckSpeeds
  static constexpr int kEfforts = 14;  ///< of now and the periods before: delays to 11 periods
  static constexpr int kColumns = kTerms + kEfforts;
  using Sums = Eigen::Matrix<double, kColumns, kColumns>;

  Regression(const AxisTrace& trace, const RegressionConfig& config);

  /// Of one second each.
  [[nodiscard]] const std::vector<Sums>& blocks() const { return blocks_; }
  [[nodiscard]] const std::vector<Sums>& postures() const { return postures_; }
  /// Below and above the root mean square speed.
  [[nodiscard]] const Sums& slow() const { return slow_; }
  [[nodiscard]] const Sums& fast() const { return fast_; }
  [[nodiscard]] const Sums& all() const { return all_; }
  /// Of the smoothed velocity [m/s or rad/s].
  [[nodiscard]] double speed() const { return speed_; }

  /// The figures that leave the least; the delay to a ten-millionth of a period.
  [[nodiscard]] AxisFigures fit(const Sums& sums, FrictionModel model) const;
  /// Sum of squares of filtered effort that these figures do not explain.
  [[nodiscard]] double left(const Sums& sums, FrictionModel model) const;
  /// How far each figure would move if as much effort as is left unexplained hid in it alone.
  [[nodiscard]] AxisFigures hidden(const Sums& sums, const AxisFigures& fitted,
                                   FrictionModel model) const;

 private:
  double period_s_;
  double speed_ = 0.0;
  Sums all_, slow_, fast_;
  std::vector<Sums> blocks_, postures_;
};

/// 0 of none.
[[nodiscard]] double rootMeanSquare(const std::vector<double>& values);

/// The smallest change of position in a trace; 0 where nothing moved [m or rad].
[[nodiscard]] double resolutionOf(const AxisTrace& trace);

}  // namespace wholehand
