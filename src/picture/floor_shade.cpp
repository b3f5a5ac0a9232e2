#include "picture/floor_shade.hpp"

#include "picture/parallel_rows.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace wholehand {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kNodes = 129;
constexpr int kLampPoints = 28;
constexpr double kLampRadius = 0.26;  // tangent of the lamp's apparent radius
constexpr double kPointSoftness = 0.07;
constexpr double kGoldenAngle_rad = 2.39996322972865332;

}  // namespace

FloorShade::FloorShade(const Diorama& diorama, const Vector3d& to_lamp) {
  const auto [center, half_m] = diorama.shadowArea(to_lamp, kLampRadius);
  low_m_ = center - Vector2d::Constant(half_m);
  cell_m_ = 2.0 * half_m / (kNodes - 1);
  if (half_m <= 0.0) return;
  std::vector<Vector3d> lamps;
  const Vector3d side = to_lamp.unitOrthogonal(), over = to_lamp.cross(side);
  for (int i = 0; i < kLampPoints; ++i) {  // evenly over the lamp's disc, as seeds in a sunflower
    const double r = kLampRadius * std::sqrt((i + 0.5) / kLampPoints);
    const double angle = i * kGoldenAngle_rad;
    lamps.push_back((to_lamp + r * (std::cos(angle) * side + std::sin(angle) * over)).normalized());
  }
  share_.resize(static_cast<std::size_t>(kNodes) * kNodes);
  forEachRow(kNodes, [&](int y) {
    for (int x = 0; x < kNodes; ++x) {
      const Vector3d p(low_m_.x() + x * cell_m_, low_m_.y() + y * cell_m_,
                       diorama.floorHeight() + 0.001);
      double sum = 0.0;
      for (const Vector3d& lamp : lamps) sum += diorama.shadow(p, lamp, kPointSoftness);
      share_[static_cast<std::size_t>(y) * kNodes + static_cast<std::size_t>(x)] =
          static_cast<float>(sum / kLampPoints);
    }
  });
}

double FloorShade::at(const Vector3d& p_m) const noexcept {
  if (share_.empty()) return 1.0;
  const Eigen::Array2d at = (p_m.head<2>() - low_m_).array() / cell_m_;
  if ((at < 0.0).any() || (at >= kNodes - 1.0).any()) return 1.0;
  const Eigen::Array2i i = at.cast<int>();
  const Eigen::Array2d f = at - i.cast<double>();
  const float* s =
      &share_[static_cast<std::size_t>(i.y()) * kNodes + static_cast<std::size_t>(i.x())];
  const auto along = [&](const float* q) {
    return static_cast<double>(q[0]) + f.x() * static_cast<double>(q[1] - q[0]);
  };
  return along(s) + f.y() * (along(s + kNodes) - along(s));
}

}  // namespace wholehand
