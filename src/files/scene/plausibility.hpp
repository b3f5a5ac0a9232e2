#pragma once

#include "loop/core/expected.hpp"
#include "loop/model/scene_model.hpp"

#include <Eigen/Core>

#include <optional>
#include <string>
#include <vector>

namespace wholehand {

// Figures of a body that no thing has, of any shape and from any file. They are the only signs of a
// wrong unit.

/// Why colliders lie too far from their body's frame for a body [m], with the offset to take off;
/// empty: near. Beyond 10 m is `refused`, else ten times their own extent.
struct FarPlace {
  std::string problem;
  bool refused = false;
};
[[nodiscard]] FarPlace farPlace(const std::vector<Shape>& shapes);

/// Notice of a body lighter than air or heavier than any matter; empty: plausible.
[[nodiscard]] std::optional<Diagnostic> densityNotice(const SceneBody& body);

/// Notice of a body whose joint has so much dry friction that a hand's 100 N at the body's
/// outermost point do not move it; empty: it moves.
[[nodiscard]] std::string heldProblem(const SceneBody& body);

/// Reason why no body of this mass within these colliders, points of ballast and points that it
/// shows can have these mass properties; empty: possible. Along a principal axis, mass between -a
/// and b of its centre has a second moment of at most m·a·b (Bhatia and Davis, 2000); 10 % more is
/// allowed, since colliders simplify. The mean of the moments is at least that of a ball of the
/// densest matter.
/// @param shapes, ballast_m, m, seen_m in one frame
[[nodiscard]] std::string inertialProblem(const std::vector<Shape>& shapes,
                                          const std::vector<Eigen::Vector3d>& ballast_m,
                                          const MassProperties& m,
                                          const std::vector<Eigen::Vector3d>& seen_m = {});

}  // namespace wholehand
