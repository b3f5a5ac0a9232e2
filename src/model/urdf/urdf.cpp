#include "model/urdf/urdf.hpp"

#include "model/urdf/urdf_bounds.hpp"
#include "model/urdf/urdf_collision.hpp"
#include "model/urdf/urdf_xml.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace wholehand {
namespace {

using tinyxml2::XMLElement;
namespace fs = std::filesystem;

struct Link {
  const XMLElement* element = nullptr;
  std::string name;
  std::vector<Shape> shapes;               ///< in the link's frame
  std::optional<MassProperties> inertial;  ///< in the link's frame
  int parent = -1;                         ///< index of the parent link; -1 for the root
  Pose in_parent;
};

/// What is wrong with an XML text, in words.
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
      const std::string key = fmt::format("gazebo[{}]", link != nullptr ? link : "");
      for (const char* name : {"mu1", "mu2"}) noteFriction(e->FirstChildElement(name), key);
    }
    if (faults_.all().empty()) checkTree();
    if (!faults_.all().empty()) return firstFaults(faults_.all(), faults_.file());
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
    if (robot_ != nullptr) return true;
    faults_.add(document_.RootElement(), "", "", "is no URDF: its root element is not <robot>",
                "give a URDF (of a .xacro file: run xacro first)");
    return false;
  }

  /// Reports an XML error in words, with the parser's name for it in brackets.
  void addXmlFault() {
    using tinyxml2::XMLError;
    const XMLError code = document_.ErrorID();
    std::error_code error;
    if (fs::file_size(faults_.file(), error) == 0) {
      faults_.addAtLine(0, "is empty", "give a URDF with at least one <link>");
    } else if (code == XMLError::XML_ERROR_EMPTY_DOCUMENT ||
               code == XMLError::XML_ERROR_PARSING_TEXT) {
      faults_.addAtLine(0, "is no URDF: it holds no XML",
                        "give a URDF: XML that starts <robot ...>");
    } else if (code == XMLError::XML_ERROR_FILE_COULD_NOT_BE_OPENED ||
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
      if (auto shape = readUrdfCollision(*c, collision, faults_, meshes_)) {
        link.shapes.push_back(std::move(*shape));
      }
    }
    if (number == 0) {
      faults_.add(&e, key, "", fmt::format("the link '{}' has no collider", link.name),
                  "give it a <collision> with a <geometry>, or take the link out");
    }
    if (const XMLElement* c = e.FirstChildElement("contact")) {
      noteFriction(c->FirstChildElement("lateral_friction"), key + ".contact");
    }
    const XMLElement* i = e.FirstChildElement("inertial");
    if (i != nullptr && use_ == UrdfUse::kShapesAndMass) {
      link.inertial = readInertial(*i, key + ".inertial");
    }
    links_.push_back(std::move(link));
  }

  /// Of Bullet (`<contact><lateral_friction value>`) or Gazebo (`<mu1>`, `<mu2>`).
  void noteFriction(const XMLElement* e, const std::string& key) {
    if (e == nullptr) return;
    const char* value = e->Attribute("value") != nullptr ? e->Attribute("value") : e->GetText();
    frictions_.push_back({faults_.file(), e->GetLineNum(), fmt::format("{}.{}", key, e->Name()),
                          value != nullptr ? value : "", "is not applied", ""});
  }

  std::optional<MassProperties> readInertial(const XMLElement& e, const std::string& key) {
    const XMLElement* mass = e.FirstChildElement("mass");
    const XMLElement* inertia = e.FirstChildElement("inertia");
    if (mass == nullptr || inertia == nullptr) {
      faults_.add(&e, key, "", fmt::format("has no <{}>", mass == nullptr ? "mass" : "inertia"),
                  "give both <mass value> and <inertia ixx iyy izz ...>, or no <inertial> at all");
      return std::nullopt;
    }
    const std::size_t before = faults_.all().size();
    MassProperties m;
    m.mass_kg = faults_.positive(*mass, "value", key + ".mass");
    constexpr std::array<const char*, 6> kNames{"ixx", "iyy", "izz", "ixy", "ixz", "iyz"};
    constexpr std::array<std::pair<int, int>, 6> kCells{
        {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}}};
    for (std::size_t i = 0; i < kNames.size(); ++i) {
      if (i >= 3 && inertia->Attribute(kNames[i]) == nullptr) continue;  // products: optional
      const double value = faults_.numbers(*inertia, kNames[i], key + ".inertia", 1).front();
      const auto [row, column] = kCells[i];
      m.inertia_kg_m2(row, column) = m.inertia_kg_m2(column, row) = value;
    }
    const Pose frame = faults_.origin(e, key);
    if (faults_.all().size() > before) return std::nullopt;
    if (const std::string why = inertiaFault(m.inertia_kg_m2); !why.empty()) {
      faults_.add(inertia, key + ".inertia", "", why,
                  "principal moments must be > 0, none larger than the sum of the other two");
      return std::nullopt;
    }
    return moved(m, frame);
  }

  void readJoint(const XMLElement& e) {
    const std::string name = faults_.text(e, "name", "joint");
    const std::string key = fmt::format("joint[{}]", name);
    const std::string type = faults_.text(e, "type", key);
    if (!type.empty() && type != "fixed") {
      faults_.add(
          &e, key + ".type", type,
          fmt::format("the joint '{}' is movable: articulated objects are not supported yet", name),
          "must be fixed");
    }
    const int parent = joined(e, "parent", key);
    const int child = joined(e, "child", key);
    const Pose pose = faults_.origin(e, key);
    if (parent < 0 || child < 0) return;
    if (links_[child].parent >= 0 || parent == child) {
      faults_.add(&e, key + ".child", links_[child].name,
                  parent == child ? "is its own parent" : "is the child of two joints",
                  "the links must form a tree");
      return;
    }
    links_[child].parent = parent;
    links_[child].in_parent = pose;
  }

  /// Index of the link that a joint's <parent> or <child> names; -1, and a fault, without one.
  int joined(const XMLElement& joint, const char* role, const std::string& key) {
    const XMLElement* e = joint.FirstChildElement(role);
    if (e == nullptr) {
      faults_.add(&joint, key + "." + role, "", "is missing",
                  fmt::format("give <{} link=\"...\"/>", role));
      return -1;
    }
    const std::string name = faults_.text(*e, "link", key + "." + role);
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
      // A path longer than the number of links is a cycle without the root.
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
    body.frictions = frictions_;
    for (const Link& link : links_) {
      Pose in_root = link.in_parent;
      for (int i = link.parent; i >= 0; i = links_[i].parent)
        in_root = links_[i].in_parent * in_root;
      for (Shape shape : link.shapes) {
        shape.in_body = in_root * shape.in_body;
        body.shapes.push_back(std::move(shape));
      }
      if (!link.inertial) continue;
      const MassProperties m = moved(*link.inertial, in_root);
      body.inertial = body.inertial ? combined(*body.inertial, m) : m;
    }
    return body;
  }

  UrdfFaults faults_;
  tinyxml2::XMLDocument document_;
  const XMLElement* robot_ = nullptr;
  std::vector<Link> links_;
  UrdfMeshes meshes_{};
  Diagnostics frictions_;
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
