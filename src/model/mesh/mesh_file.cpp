#include "core/printable.hpp"
#include "model/mesh/convex_mesh.hpp"
#include "model/mesh/mesh_load_time.hpp"
#include "model/mesh/mesh_surface.hpp"

#include <assimp/BaseImporter.h>
#include <assimp/Importer.hpp>
#include <assimp/config.h>
#include <assimp/importerdesc.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <chrono>
#include <filesystem>
#include <iterator>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>

namespace wholehand {
namespace {

Diagnostic fileFault(std::string problem, std::string remedy) {
  Diagnostic d;
  d.problem = std::move(problem);
  d.remedy = std::move(remedy);
  return d;
}

/// Appends a mesh's triangles; skips points and lines.
void append(const aiMesh& mesh, MeshSurface& surface) {
  const int first = static_cast<int>(surface.points.size());
  for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
    const aiVector3D& v = mesh.mVertices[i];
    surface.points.emplace_back(static_cast<double>(v.x), static_cast<double>(v.y),
                                static_cast<double>(v.z));
  }
  for (unsigned i = 0; i < mesh.mNumFaces; ++i) {
    const aiFace& face = mesh.mFaces[i];
    if (face.mNumIndices != 3) continue;
    surface.triangles.emplace_back(first + static_cast<int>(face.mIndices[0]),
                                   first + static_cast<int>(face.mIndices[1]),
                                   first + static_cast<int>(face.mIndices[2]));
  }
}

// The documented formats, whose readers are tested against damage. assimp has some fifty others,
// and tries all of them on an unknown file.
constexpr std::array<std::string_view, 4> kKinds = {"stl", "obj", "dae", "glb"};
constexpr std::uintmax_t kLargestFile_bytes = 64U << 20U;

bool isKind(std::string_view ending) {
  return std::find(kKinds.begin(), kKinds.end(), ending) != kKinds.end();
}

void keepDocumentedReaders(Assimp::Importer& importer) {
  std::vector<Assimp::BaseImporter*> others;
  for (std::size_t i = 0; i < importer.GetImporterCount(); ++i) {
    std::istringstream endings(importer.GetImporterInfo(i)->mFileExtensions);
    const bool kept = std::any_of(std::istream_iterator<std::string>(endings), {}, isKind);
    if (!kept) others.push_back(importer.GetImporter(i));
  }
  for (Assimp::BaseImporter* other : others) {
    importer.UnregisterLoader(other);
    delete other;  // NOLINT: what UnregisterLoader gives back is the caller's
  }
}

/// File extension: "stl" of "a/Mug.STL".
std::string endingOf(const std::string& path) {
  std::string ending = std::filesystem::path(path).extension().string();
  if (!ending.empty()) ending.erase(0, 1);
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending;
}

/// assimp's error as text, with its own message in brackets.
std::string unreadable(const Assimp::Importer& importer, const std::string& path) {
  const std::string own = importer.GetErrorString();
  return "the mesh file " + printable(path) + " holds no surface that can be read" +
         (own.empty() ? "" : " (" + own + ")");
}

/// Errors that are evident without reading the file.
std::optional<Diagnostic> nameFault(const std::string& path) {
  const std::string name = printable(path);
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) {
    return fileFault("there is no such mesh file: " + name,
                     "check the name; it is relative to the file that names it");
  }
  if (std::filesystem::file_size(path, error) == 0) {
    return fileFault("the mesh file " + name + " is empty", "give a closed convex surface");
  }
  if (std::filesystem::file_size(path, error) > kLargestFile_bytes) {
    return fileFault("the mesh file " + name + " is larger than 64 MB", "simplify the surface");
  }
  if (const std::string ending = endingOf(path); !isKind(ending)) {
    return fileFault("the mesh file " + name + " is not of a supported format: its name " +
                         (ending.empty() ? "has no ending" : "ends in ." + printable(ending)),
                     "export it as STL, OBJ, DAE or GLB");
  }
  return std::nullopt;
}

}  // namespace

Expected<MeshSurface> readMeshHere(const std::string& path) {
  if (auto fault = nameFault(path)) return *fault;
  Assimp::Importer importer;
  keepDocumentedReaders(importer);
  // Robotics exporters write z-up parts whatever the tag says: the tag must not rotate a collider.
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  const aiScene* scene =
      importer.ReadFile(path, aiProcess_Triangulate | aiProcess_PreTransformVertices);
  if (scene == nullptr) {
    return fileFault(
        unreadable(importer, path),
        // The OBJ reader skips numbers written as ".5".
        "export it again as STL, OBJ (a digit before every decimal point), DAE or GLB");
  }
  MeshSurface surface;
  for (unsigned i = 0; i < scene->mNumMeshes; ++i) append(*scene->mMeshes[i], surface);
  return surface;
}

Expected<MeshSurface> readMesh(const std::string& path, std::chrono::milliseconds longest) {
  if (auto fault = nameFault(path)) return *fault;
  const std::string reader = meshReaderProgram();
  return reader.empty() ? readMeshHere(path) : readMeshInChild(reader, path, longest);
}

namespace {

/// @param longest limit of the time to read the file
Expected<MeshCollider> loadCollider(const std::string& path, const Eigen::Vector3d& scale,
                                    std::chrono::milliseconds longest) {
  Expected<MeshSurface> surface = readMesh(path, longest);
  if (!surface) return surface.errors();
  for (Eigen::Vector3d& p : surface->points) p = scale.cwiseProduct(p);
  const std::string mesh = "the mesh " + printable(path) + " ";
  Expected<MeshCollider> collider = meshCollider(surface->points, surface->triangles);
  if (!collider) {
    Diagnostic d = collider.errors().front();
    d.problem = mesh + d.problem;
    return d;
  }
  if (collider->notice) collider->notice->problem = mesh + collider->notice->problem;
  return collider;
}

}  // namespace

Expected<MeshCollider> loadMeshCollider(const std::string& path, const Eigen::Vector3d& scale,
                                        MeshLoadTime& time) {
  const auto longest = std::min(kLongestMeshRead, time.left());
  Expected<MeshCollider> collider =
      time.measure(path, [&] { return loadCollider(path, scale, longest); });
  if (time.isOver()) return time.fault();
  return collider;
}

Expected<MeshCollider> loadMeshCollider(const std::string& path, const Eigen::Vector3d& scale) {
  MeshLoadTime time;
  return loadMeshCollider(path, scale, time);
}

}  // namespace wholehand
