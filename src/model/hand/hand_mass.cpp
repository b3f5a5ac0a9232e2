#include "model/hand/hand_mass.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace wholehand {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

double squaredDistance(const Vector3d& point, const PlacedCapsule& capsule) {
  const Vector3d axis = capsule.b_m - capsule.a_m;
  const double length2 = axis.squaredNorm();
  const double along =
      length2 > 0.0 ? std::clamp((point - capsule.a_m).dot(axis) / length2, 0.0, 1.0) : 0.0;
  return (point - capsule.a_m - along * axis).squaredNorm();
}

bool inside(const Vector3d& point, const std::vector<PlacedCapsule>& capsules) {
  return std::any_of(capsules.begin(), capsules.end(), [&](const PlacedCapsule& c) {
    return squaredDistance(point, c) <= c.radius_m * c.radius_m;
  });
}

}  // namespace

MassProperties capsuleMass(const Vector3d& a_m, const Vector3d& b_m, double radius_m,
                           double density_kg_m3) {
  const double length = (b_m - a_m).norm();
  const double r2 = radius_m * radius_m;
  const double cylinder = density_kg_m3 * std::numbers::pi * r2 * length;
  const double ball = density_kg_m3 * 4.0 / 3.0 * std::numbers::pi * r2 * radius_m;
  const double lengthwise = cylinder * r2 / 2.0 + ball * 0.4 * r2;
  const double crosswise =
      cylinder * (length * length / 12.0 + r2 / 4.0) +
      ball * (0.4 * r2 + length * length / 4.0 + 3.0 / 8.0 * length * radius_m);
  MassProperties out;
  out.mass_kg = cylinder + ball;
  out.com_m = (a_m + b_m) / 2.0;
  out.inertia_kg_m2 = crosswise * Matrix3d::Identity();
  if (length > 0.0) {
    const Vector3d axis = (b_m - a_m) / length;
    out.inertia_kg_m2 += (lengthwise - crosswise) * axis * axis.transpose();
  }
  return out;
}

MassProperties unionMass(const std::vector<PlacedCapsule>& capsules, double density_kg_m3,
                         double step_m) {
  std::vector<PlacedCapsule> solid;
  std::copy_if(capsules.begin(), capsules.end(), std::back_inserter(solid),
               [](const PlacedCapsule& c) { return c.has_mass; });
  MassProperties out;
  if (solid.empty()) return out;
  Vector3d low = solid.front().a_m;
  Vector3d high = low;
  for (const PlacedCapsule& c : solid) {
    const Vector3d swell = Vector3d::Constant(c.radius_m);
    low = low.cwiseMin(c.a_m.cwiseMin(c.b_m) - swell);
    high = high.cwiseMax(c.a_m.cwiseMax(c.b_m) + swell);
  }
  // Sums relative to the centre of the box, to preserve precision in the parallel-axis step.
  const Vector3d center = (low + high) / 2.0;
  const Eigen::Vector3i cells = ((high - low) / step_m).array().ceil().cast<int>();
  const double cell_kg = density_kg_m3 * step_m * step_m * step_m;
  Vector3d first = Vector3d::Zero();
  Matrix3d second = Matrix3d::Zero();
  for (int i = 0; i < cells.x(); ++i) {
    for (int j = 0; j < cells.y(); ++j) {
      for (int k = 0; k < cells.z(); ++k) {
        const Vector3d at = low + step_m * Vector3d(i + 0.5, j + 0.5, k + 0.5);
        if (!inside(at, solid)) continue;
        const Vector3d arm = at - center;
        out.mass_kg += cell_kg;
        first += cell_kg * arm;
        second += cell_kg * arm * arm.transpose();
      }
    }
  }
  if (out.mass_kg == 0.0) return out;
  const Vector3d shift = first / out.mass_kg;
  second -= out.mass_kg * shift * shift.transpose();
  // Own inertia of a cubic cell.
  second += out.mass_kg * step_m * step_m / 12.0 * Matrix3d::Identity();
  out.com_m = center + shift;
  out.inertia_kg_m2 = second.trace() * Matrix3d::Identity() - second;
  return out;
}

}  // namespace wholehand
