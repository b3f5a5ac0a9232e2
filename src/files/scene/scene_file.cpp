#include "files/scene/scene_file.hpp"

#include "files/mesh/convex_mesh.hpp"
#include "files/mesh/mesh_file.hpp"
#include "files/scene/object_scene.hpp"
#include "files/scene/plausibility.hpp"
#include "files/scene/separation.hpp"
#include "files/toml/toml_file.hpp"
#include "files/urdf/urdf.hpp"
#include "loop/core/geometry.hpp"
#include "loop/core/printable.hpp"
#include "loop/core/tick_record.hpp"
#include "loop/model/principal_axes.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace wholehand {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;
using std::numbers::pi;

constexpr double kTouch_m = 1e-4;  ///< allowed initial overlap of bodies: rounding in files

/// Density of a URDF's body that has no <inertial>.
constexpr double kWood_kg_m3 = 600.0;

constexpr std::size_t kMostName = 200;    ///< maximum characters of a name in a recording
constexpr std::size_t kShownName = 60;    ///< maximum characters of a name in a fault
constexpr double kThinnestCore_m = 1e-3;  ///< radius that a soft cylinder keeps

NumberRule dimension() {
  return between(0.001, 10.0, "m");
}

NumberRule bodyMass() {
  return between(1e-4, 1e3, "kg");
}

Vector3d vectorFrom(const std::vector<double>& v) {
  return {v[0], v[1], v[2]};
}

bool isColor(const std::string& text) {
  return text.size() == 7 && text[0] == '#' &&
         std::all_of(text.begin() + 1, text.end(),
                     [](unsigned char c) { return std::isxdigit(c) != 0; });
}

/// A body that moves on a joint of a URDF.
struct Mover {
  SceneBody body;
  int carrier = -1, follows = -1;  ///< others of the same URDF; -1: none
  Diagnostic link;                 ///< file, line and key of its link
};

/// Reads one `[[bodies]]` table.
class BodyReader {
 public:
  /// @param urdf the URDF that the body names, if it was read before; may be null
  BodyReader(TomlTable table, fs::path folder, MeshLoadTime& time, const UrdfBody* urdf)
      : t_(std::move(table)), folder_(std::move(folder)), time_(&time), read_(urdf) {}

  /// The body; without shapes after a fault in them.
  SceneBody read() {
    SceneBody body;
    body.name = t_.text("name");
    body.fixed = t_.flag("fixed", false);
    body.friction = t_.number("friction", between(0.0, 2.0), body.friction);
    body.linear_damping_per_s =
        t_.number("linear_damping_per_s", between(0.0, 1.0, "1/s"), body.linear_damping_per_s);
    body.color = t_.text("color", body.color);
    if (t_.isGood("color") && !isColor(body.color)) {
      t_.fail("color", "is not a colour", "must be \"#RRGGBB\", e.g. \"#3B6FD1\"");
    }
    readPose(body);
    readShapes(body);
    readSoft(body);
    readMass(body);
    readJoint(body);
    return body;
  }

  /// True when position and orientation of the body are valid.
  [[nodiscard]] bool placed() const {
    return t_.isGood("position_m") &&
           (!t_.has("orientation_rpy_rad") || t_.isGood("orientation_rpy_rad"));
  }
  [[nodiscard]] TomlTable& table() { return t_; }
  /// Paths of the mesh or URDF file and of the URDF's meshes.
  [[nodiscard]] const std::vector<std::string>& assets() const { return assets_; }
  /// Notices: differences from the file that are not faults. An empty `file` means the scene file.
  [[nodiscard]] const Diagnostics& notices() const { return notices_; }
  /// Faults inside the URDF, with lines of that file.
  [[nodiscard]] const Diagnostics& urdfFaults() const { return urdf_faults_; }
  /// Bodies that move on joints of the URDF.
  [[nodiscard]] const std::vector<Mover>& movers() const { return movers_; }
  /// Adds a fault at a link of the URDF.
  void failLink(const Mover& mover, std::string problem, std::string remedy) {
    Diagnostic fault = mover.link;
    fault.problem = std::move(problem);
    fault.remedy = std::move(remedy);
    urdf_faults_.push_back(std::move(fault));
  }

 private:
  void readPose(SceneBody& body) {
    body.pose.translation_m = vectorFrom(t_.numbers("position_m", 3, between(-10.0, 10.0, "m")));
    const std::vector<double> rpy =
        t_.numbers("orientation_rpy_rad", 3, between(-2.0 * pi, 2.0 * pi, "rad"), {0.0, 0.0, 0.0});
    body.pose.rotation = rotationFromRpy(rpy[0], rpy[1], rpy[2]);
  }

  void readShapes(SceneBody& body) {
    const std::string kind =
        t_.choice("shape", {"box", "sphere", "cylinder", "disk", "capsule", "mesh", "urdf"});
    if (!t_.isGood("shape")) {
      ignoreDimensions();
    } else if (kind == "urdf") {
      readUrdf(body);
    } else if (kind == "mesh") {
      readMesh(body);
    } else {
      Shape shape = readPrimitive(kind);
      if (!shape_wrong_) body.shapes.push_back(std::move(shape));
    }
    const FarPlace far = farPlace(body.shapes);
    if (far.refused) {
      t_.fail("file", "the " + kind + " " + far.problem, "must be within 10 m, as positions are");
    } else if (!far.problem.empty()) {
      note(fileFault("", "the " + kind + " " + far.problem, "or move it by position_m"));
    }
  }

  /// Accepts any dimension keys after an unknown shape, so that they are not reported as unknown.
  void ignoreDimensions() {
    (void)t_.numbers("size_m", 3, dimension(), {1.0, 1.0, 1.0});
    for (const char* key : {"radius_m", "height_m", "length_m"})
      (void)t_.number(key, dimension(), 1.0);
    (void)t_.number("scale", above(0.0, 1e4), 1.0);
    (void)t_.text("file", "none");
  }

  double length(const char* key) {
    const double value = t_.number(key, dimension());
    shape_wrong_ = shape_wrong_ || !t_.isGood(key);
    return value;
  }

  Shape readPrimitive(const std::string& kind) {
    Shape shape;
    if (kind == "box") {
      shape.half_extents_m = vectorFrom(t_.numbers("size_m", 3, dimension())) / 2.0;
      shape_wrong_ = !t_.isGood("size_m");
      return shape;
    }
    shape.type = *shapeNamed(kind == "disk" ? "cylinder" : kind);
    shape.radius_m = length("radius_m");
    if (const char* key = shape.kind().length_key) shape.length_m = length(key);
    return shape;
  }

  void readMesh(SceneBody& body) {
    const double scale = t_.number("scale", above(0.0, 1e4), 1.0);
    const std::string file = t_.text("file");
    if (!t_.isGood("file")) return;
    assets_.push_back((folder_ / file).string());
    if (time_->isOver()) return;  // the previous mesh reported it
    Expected<MeshCollider> mesh =
        loadMeshCollider(assets_.back(), Vector3d::Constant(scale), *time_);
    if (mesh) {
      body.shapes = std::move(mesh->shapes);
      for (const Diagnostic& notice : mesh->notices) note(notice);
    } else {
      t_.fail("file", mesh.errors().front().problem, mesh.errors().front().remedy);
    }
  }

  /// Adds a notice about the key `file`, or about the body if it has none.
  void note(Diagnostic notice) {
    notice.line = t_.lineOf("file");
    notice.key = t_.path() + (t_.has("file") ? ".file" : "");
    notices_.push_back(std::move(notice));
  }

  void readUrdf(SceneBody& body) {
    urdf_wrong_ = true;
    const bool decides = t_.has("inertia");
    const std::string inertia = t_.choice("inertia", {"file", "colliders", "refuse"}, "colliders");
    inertia_ = !decides              ? InertiaRule::kIfPossible
               : inertia == "file"   ? InertiaRule::kFile
               : inertia == "refuse" ? InertiaRule::kRefuse
                                     : InertiaRule::kColliders;
    const std::string file = t_.text("file");
    if (!t_.isGood("file")) return;
    const fs::path path = folder_ / file;
    std::error_code error;
    if (!fs::is_regular_file(path, error)) {
      t_.fail("file", "there is no such URDF file: " + printable(path.string()),
              "check the name; it is relative to the scene file");
      return;
    }
    Expected<UrdfBody> urdf =
        read_ != nullptr
            ? Expected<UrdfBody>(*read_)
            : loadUrdf(path.string(), *time_, UrdfUse{body.fixed, inertia_, t_.has("friction")});
    if (!urdf) {
      urdf_faults_ = urdf.errors();
      return;
    }
    urdf_wrong_ = false;
    assets_.push_back(path.string());
    assets_.insert(assets_.end(), urdf->mesh_files.begin(), urdf->mesh_files.end());
    // Takes over the parts of the URDF that the body uses.
    notices_ = std::move(urdf->notices);
    const double friction = body.friction;
    body.friction = urdf->friction.value_or(friction);
    body.shapes = std::move(urdf->shapes);
    inertial_ = urdf->inertial;
    ballast_m_ = urdf->ballast_m;
    visuals_ = urdf->visuals;
    urdf_read_ = true;
    if (urdf->massless && !urdf->inertial && urdf->movers.empty() && !t_.has("fixed") &&
        !t_.has("mass_kg")) {
      body.fixed = true;
      note(fileFault("", "the URDF has a mass of 0: the body stands, as in Bullet",
                     "give mass_kg, or set fixed = false, if it shall move"));
    }
    // A URDF with moving joints has a fixed root.
    if (!urdf->movers.empty()) {
      if (!body.fixed && t_.has("fixed")) {
        t_.fail("fixed",
                fmt::format("is false, and the URDF's link '{}' moves on a joint: its root "
                            "stands in the world",
                            printable(urdf->movers.front().name)),
                "set fixed = true");
      }
      body.fixed = true;
    } else if (body.fixed && decides) {
      t_.fail("inertia", "has no effect on a fixed body", "take it out, or set fixed = false");
    }
    for (UrdfMover& mover : urdf->movers) mover.friction = mover.friction.value_or(friction);
    addMovers(body, urdf->movers, path.string());
  }

  /// Adds the bodies that move on joints of a URDF. Each starts at joint position 0, or at the
  /// nearest end of a range without 0; a joint that follows another starts where that one puts it.
  void addMovers(const SceneBody& root, std::vector<UrdfMover>& movers, const std::string& path) {
    std::vector<double> starts;
    for (const UrdfMover& mover : movers) {
      starts.push_back(std::clamp(0.0, mover.joint.least, mover.joint.most));
    }
    std::vector<int> added(movers.size(), -1);
    for (std::size_t i = 0; i < movers.size(); ++i) {
      UrdfMover& mover = movers[i];
      if (mover.follows >= 0) {
        const SceneJoint& leader = movers[mover.follows].joint;
        starts[i] = mover.ratio * starts[mover.follows] + mover.offset;
        mover.joint.least = mover.ratio * leader.least + mover.offset;
        mover.joint.most = mover.ratio * leader.most + mover.offset;
        if (mover.ratio < 0.0) std::swap(mover.joint.least, mover.joint.most);
      }
      const bool moves_others =
          std::any_of(movers.begin(), movers.end(), [&](const UrdfMover& other) {
            const int index = static_cast<int>(i);
            return other.carrier == index || other.follows == index;
          });
      const std::size_t before = movers_.size();
      const int carrier = mover.carrier >= 0 ? added[mover.carrier] : -1;
      if (mover.carrier >= 0 && carrier < 0) continue;  // the carrier is a fault
      addMover(carrier >= 0 ? movers_[carrier].body.pose : root.pose, root, mover, starts[i],
               moves_others, path);
      if (movers_.size() == before) continue;
      added[i] = static_cast<int>(before);
      movers_.back().carrier = carrier;
    }
    for (std::size_t i = 0; i < movers.size(); ++i) {
      if (added[i] < 0 || movers[i].follows < 0) continue;
      movers_[added[i]].follows = added[movers[i].follows];
      movers_[added[i]].body.joint->ratio = movers[i].ratio;
    }
  }

  /// Adds a body that moves on a joint of a fixed URDF, named "<body>/<link>".
  /// @param carrier pose of what carries it @param start position of its joint
  /// @param moves_others other bodies depend on its joint
  void addMover(const Pose& carrier, const SceneBody& root, UrdfMover& mover, double start,
                bool moves_others, const std::string& path) {
    SceneBody body;
    body.name = root.name + "/" + mover.name;
    const std::string key = fmt::format("link[{}]", printable(mover.name, kShownName));
    const auto note = [&](std::string problem, std::string remedy) {
      notices_.push_back(keyFault(path, key, "", std::move(problem), std::move(remedy)));
    };
    if (mover.shapes.empty() && !moves_others) {
      note("moves on a joint and has no collider: it is left out", "give it a <collision>");
      return;
    }
    body.friction = *mover.friction;
    body.color = root.color;
    body.pose = carrier * mover.in_carrier;
    body.shapes = std::move(mover.shapes);
    body.joint = mover.joint;
    if (start != 0.0 && mover.follows < 0) {
      note(fmt::format("starts at {:g} {}: the range of its joint does not contain 0", start,
                       body.joint->isHinge() ? "rad" : "m"),
           "turn the joint's <origin> so that 0 is where it shall start");
    }
    body.pose = poseOn(*body.joint, body.pose, start);
    body.joint->least -= start, body.joint->most -= start;
    MassProperties m;
    if (body.shapes.empty()) {
      m = bareMass(mover, note);
    } else if (mover.inertial) {
      m = inertialOf(body.shapes, {}, mover.visuals, *mover.inertial, note);
    } else {
      m = uniformDensity(body.shapes, kWood_kg_m3 * moments(body.shapes).volume_m3);
      note(fmt::format("has no <inertial>: {:.3g} kg, at {} kg/m³", m.mass_kg, kWood_kg_m3),
           "give it one");
    }
    if (!bodyMass().allows(m.mass_kg)) {
      t_.fail(
          "file",
          fmt::format("the URDF's '{}' has {} kg", printable(mover.name), formatNumber(m.mass_kg)),
          bodyMass().remedy());
    }
    body.mass_kg = m.mass_kg;
    body.com_m = m.com_m;
    body.inertia_kg_m2 = m.inertia_kg_m2;
    if (!body.shapes.empty()) noteDensity(body);
    if (body.joint->dry_friction == 0.0 && mover.follows < 0) {
      note("moves without dry friction: it opens at a touch", "give its joint <dynamics friction>");
    }
    if (const std::string problem = heldProblem(body); !problem.empty()) {
      note(problem, "give its joint a smaller <dynamics friction>");
    }
    Mover moving{std::move(body), -1, -1, keyFault(path, key, "", "", "")};
    moving.link.line = mover.line;
    checkName(moving);
    movers_.push_back(std::move(moving));
  }

  /// Mass properties of a link without a collider that moves others: its inertial, or, without a
  /// whole one, a ball of 10 mm radius.
  template <class Note>
  static MassProperties bareMass(const UrdfMover& mover, Note note) {
    constexpr double kLight_kg = 1e-3, kSmall_m = 0.01;
    if (mover.inertial && mover.inertial->complete) return mover.inertial->sum;
    MassProperties m;
    m.mass_kg = kLight_kg;
    if (mover.inertial) m = mover.inertial->sum;
    m.inertia_kg_m2 = 0.4 * m.mass_kg * kSmall_m * kSmall_m * Eigen::Matrix3d::Identity();
    note(fmt::format("moves others and has neither a collider nor a whole <inertial>: {:.3g} kg",
                     m.mass_kg),
         "give it an <inertial>");
    return m;
  }

  /// Checks a moving body's name, which is recorded and shown in lists.
  void checkName(const Mover& mover) {
    const std::string& name = mover.body.name;
    if (isPrintable(name, kMostName)) return;
    if (isPrintable(name, name.size())) {
      failLink(mover, "moves on a joint, and its name with that of its body is too long",
               fmt::format("\"<body>/<link>\" may have {} characters", kMostName));
    } else {
      failLink(
          mover,
          "moves on a joint, and its name holds control characters or bytes that are not UTF-8",
          "write a name that can be shown in a list, and save the file as UTF-8");
    }
  }

  void readSoft(SceneBody& body) {
    if (!t_.has("soft_m")) return;
    const Shape* cylinder = body.cylinder();
    const double most_m = cylinder != nullptr ? cylinder->radius_m - kThinnestCore_m : 10.0;
    body.soft_m = t_.number("soft_m", between(0.0, std::max(most_m, 0.0), "m"));
    if (cylinder == nullptr && t_.isGood("shape") && !shape_wrong_) {
      t_.fail("soft_m", "is for cylinders and disks only", "take it out");
    }
  }

  void readJoint(SceneBody& body) {
    if (!t_.has("joint")) return;
    TomlTable t = t_.table("joint");
    SceneJoint joint;
    const bool hinge = t.choice("type", {"hinge", "slide"}) == "hinge";
    joint.type = hinge ? SceneJoint::Type::kHinge : SceneJoint::Type::kSlide;
    const Vector3d axis = vectorFrom(t.numbers("axis", 3, between(-1.0, 1.0)));
    if (axis.norm() >= 1e-3) {
      joint.axis = axis.normalized();
    } else if (t.isGood("axis")) {
      t.fail("axis", "has no direction", "give a direction of the body's frame, e.g. [0, 0, 1]");
    }
    if (hinge) {
      joint.point_m =
          vectorFrom(t.numbers("point_m", 3, between(-10.0, 10.0, "m"), {0.0, 0.0, 0.0}));
    }
    // Range: required for a slide, optional for a hinge.
    const char* range = hinge ? "range_rad" : "range_m";
    if (!hinge || t.has(range)) {
      const auto [least, most] = t.interval(
          range, hinge ? between(-20.0 * pi, 20.0 * pi, "rad") : between(-2.0, 2.0, "m"));
      joint.least = least, joint.most = most;
      if (t.isGood(range) && (least > 0.0 || most < 0.0)) {
        t.fail(range, "does not contain 0",
               "0 is where the body stands in the file: move the body into its range");
      }
    }
    // Friction, spring and latch.
    const auto number = [&](const char* of_hinge, const char* of_slide, double most,
                            const char* unit) {
      return t.number(hinge ? of_hinge : of_slide, between(0.0, most, unit), 0.0);
    };
    joint.dry_friction = number("friction_nm", "friction_n", 100.0, hinge ? "N·m" : "N");
    joint.viscous_friction =
        number("viscous_nms_rad", "viscous_ns_m", 1000.0, hinge ? "N·m·s/rad" : "N·s/m");
    joint.spring_stiffness =
        number("spring_nm_rad", "spring_n_m", hinge ? 1000.0 : 1e4, hinge ? "N·m/rad" : "N/m");
    if (joint.spring_stiffness > 0.0) {
      joint.spring_rest =
          hinge ? t.number("spring_rest_rad", between(-2.0 * pi, 2.0 * pi, "rad"), 0.0)
                : t.number("spring_rest_m", between(-2.0, 2.0, "m"), 0.0);
    }
    readLatch(t, joint);
    if (body.fixed) {
      t_.fail("joint", "is of a fixed body", "set fixed = false, or take the joint out");
    } else {
      body.joint = joint;
    }
  }

  void readLatch(TomlTable& t, SceneJoint& joint) {
    if (!t.has("latch_energy_j")) return;
    joint.latch_energy_j = t.number("latch_energy_j", above(0.0, 10.0, "J"));
    if (joint.isHinge()) {
      joint.latch_wave = static_cast<double>(t.integer("latch_detents_per_turn", 1, 360));
      joint.latch_at = t.number("latch_at_rad", between(-2.0 * pi, 2.0 * pi, "rad"), 0.0);
    } else {
      joint.latch_wave = 2.0 * pi / t.number("latch_pitch_m", between(1e-3, 1.0, "m"));
      joint.latch_at = t.number("latch_at_m", between(-2.0, 2.0, "m"), 0.0);
    }
  }

  /// Reads mass and inertia: from the URDF's inertials, scaled to `mass_kg` if given, or from the
  /// shapes at uniform density.
  void readMass(SceneBody& body) {
    if (body.fixed) {
      if (t_.has("mass_kg")) {
        t_.fail("mass_kg", "has no effect on a fixed body", "take it out, or set fixed = false");
      }
      return;
    }
    const bool from_urdf = inertial_.has_value() || urdf_wrong_;
    if (from_urdf) {
      body.mass_kg = t_.number("mass_kg", bodyMass(), inertial_ ? inertial_->sum.mass_kg : 1.0);
    } else if (urdf_read_ && !t_.has("mass_kg")) {
      body.mass_kg = kWood_kg_m3 * moments(body.shapes).volume_m3;
      note(fileFault(
          "",
          fmt::format("the URDF has no mass: {:.3g} kg, at {} kg/m³", body.mass_kg, kWood_kg_m3),
          "give mass_kg, or the URDF an <inertial>"));
    } else {
      body.mass_kg = t_.number("mass_kg", bodyMass());
    }
    if (body.shapes.empty()) return;
    MassProperties m =
        inertial_ ? inertialOf(body.shapes, ballast_m_, visuals_, *inertial_,
                               [&](const std::string& problem, std::string remedy) {
                                 note(fileFault("", "the URDF " + problem, std::move(remedy)));
                               })
                  : uniformDensity(body.shapes, body.mass_kg);
    if (!bodyMass().allows(m.mass_kg)) {
      t_.fail("file", fmt::format("the URDF's masses add up to {} kg", formatNumber(m.mass_kg)),
              bodyMass().remedy());
    }
    noteDensity(body);
    body.com_m = m.com_m;
    body.inertia_kg_m2 = body.mass_kg / m.mass_kg * m.inertia_kg_m2;
  }

  /// Notes an impossible density, which may be the only sign of a size or a mass in a wrong unit.
  void noteDensity(const SceneBody& body) {
    if (auto notice = densityNotice(body)) note(std::move(*notice));
  }

  /// The mass properties of a URDF's body: those of its inertials, or its colliders' own at the
  /// inertials' mass where the scene asks for them or the inertials are impossible. Many URDFs
  /// carry placeholders or moments in other units.
  /// @param note adds a notice with a problem and a remedy
  template <class Note>
  MassProperties inertialOf(const std::vector<Shape>& shapes,
                            const std::vector<Vector3d>& ballast_m,
                            const std::vector<UrdfVisual>& visuals, const UrdfInertial& urdf,
                            Note note) {
    const MassProperties& m = urdf.sum;
    MassProperties own = uniformDensity(shapes, m.mass_kg);
    if (inertia_ == InertiaRule::kColliders || !urdf.complete) return own;
    if (inertia_ == InertiaRule::kFile) return m;
    std::string problem = inertialProblem(shapes, ballast_m, m);
    if (!problem.empty() && !visuals.empty()) {
      // Colliders simplify: the mass may lie where the body is only seen.
      problem = inertialProblem(shapes, ballast_m, m, pointsOf(visuals, *time_, assets_));
    }
    if (problem.empty()) return m;
    if (inertia_ == InertiaRule::kRefuse) {
      t_.fail("file", "the URDF's " + problem,
              "correct the URDF's <inertial> (kg, m, kg·m²), or set inertia = \"colliders\"");
      return m;
    }
    const Vector3d moments = principalAxesOf(own.inertia_kg_m2).moments;
    note("has an inertial that no such body has: its " + problem +
             fmt::format("; its colliders' own takes its place: {:.3g}, {:.3g}, {:.3g} kg·m²",
                         moments[0], moments[1], moments[2]),
         "correct its <inertial>, or set inertia = \"file\" or \"colliders\" in the scene");
    return own;
  }

  TomlTable t_;
  fs::path folder_;
  MeshLoadTime* time_;
  bool shape_wrong_ = false;
  InertiaRule inertia_ = InertiaRule::kIfPossible;
  const UrdfBody* read_;  ///< the URDF, if it was read before
  std::optional<UrdfInertial> inertial_;
  std::vector<Vector3d> ballast_m_;
  std::vector<UrdfVisual> visuals_;
  Diagnostics urdf_faults_;
  bool urdf_read_ = false;   ///< a URDF was read without faults
  bool urdf_wrong_ = false;  ///< the URDF has faults, so that the mass is unknown
  std::vector<std::string> assets_;
  Diagnostics notices_;
  std::vector<Mover> movers_;
};

void reportSameNames(const SceneModel& scene, std::vector<BodyReader>& readers) {
  for (std::size_t i = 0; i < readers.size(); ++i) {
    const std::string& name = scene.bodies[i].name;
    if (readers[i].table().isGood("name") && scene.bodyIndex(name) < static_cast<int>(i)) {
      readers[i].table().fail("name", "is the name of two bodies", "give every body its own name");
    }
  }
}

void reportOverlaps(const SceneModel& scene, std::vector<BodyReader>& readers) {
  for (std::size_t j = 0; j < readers.size(); ++j) {
    for (std::size_t i = 0; i < j; ++i) {
      if (!readers[i].placed() || !readers[j].placed()) continue;
      if (scene.bodies[i].passes(scene.bodies[j])) continue;
      const SceneBody &a = scene.bodies[i], &b = scene.bodies[j];
      const double depth_m = -separation(a, b);  // -inf when a body has no valid shape
      if (!(depth_m > kTouch_m)) continue;
      readers[j].table().fail(
          "position_m",
          fmt::format("'{}' starts {:.3g} mm inside '{}'", b.name, 1e3 * depth_m, a.name),
          "move one of them; touching within 0.1 mm is allowed");
    }
  }
}

/// Reports moving bodies beyond kMaxBodies, which cannot be monitored and recorded.
void reportUnwatched(const SceneModel& scene, std::vector<BodyReader>& readers) {
  for (std::size_t i = kMaxBodies; i < readers.size(); ++i) {
    if (scene.bodies[i].fixed) continue;
    readers[i].table().fail(
        "name", fmt::format("moves and is body {} of the scene", i + 1),
        fmt::format("the first {} are watched and recorded: put it before fixed bodies, or set "
                    "fixed = true",
                    kMaxBodies));
  }
}

/// Appends the bodies that move on joints of URDFs after all others. Checks that they do not
/// overlap bodies that they can collide with.
void addMovers(SceneModel& scene, std::vector<BodyReader>& readers) {
  const std::size_t others = scene.bodies.size();
  for (BodyReader& reader : readers) {
    std::vector<int> added;
    for (const Mover& moving : reader.movers()) {
      SceneBody mover = moving.body;
      added.push_back(static_cast<int>(scene.bodies.size()));
      if (reader.table().isGood("name") && scene.bodyIndex(mover.name) >= 0) {
        reader.failLink(
            moving, fmt::format("moves on a joint as '{}', the name of another body", mover.name),
            "give one of them another name");
        continue;
      }
      for (std::size_t i = 0; i < others; ++i) {
        const SceneBody& other = scene.bodies[i];
        if (mover.passes(other) || !readers[i].placed() || !reader.placed()) continue;
        const double depth_m = -separation(mover, other);
        if (!(depth_m > kTouch_m)) continue;
        readers[i].table().fail(
            "position_m",
            fmt::format("'{}' starts {:.3g} mm inside '{}'", other.name, 1e3 * depth_m, mover.name),
            "move one of them; touching within 0.1 mm is allowed");
      }
      if (scene.bodies.size() >= std::size_t{kMaxBodies}) {
        reader.table().fail(
            "file",
            fmt::format("'{}' is body {} of the scene, and moves", printable(mover.name),
                        scene.bodies.size() + 1),
            fmt::format("a scene with URDFs that move has {} bodies at most", kMaxBodies));
        return;
      }
      scene.bodies.push_back(std::move(mover));
    }
    // Joints name the bodies that carry and lead them by their index in the scene. After a fault
    // there is no scene.
    for (std::size_t i = 0; i < added.size(); ++i) {
      if (added[i] >= static_cast<int>(scene.bodies.size())) break;
      const Mover& moving = reader.movers()[i];
      SceneJoint& joint = *scene.bodies[added[i]].joint;
      joint.parent = moving.carrier >= 0 ? added[moving.carrier] : -1;
      joint.follows = moving.follows >= 0 ? added[moving.follows] : -1;
    }
  }
}

/// Notes a heavy and a light body in one scene. While the hand touches one of them, the solver's
/// sweeps do not converge within a tick for a body that rests on a much lighter one.
void noteHeavyOnLight(SceneModel& scene) {
  const SceneBody *light = nullptr, *heavy = nullptr;
  for (const SceneBody& body : scene.bodies) {
    if (body.fixed || body.joint) continue;
    if (light == nullptr || body.mass_kg < light->mass_kg) light = &body;
    if (heavy == nullptr || body.mass_kg > heavy->mass_kg) heavy = &body;
  }
  if (light == nullptr || heavy->mass_kg <= kMostMassRatio * light->mass_kg) return;
  scene.notices.push_back(keyFault(
      scene.path, "bodies", "",
      fmt::format("\"{}\" ({:.3g} kg) is {:.0f} times as heavy as \"{}\" ({:.3g} kg): where it "
                  "rests on it while the hand touches one of them, it may sink in",
                  printable(heavy->name), heavy->mass_kg, heavy->mass_kg / light->mass_kg,
                  printable(light->name), light->mass_kg),
      fmt::format("keep bodies that rest on each other within a ratio of {:.0f}", kMostMassRatio)));
}

/// Reports falls faster than kMostBodySpeed_m_s: such a body may pass through a fixed body or the
/// hand.
void reportFalls(const SceneModel& scene, std::vector<BodyReader>& readers) {
  const double g_m_s2 = scene.gravity_m_s2.norm();
  if (!(g_m_s2 > 0.0)) return;
  const Vector3d down = scene.gravity_m_s2 / g_m_s2;
  double ground_m = 0.0;  // the hand is near the origin
  for (std::size_t i = 0; i < readers.size(); ++i) {
    const SceneBody& body = scene.bodies[i];
    if (!body.fixed || !readers[i].placed()) continue;
    for (const Shape& shape : body.shapes) {
      double top_m = std::numeric_limits<double>::infinity();
      for (const Vector3d& p : boundingPoints(shape)) {
        top_m = std::min(top_m, down.dot(body.pose * p));
      }
      ground_m = std::max(ground_m, top_m);
    }
  }
  const double most_m = kMostBodySpeed_m_s * kMostBodySpeed_m_s / (2.0 * g_m_s2);
  for (std::size_t i = 0; i < readers.size(); ++i) {
    const SceneBody& body = scene.bodies[i];
    if (body.fixed || body.joint || !readers[i].placed()) continue;
    const double fall_m = ground_m - down.dot(body.pose * body.com_m);
    if (!(fall_m > most_m)) continue;
    readers[i].table().fail("position_m",
                            fmt::format("may fall {:.3g} m and arrive at {:.3g} m/s", fall_m,
                                        std::sqrt(2.0 * g_m_s2 * fall_m)),
                            fmt::format("must be at most {:.3g} m above the lowest top of a fixed "
                                        "shape, and above the hand (the "
                                        "origin): contacts are found up to {:.3g} m/s",
                                        most_m, kMostBodySpeed_m_s));
  }
}

}  // namespace

Expected<SceneModel> loadSceneFile(const std::string& path) {
  MeshLoadTime time;
  return loadSceneFile(path, time);
}

std::string madeScenePath(const std::string& urdf) {
  return urdf + ".toml";
}

namespace {

/// @param path its folder is that of the files that it names @param urdf one of these that was read
/// before, or null
Expected<SceneModel> readScene(TomlFile& file, const std::string& path, MeshLoadTime& time,
                               const UrdfBody* urdf) {
  if (!file.readable()) return file.finish();
  TomlTable& root = file.root();
  SceneModel scene;
  scene.path = path;
  scene.name = root.text("name");
  scene.gravity_m_s2 = vectorFrom(root.numbers("gravity_m_s2", 3, between(-30.0, 30.0, "m/s^2")));
  if (const Vector3d& g = scene.gravity_m_s2; g.norm() > 0.0 && g.z() > -0.999 * g.norm()) {
    scene.notices.push_back({path, root.lineOf("gravity_m_s2"), "gravity_m_s2", "",
                             "does not point down: z is up in a scene",
                             "set [0.0, 0.0, -9.81] unless that is meant"});
  }
  scene.hand_friction = root.number("hand_friction", between(0.0, 2.0), scene.hand_friction);

  std::vector<BodyReader> readers;
  for (const TomlTable& table : root.tables("bodies", 0)) {
    readers.emplace_back(table, fs::path(path).parent_path(), time, urdf);
    scene.bodies.push_back(readers.back().read());
  }
  // Checks that involve several bodies.
  if (scene.bodies.size() > std::size_t{kMaxSceneBodies}) {
    root.fail("bodies", fmt::format("there are {} bodies", scene.bodies.size()),
              fmt::format("a scene may have {} at most", kMaxSceneBodies));
  } else {
    reportOverlaps(scene, readers);
    reportFalls(scene, readers);
    reportUnwatched(scene, readers);
  }
  reportSameNames(scene, readers);

  addMovers(scene, readers);
  Diagnostics faults = file.finish();
  for (const BodyReader& reader : readers) {
    faults.insert(faults.end(), reader.urdfFaults().begin(), reader.urdfFaults().end());
    scene.assets.insert(scene.assets.end(), reader.assets().begin(), reader.assets().end());
    for (Diagnostic notice : reader.notices()) {
      if (notice.file.empty()) notice.file = path;
      scene.notices.push_back(std::move(notice));
    }
  }
  if (!faults.empty()) return faults;
  noteHeavyOnLight(scene);
  return scene;
}

/// Names the URDF in place of the scene that was made of it.
void nameUrdf(Diagnostics& diagnostics, const std::string& made, const std::string& path) {
  constexpr std::string_view kBody = "bodies[0]";
  for (Diagnostic& d : diagnostics) {
    if (d.file != made) continue;
    d.file = path;
    d.line = 0;
    if (d.key.starts_with(kBody)) d.key.clear();
  }
}

/// Loads a scene that is made of a URDF.
Expected<SceneModel> loadObject(const std::string& path, MeshLoadTime& time) {
  if (!isPrintable(fs::path(path).filename().string(), kMostName)) {
    return fileFault(path, "has a name with control characters or bytes that are not UTF-8",
                     "rename it");
  }
  const Expected<UrdfBody> urdf = loadUrdf(path, time);
  if (!urdf) return urdf.errors();
  ObjectScene object = makeObjectScene(path, *urdf);
  const std::string made = madeScenePath(path);
  TomlFile file(made, "scene", object.text);
  Expected<SceneModel> scene = readScene(file, made, time, &*urdf);
  if (!scene) {
    Diagnostics faults = scene.errors();
    nameUrdf(faults, made, path);
    return faults;
  }
  nameUrdf(scene->notices, made, path);
  scene->notices.insert(scene->notices.begin(), std::move(object.notice));
  scene->path = path;
  scene->made_text = std::move(object.text);
  return scene;
}

}  // namespace

Expected<SceneModel> loadSceneFile(const std::string& path, MeshLoadTime& time) {
  if (isUrdf(path)) return loadObject(path, time);
  TomlFile file(path, "scene");
  return readScene(file, path, time, nullptr);
}

}  // namespace wholehand
