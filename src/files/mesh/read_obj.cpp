#include "files/mesh/mesh_readers.hpp"
#include "loop/core/printable.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <map>
#include <utility>

namespace wholehand {
namespace {

constexpr std::string_view kObjBlanks = " \t\r\v\f";

// Keywords that do not contribute to a surface of polygons and are skipped. Some belong to curved
// surfaces, which are refused at "cstype"; "t" (subdivision) and "vw" (skins) are extensions of
// other programs.
constexpr std::array<std::string_view, 19> kObjLooks = {
    "t",      "vw",       "vt",       "vn",         "l",        "p",   "s",
    "usemtl", "mtllib",   "usemap",   "maplib",     "bevel",    "lod", "mg",
    "vp",     "c_interp", "d_interp", "shadow_obj", "trace_obj"};

class ObjReader {
 public:
  explicit ObjReader(std::string_view text) : text_(withoutByteOrderMark(text)) {}

  MeshFile read() {
    while (at_ < text_.size()) readLine();
    for (const Face& face : faces_) addFace(face);
    return std::move(file_);
  }

 private:
  struct Face {
    std::vector<int>
        corners;  ///< indices from 0; indices beyond the points are detected at the end
    int line = 0;
    int part = 0;
  };

  [[noreturn]] static void fail(int line, const std::string& problem) {
    throw UnreadableMesh{fmt::format("cannot be read: its line {} {}", line, problem),
                         "correct this line, or export it again"};
  }

  /// The next line of the file, without its end.
  std::string_view rawLine() {
    const std::size_t end = std::min(text_.find_first_of("\r\n", at_), text_.size());
    const std::string_view line = text_.substr(at_, end - at_);
    at_ = end + (text_.substr(end).starts_with("\r\n") ? 2 : 1);
    ++line_;
    return line;
  }

  static std::vector<std::string_view> wordsOf(std::string_view line) {
    std::vector<std::string_view> words;
    std::size_t begin = line.find_first_not_of(kObjBlanks);
    while (begin != line.npos) {
      const std::size_t end = std::min(line.find_first_of(kObjBlanks, begin), line.size());
      words.push_back(line.substr(begin, end - begin));
      begin = line.find_first_not_of(kObjBlanks, end);
    }
    return words;
  }

  void readLine() {
    std::string line(rawLine());
    const int number = line_;
    const std::vector<std::string_view> first = wordsOf(line);
    if (first.empty() || first[0].starts_with('#')) return;
    const std::string key(first[0].substr(0, first[0].find('#')));
    if (key == "o" || key == "g") return readName(key, first);
    if (std::find(kObjLooks.begin(), kObjLooks.end(), key) != kObjLooks.end()) {
      const bool numbers = key == "vt" || key == "vn" || key == "l" || key == "p" || key == "vp";
      if (numbers) join(line);
      return;
    }
    if (key != "v" && key != "f" && key != "fo") {
      const bool curved = key == "cstype" || key == "surf" || key == "curv";
      fail(number, fmt::format("starts with \"{}\", {}", printable(key, 40),
                               curved          ? "of curved surfaces"
                               : key == "call" ? "which names another file"
                                               : "which is no word of OBJ"));
    }
    join(line);
    line.resize(std::min(line.find('#'), line.size()));
    const std::vector<std::string_view> words = wordsOf(line);
    key == "v" ? readCorner(words, number) : readFace(words, number);
  }

  /// A backslash at the end of numbers continues them in the next line; at the end of a name, it
  /// belongs to the name.
  void join(std::string& line) {
    for (;;) {
      const std::size_t last = line.find_last_not_of(kObjBlanks);
      if (last == line.npos || line[last] != '\\' || line.find('#') < last) return;
      line.resize(last);
      line += ' ';
      if (at_ >= text_.size()) return;
      line += rawLine();
    }
  }

  void readName(const std::string& key, const std::vector<std::string_view>& words) {
    std::string name = key;
    for (std::size_t i = 1; i < words.size(); ++i) name += " " + std::string(words[i]);
    if (key == "o") {
      object_ = name;
      name = "g";
    }
    part_ = parts_.try_emplace({object_, name}, static_cast<int>(parts_.size())).first->second;
  }

  /// Reads a vertex: x y z, optionally followed by a weight of 1 or a colour of 3 or 4 numbers.
  void readCorner(const std::vector<std::string_view>& words, int line) {
    std::array<double, 8> values{};
    const std::size_t count = words.size() - 1;
    if (count != 3 && count != 4 && count != 6 && count != 7) {
      fail(line, fmt::format("has a corner of {} number{}, not 3", count, plural(count)));
    }
    for (std::size_t i = 0; i < count; ++i) {
      const auto value = meshNumber(words[i + 1]);
      if (!value)
        fail(line, fmt::format("has \"{}\" where a number belongs", printable(words[i + 1], 40)));
      values[i] = *value;
    }
    if (count == 4 && values[3] != 1.0) {
      fail(line, fmt::format("has a corner of weight {:g}, not 1", values[3]));
    }
    file_.surface.points.emplace_back(values[0], values[1], values[2]);
  }

  void readFace(const std::vector<std::string_view>& words, int line) {
    Face face{{}, line, part_};
    for (std::size_t i = 1; i < words.size(); ++i) {
      const std::string_view corner = words[i].substr(0, words[i].find('/'));
      int index = 0;
      const char* end = corner.data() + corner.size();
      const auto [stop, error] = std::from_chars(corner.data(), end, index);
      if (error != std::errc{} || stop != end || index == 0) {
        fail(line, fmt::format("has \"{}\" where the number of a corner belongs",
                               printable(words[i], 40)));
      }
      const int count = static_cast<int>(file_.surface.points.size());
      if (index < -count) failCorner(line, index, count);
      face.corners.push_back(index > 0 ? index - 1 : count + index);
    }
    if (face.corners.size() < 3) {
      fail(line, fmt::format("has a face of {} corner{}", face.corners.size(),
                             plural(face.corners.size())));
    }
    faces_.push_back(std::move(face));
  }

  [[noreturn]] static void failCorner(int line, int index, int count) {
    fail(line,
         fmt::format("names the corner {}; there {} {}", index, count == 1 ? "is" : "are", count));
  }

  void addFace(const Face& face) {
    const int count = static_cast<int>(file_.surface.points.size());
    for (const int corner : face.corners) {
      if (corner >= count) failCorner(face.line, corner + 1, count);
    }
    addPolygon(file_.surface, face.corners);
    file_.part.resize(file_.surface.triangles.size(), face.part);
  }

  std::string_view text_;
  std::size_t at_ = 0;
  int line_ = 0;
  MeshFile file_;
  std::vector<Face> faces_;
  std::string object_;
  std::map<std::pair<std::string, std::string>, int> parts_{{{"", "g"}, 0}};
  int part_ = 0;
};

}  // namespace

MeshFile readObj(std::string_view bytes) {
  return ObjReader(bytes).read();
}

}  // namespace wholehand
