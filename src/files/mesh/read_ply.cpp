#include "files/mesh/mesh_readers.hpp"
#include "loop/core/printable.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

namespace wholehand {
namespace {

enum class PlyFormat { kText, kLittle, kBig };

struct PlyType {
  std::string_view name, other_name;
  std::size_t bytes;
  char kind;  ///< 'i': signed, 'u': unsigned, 'f': float
};

constexpr std::array<PlyType, 8> kPlyTypes = {{{"char", "int8", 1, 'i'},
                                               {"uchar", "uint8", 1, 'u'},
                                               {"short", "int16", 2, 'i'},
                                               {"ushort", "uint16", 2, 'u'},
                                               {"int", "int32", 4, 'i'},
                                               {"uint", "uint32", 4, 'u'},
                                               {"float", "float32", 4, 'f'},
                                               {"double", "float64", 8, 'f'}}};

struct PlyProperty {
  std::string name;
  const PlyType* count = nullptr;  ///< type of a list's length; null: a single value
  const PlyType* value = nullptr;
};

struct PlyElement {
  std::string name;
  std::int64_t count = 0;
  std::vector<PlyProperty> properties;
};

[[noreturn]] void failPly(std::string problem) {
  throw UnreadableMesh{std::move(problem), "export it again"};
}

class PlyReader {
 public:
  explicit PlyReader(std::string_view bytes)
      : bytes_(withoutByteOrderMark(bytes)), words_(bytes_) {}

  MeshFile read() {
    readHeader();
    for (const PlyElement& element : elements_) {
      // Every value takes at least one byte, so that a small file cannot announce a long loop. An
      // element without properties has no values and is skipped.
      if (element.properties.empty()) continue;
      checkCorners(element);
      checkFaces(element);
      for (std::int64_t i = 0; i < element.count; ++i) readRow(element);
    }
    addFaces();
    const bool more = format_ == PlyFormat::kText ? !words_.next().empty() : at_ < bytes_.size();
    if (more) file_.notices.emplace_back("goes on behind the values of its head, which is ignored");
    return std::move(file_);
  }

 private:
  static bool namesCorners(const PlyProperty& p) {
    return p.name == "vertex_indices" || p.name == "vertex_index";
  }

  static void checkCorners(const PlyElement& element) {
    if (element.name != "vertex" || element.count == 0) return;
    for (const char* name : {"x", "y", "z"}) {
      if (std::none_of(element.properties.begin(), element.properties.end(),
                       [&](const PlyProperty& p) { return p.name == name; })) {
        failPly(fmt::format("has vertices without a property \"{}\"", name));
      }
    }
  }

  static void checkFaces(const PlyElement& element) {
    if (element.name != "face" || element.count == 0) return;
    if (std::none_of(element.properties.begin(), element.properties.end(), namesCorners)) {
      failPly("has faces without a list \"vertex_indices\"");
    }
  }

  const PlyType& type(std::string_view name) {
    for (const PlyType& t : kPlyTypes) {
      if (name == t.name || name == t.other_name) return t;
    }
    failPly(
        fmt::format("has an unknown type \"{}\" in line {}", printable(name, 40), words_.line()));
  }

  void readHeader() {
    if (words_.next() != "ply") failPly("is no PLY: it does not start with \"ply\"");
    bool format = false;
    for (;;) {
      const std::string_view key = words_.next();
      if (key == "end_header") break;
      if (key == "format") {
        const std::string_view name = words_.next();
        format = name == "ascii" || name == "binary_little_endian" || name == "binary_big_endian";
        if (!format) failPly(fmt::format("is of an unknown format \"{}\"", printable(name, 40)));
        format_ = name == "ascii"                  ? PlyFormat::kText
                  : name == "binary_little_endian" ? PlyFormat::kLittle
                                                   : PlyFormat::kBig;
        words_.restOfLine();
      } else if (key == "comment" || key == "obj_info") {
        words_.restOfLine();
      } else if (key == "element") {
        const std::string name(words_.next());
        elements_.push_back({name, words_.whole(0, std::int64_t{1} << 32U), {}});
      } else if (key == "property" && !elements_.empty()) {
        PlyProperty property;
        std::string_view word = words_.next();
        if (word == "list") {
          property.count = &type(words_.next());
          word = words_.next();
        }
        property.value = &type(word);
        property.name = words_.next();
        elements_.back().properties.push_back(std::move(property));
      } else if (!key.empty() && elements_.empty()) {
        // A comment line without the keyword "comment", as written by Blender 2.4.
        file_.notices.push_back(fmt::format("has \"{}\" in line {} of its head, which is ignored",
                                            printable(key, 40), words_.line()));
        words_.restOfLine();
      } else {
        failPly(fmt::format(
            "has {} in line {} of its head",
            key.empty() ? "no \"end_header\"" : fmt::format("\"{}\"", printable(key, 40)),
            words_.line()));
      }
    }
    if (!format) failPly("names no format in its head");
    at_ = words_.position();
    if (const std::size_t end = bytes_.find_first_not_of(" \t", at_);
        end != bytes_.npos && (bytes_[end] == '\r' || bytes_[end] == '\n')) {
      at_ = end;
    }
    // In a file whose lines end in \r only, a \n after the header is the first byte of the values.
    const bool bare = bytes_.substr(0, 5).starts_with("ply\r") && bytes_.substr(4, 1) != "\n";
    if (!bare && bytes_.substr(at_).starts_with("\r\n")) ++at_;
    ++at_;
  }

  template <class T>
  static double as(std::uint64_t bits) {
    T value;
    std::memcpy(&value, &bits, sizeof value);
    return static_cast<double>(value);
  }

  double value(const PlyType& t) {
    if (format_ == PlyFormat::kText) return words_.number();
    if (at_ > bytes_.size() || bytes_.size() - at_ < t.bytes) {
      failPly("is cut off: it holds fewer values than its head announces");
    }
    std::uint64_t bits = 0;  // little-endian, the order of this machine
    for (std::size_t i = 0; i < t.bytes; ++i) {
      const std::size_t place = format_ == PlyFormat::kLittle ? i : t.bytes - 1 - i;
      bits |= std::uint64_t{static_cast<unsigned char>(bytes_[at_ + i])} << (8 * place);
    }
    at_ += t.bytes;
    if (t.kind == 'f') return t.bytes == 4 ? as<float>(bits) : as<double>(bits);
    if (t.kind == 'u') return static_cast<double>(bits);
    return t.bytes == 1   ? as<std::int8_t>(bits)
           : t.bytes == 2 ? as<std::int16_t>(bits)
                          : as<std::int32_t>(bits);
  }

  void readRow(const PlyElement& element) {
    Eigen::Vector3d corner = Eigen::Vector3d::Zero();
    for (const PlyProperty& p : element.properties) {
      if (p.count == nullptr) {
        const double v = value(*p.value);
        if (p.name.size() == 1 && p.name[0] >= 'x' && p.name[0] <= 'z') corner[p.name[0] - 'x'] = v;
        continue;
      }
      const double count = value(*p.count);
      if (!(count >= 0.0) || count > 1e8) failPly(fmt::format("has a list of {:g} values", count));
      list_.clear();
      for (int i = 0; i < static_cast<int>(count); ++i) list_.push_back(value(*p.value));
      const bool indices = namesCorners(p);
      if (indices && (element.name == "face" || element.name == "tristrips")) {
        faces_.push_back({element.name == "tristrips", list_});
      }
    }
    if (element.name == "vertex") file_.surface.points.push_back(corner);
    // In the text format each row has its own line.
    if (format_ == PlyFormat::kText && !words_.restOfLine().empty() && !more_) {
      more_ = true;
      file_.notices.push_back(fmt::format(
          "has more values in line {} than its head names, which are ignored", words_.line()));
    }
  }

  [[nodiscard]] std::vector<int> corners(const std::vector<double>& list) const {
    std::vector<int> found;
    for (const double v : list) {
      if (!isCorner(v, file_.surface.points.size())) {
        failPly(fmt::format("has a face with the corner {:g}; there are {}", v,
                            file_.surface.points.size()));
      }
      found.push_back(static_cast<int>(v));
    }
    return found;
  }

  /// Adds the faces after all corners: a file may list its faces first.
  void addFaces() {
    for (const Face& face : faces_) {
      if (!face.strips) {
        addPolygon(file_.surface, corners(face.list));
        continue;
      }
      // -1 ends a strip.
      for (auto from = face.list.begin(); from != face.list.end();) {
        const auto end = std::find(from, face.list.end(), -1.0);
        addStrip(file_.surface, corners({from, end}));
        from = end == face.list.end() ? end : end + 1;
      }
    }
  }

  struct Face {
    bool strips = false;       ///< consecutive strips, which -1 separates
    std::vector<double> list;  ///< indices of corners
  };

  std::string_view bytes_;
  MeshWords words_;
  PlyFormat format_ = PlyFormat::kText;
  std::vector<PlyElement> elements_;
  std::size_t at_ = 0;
  std::vector<double> list_;
  std::vector<Face> faces_;
  bool more_ = false;  ///< a row has more values than the header declares
  MeshFile file_;
};

static_assert(std::endian::native == std::endian::little);

}  // namespace

MeshFile readPly(std::string_view bytes) {
  return PlyReader(bytes).read();
}

}  // namespace wholehand
