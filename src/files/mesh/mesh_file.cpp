#include "files/mesh/mesh_file.hpp"

#include "files/foreign/foreign_file.hpp"
#include "files/mesh/convex_mesh.hpp"
#include "files/mesh/mesh_readers.hpp"
#include "files/process/child_process.hpp"
#include "loop/core/printable.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <fstream>
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

// Readers of the documented formats. They are tested with damaged files.
constexpr std::array<std::pair<std::string_view, MeshFile (*)(std::string_view)>, 5> kReaders = {
    {{"stl", readStl}, {"obj", readObj}, {"ply", readPly}, {"dae", readDae}, {"glb", readGlb}}};
constexpr std::uintmax_t kLargestFile_bytes = 64U << 20U;
constexpr const char* kExport = "export it as STL, OBJ, PLY, DAE or GLB";

/// File extension: "stl" of "a/Mug.STL".
std::string endingOf(const std::string& path) {
  std::string ending = std::filesystem::path(path).extension().string();
  if (!ending.empty()) ending.erase(0, 1);
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending;
}

auto* readerOf(std::string_view ending) {
  const auto* const found = std::find_if(kReaders.begin(), kReaders.end(),
                                         [&](const auto& r) { return r.first == ending; });
  return found == kReaders.end() ? nullptr : found->second;
}

/// Errors that are evident without reading the file.
std::optional<Diagnostic> nameFault(const std::string& path) {
  const std::string name = printable(path);
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) {
    return fileFault("", "there is no such mesh file: " + name,
                     "check the name; it is relative to the file that names it");
  }
  if (std::filesystem::file_size(path, error) == 0) {
    return fileFault("", "the mesh file " + name + " is empty", "give a closed convex surface");
  }
  if (std::filesystem::file_size(path, error) > kLargestFile_bytes) {
    return fileFault("", "the mesh file " + name + " is larger than 64 MB", "simplify the surface");
  }
  const std::string ending = endingOf(path);
  if (readerOf(ending) != nullptr) return std::nullopt;
  if (const auto foreign = foreignFileAt(path)) {
    return fileFault("", "the mesh file " + name + " " + foreign->problem, foreign->remedy);
  }
  return fileFault("",
                   "the mesh file " + name + " is not of a supported format: its name " +
                       (ending.empty() ? "has no ending" : "ends in ." + printable(ending)),
                   kExport);
}

/// @param longest, spent as readMesh()
Expected<MeshCollider> loadCollider(const std::string& path, const Eigen::Vector3d& scale,
                                    std::chrono::milliseconds longest,
                                    std::chrono::milliseconds* spent) {
  Expected<MeshFile> file = readMesh(path, longest, spent);
  if (!file) return file.errors();
  for (Eigen::Vector3d& p : file->surface.points) p = scale.cwiseProduct(p);
  const std::string mesh = "the mesh " + printable(path) + " ";
  Expected<MeshCollider> collider = meshCollider(*file);
  if (!collider) {
    Diagnostic d = collider.errors().front();
    d.problem = mesh + d.problem;
    return d;
  }
  for (Diagnostic& notice : collider->notices) notice.problem = mesh + notice.problem;
  for (const std::string& notice : file->notices) {
    collider->notices.push_back(
        fileFault("", mesh + notice, "turn or export it otherwise if it is wrong"));
  }
  return collider;
}

UnreadableMesh withoutTriangles(const MeshSurface& surface) {
  const std::size_t points = surface.points.size();
  if (points == 0) return {"holds no triangle", kExport};
  return {fmt::format("holds {} point{} and no triangle: a cloud of points, or lines", points,
                      plural(points)),
          "make a surface of them (MeshLab), or give their convex hull"};
}

/// Removes points that belong to no triangle.
void dropUnused(MeshSurface& surface) {
  std::vector<int> index(surface.points.size(), -1);
  for (const Eigen::Vector3i& t : surface.triangles) {
    for (const int corner : t) index[corner] = 0;
  }
  int used = 0;
  for (std::size_t i = 0; i < index.size(); ++i) {
    if (index[i] < 0) continue;
    surface.points[used] = surface.points[i];
    index[i] = used++;
  }
  surface.points.resize(used);
  for (Eigen::Vector3i& t : surface.triangles) {
    for (int& corner : t) corner = index[corner];
  }
}

constexpr const char* kProgram = "wholehand-read-mesh";
constexpr std::uint32_t kSurface = 0x31534857, kRefusal = 0x31524857;  // "WHS1", "WHR1"

struct Head {
  std::uint32_t what = 0;
  /// For a surface: number of points, number of triangles, bytes of the notices. For a refusal:
  /// bytes of the problem, bytes of the remedy.
  std::uint32_t first = 0, second = 0, third = 0;
};

Diagnostic damaged() {
  return fileFault("", "the result of the mesh reader is damaged",
                   "install the program and wholehand-read-mesh from one build");
}

template <class T>
void put(std::string& text, const T* values, std::size_t count) {
  static_assert(std::is_trivially_copyable_v<T>);
  text.append(reinterpret_cast<const char*>(values), count * sizeof(T));
}

Expected<MeshFile> decodeSurface(const Head& head, std::string_view body) {
  using Point = std::array<double, 3>;
  using Triangle = std::array<std::int32_t, 3>;
  const std::size_t row = sizeof(Triangle) + sizeof(std::int32_t);
  if (body.size() != head.first * sizeof(Point) + head.second * row + head.third) return damaged();
  MeshFile file;
  MeshSurface& mesh = file.surface;
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
  file.part.resize(head.second);
  if (!file.part.empty()) {
    std::memcpy(file.part.data(), body.data(), file.part.size() * sizeof(std::int32_t));
  }
  body.remove_prefix(head.second * sizeof(std::int32_t));
  while (!body.empty()) {
    const std::size_t end = std::min(body.find('\n'), body.size());
    file.notices.emplace_back(body.substr(0, end));
    body.remove_prefix(std::min(end + 1, body.size()));
  }
  return file;
}

/// Describes why a reader process ended without a result.
std::string ending(const ChildResult& child, const ChildLimits& limits) {
  switch (child.ending) {
    case ChildEnding::kLate:
      if (child.processor_time <= limits.processor_time) {
        return fmt::format("was not read within {:g} s", seconds(limits.time));
      }
      return fmt::format("takes more than {:g} s of processor time to read",
                         seconds(limits.processor_time));
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

std::chrono::nanoseconds MeshLoadTime::threadProcessorTime() {
  timespec now{};
  (void)::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return std::chrono::seconds(now.tv_sec) + std::chrono::nanoseconds(now.tv_nsec);
}

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
  return fileFault("",
                   fmt::format("the meshes up to this one took more than {:g} s of processor time "
                               "({})",
                               seconds(total_), files),
                   "simplify the meshes that took longest, or name fewer meshes");
}

Expected<MeshFile> readMeshHere(const std::string& path) {
  if (auto fault = nameFault(path)) return *fault;
  const std::string name = "the mesh file " + printable(path) + " ";
  std::ifstream in(path, std::ios::binary);
  std::ostringstream bytes;
  if (!in || !(bytes << in.rdbuf()))
    return fileFault("", name + "cannot be read", "check that the file may be read");
  if (const auto wide = wideText(bytes.view()))
    return fileFault("", name + wide->problem, wide->remedy);
  try {
    MeshFile file = readerOf(endingOf(path))(bytes.view());
    if (file.surface.triangles.empty()) throw withoutTriangles(file.surface);
    dropUnused(file.surface);
    file.part.resize(file.surface.triangles.size());  // one part if the format has no parts
    std::sort(file.notices.begin(), file.notices.end());
    file.notices.erase(std::unique(file.notices.begin(), file.notices.end()), file.notices.end());
    return file;
  } catch (const UnreadableMesh& why) {
    // A file of another format may carry the extension of a mesh format.
    const auto foreign = foreignFile(bytes.view().substr(0, 4096), "");
    if (foreign && !foreign->problem.starts_with("is a mesh"))
      return fileFault("", name + foreign->problem, foreign->remedy);
    return fileFault("", name + why.problem, why.remedy);
  }
}

Expected<MeshFile> readMesh(const std::string& path, std::chrono::milliseconds longest,
                            std::chrono::milliseconds* spent) {
  if (auto fault = nameFault(path)) return *fault;
  const std::string reader = meshReaderProgram();
  return reader.empty() ? readMeshHere(path) : readMeshInChild(reader, path, longest, spent);
}

Expected<MeshCollider> loadMeshCollider(const std::string& path, const Eigen::Vector3d& scale,
                                        MeshLoadTime& time) {
  const auto longest = std::min(kLongestMeshRead, time.left());
  Expected<MeshCollider> collider =
      time.measure(path, [&](auto* spent) { return loadCollider(path, scale, longest, spent); });
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

Expected<MeshFile> readMeshInChild(const std::string& program, const std::string& path,
                                   std::chrono::milliseconds longest,
                                   std::chrono::milliseconds* spent,
                                   std::chrono::milliseconds wait) {
  const ChildLimits limits = {.time = wait,
                              .processor_time = longest,
                              .memory_bytes = 1ULL << 30,
                              .output_bytes = 256ULL << 20};
  const ChildResult child = runChild(program, {path}, limits);
  if (spent != nullptr) *spent += child.processor_time;
  if (child.ending == ChildEnding::kExited && child.code == 0) return decodeMesh(child.output);
  return fileFault("", "the mesh file " + printable(path) + " " + ending(child, limits),
                   "export it again as STL, OBJ, PLY, DAE or GLB, with fewer triangles");
}

std::string encodeMesh(const Expected<MeshFile>& file) {
  std::string text;
  if (!file) {
    const Diagnostic& why = file.errors().front();
    const Head head{kRefusal, static_cast<std::uint32_t>(why.problem.size()),
                    static_cast<std::uint32_t>(why.remedy.size())};
    put(text, &head, 1);
    return text + why.problem + why.remedy;
  }
  std::string notices;
  for (const std::string& notice : file->notices) notices += notice + "\n";
  const MeshSurface& mesh = file->surface;
  const Head head{kSurface, static_cast<std::uint32_t>(mesh.points.size()),
                  static_cast<std::uint32_t>(mesh.triangles.size()),
                  static_cast<std::uint32_t>(notices.size())};
  put(text, &head, 1);
  for (const Eigen::Vector3d& p : mesh.points) put(text, p.data(), 3);
  for (const Eigen::Vector3i& t : mesh.triangles) put(text, t.data(), 3);
  put(text, file->part.data(), mesh.triangles.size());
  return text + notices;
}

Expected<MeshFile> decodeMesh(std::string_view text) {
  Head head;
  if (text.size() < sizeof head) return damaged();
  std::memcpy(&head, text.data(), sizeof head);
  text.remove_prefix(sizeof head);
  if (head.what == kSurface) return decodeSurface(head, text);
  if (head.what != kRefusal || text.size() != std::size_t{head.first} + head.second) {
    return damaged();
  }
  return fileFault("", std::string(text.substr(0, head.first)),
                   std::string(text.substr(head.first)));
}

}  // namespace wholehand
