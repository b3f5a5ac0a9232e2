#pragma once

#include "files/mesh/mesh_file.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace wholehand {

// One reader for each kind of mesh file. The bytes may be anything. Each returns the surface, or
// throws an UnreadableMesh.

/// Why a file's bytes give no surface: "the mesh file cup.obj " + problem.
struct UnreadableMesh {
  std::string problem;
  std::string remedy;
};

[[nodiscard]] MeshFile readStl(std::string_view bytes);
[[nodiscard]] MeshFile readObj(std::string_view bytes);
[[nodiscard]] MeshFile readPly(std::string_view bytes);
[[nodiscard]] MeshFile readDae(std::string_view bytes);
[[nodiscard]] MeshFile readGlb(std::string_view bytes);

/// Limit of triangles that nodes of one file may place together: a node may place the same mesh
/// again and again.
inline constexpr std::size_t kMostPlacedTriangles = 4'000'000;
/// Limit of nodes in nodes.
inline constexpr int kMostNestedNodes = 64;

/// Number in any locale: "1", "+.5", "2.", "1e-3"; empty when the word is none. A number too small
/// for a double is 0.
[[nodiscard]] std::optional<double> meshNumber(std::string_view word);
/// True for the number of one of `count` corners, from 0.
[[nodiscard]] bool isCorner(double value, std::size_t count);

/// Words of a text between blanks and line ends, with the line that each stands in.
class MeshWords {
 public:
  explicit MeshWords(std::string_view text) : text_(text) {}

  /// The next word; empty at the end.
  std::string_view next();
  /// The rest of the line, without its blanks at both ends.
  std::string_view restOfLine();
  /// Goes on at the start of a part of what was returned.
  void resumeAt(std::string_view part) {
    at_ = static_cast<std::size_t>(part.data() - text_.data());
  }
  /// The next word as a number. @throws UnreadableMesh with line and word, when it is none
  double number();
  /// As number(), a whole one. @throws also when it is not within [least, most]
  std::int64_t whole(std::int64_t least, std::int64_t most);
  [[nodiscard]] int line() const { return line_; }
  /// Where the rest of the text starts.
  [[nodiscard]] std::size_t position() const { return at_; }

 private:
  std::string_view text_;
  std::size_t at_ = 0;
  int line_ = 1;
};

/// Text without a byte order mark of UTF-8.
[[nodiscard]] std::string_view withoutByteOrderMark(std::string_view text);

/// Appends a polygon as triangles: a fan from its first corner; where it is not convex, by cutting
/// ears.
/// @pre every corner is an index of surface.points
void addPolygon(MeshSurface& surface, const std::vector<int>& corners);
/// Appends a strip of triangles, every second one turned, or a fan about the first corner.
void addStrip(MeshSurface& surface, const std::vector<int>& corners);
void addFan(MeshSurface& surface, const std::vector<int>& corners);

/// Appends a surface, placed by an affine map, as a part of its own. A map that mirrors turns the
/// winding. @throws UnreadableMesh beyond kMostPlacedTriangles
void place(const MeshSurface& surface, const Eigen::Matrix4d& map, MeshFile& file);

}  // namespace wholehand
