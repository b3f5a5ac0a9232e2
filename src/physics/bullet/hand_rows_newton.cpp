#include "physics/bullet/hand_rows.hpp"

// The joint ends as cones of ConeNewton.

namespace wholehand::bullet {

bool HandRows::addEndsTo(ConeNewton& newton, const AxisRoot& root) const noexcept {
  for (int i = 0; i < near_end_count_; ++i) {
    const AxisRow& end = ends_[near_end_[i]].row;
    ConeNewton::Row* row = newton.add(1, 0.0, 0.0);
    if (row == nullptr) return false;
    root.transpose(end.jacobian.data(), row->along.data());
    row->goal = end.lacking;
    row->start = 0.0;
  }
  return true;
}

void HandRows::takeEndsFrom(const ConeNewton& newton, int row) noexcept {
  for (int i = 0; i < near_end_count_; ++i) {
    ends_[near_end_[i]].row.impulse = newton.row(row++).impulse;
  }
}

}  // namespace wholehand::bullet
