#include "files/scene/plausibility.hpp"

#include "loop/core/printable.hpp"
#include "loop/model/principal_axes.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace wholehand {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

// Density limits. Osmium is the densest matter. The mass of a body may be concentrated to 10 times
// its mean density, because light colliders may represent a heavy object.
constexpr double kOsmium_kg_m3 = 22.6e3, kMostConcentration = 10.0;
constexpr double kAir_kg_m3 = 1.2;
/// Largest distance of ballast or of the body's frame from the colliders, in extents of the
/// colliders. Ballast has no collider; a larger distance indicates a wrong unit.
constexpr double kMostReach = 10.0;
constexpr double kMostPlace_m = 10.0;  ///< the limit of positions in a scene
constexpr double kMoreMoment = 1.1;    ///< allowed excess of a second moment of mass

AlignedBox3d boxOf(const std::vector<Shape>& shapes) {
  AlignedBox3d box;
  for (const Shape& shape : shapes) box.extend(boxOf(shape));
  return box;
}

/// Moment of inertia of a ball [kg·m²]. Among all bodies of this mass that are at most this dense,
/// a ball has the least sum of principal moments.
double ballInertia(double mass_kg, double density_kg_m3) {
  const double radius_m = std::cbrt(mass_kg / density_kg_m3 / (4.0 / 3.0 * std::numbers::pi));
  return 0.4 * mass_kg * radius_m * radius_m;
}

std::string ballastProblem(const AlignedBox3d& colliders, const std::vector<Vector3d>& ballast_m) {
  const double most_m = kMostReach * colliders.diagonal().norm();
  for (const Vector3d& p : ballast_m) {
    const double aside_m = colliders.exteriorDistance(p);
    if (aside_m <= most_m) continue;
    return fmt::format(
        "ballast, the mass of a link without a collider, is {:.3g} m outside of its colliders; "
        "{:.3g} m at most",
        aside_m, most_m);
  }
  return {};
}

}  // namespace

FarPlace farPlace(const std::vector<Shape>& shapes) {
  if (shapes.empty()) return {};
  const AlignedBox3d box = boxOf(shapes);
  const double away_m = box.exteriorDistance(Vector3d(Vector3d::Zero()));
  const double most_m = std::min(kMostPlace_m, kMostReach * box.diagonal().norm());
  if (away_m <= most_m) return {};
  const Vector3d middle = box.center();
  return {fmt::format("lies {:.4g} m from its own origin; its middle is at ({:.7g}, {:.7g}, "
                      "{:.7g}) m: take this off its corners",
                      away_m, middle.x(), middle.y(), middle.z()),
          away_m > kMostPlace_m};
}

std::optional<Diagnostic> densityNotice(const SceneBody& body) {
  const double volume_m3 = moments(body.shapes).volume_m3;
  const double density_kg_m3 = body.mass_kg / volume_m3;
  if (density_kg_m3 >= kAir_kg_m3 && density_kg_m3 <= kOsmium_kg_m3) return std::nullopt;
  return fileFault(
      "",
      fmt::format("makes '{}' {} ({:.3g} kg/m³: {:.3g} kg in {:.3g} cm³)", printable(body.name),
                  density_kg_m3 < kAir_kg_m3 ? "lighter than air" : "heavier than any matter",
                  density_kg_m3, body.mass_kg, 1e6 * volume_m3),
      "check its size (m) and its mass (kg)", DiagnosticCode::kRange);
}

std::string heldProblem(const SceneBody& body) {
  constexpr double kHand_n = 100.0;
  const SceneJoint& joint = *body.joint;
  double lever_m = 0.0;
  for (const Shape& shape : body.shapes) {
    for (const Vector3d& p : boundingPoints(shape)) {
      lever_m = std::max(lever_m, joint.axis.cross(p - joint.point_m).norm());
    }
  }
  const double most = kHand_n * (joint.isHinge() ? lever_m : 1.0);
  if (body.shapes.empty() || joint.dry_friction < most) return {};
  return fmt::format(
      "is held by a dry friction of {:g} {}: {:g} N at its outermost point, which is "
      "more than a hand's, do not move it",
      joint.dry_friction, joint.isHinge() ? "N·m" : "N", kHand_n);
}

std::string inertialProblem(const std::vector<Shape>& shapes,
                            const std::vector<Vector3d>& ballast_m, const MassProperties& m,
                            const std::vector<Vector3d>& seen_m) {
  AlignedBox3d box = boxOf(shapes);
  if (std::string problem = ballastProblem(box, ballast_m); !problem.empty()) return problem;
  std::vector<Vector3d> reach_m = ballast_m;
  for (const Shape& shape : shapes) {
    const std::vector<Vector3d> points = boundingPoints(shape);
    reach_m.insert(reach_m.end(), points.begin(), points.end());
  }
  reach_m.insert(reach_m.end(), seen_m.begin(), seen_m.end());
  for (const Vector3d& p : ballast_m) box.extend(p);
  for (const Vector3d& p : seen_m) box.extend(p);
  if (const double aside_m = box.exteriorDistance(m.com_m); aside_m > 0.0) {
    return fmt::format("centre of mass is {:.3g} m outside of its colliders", aside_m);
  }
  const PrincipalAxes principal = principalAxesOf(m.inertia_kg_m2);
  for (int k = 0; k < 3; ++k) {
    double least_m = std::numeric_limits<double>::infinity(), most_m = -least_m;
    for (const Vector3d& p : reach_m) {
      const double along_m = principal.axes.col(k).dot(p - m.com_m);
      least_m = std::min(least_m, along_m), most_m = std::max(most_m, along_m);
    }
    const double second = principal.moments.sum() / 2.0 - principal.moments[k];
    const double most = m.mass_kg * std::max(-least_m, 0.0) * std::max(most_m, 0.0);
    if (second <= kMoreMoment * most) continue;
    return fmt::format(
        "moments of inertia are {:.3g}, {:.3g}, {:.3g} kg·m²; {:.3g} kg between {:.3g} and {:.3g} "
        "m of their centre have a second moment of {:.3g} kg·m² at most along that axis, not "
        "{:.3g}",
        principal.moments[0], principal.moments[1], principal.moments[2], m.mass_kg, least_m,
        most_m, most, second);
  }
  const double density_kg_m3 =
      std::max(kOsmium_kg_m3, kMostConcentration * m.mass_kg / moments(shapes).volume_m3);
  const double least = ballInertia(m.mass_kg, density_kg_m3);
  if (principal.moments.mean() >= least) return {};
  return fmt::format(
      "moments of inertia are {:.3g} kg·m² in the mean; {:.3g} kg have {:.3g} at least, as a ball "
      "of {:.3g} kg/m³",
      principal.moments.mean(), m.mass_kg, least, density_kg_m3);
}

}  // namespace wholehand
