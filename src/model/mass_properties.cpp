#include "model/mass_properties.hpp"

#include <Eigen/Eigenvalues>
#include <fmt/format.h>

namespace wholehand {

MassProperties uniformDensity(const std::vector<Shape>& shapes, double mass_kg) {
  MassProperties unit;  // of unit density: kg stands for m³ here
  for (const Shape& shape : shapes) {
    const ShapeMoments m = moments(shape);
    unit = combined(unit, {m.volume_m3, m.center_m, m.inertia_m5});
  }
  if (!(unit.mass_kg > 0.0)) return {};
  const double density = mass_kg / unit.mass_kg;
  return {mass_kg, unit.com_m, density * unit.inertia_kg_m2};
}

MassProperties combined(const MassProperties& a, const MassProperties& b) {
  const double mass_kg = a.mass_kg + b.mass_kg;
  if (!(mass_kg > 0.0)) return {};
  MassProperties sum;
  sum.mass_kg = mass_kg;
  sum.com_m = (a.mass_kg * a.com_m + b.mass_kg * b.com_m) / mass_kg;
  // Two point masses about their common centre equal one reduced mass at their distance.
  const Eigen::Vector3d between = b.com_m - a.com_m;
  const double reduced_kg = a.mass_kg * b.mass_kg / mass_kg;
  const Eigen::Matrix3d points =
      between.squaredNorm() * Eigen::Matrix3d::Identity() - between * between.transpose();
  sum.inertia_kg_m2 = a.inertia_kg_m2 + b.inertia_kg_m2 + reduced_kg * points;
  return sum;
}

MassProperties moved(const MassProperties& m, const Pose& inner_in_outer) {
  const Eigen::Matrix3d& r = inner_in_outer.rotation;
  return {m.mass_kg, inner_in_outer * m.com_m, r * m.inertia_kg_m2 * r.transpose()};
}

std::string inertiaFault(const Eigen::Matrix3d& inertia_kg_m2) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(inertia_kg_m2,
                                                              Eigen::EigenvaluesOnly);
  const Eigen::Vector3d& principal = solver.eigenvalues();  // ascending
  const std::string moments = fmt::format("(principal moments {:.4g}, {:.4g}, {:.4g} kg·m²)",
                                          principal[0], principal[1], principal[2]);
  if (!(principal[0] > 0.0)) return "is not positive definite " + moments;
  // A flat plate meets the bound exactly: tolerates rounding.
  if (principal[2] > (principal[0] + principal[1]) * (1.0 + 1e-6)) {
    return "breaks the triangle inequality " + moments;
  }
  return {};
}

}  // namespace wholehand
