#include "core/printable.hpp"
#include "model/mesh/mesh_surface.hpp"
#include "process/child_process.hpp"

#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <type_traits>
#include <utility>

namespace wholehand {
namespace {

namespace fs = std::filesystem;

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
