#include "model/mesh/mesh_file.hpp"

#include "core/printable.hpp"
#include "model/mesh/convex_mesh.hpp"
#include "process/child_process.hpp"

#include <assimp/BaseImporter.h>
#include <assimp/Importer.hpp>
#include <assimp/config.h>
#include <assimp/importerdesc.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <iterator>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <system_error>
#include <type_traits>
#include <utility>

namespace wholehand {
namespace {

namespace fs = std::filesystem;

double seconds(MeshLoadTime::Duration duration) {
  return std::chrono::duration<double>(duration).count();
}

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

constexpr const char* kProgram = "wholehand-read-mesh";
constexpr std::uint32_t kSurface = 0x31534857, kRefusal = 0x31524857;  // "WHS1", "WHR1"

struct Head {
  std::uint32_t what = 0;
  std::uint32_t first = 0, second = 0;  ///< points, triangles; bytes of the problem, of the remedy
};

Diagnostic fault(std::string problem, std::string remedy) {
  return {"", 0, "", "", std::move(problem), std::move(remedy)};
}

Diagnostic damaged() {
  return fault("the result of the mesh reader is damaged",
               "install the program and wholehand-read-mesh from one build");
}

template <class T>
void put(std::string& text, const T* values, std::size_t count) {
  static_assert(std::is_trivially_copyable_v<T>);
  text.append(reinterpret_cast<const char*>(values), count * sizeof(T));
}

Expected<MeshSurface> decodeSurface(const Head& head, std::string_view body) {
  using Point = std::array<double, 3>;
  using Triangle = std::array<std::int32_t, 3>;
  if (body.size() != head.first * sizeof(Point) + head.second * sizeof(Triangle)) return damaged();
  MeshSurface mesh;
  mesh.points.reserve(head.first);
  mesh.triangles.reserve(head.second);
  for (std::uint32_t i = 0; i < head.first; ++i, body.remove_prefix(sizeof(Point))) {
    Point p;
    std::memcpy(p.data(), body.data(), sizeof p);
    mesh.points.emplace_back(p[0], p[1], p[2]);
  }
  for (std::uint32_t i = 0; i < head.second; ++i, body.remove_prefix(sizeof(Triangle))) {
    Triangle t;
    std::memcpy(t.data(), body.data(), sizeof t);
    for (const std::int32_t corner : t) {
      if (corner < 0 || static_cast<std::uint32_t>(corner) >= head.first) return damaged();
    }
    mesh.triangles.emplace_back(t[0], t[1], t[2]);
  }
  return mesh;
}

/// Why a reader without a result ended.
std::string ending(const ChildResult& child, std::chrono::milliseconds longest) {
  switch (child.ending) {
    case ChildEnding::kLate:
      return fmt::format("takes longer than {:g} s to read",
                         std::chrono::duration<double>(longest).count());
    case ChildEnding::kTooMuchOutput:
      return "holds more than 256 MB of surface";
    case ChildEnding::kNotStarted:
      return std::string("was not read: its reader could not be started: ") +
             std::strerror(child.code);
    case ChildEnding::kSignal:
      return std::string("crashed its reader: ") + ::strsignal(child.code);
    case ChildEnding::kExited:
    case ChildEnding::kStopped:
      break;
  }
  return "made its reader fail, which may use 1 GB of memory";
}

}  // namespace

MeshLoadTime::Duration MeshLoadTime::left() const {
  return std::max(total_ - taken_, Duration::zero());
}

void MeshLoadTime::add(const std::string& path, Duration taken) {
  taken_ += taken;
  files_.emplace_back(path, taken);
}

Diagnostic MeshLoadTime::fault() const {
  constexpr std::size_t kNamed = 3;
  auto slowest = files_;
  std::stable_sort(slowest.begin(), slowest.end(),
                   [](const auto& a, const auto& b) { return a.second > b.second; });
  std::string files;
  Duration others{0};
  for (std::size_t i = 0; i < slowest.size(); ++i) {
    const auto& [path, taken] = slowest[i];
    if (i >= kNamed) {
      others += taken;
      continue;
    }
    files +=
        fmt::format("{}{} {:.1f} s", i == 0 ? "" : ", ",
                    printable(std::filesystem::path(path).filename().string()), seconds(taken));
  }
  if (slowest.size() > kNamed) {
    files += fmt::format(", {} more {:.1f} s", slowest.size() - kNamed, seconds(others));
  }
  return {"",
          0,
          "",
          "",
          fmt::format("the meshes up to this one took longer than {:g} s to load ({})",
                      seconds(total_), files),
          "simplify the meshes that took longest, or name fewer meshes"};
}

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

std::string meshReaderProgram() {
  std::error_code error;
  const fs::path folder = fs::read_symlink("/proc/self/exe", error).parent_path();
  if (error) return {};
  for (const fs::path& program :
       {folder / kProgram, folder.parent_path() / "lib" / "wholehand" / kProgram}) {
    if (fs::is_regular_file(program, error)) return program.string();
  }
  return {};
}

Expected<MeshSurface> readMeshInChild(const std::string& program, const std::string& path,
                                      std::chrono::milliseconds longest) {
  const ChildLimits limits = {
      .time = longest, .memory_bytes = 1ULL << 30, .output_bytes = 256ULL << 20};
  const ChildResult child = runChild(program, {path}, limits);
  if (child.ending == ChildEnding::kExited && child.code == 0) return decodeMesh(child.output);
  return fault("the mesh file " + printable(path) + " " + ending(child, longest),
               "export it again as STL, OBJ, DAE or GLB, with fewer triangles");
}

std::string encodeMesh(const Expected<MeshSurface>& mesh) {
  std::string text;
  if (!mesh) {
    const Diagnostic& why = mesh.errors().front();
    const Head head{kRefusal, static_cast<std::uint32_t>(why.problem.size()),
                    static_cast<std::uint32_t>(why.remedy.size())};
    put(text, &head, 1);
    return text + why.problem + why.remedy;
  }
  const Head head{kSurface, static_cast<std::uint32_t>(mesh->points.size()),
                  static_cast<std::uint32_t>(mesh->triangles.size())};
  put(text, &head, 1);
  for (const Eigen::Vector3d& p : mesh->points) put(text, p.data(), 3);
  for (const Eigen::Vector3i& t : mesh->triangles) put(text, t.data(), 3);
  return text;
}

Expected<MeshSurface> decodeMesh(std::string_view text) {
  Head head;
  if (text.size() < sizeof head) return damaged();
  std::memcpy(&head, text.data(), sizeof head);
  text.remove_prefix(sizeof head);
  if (head.what == kSurface) return decodeSurface(head, text);
  if (head.what != kRefusal || text.size() != std::size_t{head.first} + head.second) {
    return damaged();
  }
  return fault(std::string(text.substr(0, head.first)), std::string(text.substr(head.first)));
}

}  // namespace wholehand
