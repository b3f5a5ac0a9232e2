#pragma once

#include "files/mesh/mesh_file.hpp"

namespace wholehand {

/// Which shells of a closed surface were wound inward and are turned.
enum class TurnedShells { kNone, kSome, kAll };

/// Reverses shells that are wound inward. A shell is a set of triangles connected by edges.
/// Afterwards every shell that lies in no other is wound outward. A shell within it is reversed
/// together with it, so that a hollow stays a hollow.
///
/// @param surface closed, vertices merged; every edge is passed as often in one direction as in the
/// other
/// @param size_m diagonal of its bounding box
/// Not real-time safe.
[[nodiscard]] TurnedShells turnInwardShells(MeshSurface& surface, double size_m);

}  // namespace wholehand
