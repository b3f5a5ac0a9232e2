#include "files/mesh/mesh_readers.hpp"
#include "loop/core/printable.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <tinyxml2.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

namespace wholehand {
namespace {

using Eigen::Matrix4d;
using Eigen::Vector3d;
using tinyxml2::XMLElement;

/// Calls `take` for each child element, or only for those with the name if one is given.
template <class Take>
void eachChild(const XMLElement& parent, const char* name, Take take) {
  for (const XMLElement* e = parent.FirstChildElement(name); e != nullptr;
       e = e->NextSiblingElement(name)) {
    take(*e);
  }
}

std::string attribute(const XMLElement& e, const char* name) {
  const char* found = e.Attribute(name);
  return found != nullptr ? found : "";
}

[[noreturn]] void failDae(const XMLElement& at, std::string problem) {
  throw UnreadableMesh{fmt::format("{}, in line {}", problem, at.GetLineNum()), "export it again"};
}

/// The text of an element. Comments divide it into pieces, which are joined.
std::string textOf(const XMLElement& e) {
  std::string text;
  for (const auto* node = e.FirstChild(); node != nullptr; node = node->NextSibling()) {
    if (node->ToText() != nullptr) text += node->Value();
  }
  return text;
}

std::vector<double> numbersOf(const XMLElement& e) {
  std::vector<double> numbers;
  const std::string text = textOf(e);
  MeshWords words(text);
  for (std::string_view word = words.next(); !word.empty(); word = words.next()) {
    const auto number = meshNumber(word);
    if (!number) {
      failDae(e, fmt::format("has \"{}\" where a number belongs", printable(word, 40)));
    }
    numbers.push_back(*number);
  }
  return numbers;
}

std::vector<double> numbersOf(const XMLElement& e, std::size_t count) {
  std::vector<double> numbers = numbersOf(e);
  if (numbers.size() != count) {
    failDae(e, fmt::format("has {} numbers in <{}>, not {}", numbers.size(), e.Name(), count));
  }
  return numbers;
}

Matrix4d matrixOf(const XMLElement& e) {
  const std::vector<double> n = numbersOf(e, 16);
  return Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(n.data());
}

/// The map of a <lookat>: located at `eye`, with -z pointing to `interest`.
Matrix4d lookAt(const XMLElement& e) {
  const std::vector<double> n = numbersOf(e, 9);
  const Vector3d eye(n[0], n[1], n[2]), interest(n[3], n[4], n[5]), up(n[6], n[7], n[8]);
  const Vector3d back = (eye - interest).normalized(), right = up.cross(back).normalized();
  Matrix4d map = Matrix4d::Identity();
  map.block<3, 1>(0, 0) = right;
  map.block<3, 1>(0, 1) = back.cross(right);
  map.block<3, 1>(0, 2) = back;
  map.block<3, 1>(0, 3) = eye;
  return map;
}

/// The map of one transformation element; identity for any other element.
Matrix4d mapOf(const XMLElement& e) {
  const std::string_view kind = e.Name();
  Eigen::Affine3d map = Eigen::Affine3d::Identity();
  if (kind == "matrix") return matrixOf(e);
  if (kind == "lookat") return lookAt(e);
  if (kind == "skew") failDae(e, "has a <skew>, which is not read");
  if (kind == "translate" || kind == "scale") {
    const std::vector<double> n = numbersOf(e, 3);
    const Vector3d v(n[0], n[1], n[2]);
    kind == "scale" ? map.scale(v) : map.translate(v);
  } else if (kind == "rotate") {
    const std::vector<double> n = numbersOf(e, 4);
    const Vector3d axis(n[0], n[1], n[2]);
    const double angle_rad = n[3] * std::numbers::pi / 180.0;
    if (axis.norm() > 0.0) map.rotate(Eigen::AngleAxisd(angle_rad, axis.normalized()));
  }
  return map.matrix();
}

class DaeReader {
 public:
  explicit DaeReader(std::string_view bytes) {
    const std::string_view text = withoutByteOrderMark(bytes);
    if (document_.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS) {
      throw UnreadableMesh{fmt::format("is not well-formed XML: {}, in line {}",
                                       document_.ErrorName(), document_.ErrorLineNum()),
                           "export it again"};
    }
  }

  MeshFile read() {
    const XMLElement* root = document_.FirstChildElement("COLLADA");
    if (root == nullptr) {
      throw UnreadableMesh{"is no DAE: its root element is not <COLLADA>", "export it again"};
    }
    readAsset(*root);
    collect(*root, 0);
    const XMLElement* scene = root->FirstChildElement("scene");
    const XMLElement* shown =
        scene != nullptr ? scene->FirstChildElement("instance_visual_scene") : nullptr;
    const XMLElement* first = root->FirstChildElement("library_visual_scenes");
    if (shown != nullptr) {
      placeNodes(target(*shown, "url"), unit_, 0);
    } else if (first != nullptr && first->FirstChildElement("visual_scene") != nullptr) {
      placeNodes(*first->FirstChildElement("visual_scene"), unit_, 0);
    } else {
      for (const auto& [id, elements] : by_id_) {
        for (const XMLElement* e : elements) {
          if (std::string_view(e->Name()) == "geometry") placeGeometry(*e, unit_);
        }
      }
    }
    return std::move(file_);
  }

 private:
  void readAsset(const XMLElement& root) {
    const XMLElement* asset = root.FirstChildElement("asset");
    const auto given = [&](const char* name) {
      return asset != nullptr ? asset->FirstChildElement(name) : nullptr;
    };
    if (const XMLElement* unit = given("unit");
        unit != nullptr && unit->Attribute("meter") != nullptr) {
      std::string text = attribute(*unit, "meter");
      std::replace(text.begin(), text.end(), ',', '.');  // some locales write a decimal comma
      const auto metres = meshNumber(text);
      if (!metres || !(*metres > 0.0) || !std::isfinite(*metres)) {
        failDae(*unit, "has a <unit> that is no length");
      }
      unit_.topLeftCorner<3, 3>() *= *metres;
    }
    const XMLElement* up = given("up_axis");
    const std::string text = up != nullptr ? textOf(*up) : "";
    std::string_view axis = MeshWords(text).next();
    if (axis.empty()) axis = "Y_UP";  // default of the specification
    if (axis != "Z_UP") {
      file_.notices.push_back(
          fmt::format("has <up_axis> {}, which is ignored: its axes are taken as they are",
                      printable(axis, 10)));
    }
  }

  /// Collects elements by their id, in libraries and nested nodes.
  void collect(const XMLElement& e, int depth) {
    if (depth > 2 * kMostNestedNodes) failDae(e, "has elements nested too deeply");
    if (e.Attribute("id") != nullptr) by_id_[e.Attribute("id")].push_back(&e);
    eachChild(e, nullptr, [&](const XMLElement& child) { collect(child, depth + 1); });
  }

  /// The element whose id an attribute of `e` names. Exporters repeat ids, one geometry after the
  /// other: of several elements with the id, the one within the innermost element around `e` that
  /// holds any counts.
  const XMLElement& target(const XMLElement& e, const char* name) {
    const std::string url = attribute(e, name);
    const auto found = url.starts_with('#') ? by_id_.find(url.substr(1)) : by_id_.end();
    if (found == by_id_.end()) {
      failDae(e, fmt::format("names \"{}\", which it does not hold", printable(url, 60)));
    }
    std::vector<const XMLElement*> near = found->second;
    for (const auto* around = e.Parent(); near.size() > 1 && around != nullptr;
         around = around->Parent()) {
      std::vector<const XMLElement*> within;
      std::copy_if(near.begin(), near.end(), std::back_inserter(within),
                   [&](const XMLElement* one) { return holds(*around, *one); });
      if (within.empty()) continue;
      near = std::move(within);
      break;
    }
    if (near.size() == 1) return *near.front();
    failDae(e, fmt::format("names \"{}\", the id of several elements (lines {} and {})",
                           printable(url, 60), near[0]->GetLineNum(), near[1]->GetLineNum()));
  }

  static bool holds(const tinyxml2::XMLNode& around, const XMLElement& e) {
    const tinyxml2::XMLNode* up = &e;
    while (up != nullptr && up != &around) up = up->Parent();
    return up != nullptr;
  }

  void placeNodes(const XMLElement& parent, const Matrix4d& map, int depth) {
    eachChild(parent, "node", [&](const XMLElement& node) { placeNode(node, map, depth); });
  }

  void placeNode(const XMLElement& node, const Matrix4d& parent, int depth) {
    if (depth > kMostNestedNodes || ++placed_nodes_ > kMostPlacedTriangles / 40) {
      failDae(node, "has nodes that hold one another too often");
    }
    Matrix4d map = parent;
    eachChild(node, nullptr, [&](const XMLElement& e) { map = map * mapOf(e); });
    eachChild(node, "instance_geometry",
              [&](const XMLElement& e) { placeGeometry(target(e, "url"), map); });
    eachChild(node, "instance_controller",
              [&](const XMLElement& e) { placeSkin(target(e, "url"), map); });
    eachChild(node, "instance_node",
              [&](const XMLElement& e) { placeNode(target(e, "url"), map, depth + 1); });
    placeNodes(node, map, depth + 1);
  }

  void placeSkin(const XMLElement& controller, const Matrix4d& map) {
    const XMLElement* skin = controller.FirstChildElement("skin");
    if (skin == nullptr) failDae(controller, "has a <controller> without a <skin>");
    const XMLElement* bind = skin->FirstChildElement("bind_shape_matrix");
    placeGeometry(target(*skin, "source"), bind != nullptr ? map * matrixOf(*bind) : map);
    file_.notices.emplace_back("has a skin, whose joints are ignored: it is as it was bound");
  }

  void placeGeometry(const XMLElement& geometry, const Matrix4d& map) {
    const auto [at, is_new] = surfaces_.try_emplace(&geometry);
    if (is_new) at->second = surfaceOf(geometry);
    place(at->second, map, file_);
  }

  MeshSurface surfaceOf(const XMLElement& geometry) {
    MeshSurface surface;
    const XMLElement* mesh = geometry.FirstChildElement("mesh");
    if (mesh == nullptr) return surface;        // it is a <spline> or a <convex_mesh>
    std::map<const XMLElement*, int> first_of;  // sources whose points are in the surface
    eachChild(*mesh, nullptr, [&](const XMLElement& e) {
      const std::string_view kind = e.Name();
      if (kind == "triangles" || kind == "polylist" || kind == "polygons" || kind == "tristrips" ||
          kind == "trifans") {
        readFaces(e, first_of, surface);
      }
    });
    return surface;
  }

  /// The points of a source. From each stride the accessor selects the numbers named X, Y and Z,
  /// else the first three named ones.
  std::vector<Vector3d> pointsOf(const XMLElement& source) {
    const XMLElement* common = source.FirstChildElement("technique_common");
    const XMLElement* accessor =
        common != nullptr ? common->FirstChildElement("accessor") : nullptr;
    if (accessor == nullptr) failDae(source, "has a <source> without an <accessor>");
    const std::vector<double> values = numbersOf(target(*accessor, "source"));
    const int stride = accessor->IntAttribute("stride", 1),
              offset = accessor->IntAttribute("offset");
    std::vector<int> places;
    std::array<int, 3> named = {-1, -1, -1};
    int place = 0;
    eachChild(*accessor, "param", [&](const XMLElement& param) {
      const std::string name = attribute(param, "name");
      if (!name.empty()) places.push_back(place);
      if (name == "X" || name == "Y" || name == "Z") named[name[0] - 'X'] = place;
      ++place;
    });
    if (std::none_of(named.begin(), named.end(), [](int at) { return at < 0; })) {
      places.assign(named.begin(), named.end());
    }
    if (place == 0 || (places.empty() && place == 3)) places = {0, 1, 2};
    if (stride < 3 || stride > 1000 || offset < 0 || places.size() < 3 ||
        *std::max_element(places.begin(), places.begin() + 3) >= stride) {
      failDae(*accessor, "has an <accessor> that gives no three coordinates");
    }
    std::vector<Vector3d> points;
    const auto step = static_cast<std::size_t>(stride);
    for (auto at = static_cast<std::size_t>(offset); at + step <= values.size(); at += step) {
      points.emplace_back(values[at + places[0]], values[at + places[1]], values[at + places[2]]);
    }
    return points;
  }

  /// The source that holds the points of a <vertices>.
  const XMLElement& positionOf(const XMLElement& vertices) {
    const XMLElement* found = nullptr;
    eachChild(vertices, "input", [&](const XMLElement& input) {
      if (attribute(input, "semantic") == "POSITION") found = &target(input, "source");
    });
    if (found == nullptr) failDae(vertices, "has <vertices> without a POSITION");
    return *found;
  }

  void readFaces(const XMLElement& e, std::map<const XMLElement*, int>& first_of,
                 MeshSurface& surface) {
    int width = 1, offset = -1;
    const XMLElement* source = nullptr;
    eachChild(e, "input", [&](const XMLElement& input) {
      const int at = input.IntAttribute("offset");
      if (at < 0 || at > 1000) failDae(input, "has an offset that is none");
      width = std::max(width, at + 1);
      if (attribute(input, "semantic") != "VERTEX") return;
      offset = at;
      source = &positionOf(target(input, "source"));
    });
    if (source == nullptr) failDae(e, fmt::format("has <{}> without a VERTEX", e.Name()));
    if (!first_of.contains(source)) {
      first_of[source] = static_cast<int>(surface.points.size());
      const std::vector<Vector3d> points = pointsOf(*source);
      surface.points.insert(surface.points.end(), points.begin(), points.end());
      count_of_[source] = static_cast<int>(points.size());
    }
    const auto corners = [&](const XMLElement& p) {
      return cornersOf(p, width, offset, first_of[source], count_of_[source]);
    };
    const std::string_view kind = e.Name();
    if (kind == "polylist") return readPolylist(e, corners, surface);
    eachChild(e, "p", [&](const XMLElement& p) {
      const std::vector<int> found = corners(p);
      if (kind == "tristrips") {
        addStrip(surface, found);
      } else if (kind == "trifans") {
        addFan(surface, found);
      } else if (kind == "polygons") {
        addPolygon(surface, found);
      } else {
        for (std::size_t i = 2; i < found.size(); i += 3) {
          surface.triangles.emplace_back(found[i - 2], found[i - 1], found[i]);
        }
      }
    });
    if (e.FirstChildElement("ph") != nullptr) failDae(e, "has a face with a hole (<ph>)");
  }

  template <class Corners>
  void readPolylist(const XMLElement& e, const Corners& corners, MeshSurface& surface) {
    const XMLElement *counts = e.FirstChildElement("vcount"), *p = e.FirstChildElement("p");
    if (counts == nullptr || p == nullptr) return;  // without faces
    const std::vector<int> all = corners(*p);
    std::size_t next = 0;
    for (const double count : numbersOf(*counts)) {
      if (!(count >= 0.0) || count > static_cast<double>(all.size() - next)) {
        failDae(*counts, "has a <vcount> beyond its <p>");
      }
      const auto begin = all.begin() + static_cast<std::ptrdiff_t>(next);
      next += static_cast<std::size_t>(count);
      addPolygon(surface, {begin, all.begin() + static_cast<std::ptrdiff_t>(next)});
    }
  }

  static std::vector<int> cornersOf(const XMLElement& p, int width, int offset, int first,
                                    int count) {
    std::vector<int> corners;
    const std::vector<double> numbers = numbersOf(p);
    for (std::size_t i = static_cast<std::size_t>(offset); i < numbers.size();
         i += static_cast<std::size_t>(width)) {
      if (!isCorner(numbers[i], static_cast<std::size_t>(count))) {
        failDae(p, fmt::format("has a face with the corner {:g}; there are {}", numbers[i], count));
      }
      corners.push_back(first + static_cast<int>(numbers[i]));
    }
    return corners;
  }

  tinyxml2::XMLDocument document_;
  Matrix4d unit_ = Matrix4d::Identity();
  std::map<std::string, std::vector<const XMLElement*>> by_id_;
  std::map<const XMLElement*, MeshSurface> surfaces_;
  std::map<const XMLElement*, int> count_of_;  ///< number of points of each source
  std::size_t placed_nodes_ = 0;
  MeshFile file_;
};

}  // namespace

MeshFile readDae(std::string_view bytes) {
  return DaeReader(bytes).read();
}

}  // namespace wholehand
