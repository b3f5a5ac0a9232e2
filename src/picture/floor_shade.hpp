#pragma once

#include "picture/diorama.hpp"

#include <Eigen/Core>

#include <vector>

namespace wholehand {

/// The shadow of a wide lamp on the floor, sampled once on a coarse grid: so soft a shadow has no
/// detail finer than the grid, and many lamp points a node leave no bands.
class FloorShade {
 public:
  FloorShade(const Diorama& diorama, const Eigen::Vector3d& to_lamp);

  /// Share of the lamp seen from a point of the floor; 1 outside the sampled area.
  [[nodiscard]] double at(const Eigen::Vector3d& p_m) const noexcept;

 private:
  Eigen::Vector2d low_m_{0, 0};
  double cell_m_ = 0.01;
  std::vector<float> share_;
};

}  // namespace wholehand
