#pragma once

#include "model/mesh/mesh_surface.hpp"
#include "model/mesh/solid_cut.hpp"

#include <Eigen/Core>

#include <vector>

namespace wholehand {

/// Plane of a face at a reflex edge (the solid's inner angle is larger than pi): a cut along it
/// takes the edge away.
struct FeaturePlane {
  CutPlane plane;
  Eigen::Vector3d edge_middle_m;
  double weight_m = 0.0;  ///< length of the edge times the sine of its angle
};

/// Both planes of every reflex edge. @pre closed, wound outward. Not real-time safe.
[[nodiscard]] std::vector<FeaturePlane> featurePlanes(const MeshSurface& surface);

/// A cut to try.
struct Candidate {
  CutPlane plane;
  double reflex_share = 0.0;  ///< of the weight of the cell's reflex edges: those on the plane
};

/// The different planes of edges inside a cell, those of the largest weight, 16 at most.
[[nodiscard]] std::vector<Candidate> candidatesAtEdges(const std::vector<FeaturePlane>& features,
                                                       const std::vector<CutPlane>& cell,
                                                       double size_m);

}  // namespace wholehand
