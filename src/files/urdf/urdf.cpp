#include "files/urdf/urdf.hpp"

#include "files/foreign/foreign_file.hpp"
#include "files/mesh/convex_mesh.hpp"
#include "files/mesh/mesh_checks.hpp"
#include "files/mesh/mesh_file.hpp"
#include "files/mesh/mesh_readers.hpp"
#include "files/toml/toml_file.hpp"
#include "files/urdf/joint_range.hpp"
#include "files/urdf/urdf_chains.hpp"
#include "files/urdf/urdf_text.hpp"
#include "files/urdf/urdf_visuals.hpp"
#include "loop/core/expected.hpp"
#include "loop/core/geometry.hpp"
#include "loop/model/scene_model.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tinyxml2.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace wholehand {
namespace {

namespace fs = std::filesystem;
using tinyxml2::XMLElement;

/// Strict reader of a URDF's elements. Every fault is stored with its line and a key such as
/// "link[cup].collision[1].geometry", and reading continues with a harmless value.
class UrdfFaults {
 public:
  explicit UrdfFaults(std::string file) : file_(std::move(file)) {}

  void add(const XMLElement* at, std::string key, std::string value, std::string problem,
           std::string remedy);
  /// Adds a fault of the whole file or of a line outside any element. Line 0: unknown.
  void addAtLine(int line, std::string problem, std::string remedy);
  /// Adds a notice for the user, which is not a fault.
  void note(const XMLElement* at, std::string key, std::string value, Diagnostic notice);
  [[nodiscard]] const Diagnostics& all() const { return all_; }
  [[nodiscard]] const Diagnostics& notices() const { return notices_; }
  [[nodiscard]] const std::string& file() const { return file_; }

  /// The child with this name, or nullptr; more than one is a fault.
  const XMLElement* only(const XMLElement& parent, const char* name, const std::string& key);
  /// Text of an attribute. A missing or empty attribute is a fault and gives an empty text.
  std::string text(const XMLElement& e, const char* attribute, const std::string& key);
  /// Exactly `count` finite numbers separated by blanks. Anything else is a fault and gives zeros.
  std::vector<double> numbers(const XMLElement& e, const char* attribute, const std::string& key,
                              std::size_t count);
  /// A mass > 0 [kg]. Any other value is a fault and gives 1.
  double mass_kg(const XMLElement& e, const std::string& key);
  /// A dimension in [0.001, 10] m.
  double length_m(const XMLElement& e, const char* attribute, const std::string& key);
  /// Pose of an element's `<origin xyz rpy>` or `<origin xyz quat_xyzw>`; identity without one.
  Pose origin(const XMLElement& parent, const std::string& key);
  /// Pose as origin() reads it, limited to 10 m: for elements that are placed in the scene.
  Pose place(const XMLElement& parent, const std::string& key);
  /// Reports names that resemble names of URDF: their content would otherwise be ignored.
  void checkNames(const XMLElement& e, const std::string& key);

 private:
  std::string file_;
  Diagnostics all_;
  Diagnostics notices_;
};

/// The meshes of a URDF.
struct UrdfMeshes {
  std::vector<std::string> files;  ///< paths
  MeshLoadTime* time;              ///< time limit for all meshes together
  struct Flat {
    const XMLElement* at;
    std::string key, name;
    Diagnostic fault;
  };
  std::vector<Flat> flat;  ///< colliders without volume: left out if the body has others
};

constexpr double kMostFriction = 2.0;
constexpr double kMostPlace_m = 10.0;  ///< the limit for a body of a scene
constexpr double kMostTurn_rad = 4.0 * std::numbers::pi;
constexpr const char* kBeyondTurns = "is beyond two turns (4π rad)";
constexpr const char* kInRad = "must be in rad: multiply degrees by π / 180";

constexpr const char *kMacro = "is a macro of xacro", *kExpand = "run xacro first";

bool isMacro(std::string_view text) {
  return text.find("$(") != text.npos || text.find("${") != text.npos;
}

void UrdfFaults::add(const XMLElement* at, std::string key, std::string value, std::string problem,
                     std::string remedy) {
  all_.push_back({file_, at != nullptr ? at->GetLineNum() : 0, std::move(key), std::move(value),
                  std::move(problem), std::move(remedy)});
}

void UrdfFaults::note(const XMLElement* at, std::string key, std::string value, Diagnostic notice) {
  notice.file = file_;
  notice.line = at->GetLineNum();
  notice.key = std::move(key);
  notice.value = std::move(value);
  notices_.push_back(std::move(notice));
}

void UrdfFaults::addAtLine(int line, std::string problem, std::string remedy) {
  add(nullptr, "", "", std::move(problem), std::move(remedy));
  all_.back().line = line;
}

const XMLElement* UrdfFaults::only(const XMLElement& parent, const char* name,
                                   const std::string& key) {
  const XMLElement* const first = parent.FirstChildElement(name);
  const XMLElement* const second = first != nullptr ? first->NextSiblingElement(name) : nullptr;
  if (second != nullptr) {
    add(second, key + "." + name, "",
        fmt::format("stands there twice, first in line {}", first->GetLineNum()),
        "keep one of the two");
  }
  return first;
}

std::string UrdfFaults::text(const XMLElement& e, const char* attribute, const std::string& key) {
  const char* found = e.Attribute(attribute);
  if (found != nullptr && isMacro(found)) {
    add(&e, key + "." + attribute, found, kMacro, kExpand);
    return {};
  }
  if (found != nullptr && *found != '\0') return found;
  add(&e, key + "." + attribute, "", "is missing",
      fmt::format("give <{} {}=\"...\">", e.Name(), attribute));
  return {};
}

std::vector<double> UrdfFaults::numbers(const XMLElement& e, const char* attribute,
                                        const std::string& key, std::size_t count) {
  std::vector<double> zeros(count, 0.0);
  const char* found = e.Attribute(attribute);
  const std::string remedy =
      count == 1 ? "must be a finite number"
                 : fmt::format("must be {} finite numbers, with blanks between", count);
  if (found == nullptr) {
    add(&e, key + "." + attribute, "", "is missing", remedy);
    return zeros;
  }
  if (auto parsed = parseNumbers(found); parsed && parsed->size() == count) return *parsed;
  const bool macro = isMacro(found);
  add(&e, key + "." + attribute, found, macro ? kMacro : "cannot be read",
      macro ? kExpand : remedy);
  return zeros;
}

double UrdfFaults::mass_kg(const XMLElement& e, const std::string& key) {
  const std::size_t before = all_.size();
  const double value = numbers(e, "value", key, 1).front();
  if (all_.size() > before) return 1.0;
  if (value > 0.0) return value;
  add(&e, key + ".value", e.Attribute("value"), "is negative", "must be >= 0");
  return 1.0;
}

double UrdfFaults::length_m(const XMLElement& e, const char* attribute, const std::string& key) {
  const std::size_t before = all_.size();
  const double value = numbers(e, attribute, key, 1).front();
  if (all_.size() > before) return 1.0;
  if (value >= 1e-3 && value <= 10.0) return value;
  add(&e, key + "." + attribute, e.Attribute(attribute), "is out of range",
      "must be in [0.001, 10] m");
  return 1.0;
}

Pose UrdfFaults::origin(const XMLElement& parent, const std::string& key) {
  Pose pose;
  const XMLElement* e = only(parent, "origin", key);
  if (e == nullptr) return pose;
  if (e->Attribute("xyz") != nullptr) {
    const std::vector<double> xyz = numbers(*e, "xyz", key + ".origin", 3);
    pose.translation_m = {xyz[0], xyz[1], xyz[2]};
  }
  if (e->Attribute("quat_xyzw") != nullptr) {
    const std::vector<double> q = numbers(*e, "quat_xyzw", key + ".origin", 4);
    const Eigen::Quaterniond turn(q[3], q[0], q[1], q[2]);
    if (turn.norm() > 0.0) {
      pose.rotation = turn.normalized().toRotationMatrix();
    } else if (all_.empty() || all_.back().key != key + ".origin.quat_xyzw") {
      add(e, key + ".origin.quat_xyzw", e->Attribute("quat_xyzw"), "is no rotation",
          "must have a length > 0; 0 0 0 1 turns nothing");
    }
  } else if (e->Attribute("rpy") != nullptr) {
    const std::vector<double> rpy = numbers(*e, "rpy", key + ".origin", 3);
    if (Eigen::Vector3d(rpy.data()).cwiseAbs().maxCoeff() > kMostTurn_rad) {
      add(e, key + ".origin.rpy", e->Attribute("rpy"), kBeyondTurns, kInRad);
    }
    pose.rotation = rotationFromRpy(rpy[0], rpy[1], rpy[2]);
  }
  return pose;
}

Pose UrdfFaults::place(const XMLElement& parent, const std::string& key) {
  Pose pose = origin(parent, key);
  if (pose.translation_m.cwiseAbs().maxCoeff() > kMostPlace_m) {
    add(parent.FirstChildElement("origin"), key + ".origin.xyz",
        parent.FirstChildElement("origin")->Attribute("xyz"), "is out of range",
        "must be in [-10, 10] m: divide millimetres by 1000");
  }
  return pose;
}

/// Names of children and attributes that this reader knows in an element of URDF.
struct UrdfNames {
  std::string_view element;
  std::vector<std::string> children, attributes;
  bool no_others = false;  ///< no dialect of URDF has other attributes here
};

const std::vector<UrdfNames>& urdfNames() {
  static const std::vector<UrdfNames> kNames = {
      {"robot", {"link", "joint", "gazebo", "material", "transmission"}, {}},
      {"link", {"collision", "inertial", "visual", "contact"}, {}},
      {"collision", {"geometry", "origin"}, {}},
      {"inertial", {"mass", "inertia", "origin", "density"}, {}},
      {"joint", {"parent", "child", "origin", "axis", "limit", "dynamics", "mimic"}, {}},
      {"geometry", {}, {}},
      {"mesh", {}, {"filename", "scale"}},
      {"origin", {}, {"xyz", "rpy", "quat_xyzw"}, true},
      {"inertia", {}, {"ixx", "iyy", "izz", "ixy", "ixz", "iyz", "iyx", "izx", "izy"}, true},
      {"limit", {}, {"lower", "upper"}},
      {"dynamics", {}, {"damping", "friction"}},
      {"mimic", {}, {"joint", "multiplier", "offset"}}};
  return kNames;
}

/// The one of `names` that `name` misspells; empty: `name` is correct, resembles none, or belongs
/// to an extension.
std::string misspelt(std::string_view name, const std::vector<std::string>& names) {
  if (std::find(names.begin(), names.end(), name) != names.end()) return {};
  const std::string near = name == "pose" ? nearestWord("origin", names) : nearestWord(name, names);
  const bool begins = name.size() > near.size() + 1;  // an extension such as "collision_checking"
  return near.empty() || begins || name.find(':') != name.npos ? "" : near;
}

void UrdfFaults::checkNames(const XMLElement& e, const std::string& key) {
  const auto names = std::find_if(urdfNames().begin(), urdfNames().end(),
                                  [&](const UrdfNames& n) { return n.element == e.Name(); });
  if (names == urdfNames().end()) return;
  const std::vector<std::string>& known = names->attributes;
  for (const auto* a = e.FirstAttribute(); a != nullptr; a = a->Next()) {
    const bool other =
        names->no_others && std::find(known.begin(), known.end(), a->Name()) == known.end();
    if (!other && misspelt(a->Name(), known).empty()) continue;
    add(&e, (key.empty() ? "" : key + ".") + a->Name(), a->Value(), "is unknown",
        fmt::format("must be one of {}", fmt::join(known, ", ")));
  }
  for (const XMLElement* c = e.FirstChildElement(); c != nullptr; c = c->NextSiblingElement()) {
    const char* const name = c->Attribute("name");
    const std::string own = name != nullptr ? fmt::format("{}[{}]", c->Name(), name) : c->Name();
    const std::string child = key.empty() ? own : key + "." + own;
    if (const std::string near = misspelt(c->Name(), names->children); !near.empty()) {
      add(c, child, "", "is unknown", fmt::format("did you mean <{}>?", near));
    }
    checkNames(*c, child);
  }
}

/// A collider smaller than 1 mm in each direction: other engines use it as a point of contact or as
/// a placeholder. It is kept in `meshes.flat`.
bool isToken(const XMLElement& e, const char* attribute, const std::string& key,
             const std::vector<double>& sizes, UrdfMeshes& meshes) {
  if (std::any_of(sizes.begin(), sizes.end(), [](double s) { return s < 0.0 || s >= 1e-3; })) {
    return false;
  }
  meshes.flat.push_back({&e, key + "." + attribute, e.Attribute(attribute),
                         fileFault("", "is smaller than 1 mm", "must be in [0.001, 10] m")});
  return true;
}

std::vector<Shape> readBox(const XMLElement& e, const std::string& key, UrdfFaults& faults,
                           UrdfMeshes& meshes) {
  const std::size_t before = faults.all().size();
  const std::vector<double> size = faults.numbers(e, "size", key, 3);
  if (faults.all().size() > before || isToken(e, "size", key, size, meshes)) return {};
  const auto [least, most] = std::minmax_element(size.begin(), size.end());
  if (*least < 1e-3 || *most > 10.0) {
    faults.add(&e, key + ".size", e.Attribute("size"), "is out of range",
               "must be three lengths in [0.001, 10] m");
    return {};
  }
  Shape shape;
  shape.half_extents_m = Eigen::Vector3d(size[0], size[1], size[2]) / 2.0;
  return {shape};
}

std::vector<Shape> readMesh(const XMLElement& e, const std::string& key, UrdfFaults& faults,
                            UrdfMeshes& meshes) {
  const std::string name = faults.text(e, "filename", key);
  Eigen::Vector3d scale = Eigen::Vector3d::Ones();
  const std::size_t before = faults.all().size();
  if (const char* const text = e.Attribute("scale"); text != nullptr) {
    const auto one = parseNumbers(text);
    const bool even = one && one->size() == 1;
    const std::vector<double> s = faults.numbers(e, "scale", key, even ? 1 : 3);
    scale = {s.front(), s[even ? 0 : 1], s.back()};
  }
  if (name.empty() || faults.all().size() > before) return {};
  meshes.files.push_back(meshPath(name, faults.file()).string());
  if (meshes.time->isOver()) return {};  // the previous mesh reported it
  Expected<MeshCollider> mesh = loadMeshCollider(meshes.files.back(), scale, *meshes.time);
  if (mesh) {
    for (Diagnostic& notice : mesh->notices) faults.note(&e, key + ".filename", name, notice);
    return std::move(mesh->shapes);
  }
  const Diagnostic& d = mesh.errors().front();
  if (isFlatFault(d)) {
    meshes.flat.push_back({&e, key + ".filename", name, d});
  } else {
    faults.add(&e, key + ".filename", name, d.problem, d.remedy);
  }
  return {};
}

std::vector<Shape> readRound(const XMLElement& e, ShapeType type, const std::string& key,
                             UrdfFaults& faults, UrdfMeshes& meshes) {
  const std::size_t before = faults.all().size();
  Shape shape;
  shape.type = type;
  const bool long_one = shape.kind().length_key != nullptr;
  std::vector<double> sizes = faults.numbers(e, "radius", key, 1);
  if (long_one) sizes.push_back(faults.numbers(e, "length", key, 1).front());
  if (faults.all().size() > before || isToken(e, "radius", key, sizes, meshes)) return {};
  shape.radius_m = faults.length_m(e, "radius", key);
  if (long_one) shape.length_m = faults.length_m(e, "length", key);
  if (faults.all().size() > before) return {};
  return {shape};
}

std::vector<Shape> readGeometry(const XMLElement& e, const std::string& key, UrdfFaults& faults,
                                UrdfMeshes& meshes) {
  const std::string_view kind = e.Name();
  if (kind == "box") return readBox(e, key, faults, meshes);
  if (kind == "mesh") return readMesh(e, key, faults, meshes);
  if (const auto type = shapeNamed(kind)) return readRound(e, *type, key, faults, meshes);
  faults.add(&e, key, "", fmt::format("is an unknown shape <{}>", kind),
             "must be one of box, sphere, cylinder, capsule, mesh");
  return {};
}

/// Reads the shapes of one `<collision>` in its link's frame. A mesh of convex parts gives several
/// shapes; an invalid collider is a fault and gives none. `key` names the element in messages.
/// Appends the path of its mesh to `meshes`. Meshes are not read after their time limit.
std::vector<Shape> readUrdfCollision(const XMLElement& collision, const std::string& key,
                                     UrdfFaults& faults, UrdfMeshes& meshes) {
  const XMLElement* geometry = faults.only(collision, "geometry", key);
  const XMLElement* kind = geometry != nullptr ? geometry->FirstChildElement() : nullptr;
  if (kind == nullptr || kind->NextSiblingElement() != nullptr) {
    faults.add(&collision, key + ".geometry", "", "does not hold exactly one shape",
               "give one of box, sphere, cylinder, capsule, mesh");
    return {};
  }
  std::vector<Shape> shapes = readGeometry(*kind, key + "." + kind->Name(), faults, meshes);
  const Pose in_link = faults.place(collision, key);
  for (Shape& shape : shapes) shape.in_body = in_link;
  return shapes;
}

struct Link {
  const XMLElement* element = nullptr;
  std::string name;
  std::vector<Shape> shapes;             ///< in the link's frame
  std::vector<UrdfVisual> visuals;       ///< in the link's frame
  std::optional<UrdfInertial> inertial;  ///< in the link's frame
  int parent = -1;                       ///< index of the parent link; -1 for the root
  Pose in_parent;
  const XMLElement* inertial_element = nullptr;  ///< set for a link that has mass
  std::optional<SceneJoint>
      joint;  ///< movable joint to the parent, in the link's frame; empty: fixed
  const XMLElement* joint_element = nullptr;
  std::optional<double> friction;  ///< of the body that the movable joint carries
  // Of a movable joint: the link whose joint it follows (-1: none), and how.
  int follows = -1;
  double ratio = 1.0, offset = 0.0;
};

/// Description of an XML error.
const char* xmlProblem(tinyxml2::XMLError code) {
  switch (code) {
    case tinyxml2::XML_ERROR_PARSING:
    case tinyxml2::XML_ERROR_PARSING_ELEMENT:
    case tinyxml2::XML_ERROR_MISMATCHED_ELEMENT:
      return "an element is not closed, or closed under another name";
    case tinyxml2::XML_ERROR_PARSING_ATTRIBUTE:
      return "an attribute is not written as name=\"value\"";
    case tinyxml2::XML_ERROR_PARSING_COMMENT:
      return "a comment is not closed";
    case tinyxml2::XML_ELEMENT_DEPTH_EXCEEDED:
      return "its elements are nested too deeply";
    default:
      return "its text does not follow the syntax of XML";
  }
}

class Reader {
 public:
  Reader(const std::string& path, MeshLoadTime& time, UrdfUse use) : faults_(path), use_(use) {
    meshes_.time = &time;
  }

  Expected<UrdfBody> read() {
    if (!open()) return faults_.all();
    faults_.checkNames(*robot_, "");
    for (const XMLElement* e = robot_->FirstChildElement("link"); e != nullptr;
         e = e->NextSiblingElement("link")) {
      readLink(*e);
    }
    if (links_.empty()) {
      faults_.add(robot_, "robot", "", "has no link",
                  "give at least one <link> with a <collision>");
    }
    for (const XMLElement* e = robot_->FirstChildElement("joint"); e != nullptr;
         e = e->NextSiblingElement("joint")) {
      readJoint(*e);
    }
    for (const XMLElement* e = robot_->FirstChildElement("gazebo"); e != nullptr;
         e = e->NextSiblingElement("gazebo")) {
      const char* link = e->Attribute("reference");
      noteGazebo(*e);
      if (link == nullptr || linkIndex(link) < 0) continue;
      const std::string key = fmt::format("gazebo[{}]", link);
      for (const char* name : {"mu1", "mu2"}) {
        readFriction(e->FirstChildElement(name), key, linkIndex(link));
      }
    }
    noteFriction(*robot_);
    checkColliders();
    if (faults_.all().empty()) checkTree();
    if (faults_.all().empty()) linkMovables();
    if (faults_.all().empty()) readInertials();
    if (faults_.all().empty()) shareFrictions();
    if (!faults_.all().empty()) return firstFaults(faults_.all(), faults_.file());
    noteWorld();
    return merged();
  }

 private:
  bool open() {
    std::error_code error;
    if (!fs::is_regular_file(faults_.file(), error)) {
      faults_.add(nullptr, "", "", "there is no such URDF file",
                  "check the name; it is relative to the scene file");
      return false;
    }
    if (const std::string problem = beyondUrdfBounds(faults_.file()); !problem.empty()) {
      faults_.addAtLine(0, problem, "give the URDF of one object");
      return false;
    }
    if (document_.LoadFile(faults_.file().c_str()) != tinyxml2::XML_SUCCESS) {
      addXmlFault();
      return false;
    }
    robot_ = document_.FirstChildElement("robot");
    const XMLElement* const macro = robot_ != nullptr ? firstMacro(*robot_) : nullptr;
    if (robot_ != nullptr && macro == nullptr) {
      if (const XMLElement* second = robot_->NextSiblingElement("robot")) {
        faults_.add(second, "robot", "",
                    fmt::format("stands there twice, first in line {}", robot_->GetLineNum()),
                    "give each its own file");
      }
      return true;
    }
    if (addForeignFault(document_.RootElement())) return false;
    if (macro != nullptr) {
      faults_.add(macro, macro->Name(), "", kMacro, kExpand);
    } else {
      faults_.add(document_.RootElement(), "", "", "is no URDF: its root element is not <robot>",
                  "give a URDF (of a .xacro file: run xacro first)");
    }
    return false;
  }

  /// The first xacro macro that was not expanded.
  static const XMLElement* firstMacro(const XMLElement& e) {
    if (std::string_view(e.Name()).starts_with("xacro:")) return &e;
    for (const XMLElement* c = e.FirstChildElement(); c != nullptr; c = c->NextSiblingElement()) {
      if (const XMLElement* const found = firstMacro(*c)) return found;
    }
    return nullptr;
  }

  /// Adds a fault that names the file's format. @return true when the format is known and is not
  /// URDF
  bool addForeignFault(const XMLElement* at) {
    const auto foreign = foreignFileAt(faults_.file());
    if (!foreign || foreign->problem == "is a URDF") return false;
    faults_.add(at, "", "", foreign->problem, foreign->remedy);
    return true;
  }

  /// Reports an XML error in words, with the parser's name for it in brackets.
  void addXmlFault() {
    using tinyxml2::XMLError;
    const XMLError code = document_.ErrorID();
    const bool no_xml =
        code == XMLError::XML_ERROR_EMPTY_DOCUMENT || code == XMLError::XML_ERROR_PARSING_TEXT;
    if (addForeignFault(nullptr)) return;
    std::error_code error;
    if (fs::file_size(faults_.file(), error) == 0) {
      faults_.addAtLine(0, "is empty", "give a URDF with at least one <link>");
    } else if (no_xml) {
      faults_.addAtLine(0, "is no URDF: it holds no XML",
                        "give a URDF: XML that starts <robot ...>");
    } else if (code == XMLError::XML_ERROR_FILE_NOT_FOUND ||  // the file exists, so this is a read
                                                              // error
               code == XMLError::XML_ERROR_FILE_COULD_NOT_BE_OPENED ||
               code == XMLError::XML_ERROR_FILE_READ_ERROR) {
      faults_.addAtLine(0, "cannot be read", "check that the file may be read");
    } else {
      faults_.addAtLine(
          document_.ErrorLineNum(),
          fmt::format("is not well-formed XML: {} ({})", xmlProblem(code), document_.ErrorName()),
          "correct it at or above this line");
    }
  }

  [[nodiscard]] int linkIndex(const std::string& name) const {
    const auto at = std::find_if(links_.begin(), links_.end(),
                                 [&](const Link& link) { return link.name == name; });
    return at == links_.end() ? -1 : static_cast<int>(at - links_.begin());
  }

  /// Reports a body without any collider. Single links may have none (a frame, ballast), and single
  /// meshes may have no volume.
  void checkColliders() {
    const bool any = std::any_of(links_.begin(), links_.end(),
                                 [](const Link& link) { return !link.shapes.empty(); });
    for (UrdfMeshes::Flat& flat : meshes_.flat) {
      if (any) {
        flat.fault.problem += "; it is left out";
        faults_.note(flat.at, flat.key, flat.name, flat.fault);
      } else {
        faults_.add(flat.at, flat.key, flat.name, flat.fault.problem, flat.fault.remedy);
      }
    }
    if (any || !faults_.all().empty()) return;
    const Link& link = links_.front();
    faults_.add(link.element, fmt::format("link[{}]", link.name), "",
                "has no collider, nor has any other link",
                "give a link a <collision> with a <geometry>");
  }

  void readLink(const XMLElement& e) {
    Link link;
    link.element = &e;
    link.name = faults_.text(e, "name", "link");
    const std::string key = fmt::format("link[{}]", link.name);
    if (!link.name.empty() && linkIndex(link.name) >= 0) {
      faults_.add(&e, key, "", "is the name of two links", "give every link a name of its own");
    }
    int number = 0;
    for (const XMLElement* c = e.FirstChildElement("collision"); c != nullptr;
         c = c->NextSiblingElement("collision")) {
      const std::string collision = fmt::format("{}.collision[{}]", key, number++);
      for (Shape& shape : readUrdfCollision(*c, collision, faults_, meshes_)) {
        link.shapes.push_back(std::move(shape));
      }
    }
    for (const XMLElement* contact = e.FirstChildElement("contact"); contact != nullptr;
         contact = contact->NextSiblingElement("contact")) {
      for (const XMLElement* c = contact->FirstChildElement(); c != nullptr;
           c = c->NextSiblingElement()) {
        readContact(*c, key + ".contact");
      }
    }
    link.visuals = readVisuals(e, faults_.file());
    const XMLElement* i = e.FirstChildElement("inertial");
    const bool frame = number == 0 && i != nullptr && isMassless(*i) &&
                       i->NextSiblingElement("inertial") == nullptr;
    if (i != nullptr && !frame) link.inertial_element = i;
    links_.push_back(std::move(link));
  }

  /// Reads an element of Bullet's `<contact>`. Friction is applied; other elements are not.
  void readContact(const XMLElement& e, const std::string& key) {
    if (std::string_view(e.Name()) == "lateral_friction") {
      return readFriction(&e, key, static_cast<int>(links_.size()));  // the link follows them
    }
    frictions_.push_back(&e);
    const char* const value = e.Attribute("value");
    if (value == nullptr || parseNumbers(value) == std::vector<double>{0.0}) return;
    faults_.note(&e, key + "." + e.Name(), value,
                 fileFault("", "is not applied", "the body keeps its own; friction is applied"));
  }

  /// Reads a link's friction of Bullet (`<contact><lateral_friction value>`) or Gazebo (`<mu1>`,
  /// `<mu2>`).
  void readFriction(const XMLElement* e, const std::string& key, int link) {
    if (e == nullptr || use_.friction) return;
    frictions_.push_back(e);
    const char* const text =
        e->Attribute("value") != nullptr ? e->Attribute("value") : e->GetText();
    const auto value = parseNumbers(text != nullptr ? text : "");
    if (!value || value->size() != 1 || value->front() < 0.0) {
      faults_.add(e, key + "." + e->Name(), text != nullptr ? text : "", "is no friction",
                  "must be a number >= 0");
      return;
    }
    if (value->front() > kMostFriction) {
      faults_.note(e, key + "." + e->Name(), text,
                   fileFault("", fmt::format("is too large: {:g} is applied", kMostFriction),
                             "must be in [0, 2]"));
    }
    link_frictions_.push_back({e, key, text, link, std::min(value->front(), kMostFriction)});
  }

  /// Gives each rigid body the friction that the first of its links states. Others that differ are
  /// noted.
  void shareFrictions() {
    for (const LinkFriction& of : link_frictions_) {
      const int carrier = carrierOf(of.link);
      std::optional<double>& friction = carrier >= 0 ? links_[carrier].friction : friction_;
      if (!friction) friction = of.value;
      if (*friction == of.value) continue;
      faults_.note(
          of.at, of.key + "." + of.at->Name(), of.text,
          fileFault("",
                    fmt::format("is not applied: the body has one friction, {:g} as named before",
                                *friction),
                    "give the body of the scene a friction of its own"));
    }
  }

  /// Notes settings of Gazebo that decide how a body moves and are not applied.
  void noteGazebo(const XMLElement& gazebo) {
    constexpr std::array<std::pair<const char*, bool>, 3> kMoves{
        {{"static", true}, {"turnGravityOff", true}, {"gravity", false}}};
    for (const auto& [name, matters] : kMoves) {
      const XMLElement* e = gazebo.FirstChildElement(name);
      bool on = !matters;
      if (use_.fixed || e == nullptr || e->QueryBoolText(&on) != tinyxml2::XML_SUCCESS ||
          on != matters) {
        continue;
      }
      faults_.note(e, std::string("gazebo.") + name, e->GetText(),
                   fileFault("", "is not applied: the body falls and moves",
                             "set fixed = true in the scene if it shall stand"));
    }
  }

  /// Notes that a root link "world" does not hold the body. By convention that link is the world,
  /// and its fixed joints hold the robot.
  void noteWorld() {
    const auto root = std::find_if(links_.begin(), links_.end(),
                                   [](const Link& link) { return link.parent < 0; });
    const bool moves = std::any_of(links_.begin(), links_.end(),
                                   [](const Link& link) { return link.joint.has_value(); });
    if (use_.fixed || moves || root->name != "world" || !root->shapes.empty()) return;
    faults_.note(root->element, "link[world]", "",
                 fileFault("", "does not hold the body, which moves",
                           "set fixed = true in the scene if it shall stand"));
  }

  /// Notes friction in an element or its descendants at a place from which it is not read.
  void noteFriction(const XMLElement& e) {
    if (use_.friction) return;
    const char* const text = frictionIn(e);
    if (text != nullptr &&
        std::find(frictions_.begin(), frictions_.end(), &e) == frictions_.end()) {
      faults_.note(&e, e.Name(), text,
                   {"", 0, "", "", "is friction where none is read: it is not applied",
                    fmt::format("give the body of the scene friction = 0 to {:g}", kMostFriction)});
    }
    for (const XMLElement* c = e.FirstChildElement(); c != nullptr; c = c->NextSiblingElement()) {
      noteFriction(*c);
    }
  }

  /// Friction stated by an element of any dialect; nullptr: none. Friction of a joint (<dynamics>)
  /// is not contact friction and gives nullptr.
  static const char* frictionIn(const XMLElement& e) {
    const std::string_view name = e.Name();
    const std::string_view last = name.substr(name.rfind(':') + 1);
    if (last == "dynamics") return nullptr;
    for (const char* attribute : {"mu", "mu1", "friction", "static_friction"}) {
      if (const char* const value = e.Attribute(attribute)) return value;
    }
    constexpr std::array<std::string_view, 5> kNames{"mu", "mu1", "mu2", "mu_static", "mu_dynamic"};
    const bool named = std::find(kNames.begin(), kNames.end(), last) != kNames.end() ||
                       last.find("friction") != last.npos;
    if (!named || e.FirstChildElement() != nullptr) return nullptr;
    return e.Attribute("value") != nullptr ? e.Attribute("value") : e.GetText();
  }

  static bool isMassless(const XMLElement& inertial) {
    const XMLElement* mass = inertial.FirstChildElement("mass");
    const char* const value = mass != nullptr ? mass->Attribute("value") : nullptr;
    return value != nullptr && parseNumbers(value) == std::vector<double>{0.0};
  }

  /// Reads an inertial of Isaac Gym: its density applies to the link's colliders.
  std::optional<UrdfInertial> readDensity(const XMLElement& density, const std::string& key,
                                          const std::vector<Shape>& shapes) {
    const std::size_t before = faults_.all().size();
    const double value = faults_.numbers(density, "value", key + ".density", 1).front();
    if (faults_.all().size() > before) return std::nullopt;
    const double volume_m3 = moments(shapes).volume_m3;
    if (value > 0.0 && volume_m3 > 0.0) {
      return UrdfInertial{uniformDensity(shapes, value * volume_m3)};
    }
    faults_.add(&density, key + ".density.value", density.Attribute("value"), "gives no mass",
                "must be > 0 kg/m3, of a link with a <collision>; or give <mass> and <inertia>");
    return std::nullopt;
  }

  std::optional<UrdfInertial> readInertial(const XMLElement& e, const Link& link) {
    const std::string key = fmt::format("link[{}].inertial", link.name);
    const std::size_t before = faults_.all().size();
    (void)faults_.only(*link.element, "inertial", fmt::format("link[{}]", link.name));
    const XMLElement* mass = faults_.only(e, "mass", key);
    const XMLElement* density = e.FirstChildElement("density");
    if (mass == nullptr && density != nullptr) return readDensity(*density, key, link.shapes);
    const XMLElement* inertia = faults_.only(e, "inertia", key);
    if (mass == nullptr) {
      faults_.add(&e, key, "", "has no <mass>",
                  "give both <mass value> and <inertia ixx iyy izz ...>, or no <inertial>");
      return std::nullopt;
    }
    UrdfInertial m;
    m.sum.mass_kg = faults_.mass_kg(*mass, key + ".mass");
    m.complete = use_.inertia != InertiaRule::kColliders && inertia != nullptr;
    if (m.complete) m.sum.inertia_kg_m2 = readInertia(*inertia, key);
    const Pose frame = faults_.origin(e, key);
    if (faults_.all().size() > before) return std::nullopt;
    std::string why;
    if (use_.inertia != InertiaRule::kColliders) {
      why = inertia == nullptr ? "has no <inertia>" : inertiaFault(m.sum.inertia_kg_m2);
    }
    if (!why.empty() &&
        (use_.inertia == InertiaRule::kFile || use_.inertia == InertiaRule::kRefuse)) {
      faults_.add(inertia != nullptr ? inertia : &e, key + ".inertia", "", why,
                  "principal moments must be > 0, none larger than the sum of the other two; or "
                  "set inertia = \"colliders\" in the scene");
      return std::nullopt;
    }
    if (!why.empty()) {
      faults_.note(inertia != nullptr ? inertia : &e, key + ".inertia", "",
                   fileFault("", why + ": the colliders' own takes its place",
                             "give <inertia ixx iyy izz ...> in kg·m²"));
      m.complete = false;
    }
    m.sum = moved(m.sum, frame);
    return m;
  }

  /// The moments and products of inertia. Products are optional, and may stand twice (ixy, iyx).
  Eigen::Matrix3d readInertia(const XMLElement& inertia, const std::string& key) {
    Eigen::Matrix3d matrix = Eigen::Matrix3d::Zero();
    constexpr std::array<std::array<const char*, 2>, 6> kNames{{{"ixx", "ixx"},
                                                                {"iyy", "iyy"},
                                                                {"izz", "izz"},
                                                                {"ixy", "iyx"},
                                                                {"ixz", "izx"},
                                                                {"iyz", "izy"}}};
    constexpr std::array<std::pair<int, int>, 6> kCells{
        {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}}};
    for (std::size_t i = 0; i < kNames.size(); ++i) {
      const auto [name, other] = kNames[i];
      const char* const given = inertia.Attribute(name) != nullptr || i < 3 ? name : other;
      if (inertia.Attribute(given) == nullptr && i >= 3) continue;
      const double value = faults_.numbers(inertia, given, key + ".inertia", 1).front();
      const auto [row, column] = kCells[i];
      matrix(row, column) = matrix(column, row) = value;
      if (i < 3 || inertia.Attribute(name) == nullptr || inertia.Attribute(other) == nullptr) {
        continue;
      }
      if (faults_.numbers(inertia, other, key + ".inertia", 1).front() == value) continue;
      faults_.add(&inertia, fmt::format("{}.inertia.{}", key, other), inertia.Attribute(other),
                  fmt::format("differs from {} = {}", name, inertia.Attribute(name)),
                  "an inertia is symmetric: give one of them");
    }
    return matrix;
  }

  void readJoint(const XMLElement& e) {
    const std::string name = faults_.text(e, "name", "joint");
    const std::string key = fmt::format("joint[{}]", name);
    const std::string type = faults_.text(e, "type", key);
    const int parent = joined(e, "parent", key);
    const int child = joined(e, "child", key);
    const Pose pose = faults_.place(e, key);
    if (parent < 0 || child < 0) return;
    if (links_[child].parent >= 0 || parent == child) {
      faults_.add(&e, key + ".child", links_[child].name,
                  parent == child ? "is its own parent" : "is the child of two joints",
                  "the links must form a tree");
      return;
    }
    links_[child].parent = parent;
    links_[child].in_parent = pose;
    links_[child].joint_element = &e;
    if (!type.empty() && type != "fixed") links_[child].joint = readMovable(e, key, name, type);
  }

  /// Reads a revolute, continuous or prismatic joint. A joint whose range does not contain 0 starts
  /// at the end of the range nearest to 0. Empty: its range is one place, so that it is fixed.
  std::optional<SceneJoint> readMovable(const XMLElement& e, const std::string& key,
                                        const std::string& name, const std::string& type) {
    SceneJoint joint;
    if (type != "revolute" && type != "continuous" && type != "prismatic") {
      faults_.add(&e, key + ".type", type,
                  fmt::format("the joint '{}' moves in a way that is not supported", name),
                  "must be fixed, revolute, continuous or prismatic");
      return joint;
    }
    if (type == "prismatic") joint.type = SceneJoint::Type::kSlide;
    joint.axis = Eigen::Vector3d::UnitX();
    if (const XMLElement* axis = faults_.only(e, "axis", key)) {
      const std::size_t before = faults_.all().size();
      const std::vector<double> v = faults_.numbers(*axis, "xyz", key + ".axis", 3);
      joint.axis = {v[0], v[1], v[2]};
      if (faults_.all().size() == before && !(joint.axis.norm() > 1e-6)) {
        faults_.add(axis, key + ".axis.xyz", axis->Attribute("xyz"), "has no direction",
                    "give a direction, e.g. 0 0 1");
      }
      joint.axis.normalize();
    }
    // A joint that follows another one needs no range of its own.
    const bool free = type == "continuous" || (e.FirstChildElement("mimic") != nullptr &&
                                               e.FirstChildElement("limit") == nullptr);
    if (!free && !readLimit(e, key, joint)) return std::nullopt;
    noteUnused(e, key, type);
    if (const XMLElement* dynamics = faults_.only(e, "dynamics", key)) {
      joint.viscous_friction = notNegative(*dynamics, "damping", key + ".dynamics");
      joint.dry_friction = notNegative(*dynamics, "friction", key + ".dynamics");
    }
    return joint;
  }

  /// Notes what a joint states and this reader does not apply.
  void noteUnused(const XMLElement& e, const std::string& key, const std::string& type) {
    const auto note = [&](const char* child, std::initializer_list<const char*> attributes,
                          const char* remedy) {
      const XMLElement* const at = e.FirstChildElement(child);
      if (at == nullptr) return;
      for (const char* name : attributes) {
        const char* const value = at->Attribute(name);
        if (value == nullptr || parseNumbers(value) == std::vector<double>{0.0}) continue;
        faults_.note(at, fmt::format("{}.{}.{}", key, child, name), value,
                     fileFault("", "is not applied", remedy));
      }
    };
    if (type == "continuous") {
      note("limit", {"lower", "upper"},
           "a continuous joint turns without end; make it revolute if it shall stop there");
    }
    note("safety_controller", {"soft_lower_limit", "soft_upper_limit"},
         "narrow <limit lower upper> if it shall stop there");
    note("dynamics", {"spring_stiffness", "spring_reference", "stiffness", "armature"},
         "give the body of a scene a [bodies.joint] with its spring");
  }

  /// The <limit> of a joint that has ends; the first one if none has. Others may give an effort or
  /// a speed, which are not used. Two with ends are a fault.
  const XMLElement* limitOf(const XMLElement& joint, const std::string& key) {
    const XMLElement* found = nullptr;
    for (const XMLElement* e = joint.FirstChildElement("limit"); e != nullptr;
         e = e->NextSiblingElement("limit")) {
      if (e->Attribute("lower") == nullptr && e->Attribute("upper") == nullptr) continue;
      if (found != nullptr) return faults_.only(joint, "limit", key);
      found = e;
    }
    return found != nullptr ? found : joint.FirstChildElement("limit");
  }

  /// Reads the range of a revolute or prismatic joint. @return false: it does not move
  bool readLimit(const XMLElement& e, const std::string& key, SceneJoint& joint) {
    const std::size_t before = faults_.all().size();
    const XMLElement* const limit = limitOf(e, key);
    const auto end = [&](const char* name) -> std::optional<double> {
      const char* const text = limit != nullptr ? limit->Attribute(name) : nullptr;
      if (text == nullptr) return std::nullopt;
      if (const auto value = limitEnd(text)) return value;
      return faults_.numbers(*limit, name, key + ".limit", 1).front();
    };
    const std::optional<double> lower = end("lower"), upper = end("upper");
    if (faults_.all().size() > before) return true;
    JointRange range = jointRange(joint.type == SceneJoint::Type::kSlide, lower, upper);
    joint.least = range.least, joint.most = range.most;
    if (range.problem.empty()) return true;
    const XMLElement* const at = limit != nullptr ? limit : &e;
    const std::string given =
        lower || upper ? fmt::format("{} .. {}", lower.value_or(0.0), upper.value_or(0.0)) : "";
    if (range.refused) {
      const std::string of_end = range.end != nullptr ? std::string(".") + range.end : "";
      faults_.add(at, key + ".limit" + of_end,
                  range.end != nullptr ? limit->Attribute(range.end) : given, range.problem,
                  range.remedy);
    } else {
      faults_.note(at, key + ".limit", given, fileFault("", range.problem, range.remedy));
    }
    return range.moves;
  }

  /// An optional attribute >= 0; 0 when it is missing or faulty.
  double notNegative(const XMLElement& e, const char* attribute, const std::string& key) {
    if (e.Attribute(attribute) == nullptr) return 0.0;
    const double value = faults_.numbers(e, attribute, key, 1).front();
    if (value >= 0.0) return value;
    faults_.add(&e, key + "." + attribute, e.Attribute(attribute), "is negative", "must be >= 0");
    return 0.0;
  }

  /// Index of the link whose movable joint carries `link`; -1: the root body carries it.
  [[nodiscard]] int carrierOf(int link) const {
    while (link >= 0 && !links_[link].joint) link = links_[link].parent;
    return link;
  }

  /// The optional number of a <mimic>.
  double ofMimic(const XMLElement& mimic, const char* attribute, const std::string& key,
                 double otherwise) {
    if (mimic.Attribute(attribute) == nullptr) return otherwise;
    return faults_.numbers(mimic, attribute, key, 1).front();
  }

  /// Finds which movable joints carry and follow which others (linkJoints()).
  void linkMovables() {
    std::vector<LinkedJoint> joints(links_.size());
    for (std::size_t i = 0; i < links_.size(); ++i) {
      Link& link = links_[i];
      LinkedJoint& of = joints[i];
      of.movable = link.joint.has_value();
      if (link.joint_element == nullptr) continue;
      const char* const name = link.joint_element->Attribute("name");
      of.name = name != nullptr ? name : "";
      if (!of.movable) continue;
      of.carrier = carrierOf(link.parent);
      of.joint = &*link.joint;
      const std::string key = fmt::format("joint[{}]", of.name);
      if (const XMLElement* mimic = faults_.only(*link.joint_element, "mimic", key)) {
        of.mimics = true;
        of.leader = faults_.text(*mimic, "joint", key + ".mimic");
        of.ratio = ofMimic(*mimic, "multiplier", key + ".mimic", 1.0);
        of.offset = ofMimic(*mimic, "offset", key + ".mimic", 0.0);
      }
    }
    if (!faults_.all().empty()) return;
    const JointRemarks remarks = linkJoints(joints);
    const auto where = [&](const JointRemark& remark) {
      const XMLElement* const joint = links_[remark.joint].joint_element;
      return remark.of_mimic ? joint->FirstChildElement("mimic") : joint;
    };
    const auto key_of = [&](const JointRemark& remark) {
      return fmt::format("joint[{}]{}", joints[remark.joint].name,
                         remark.of_mimic ? ".mimic.joint" : "");
    };
    for (const JointRemark& fault : remarks.faults) {
      faults_.add(where(fault), key_of(fault), fault.value, fault.problem, fault.remedy);
    }
    for (const JointRemark& notice : remarks.notices) {
      faults_.note(where(notice), key_of(notice), notice.value,
                   fileFault("", notice.problem, notice.remedy));
    }
    for (std::size_t i = 0; i < links_.size(); ++i) {
      links_[i].follows = joints[i].follows;
      links_[i].ratio = joints[i].ratio, links_[i].offset = joints[i].offset;
    }
  }

  /// Reads the inertials of links that need a mass.
  void readInertials() {
    const bool stands = use_.fixed || std::any_of(links_.begin(), links_.end(), [](const Link& l) {
                          return l.joint.has_value();
                        });
    for (Link& link : links_) {
      const bool moves = carrierOf(linkIndex(link.name)) >= 0;
      if (link.inertial_element == nullptr || !(moves || !stands)) continue;
      if (isMassless(*link.inertial_element)) {
        massless_.push_back(&link);
        continue;
      }
      link.inertial = readInertial(*link.inertial_element, link);
    }
    // A body without any mass is the scene's matter.
    const bool any = std::any_of(links_.begin(), links_.end(),
                                 [](const Link& l) { return l.inertial || l.joint; });
    for (const Link* link : massless_) {
      if (!any) continue;
      faults_.note(link->inertial_element, fmt::format("link[{}].inertial.mass.value", link->name),
                   "0", fileFault("", "is no mass: it is not used", "give the link its mass"));
    }
  }

  /// Index of the link that a joint's <parent> or <child> names; -1 with a fault if there is none.
  /// The link "world" need not be in the file (Drake): it is a frame that holds others.
  int joined(const XMLElement& joint, const char* role, const std::string& key) {
    const XMLElement* e = faults_.only(joint, role, key);
    if (e == nullptr) {
      faults_.add(&joint, key + "." + role, "", "is missing",
                  fmt::format("give <{} link=\"...\"/>", role));
      return -1;
    }
    const std::string name = faults_.text(*e, "link", key + "." + role);
    if (name == "world" && std::string_view(role) == "parent" && linkIndex(name) < 0) {
      Link world;
      world.element = e;
      world.name = name;
      links_.push_back(std::move(world));
    }
    const int index = linkIndex(name);
    if (index < 0 && !name.empty()) {
      faults_.add(e, key + "." + role, name, "there is no link of that name",
                  "name one of the file's links");
    }
    return index;
  }

  void checkTree() {
    const auto roots = std::count_if(links_.begin(), links_.end(),
                                     [](const Link& link) { return link.parent < 0; });
    if (roots != 1) {
      faults_.add(robot_, "robot", "", fmt::format("has {} root links", roots),
                  "join all links by fixed joints to one root");
      return;
    }
    for (const Link& link : links_) {
      // A path longer than the number of links contains a cycle without the root.
      std::size_t steps = 0;
      for (int i = linkIndex(link.name); i >= 0 && steps <= links_.size(); ++steps) {
        i = links_[i].parent;
      }
      if (steps <= links_.size()) continue;
      faults_.add(link.element, fmt::format("link[{}]", link.name), "",
                  "is connected by joints that form a cycle", "the links must form a tree");
    }
  }

  UrdfBody merged() const {
    UrdfBody body;
    body.mesh_files = meshes_.files;
    body.notices = faults_.notices();
    body.friction = friction_;
    body.massless = !massless_.empty();
    std::vector<int> mover_of(links_.size(), -1);
    const std::vector<int> movables = movablesInOrder();
    for (const int i : movables) {
      mover_of[i] = static_cast<int>(body.movers.size());
      const int carrier = carrierOf(links_[i].parent);
      UrdfMover& mover = body.movers.emplace_back();
      mover.name = links_[i].name;
      mover.line = links_[i].element->GetLineNum();
      mover.joint = *links_[i].joint;
      mover.friction = links_[i].friction;
      mover.carrier = carrier >= 0 ? mover_of[carrier] : -1;
      mover.in_carrier = poseBelow(i, carrier);
      mover.ratio = links_[i].ratio, mover.offset = links_[i].offset;
    }
    for (const int i : movables) {
      const int leads = links_[i].follows;
      if (leads >= 0) body.movers[mover_of[i]].follows = mover_of[leads];
    }
    for (std::size_t i = 0; i < links_.size(); ++i) {
      const Link& link = links_[i];
      const int carrier = carrierOf(static_cast<int>(i));
      const Pose in_body = poseBelow(static_cast<int>(i), carrier);
      UrdfMover* mover = carrier >= 0 ? &body.movers[mover_of[carrier]] : nullptr;
      for (Shape shape : link.shapes) {
        shape.in_body = in_body * shape.in_body;
        (mover != nullptr ? mover->shapes : body.shapes).push_back(std::move(shape));
      }
      for (UrdfVisual visual : link.visuals) {
        visual.in_body = in_body * visual.in_body;
        (mover != nullptr ? mover->visuals : body.visuals).push_back(std::move(visual));
      }
      if (!link.inertial) continue;
      const MassProperties m = moved(link.inertial->sum, in_body);
      if (mover == nullptr && link.shapes.empty()) body.ballast_m.push_back(m.com_m);
      auto& inertial = mover != nullptr ? mover->inertial : body.inertial;
      inertial = inertial ? UrdfInertial{combined(inertial->sum, m),
                                         inertial->complete && link.inertial->complete}
                          : UrdfInertial{m, link.inertial->complete};
    }
    return body;
  }

  /// Links on movable joints, each after those that carry it, otherwise as in the file.
  [[nodiscard]] std::vector<int> movablesInOrder() const {
    std::vector<int> movables;
    for (std::size_t i = 0; i < links_.size(); ++i) {
      if (links_[i].joint) movables.push_back(static_cast<int>(i));
    }
    const auto depth = [this](int link) {
      int joints = 0;
      while ((link = carrierOf(links_[link].parent)) >= 0) ++joints;
      return joints;
    };
    std::stable_sort(movables.begin(), movables.end(),
                     [&](int a, int b) { return depth(a) < depth(b); });
    return movables;
  }

  /// Pose of a link's frame in the frame of a link above it; -1: in the root's frame.
  [[nodiscard]] Pose poseBelow(int link, int above) const {
    Pose pose;
    for (int i = link; i >= 0 && i != above; i = links_[i].parent)
      pose = links_[i].in_parent * pose;
    return pose;
  }

  UrdfFaults faults_;
  tinyxml2::XMLDocument document_;
  const XMLElement* robot_ = nullptr;
  std::vector<Link> links_;
  UrdfMeshes meshes_{};
  std::vector<const Link*> massless_;  ///< links with a collider and a mass of 0
  std::optional<double> friction_;     ///< of the root's body
  struct LinkFriction {
    const XMLElement* at;
    std::string key, text;
    int link;
    double value;
  };
  std::vector<LinkFriction> link_frictions_;  ///< in the order of the file
  std::vector<const XMLElement*> frictions_;  ///< elements whose friction was read or noted
  UrdfUse use_;
};

}  // namespace

Expected<UrdfBody> loadUrdf(const std::string& path, MeshLoadTime& time, UrdfUse use) {
  return Reader(path, time, use).read();
}

Expected<UrdfBody> loadUrdf(const std::string& path) {
  MeshLoadTime time;
  return loadUrdf(path, time);
}

}  // namespace wholehand
