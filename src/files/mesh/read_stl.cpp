#include "files/mesh/mesh_readers.hpp"
#include "loop/core/printable.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstring>

namespace wholehand {
namespace {

constexpr std::size_t kStlHead_bytes = 84, kStlTriangle_bytes = 50;

std::string lowerCase(std::string_view word) {
  std::string lower(word);
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return lower;
}

[[noreturn]] void failStlWord(const MeshWords& words, std::string_view found,
                              const char* expected) {
  throw UnreadableMesh{
      fmt::format("has {} where {} belongs, in line {}",
                  found.empty() ? "its end" : fmt::format("\"{}\"", printable(found, 40)), expected,
                  words.line()),
      "export it again"};
}

/// Skips the name after "solid" or "endsolid": the rest of the line up to a facet that starts in
/// it.
void skipStlName(MeshWords& words, bool ends) {
  constexpr std::size_t kLongest = 1000;
  const std::string_view rest = words.restOfLine();
  const std::string line = " " + lowerCase(rest.substr(0, kLongest));
  for (std::size_t at = line.find(" facet"); at != line.npos; at = line.find(" facet", at + 1)) {
    MeshWords next(std::string_view(line).substr(at));
    if (next.next() != "facet" || next.next() != "normal") continue;
    const std::size_t solid = ends ? line.rfind(" solid", at) : line.npos;
    return words.resumeAt(rest.substr(std::min(at, solid)));
  }
}

/// Reads the text format: "solid", "facet normal", "outer loop", "vertex", "endloop", "endfacet",
/// "endsolid", in upper or lower case. Each solid is a part.
MeshFile readStlText(std::string_view text) {
  MeshFile file;
  MeshWords words(text);
  std::vector<int> corners;
  bool open = false;
  int part = -1;
  for (std::string_view word = words.next(); !word.empty(); word = words.next()) {
    const std::string key = lowerCase(word);
    if (key == "solid") {
      skipStlName(words, false);
      ++part;
    } else if (key == "endsolid") {
      skipStlName(words, true);
    } else if (key == "facet") {
      if (open) failStlWord(words, word, "endfacet");
      open = true;
      corners.clear();
      if (lowerCase(words.next()) != "normal") failStlWord(words, word, "facet normal");
      for (int i = 0; i < 3; ++i)
        words.next();  // skips the normal, which follows from the corners and is often nan
    } else if (key == "vertex" && open) {
      const double x = words.number(), y = words.number(), z = words.number();
      corners.push_back(static_cast<int>(file.surface.points.size()));
      file.surface.points.emplace_back(x, y, z);
    } else if (key == "endfacet" && open) {
      if (corners.size() < 3) failStlWord(words, word, "a third vertex");
      addPolygon(file.surface, corners);
      file.part.resize(file.surface.triangles.size(), part);
      open = false;
    } else if (key != "outer" && key != "loop" && key != "endloop") {
      failStlWord(words, word, "facet, vertex or endsolid");
    }
  }
  if (open) failStlWord(words, "", "endfacet");
  return file;
}

/// True for bytes of a text alone, such as a dump of a binary file.
bool isText(std::string_view bytes) {
  return std::all_of(bytes.begin(), bytes.end(), [](unsigned char c) {
    return (c >= ' ' && c != 0x7F) || c == '\n' || c == '\r' || c == '\t';
  });
}

MeshFile readStlBinary(std::string_view bytes, std::uint32_t count) {
  MeshFile file;
  const std::size_t present = (bytes.size() - kStlHead_bytes) / kStlTriangle_bytes;
  // Programs that write to a pipe do not know the number of triangles and leave 0.
  const std::size_t triangles = count == 0 ? present : count;
  if (triangles > present && isText(bytes.substr(0, kStlHead_bytes))) {
    throw UnreadableMesh{"is a text that does not begin as an STL, with \"solid\"",
                         "export it again, as STL"};
  }
  if (triangles > present) {
    throw UnreadableMesh{
        fmt::format("is cut off: it announces {} triangles and holds {}", triangles, present),
        "copy or export it again"};
  }
  if (present > triangles) {
    file.notices.push_back(
        fmt::format("has {} bytes behind the {} triangles that it announces, which are ignored",
                    bytes.size() - kStlHead_bytes - triangles * kStlTriangle_bytes, triangles));
  }
  for (std::size_t i = 0; i < triangles; ++i) {
    const int first = static_cast<int>(file.surface.points.size());
    std::array<float, 9> corners;  // three corners, stored after the normal
    std::memcpy(corners.data(), bytes.data() + kStlHead_bytes + i * kStlTriangle_bytes + 12,
                sizeof corners);
    for (std::size_t k = 0; k < 9; k += 3) {
      file.surface.points.emplace_back(corners[k], corners[k + 1], corners[k + 2]);
    }
    file.surface.triangles.emplace_back(first, first + 1, first + 2);
  }
  return file;
}

}  // namespace

MeshFile readStl(std::string_view bytes) {
  std::uint32_t count = 0;
  if (bytes.size() >= kStlHead_bytes) std::memcpy(&count, bytes.data() + 80, sizeof count);
  const bool exact = bytes.size() == kStlHead_bytes + std::size_t{count} * kStlTriangle_bytes;
  // Some programs start a binary file with "solid" as well. A binary file contains zero bytes, a
  // text does not; zero bytes at the end of a text are padding.
  std::string_view text = withoutByteOrderMark(bytes);
  text = text.substr(0, text.find_last_not_of('\0') + 1);
  if (!(exact && count > 0) && lowerCase(MeshWords(text.substr(0, 200)).next()) == "solid" &&
      text.find('\0') == text.npos) {
    return readStlText(text);
  }
  if (bytes.size() < kStlHead_bytes) {
    throw UnreadableMesh{
        "holds no surface that can be read: it is neither a text that starts with "
        "\"solid\" nor 84 bytes long",
        "export it again as STL, OBJ, PLY, DAE or GLB"};
  }
  if (!exact && text.find('\0') == text.npos && lowerCase(text).find("facet normal") != text.npos) {
    throw UnreadableMesh{fmt::format("is a text that starts with \"{}\", not with \"solid\"",
                                     printable(MeshWords(text.substr(0, 200)).next(), 40)),
                         "take out what stands before its line \"solid\""};
  }
  return readStlBinary(bytes, count);
}

}  // namespace wholehand
