#pragma once

#include "core/expected.hpp"
#include "model/mass_properties.hpp"
#include "model/mesh/mesh_file.hpp"

#include <string>
#include <vector>

namespace wholehand {

/// What `decompose` writes of a mesh.
struct DecomposedMesh {
  std::string source;               ///< path of the mesh as given
  std::string name;                 ///< what every file's name begins with
  std::vector<MeshSurface> pieces;  ///< convex, in the mesh's frame [m]
  MassProperties mass;              ///< of the mesh
};

/// What the files of a mesh are named after: its file name without ending; other characters than
/// letters, digits, - and _ become _.
[[nodiscard]] std::string pieceName(const std::string& mesh_path);

/// "NAME_01.obj" ..
[[nodiscard]] std::string pieceFile(const std::string& name, std::size_t index);

/// Checks before the computation whether the folder can hold the files: it can be made or written
/// to, and none of their names belongs to a file of another origin.
[[nodiscard]] Expected<Done> checkFolder(const std::string& folder, const std::string& name,
                                         int pieces);

/// Writes NAME_01.obj .., NAME.urdf and NAME.toml, a scene. They are written into a folder of their
/// own inside `folder`, loaded from it as a scene, and then moved: a failure leaves what was there.
/// Pieces of an earlier computation that are not replaced are removed.
/// @return the names of the files written
[[nodiscard]] Expected<std::vector<std::string>> writeDecomposed(const DecomposedMesh& mesh,
                                                                 const std::string& folder);

}  // namespace wholehand
