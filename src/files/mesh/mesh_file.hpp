#pragma once

#include "loop/core/expected.hpp"

#include <Eigen/Core>

#include <chrono>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace wholehand {

/// A surface of triangles.
struct MeshSurface {
  std::vector<Eigen::Vector3d> points;     ///< in the file's own unit
  std::vector<Eigen::Vector3i> triangles;  ///< indices into points
};

/// Content of a mesh file: its triangles, placed by the file's nodes and otherwise unchanged.
struct MeshFile {
  MeshSurface surface;
  /// For each triangle the number of its object, group, solid or placed geometry.
  std::vector<int> part;
  std::vector<std::string>
      notices;  ///< content of the file that is not applied, as "has ..." or "is ..."
};

/// Limit of the processor time that reading one mesh file takes. Processor time, because the time
/// on the clock depends on what else the machine does.
inline constexpr std::chrono::milliseconds kLongestMeshRead = std::chrono::seconds(10);
/// Limit of its time on the clock: a disk that does not answer.
inline constexpr std::chrono::milliseconds kLongestMeshWait = std::chrono::minutes(2);

/// Reads a mesh file (STL, OBJ, PLY, DAE, GLB) in a child process (meshReaderProgram()). If that
/// program is not found, reads it in this process without a time limit.
/// @param longest processor time @param spent if not null: the child's processor time is added
/// @return as readMeshHere()
[[nodiscard]] Expected<MeshFile> readMesh(const std::string& path,
                                          std::chrono::milliseconds longest = kLongestMeshRead,
                                          std::chrono::milliseconds* spent = nullptr);

/// Reads a mesh file in this process.
/// @return the surface, or one Diagnostic with problem and remedy (the caller adds file and key)
[[nodiscard]] Expected<MeshFile> readMeshHere(const std::string& path);

/// Path of wholehand-read-mesh, the program that reads a mesh in a child process: in the folder of
/// this program, or in lib/wholehand of the parent folder. Empty: not found.
[[nodiscard]] std::string meshReaderProgram();

/// Runs `program FILE` with limits of `longest` processor time, `wait` on the clock and 1 GB, and
/// reads its result. Survives a crash of that process.
/// @return as readMeshHere()
[[nodiscard]] Expected<MeshFile> readMeshInChild(
    const std::string& program, const std::string& path,
    std::chrono::milliseconds longest = kLongestMeshRead,
    std::chrono::milliseconds* spent = nullptr, std::chrono::milliseconds wait = kLongestMeshWait);

/// Encodes the result for that program's standard output: a surface or an error. For processes of
/// the same build on the same machine.
[[nodiscard]] std::string encodeMesh(const Expected<MeshFile>& file);
/// @param text any bytes
/// @return the argument that encodeMesh() got. Every index is valid.
[[nodiscard]] Expected<MeshFile> decodeMesh(std::string_view text);

/// Processor time that all meshes of one scene or URDF may take together: of the processes that
/// read them, and of this thread. Each single file is also limited to kLongestMeshRead.
class MeshLoadTime {
 public:
  using Duration = std::chrono::milliseconds;
  using Clock = std::function<std::chrono::nanoseconds()>;

  static constexpr Duration kTotal = std::chrono::seconds(30);

  /// @param clock processor time of this thread
  explicit MeshLoadTime(Duration total = kTotal, Clock clock = threadProcessorTime)
      : total_(total), clock_(std::move(clock)) {}

  [[nodiscard]] static std::chrono::nanoseconds threadProcessorTime();

  /// Runs `load`, which adds the processor time of other processes to its argument, and adds both
  /// to the file's time.
  template <class Load>
  auto measure(const std::string& path, Load load) {
    const auto begin = clock_();
    Duration elsewhere{0};
    auto result = load(&elsewhere);
    add(path, std::chrono::duration_cast<Duration>(clock_() - begin) + elsewhere);
    return result;
  }
  /// Remaining processor time, >= 0.
  [[nodiscard]] Duration left() const;
  [[nodiscard]] bool isOver() const { return !files_.empty() && taken_ >= total_; }
  /// Problem and remedy when the time is used up: lists the files with their times, the slowest
  /// first.
  [[nodiscard]] Diagnostic fault() const;

 private:
  void add(const std::string& path, Duration taken);

  Duration total_;
  Clock clock_;
  Duration taken_{0};
  std::vector<std::pair<std::string, Duration>> files_;
};

}  // namespace wholehand
