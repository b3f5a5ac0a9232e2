#pragma once

#include "files/mesh/mesh_file.hpp"

#include <vector>

namespace wholehand {

/// Number of the shell of each triangle; a shell is a closed set of triangles connected by edges.
/// At an edge of more than two triangles, where shells touch, each belongs with the one that closes
/// the solid behind it.
///
/// @param surface vertices merged
/// @return empty when some edge is not passed as often in one direction as in the other
/// Not real-time safe.
[[nodiscard]] std::vector<int> shellNumbers(const MeshSurface& surface);

/// Which shells of a closed surface were wound inward and are turned.
enum class TurnedShells { kNone, kSome, kAll };

/// Reverses shells that are wound inward. Afterwards every shell that lies in no other is wound
/// outward. A shell within it is reversed together with it, so that a hollow stays a hollow.
///
/// @param surface closed, vertices merged; every edge is passed as often in one direction as in the
/// other
/// @param size_m diagonal of its bounding box
/// Not real-time safe.
[[nodiscard]] TurnedShells turnInwardShells(MeshSurface& surface, double size_m);

}  // namespace wholehand
