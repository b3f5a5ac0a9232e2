#pragma once

#include "files/mesh/solid.hpp"
#include "loop/core/expected.hpp"

#include <functional>
#include <vector>

namespace wholehand {

struct PieceOptions {
  int most_pieces = 16;      ///< 1 .. 64
  double concavity_m = 0.0;  ///< depth of hollows that a piece may fill; > 0
  int most_vertices = 64;    ///< maximum number of vertices of a piece, at least 4
  /// Called with the current activity and the number of parts or pieces; may be empty.
  std::function<void(const char* doing, int count)> progress = nullptr;
};

/// Convex pieces that approximate a solid.
struct ConvexPieces {
  std::vector<MeshSurface> pieces;  ///< closed, convex, wound outward; coordinates are floats
  double pieces_m3 = 0.0;           ///< sum of the pieces' volumes
  double overlap_m3 = 0.0;          ///< sum of the volumes shared by pairs of pieces
  double beyond_m = 0.0;            ///< largest distance of the pieces' surface outside the solid
  double missing_m = 0.0;           ///< largest distance of the solid's surface outside the pieces
  /// Share of the surface that lies inside the solid, because the solid overlaps itself.
  double twice_share = 0.0;
};

/// Approximate convex decomposition: the solid is cut by planes until no part's hull is farther
/// from the solid than `concavity_m` or there are four times `most_pieces`; the hulls of parts are
/// then merged, cheapest volume first, while `concavity_m` allows it or there are too many
/// (docs/adr/0052-convex-hulls-and-pieces.md). Equal inputs give bit-identical results.
///
/// @return the pieces, or one Diagnostic with problem and remedy. Not real-time safe.
[[nodiscard]] Expected<ConvexPieces> convexPieces(const ClosedSurface& solid,
                                                  const PieceOptions& options);

}  // namespace wholehand
