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

// One reader for each mesh format. Arbitrary bytes are safe. Each reader returns the surface or
// throws UnreadableMesh.

/// Reason why a file's bytes give no surface. `problem` completes the sentence "the mesh file
/// cup.obj ...".
struct UnreadableMesh {
  std::string problem;
  std::string remedy;
};

[[nodiscard]] MeshFile readStl(std::string_view bytes);
[[nodiscard]] MeshFile readObj(std::string_view bytes);
[[nodiscard]] MeshFile readPly(std::string_view bytes);
[[nodiscard]] MeshFile readDae(std::string_view bytes);
[[nodiscard]] MeshFile readGlb(std::string_view bytes);

/// Maximum number of triangles that all nodes of one file may place. Nodes may place the same mesh
/// repeatedly.
inline constexpr std::size_t kMostPlacedTriangles = 4'000'000;
/// Maximum nesting depth of nodes.
inline constexpr int kMostNestedNodes = 64;

/// Reads a number independently of the locale: "1", "+.5", "2.", "1e-3"; empty when the word is not
/// a number. A number too small for a double gives 0.
[[nodiscard]] std::optional<double> meshNumber(std::string_view word);
/// True when the value is an index of one of `count` corners, starting at 0.
[[nodiscard]] bool isCorner(double value, std::size_t count);

/// Splits a text into words separated by blanks and line ends, and counts lines.
class MeshWords {
 public:
  explicit MeshWords(std::string_view text) : text_(text) {}

  /// The next word; empty at the end.
  std::string_view next();
  /// The rest of the line, without its blanks at both ends.
  std::string_view restOfLine();
  /// Continues at the start of `part`. @pre `part` lies in a word or line that was returned
  void resumeAt(std::string_view part) {
    at_ = static_cast<std::size_t>(part.data() - text_.data());
  }
  /// The next word as a number. @throws UnreadableMesh with line and word when it is not a number
  double number();
  /// The next word as an integer. @throws UnreadableMesh also when it is outside [least, most]
  std::int64_t whole(std::int64_t least, std::int64_t most);
  [[nodiscard]] int line() const { return line_; }
  /// Offset of the unread rest of the text [bytes].
  [[nodiscard]] std::size_t position() const { return at_; }

 private:
  std::string_view text_;
  std::size_t at_ = 0;
  int line_ = 1;
};

/// The text without a leading UTF-8 byte order mark.
[[nodiscard]] std::string_view withoutByteOrderMark(std::string_view text);

/// Appends a polygon as triangles: a fan from its first corner, or by ear cutting when it is not
/// convex.
/// @pre every corner is an index of surface.points
void addPolygon(MeshSurface& surface, const std::vector<int>& corners);
/// addStrip() appends a strip of triangles and reverses every second one; addFan() appends a fan
/// about the first corner.
void addStrip(MeshSurface& surface, const std::vector<int>& corners);
void addFan(MeshSurface& surface, const std::vector<int>& corners);

/// Appends a surface, transformed by an affine map, as a new part. A mirroring map reverses the
/// winding. @throws UnreadableMesh beyond kMostPlacedTriangles
void place(const MeshSurface& surface, const Eigen::Matrix4d& map, MeshFile& file);

}  // namespace wholehand
