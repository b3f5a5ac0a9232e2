#include "model/convex_mesh.hpp"

#include <assimp/Importer.hpp>
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <filesystem>
#include <string>
#include <utility>

namespace wholehand {
namespace {

Diagnostic fileFault(std::string problem, std::string remedy) {
  Diagnostic d;
  d.problem = std::move(problem);
  d.remedy = std::move(remedy);
  return d;
}

/// Appends a mesh's triangles; points and lines are left out.
void append(const aiMesh& mesh, const Eigen::Vector3d& scale,
            std::vector<Eigen::Vector3d>& points_m, std::vector<Eigen::Vector3i>& triangles) {
  const int first = static_cast<int>(points_m.size());
  for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
    const aiVector3D& v = mesh.mVertices[i];
    points_m.emplace_back(scale.x() * static_cast<double>(v.x),
                          scale.y() * static_cast<double>(v.y),
                          scale.z() * static_cast<double>(v.z));
  }
  for (unsigned i = 0; i < mesh.mNumFaces; ++i) {
    const aiFace& face = mesh.mFaces[i];
    if (face.mNumIndices != 3) continue;
    triangles.emplace_back(first + static_cast<int>(face.mIndices[0]),
                           first + static_cast<int>(face.mIndices[1]),
                           first + static_cast<int>(face.mIndices[2]));
  }
}

/// Why assimp gave up, in words; its own go into brackets.
std::string unreadable(const Assimp::Importer& importer, const std::string& path) {
  const std::string ending = std::filesystem::path(path).extension().string();
  const std::string own = importer.GetErrorString();
  if (ending.empty() || !importer.IsExtensionSupported(ending)) {
    return "the mesh file " + path + " is of no known kind: its name " +
           (ending.empty() ? "has no ending" : "ends in " + ending);
  }
  return "the mesh file " + path + " holds no surface that can be read" +
         (own.empty() ? "" : " (" + own + ")");
}

}  // namespace

Expected<Shape> loadConvexMesh(const std::string& path, const Eigen::Vector3d& scale) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) {
    return fileFault("there is no such mesh file: " + path,
                     "check the name; it is relative to the file that names it");
  }
  if (std::filesystem::file_size(path, error) == 0) {
    return fileFault("the mesh file " + path + " is empty", "give a closed convex surface");
  }
  Assimp::Importer importer;
  // Robotics exporters write z-up parts whatever the tag says, and a tag must not turn a collider.
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  const aiScene* scene =
      importer.ReadFile(path, aiProcess_Triangulate | aiProcess_PreTransformVertices);
  if (scene == nullptr) {
    return fileFault(
        unreadable(importer, path),
        // The reader of OBJ skips corners written as ".5".
        "export it again as STL, OBJ (a digit before every decimal point), DAE or GLB");
  }
  std::vector<Eigen::Vector3d> points_m;
  std::vector<Eigen::Vector3i> triangles;
  for (unsigned i = 0; i < scene->mNumMeshes; ++i) {
    append(*scene->mMeshes[i], scale, points_m, triangles);
  }
  Expected<Shape> shape = convexMesh(points_m, triangles);
  if (shape) return shape;
  Diagnostic d = shape.errors().front();
  d.problem = "the mesh " + path + " " + d.problem;
  return d;
}

}  // namespace wholehand
