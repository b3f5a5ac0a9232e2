#pragma once

#include <limits>
#include <vector>

namespace wholehand {

struct PlotPoint {
  double x = 0.0, y = 0.0;
};

/// Thins a series of any length to what a plot of `columns` pixels can show: the smallest and the
/// largest value of every column, in the order in which they came, so that no peak is lost.
/// A value that is not finite breaks the line (a point with y = NaN).
class Decimator {
 public:
  /// @pre columns >= 1
  Decimator(double x_min, double x_max, int columns)
      : x_min_(x_min), x_max_(x_max), columns_(columns) {}

  /// Adds a point; x must not fall from one to the next.
  void add(double x, double y);
  /// All points so far.
  [[nodiscard]] std::vector<PlotPoint> points() const;

 private:
  void closeColumn(std::vector<PlotPoint>& out) const;

  double x_min_, x_max_;
  int columns_, column_ = -1;
  bool gap_ = false;
  std::vector<PlotPoint> points_;
  PlotPoint low_, high_;  ///< of the column that is being filled
};

}  // namespace wholehand
