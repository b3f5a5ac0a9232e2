#include "files/mesh/mesh_readers.hpp"
#include "loop/core/printable.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>

namespace wholehand {
namespace {

using Eigen::Matrix4d;
using Json = nlohmann::json;

[[noreturn]] void failGlb(std::string problem, std::string remedy = "export it again") {
  throw UnreadableMesh{std::move(problem), std::move(remedy)};
}

/// Extensions of compressed geometry, which is not read.
constexpr std::array<std::string_view, 2> kCompressed = {"KHR_draco_mesh_compression",
                                                         "EXT_meshopt_compression"};

/// True for an extension that is supported or concerns appearance only.
bool isKnown(std::string_view extension) {
  constexpr std::array<std::string_view, 4> kBegins = {"KHR_mesh_quantization", "KHR_materials_",
                                                       "KHR_texture_", "EXT_texture_"};
  return std::any_of(kBegins.begin(), kBegins.end(),
                     [&](std::string_view begin) { return extension.starts_with(begin); });
}

class GlbReader {
 public:
  explicit GlbReader(std::string_view bytes) {
    if (!bytes.starts_with("glTF") || bytes.size() < 20) {
      failGlb("is no GLB: it does not start with \"glTF\"");
    }
    if (const std::uint32_t version = word(bytes, 4); version != 2) {
      failGlb(fmt::format("is GLB of version {}, not 2", version));
    }
    if (const std::size_t length = word(bytes, 8); length < bytes.size()) {
      bytes = bytes.substr(0, length);
    } else if (length > bytes.size()) {
      failGlb(fmt::format("is cut off: it announces {} bytes and holds {}", length, bytes.size()),
              "copy or export it again");
    }
    for (std::size_t at = 12; at + 8 <= bytes.size();) {
      const std::size_t length = word(bytes, at);
      const std::string_view kind = bytes.substr(at + 4, 4);
      if (length > bytes.size() - at - 8) failGlb("is cut off: a chunk ends behind its end");
      const std::string_view chunk = bytes.substr(at + 8, length);
      if (kind == "JSON" && json_.is_null()) json_ = Json::parse(chunk, nullptr, false);
      if (kind == std::string_view("BIN\0", 4) && binary_.empty()) binary_ = chunk;
      at += 8 + length;
    }
    if (!json_.is_object()) failGlb("holds no JSON that can be read");
  }

  MeshFile read() {
    for (const Json& name : list(json_, "extensionsRequired")) {
      for (const std::string_view compressed : kCompressed) {
        if (name == compressed) {
          failGlb(fmt::format("has compressed geometry ({})", compressed),
                  "export it again without compression");
        }
      }
      if (name.is_string() && !isKnown(name.get<std::string>())) {
        file_.notices.push_back(
            fmt::format("requires the extension {}, which is not known and ignored",
                        printable(name.get<std::string>(), 60)));
      }
    }
    for (const Json& name : list(json_, "extensionsUsed")) {
      if (name == "EXT_mesh_gpu_instancing") {
        failGlb("repeats its meshes by EXT_mesh_gpu_instancing",
                "export it again with a node for each");
      }
    }
    file_.notices.emplace_back(
        "is of glTF, whose y axis points up, which is ignored: its axes are taken as they are");
    const Json& scenes = list(json_, "scenes");
    if (scenes.empty()) {
      placeRoots();
    } else {
      const Json& scene = at(scenes, index(json_, "scene", 0), "scene");
      for (const Json& node : list(scene, "nodes")) placeNode(node, Matrix4d::Identity(), 0);
    }
    return std::move(file_);
  }

 private:
  static std::uint32_t word(std::string_view bytes, std::size_t at) {
    std::uint32_t value = 0;
    std::memcpy(&value, bytes.data() + at, sizeof value);
    return value;
  }

  /// A member that is a list; an empty list if the member is missing.
  static const Json& list(const Json& of, const char* name) {
    static const Json kNone = Json::array();
    if (!of.is_object()) failGlb(fmt::format("has a JSON value that is no object around {}", name));
    const auto found = of.find(name);
    if (found == of.end()) return kNone;
    if (!found->is_array()) failGlb(fmt::format("has {} that are no list", name));
    return *found;
  }

  static std::size_t indexOf(const Json& value, const char* name) {
    if (!value.is_number_integer() || value < 0)
      failGlb(fmt::format("has a {} that is no index", name));
    return value.get<std::size_t>();
  }

  static std::size_t index(const Json& of, const char* name, std::size_t otherwise) {
    const auto found = of.find(name);
    return found == of.end() ? otherwise : indexOf(*found, name);
  }

  static const Json& at(const Json& items, std::size_t i, const char* name) {
    if (i >= items.size() || !items[i].is_object())
      failGlb(fmt::format("names a {} that it does not hold", name));
    return items[i];
  }

  template <std::size_t N>
  static std::array<double, N> numbers(const Json& node, const char* name,
                                       std::array<double, N> otherwise) {
    const Json& found = list(node, name);
    if (found.empty()) return otherwise;
    if (found.size() != N)
      failGlb(fmt::format("has a node whose {} has {} numbers", name, found.size()));
    for (std::size_t i = 0; i < N; ++i) {
      if (!found[i].is_number()) failGlb(fmt::format("has a node whose {} is no number", name));
      otherwise[i] = found[i].get<double>();
    }
    return otherwise;
  }

  static Matrix4d mapOf(const Json& node) {
    if (node.contains("matrix")) {
      const auto m = numbers<16>(node, "matrix", {});
      return Eigen::Map<const Matrix4d>(m.data());  // column by column, as in the file
    }
    const auto t = numbers<3>(node, "translation", {0.0, 0.0, 0.0});
    const auto r = numbers<4>(node, "rotation", {0.0, 0.0, 0.0, 1.0});
    const auto s = numbers<3>(node, "scale", {1.0, 1.0, 1.0});
    const Eigen::Quaterniond turn(r[3], r[0], r[1], r[2]);
    if (!(turn.norm() > 0.0)) failGlb("has a node whose rotation is 0");
    Eigen::Affine3d map = Eigen::Affine3d::Identity();
    map.translate(Eigen::Vector3d(t[0], t[1], t[2])).rotate(turn.normalized());
    return map.scale(Eigen::Vector3d(s[0], s[1], s[2])).matrix();
  }

  /// Places all root nodes (nodes that are not a child of another); used when the file has no
  /// scene.
  void placeRoots() {
    const Json& nodes = list(json_, "nodes");
    std::vector<bool> is_child(nodes.size());
    for (const Json& node : nodes) {
      for (const Json& child : list(node, "children")) {
        const std::size_t i = indexOf(child, "child");
        if (i < is_child.size()) is_child[i] = true;
      }
    }
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      if (!is_child[i]) placeNode(Json(i), Matrix4d::Identity(), 0);
    }
  }

  void placeNode(const Json& which, const Matrix4d& parent, int depth) {
    if (depth > kMostNestedNodes || ++placed_nodes_ > kMostPlacedTriangles / 40) {
      failGlb("has nodes that hold one another too often");
    }
    const Json& node = at(list(json_, "nodes"), indexOf(which, "node"), "node");
    const Matrix4d map = parent * mapOf(node);
    if (node.contains("skin")) {
      file_.notices.emplace_back("has a skin, whose joints are ignored: it stands at its node");
    }
    if (node.contains("mesh")) {
      const std::size_t mesh = indexOf(node["mesh"], "mesh");
      const auto [found, is_new] = surfaces_.try_emplace(mesh);
      if (is_new) found->second = surfaceOf(at(list(json_, "meshes"), mesh, "mesh"));
      place(found->second, map, file_);
    }
    for (const Json& child : list(node, "children")) placeNode(child, map, depth + 1);
  }

  /// Joins the primitives of a mesh; primitives only divide a surface by material.
  MeshSurface surfaceOf(const Json& mesh) {
    MeshSurface surface;
    for (const Json& primitive : list(mesh, "primitives")) {
      if (!primitive.is_object()) failGlb("has a primitive that is no object");
      const std::size_t mode = index(primitive, "mode", 4);
      if (mode < 4) continue;  // points and lines have no surface
      const auto attributes = primitive.find("attributes");
      if (attributes == primitive.end() || !attributes->is_object() ||
          !attributes->contains("POSITION")) {
        continue;
      }
      if (!list(primitive, "targets").empty()) {
        file_.notices.emplace_back("has morph targets, which are ignored");
      }
      const std::vector<double> values =
          valuesOf(indexOf((*attributes)["POSITION"], "POSITION"), 3);
      const int first = static_cast<int>(surface.points.size());
      for (std::size_t i = 0; i + 2 < values.size(); i += 3) {
        surface.points.emplace_back(values[i], values[i + 1], values[i + 2]);
      }
      const int count = static_cast<int>(surface.points.size()) - first;
      addTriangles(cornersOf(primitive, first, count), mode, surface);
    }
    return surface;
  }

  std::vector<int> cornersOf(const Json& primitive, int first, int count) {
    std::vector<int> corners;
    if (!primitive.contains("indices")) {
      for (int i = 0; i < count; ++i) corners.push_back(first + i);
      return corners;
    }
    for (const double i : valuesOf(indexOf(primitive["indices"], "indices"), 1)) {
      if (!isCorner(i, static_cast<std::size_t>(count))) {
        failGlb(fmt::format("has a face with the corner {:g}; there are {}", i, count));
      }
      corners.push_back(first + static_cast<int>(i));
    }
    return corners;
  }

  static void addTriangles(const std::vector<int>& corners, std::size_t mode,
                           MeshSurface& surface) {
    if (mode == 5) return addStrip(surface, corners);
    if (mode == 6) return addFan(surface, corners);
    for (std::size_t i = 2; i < corners.size(); i += 3) {
      surface.triangles.emplace_back(corners[i - 2], corners[i - 1], corners[i]);
    }
  }

  std::string_view view(std::size_t which, std::size_t& stride) {
    const Json& found = at(list(json_, "bufferViews"), which, "bufferView");
    const std::size_t which_buffer = index(found, "buffer", 0);
    const Json& buffer = at(list(json_, "buffers"), which_buffer, "buffer");
    if (const auto uri = buffer.find("uri"); uri != buffer.end()) {
      if (uri->is_string() && uri->get<std::string>().starts_with("data:")) {
        failGlb("keeps its geometry as text in its JSON",
                "make it binary: npx @gltf-transform/cli copy in.glb out.glb");
      }
      failGlb("keeps its geometry in another file", "export it as one GLB file");
    }
    if (which_buffer != 0) failGlb("names a buffer that it does not hold");
    const std::size_t offset = index(found, "byteOffset", 0),
                      length = index(found, "byteLength", 0);
    if (offset > binary_.size() || length > binary_.size() - offset) {
      failGlb("is cut off: its geometry ends behind its end");
    }
    stride = index(found, "byteStride", stride);
    return binary_.substr(offset, length);
  }

  struct ComponentType {
    std::size_t code, bytes;
    double scale;  ///< value that stands for 1 in a normalized accessor
  };

  static ComponentType componentType(const Json& of) {
    constexpr std::array<ComponentType, 6> kTypes = {{{5120, 1, 127.0},
                                                      {5121, 1, 255.0},
                                                      {5122, 2, 32767.0},
                                                      {5123, 2, 65535.0},
                                                      {5125, 4, 4294967295.0},
                                                      {5126, 4, 1.0}}};
    const std::size_t code = index(of, "componentType", 0);
    for (const ComponentType& t : kTypes) {
      if (t.code == code) return t;
    }
    failGlb(fmt::format("has numbers of an unknown type {}", code));
  }

  template <class T>
  static double as(const char* bytes) {
    T value;
    std::memcpy(&value, bytes, sizeof value);
    return static_cast<double>(value);
  }

  static double component(std::size_t code, const char* bytes) {
    switch (code) {
      case 5120:
        return as<std::int8_t>(bytes);
      case 5121:
        return as<std::uint8_t>(bytes);
      case 5122:
        return as<std::int16_t>(bytes);
      case 5123:
        return as<std::uint16_t>(bytes);
      case 5125:
        return as<std::uint32_t>(bytes);
      default:
        return as<float>(bytes);
    }
  }

  /// Reads `rows` x `width` numbers that lie in a view.
  std::vector<double> readView(const Json& of, const ComponentType& t, std::size_t rows,
                               std::size_t width) {
    std::size_t stride = width * t.bytes;
    const std::string_view bytes = view(index(of, "bufferView", 0), stride);
    const std::size_t offset = index(of, "byteOffset", 0), row_bytes = width * t.bytes;
    if (rows == 0) return {};
    if (stride > 4096 || rows > binary_.size() || offset > bytes.size() ||
        (rows - 1) * stride + row_bytes > bytes.size() - offset) {
      failGlb("is cut off: its geometry ends behind its end");
    }
    std::vector<double> values;
    values.reserve(rows * width);
    for (std::size_t row = 0; row < rows; ++row) {
      for (std::size_t i = 0; i < width; ++i) {
        values.push_back(component(t.code, bytes.data() + offset + row * stride + i * t.bytes));
      }
    }
    return values;
  }

  /// The numbers of an accessor. Quantised numbers stay unchanged (KHR_mesh_quantization);
  /// normalized numbers are divided by the largest value of their type.
  std::vector<double> valuesOf(std::size_t which, std::size_t width) {
    const Json& accessor = at(list(json_, "accessors"), which, "accessor");
    const auto kind = accessor.find("type");
    if (kind == accessor.end() || *kind != (width == 3 ? "VEC3" : "SCALAR")) {
      failGlb("has corners that are no points in space");
    }
    const ComponentType t = componentType(accessor);
    const std::size_t count = index(accessor, "count", 0);
    std::vector<double> values;
    if (accessor.contains("bufferView")) {
      values = readView(accessor, t, count, width);
    } else {
      if (count > kMostPlacedTriangles) failGlb(fmt::format("has {} corners", count));
      values.assign(count * width, 0.0);
    }
    if (accessor.contains("sparse")) replaceSome(accessor["sparse"], t, width, values);
    const auto normalized = accessor.find("normalized");
    if (normalized != accessor.end() && *normalized == true) {
      for (double& v : values) v = std::max(v / t.scale, -1.0);
    }
    return values;
  }

  void replaceSome(const Json& sparse, const ComponentType& t, std::size_t width,
                   std::vector<double>& values) {
    if (!sparse.is_object() || !sparse.contains("indices") || !sparse.contains("values") ||
        !sparse["indices"].is_object() || !sparse["values"].is_object()) {
      failGlb("has a sparse accessor without indices and values");
    }
    const std::size_t count = index(sparse, "count", 0);
    const std::vector<double> rows =
        readView(sparse["indices"], componentType(sparse["indices"]), count, 1);
    const std::vector<double> replacing = readView(sparse["values"], t, count, width);
    for (std::size_t i = 0; i < count; ++i) {
      if (!(rows[i] >= 0.0) ||
          rows[i] * static_cast<double>(width) >= static_cast<double>(values.size())) {
        failGlb("has a sparse accessor beyond its corners");
      }
      const std::size_t first = static_cast<std::size_t>(rows[i]) * width;
      std::copy_n(replacing.begin() + static_cast<std::ptrdiff_t>(i * width), width,
                  values.begin() + static_cast<std::ptrdiff_t>(first));
    }
  }

  Json json_;
  std::string_view binary_;
  std::map<std::size_t, MeshSurface> surfaces_;
  std::size_t placed_nodes_ = 0;
  MeshFile file_;
};

}  // namespace

MeshFile readGlb(std::string_view bytes) {
  return GlbReader(bytes).read();
}

}  // namespace wholehand
