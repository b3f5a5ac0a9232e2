#pragma once

#include "files/mesh/mesh_file.hpp"

namespace wholehand {

/// Which shells of a closed surface were wound inward and are turned.
enum class TurnedShells { kNone, kSome, kAll };

/// Turns the shells that are wound inward. A shell is what hangs together by its edges. One that
/// lies in no other is wound outward then. One within it keeps its sense against it: a hollow stays
/// a hollow.
///
/// @param surface closed, vertices merged; every edge is passed as often in one direction as in the
/// other
/// @param size_m diagonal of its bounding box
/// Not real-time safe.
[[nodiscard]] TurnedShells turnInwardShells(MeshSurface& surface, double size_m);

}  // namespace wholehand
