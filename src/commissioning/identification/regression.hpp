#pragma once

#include "commissioning/identification/axis_trace.hpp"
#include "commissioning/identification/identify_axis.hpp"

#include <Eigen/Core>

#include <array>
#include <vector>

namespace wholehand {

struct RegressionConfig {
  double low_pass_hz = 4.0;  ///< cut-off of the common filter, two equal poles
  double smooth_s = 0.004;   ///< Gaussian for the direction of motion
  double fade_s = 0.02;      ///< fade of the equation around a standstill
};

/// Stribeck terms sign(q̇) e^(−(q̇/v)²) of the friction, beside viscous and dry, with v these
/// shares of the RMS speed.
inline constexpr std::array<double, 4> kStribeckSpeeds = {0.07, 0.17, 0.4, 0.8};
/// Index of a Stribeck term; kPlain: none.
using FrictionModel = int;
inline constexpr FrictionModel kPlain = -1;

/// The filtered equation of one axis, as normal equations summed over parts of the data. Any sum of
/// parts is fitted at no extra cost. Not real-time safe.
class Regression {
 public:
  static constexpr int kTerms = 9;     ///< q̈, q̇, sign q̇, 1, q, kStribeckSpeeds
  static constexpr int kEfforts = 14;  ///< of now and earlier periods: delays to 11 periods
  static constexpr int kColumns = kTerms + kEfforts;
  using Sums = Eigen::Matrix<double, kColumns, kColumns>;

  Regression(const AxisTrace& trace, const RegressionConfig& config);

  /// Parts of one second each.
  [[nodiscard]] const std::vector<Sums>& blocks() const { return blocks_; }
  [[nodiscard]] const std::vector<Sums>& postures() const { return postures_; }
  /// Parts below and above the RMS speed.
  [[nodiscard]] const Sums& slow() const { return slow_; }
  [[nodiscard]] const Sums& fast() const { return fast_; }
  [[nodiscard]] const Sums& all() const { return all_; }
  /// RMS of the smoothed velocity [m/s or rad/s].
  [[nodiscard]] double speed() const { return speed_; }

  /// Figures with the least residual; the delay to a ten-millionth of a period.
  [[nodiscard]] AxisFigures fit(const Sums& sums, FrictionModel model) const;
  /// Residual sum of squares of the filtered effort.
  [[nodiscard]] double left(const Sums& sums, FrictionModel model) const;
  /// Change of each figure alone that could account for the residual.
  [[nodiscard]] AxisFigures hidden(const Sums& sums, const AxisFigures& fitted,
                                   FrictionModel model) const;

 private:
  double period_s_;
  double speed_ = 0.0;
  Sums all_, slow_, fast_;
  std::vector<Sums> blocks_, postures_;
};

/// Root mean square of the values; 0 of none.
[[nodiscard]] double rootMeanSquare(const std::vector<double>& values);

/// Smallest change of position in a trace; 0 where nothing moved [m or rad].
[[nodiscard]] double resolutionOf(const AxisTrace& trace);

}  // namespace wholehand
