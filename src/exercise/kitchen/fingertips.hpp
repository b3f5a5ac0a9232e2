#pragma once

#include "core/axis_array.hpp"
#include "core/real_time.hpp"
#include "model/hand/hand_model.hpp"

#include <Eigen/Core>

#include <array>

namespace wholehand::kitchen {

/// Foremost points of the four fingertips along the axes of the world, from the hand's base, as the
/// fingers are more or less bent. Nothing allocates after construction.
class Fingertips {
 public:
  /// @param fingers the axis that flexes all four; -1: none
  Fingertips(const HandModel& hand, int fingers);

  /// @param toward ±x, ±y or ±z @param flexion_rad of the axis; interpolated within 0 .. kMost_rad
  [[nodiscard]] WHOLEHAND_RT Eigen::Vector3d foremost(const Eigen::Vector3d& toward,
                                                      double flexion_rad) const noexcept;

 private:
  static constexpr int kPostures = 9;
  static constexpr double kMost_rad = 2.0;
  /// Along x, y, z, -x, -y, -z.
  using Points = std::array<Eigen::Vector3d, 6>;
  std::array<Points, kPostures> at_{};
};

}  // namespace wholehand::kitchen
