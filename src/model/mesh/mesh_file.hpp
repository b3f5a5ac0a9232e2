#pragma once

#include "core/expected.hpp"

#include <Eigen/Core>

#include <chrono>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace wholehand {

/// The triangles of a mesh file, unchanged.
struct MeshSurface {
  std::vector<Eigen::Vector3d> points;     ///< in the file's own unit
  std::vector<Eigen::Vector3i> triangles;  ///< indices into points
};

/// Limit of the time to read one mesh file.
inline constexpr std::chrono::milliseconds kLongestMeshRead = std::chrono::seconds(10);

/// Reads a mesh file (STL, OBJ, DAE, GLB) in a child process (meshReaderProgram()); without that
/// program, in this process, without a limit of time.
/// @return as readMeshHere()
[[nodiscard]] Expected<MeshSurface> readMesh(const std::string& path,
                                             std::chrono::milliseconds longest = kLongestMeshRead);

/// Reads a mesh file in this process with assimp, which a damaged file may crash.
/// @return the surface, or one Diagnostic with problem and remedy (file and key are the caller's)
[[nodiscard]] Expected<MeshSurface> readMeshHere(const std::string& path);

/// Path of wholehand-read-mesh, the program that reads a mesh in a child process: beside this
/// program, or in lib/wholehand of the parent folder. Empty: not found.
[[nodiscard]] std::string meshReaderProgram();

/// Runs `program FILE` with limits of `longest` and 1 GB, and reads its result. Survives a crash of
/// that process.
/// @return as readMeshHere()
[[nodiscard]] Expected<MeshSurface> readMeshInChild(
    const std::string& program, const std::string& path,
    std::chrono::milliseconds longest = kLongestMeshRead);

/// Encodes the result for that program's standard output: a surface or an error. For processes of
/// the same build on the same machine.
[[nodiscard]] std::string encodeMesh(const Expected<MeshSurface>& mesh);
/// @param text any bytes
/// @return the input of encodeMesh(). Every index is valid.
[[nodiscard]] Expected<MeshSurface> decodeMesh(std::string_view text);

/// Time that all meshes of one scene or URDF may take together. One file alone is limited to
/// kLongestMeshRead, too.
class MeshLoadTime {
 public:
  using Duration = std::chrono::milliseconds;
  using Clock = std::function<std::chrono::steady_clock::time_point()>;

  static constexpr Duration kTotal = std::chrono::seconds(30);

  explicit MeshLoadTime(Duration total = kTotal, Clock clock = std::chrono::steady_clock::now)
      : total_(total), clock_(std::move(clock)) {}

  /// Runs `load` and adds its time to that of the file.
  template <class Load>
  auto measure(const std::string& path, Load load) {
    const auto begin = clock_();
    auto result = load();
    add(path, std::chrono::duration_cast<Duration>(clock_() - begin));
    return result;
  }
  /// Time that is left, >= 0.
  [[nodiscard]] Duration left() const;
  [[nodiscard]] bool isOver() const { return !files_.empty() && taken_ >= total_; }
  /// Problem and remedy once the time is over: which files took how long, the slowest first.
  [[nodiscard]] Diagnostic fault() const;

 private:
  void add(const std::string& path, Duration taken);

  Duration total_;
  Clock clock_;
  Duration taken_{0};
  std::vector<std::pair<std::string, Duration>> files_;
};

}  // namespace wholehand
