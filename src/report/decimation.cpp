#include "report/decimation.hpp"

#include <algorithm>
#include <cmath>

namespace wholehand {

void Decimator::add(double x, double y) {
  if (!std::isfinite(y)) {
    if (column_ >= 0) closeColumn(points_);
    if (column_ >= 0 || !gap_) points_.push_back({x, std::numeric_limits<double>::quiet_NaN()});
    column_ = -1;
    gap_ = true;
    return;
  }
  const double share = x_max_ > x_min_ ? (x - x_min_) / (x_max_ - x_min_) : 0.0;
  const int column = static_cast<int>(std::lround(std::clamp(share, 0.0, 1.0) * (columns_ - 1)));
  if (column != column_) {
    if (column_ >= 0) closeColumn(points_);
    column_ = column;
    gap_ = false;
    low_ = high_ = {x, y};
  } else {
    if (y < low_.y) low_ = {x, y};
    if (y >= high_.y) high_ = {x, y};
  }
}

void Decimator::closeColumn(std::vector<PlotPoint>& out) const {
  const bool low_first = low_.x <= high_.x;
  out.push_back(low_first ? low_ : high_);
  if (low_.x != high_.x || low_.y != high_.y) out.push_back(low_first ? high_ : low_);
}

std::vector<PlotPoint> Decimator::points() const {
  std::vector<PlotPoint> out = points_;
  if (column_ >= 0) closeColumn(out);
  return out;
}

}  // namespace wholehand
