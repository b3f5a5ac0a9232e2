#pragma once

#include "loop/core/expected.hpp"
#include "loop/model/scene_model.hpp"

#include <string>

namespace wholehand {

class MeshLoadTime;  // files/mesh/mesh_file.hpp

/// Reads a scene file with its meshes and URDFs, whose paths are relative to it. Of a URDF itself,
/// a scene with this object before the hand is made (scene/object_scene.hpp). Reports every
/// fault at once: unknown shapes, meshes that make no collider (mesh/convex_mesh.hpp), bodies that
/// overlap at the start, meshes that take longer than MeshLoadTime::kTotal together.
[[nodiscard]] Expected<SceneModel> loadSceneFile(const std::string& path);
/// The same with the given limit of the meshes' reading time.
[[nodiscard]] Expected<SceneModel> loadSceneFile(const std::string& path, MeshLoadTime& time);
/// Name in a recording of the scene that was made of a URDF.
[[nodiscard]] std::string madeScenePath(const std::string& urdf);

}  // namespace wholehand
