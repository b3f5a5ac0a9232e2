#pragma once

#include "model/mesh/closed_surface.hpp"
#include "model/mesh/mesh_surface.hpp"
#include "model/mesh/surface_distance.hpp"

namespace wholehand {

// How well convex pieces stand for a solid. Distances are of points on the triangles, at most a
// fortieth of the solid's size apart. Not real-time safe.

/// Largest distance of a piece's surface outside the solid [m]; what is below `small_m` counts as
/// 0.
/// @param distance to the solid's surface
[[nodiscard]] double farthestOutside(const MeshSurface& piece, const ClosedSurface& solid,
                                     const SurfaceDistance& distance, double small_m);

/// Largest distance of the solid's surface outside of all pieces [m].
/// @param pieces the surfaces of all, in one
[[nodiscard]] double farthestMissing(const ClosedSurface& solid, const MeshSurface& pieces);

/// Volume that two convex pieces share [m³].
/// @param snap_m points nearer than this to a plane lie on it
[[nodiscard]] double overlapOf(const MeshSurface& a, const MeshSurface& b, double snap_m);

/// Share of about 200 of the solid's triangles whose two sides are both inside the solid.
/// @param distance to the solid's surface
[[nodiscard]] double shareInside(const ClosedSurface& solid, const SurfaceDistance& distance);

}  // namespace wholehand
