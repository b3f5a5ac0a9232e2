#include "files/hand/hand_file.hpp"

#include "files/hand/anthropometry.hpp"
#include "files/hand/self_contacts.hpp"
#include "files/toml/toml_file.hpp"
#include "loop/core/printable.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

namespace wholehand {

namespace {

const NumberRule kAngle = between(-std::numbers::pi, std::numbers::pi, "rad");

/// `[joints]`: every joint of a hand, by name, with its range and rest.
void readJoints(TomlTable& root, HandFile& hand) {
  TomlTable joints = root.table("joints");
  for (const std::string& name : handJointNames()) {
    TomlTable table = joints.table(name);
    JointRange joint;
    joint.joint = name;
    const std::array<double, 2> range = table.interval("range_rad", kAngle);
    joint.lower_rad = range[0];
    joint.upper_rad = range[1];
    joint.rest_rad = table.number("rest_rad", kAngle);
    joint.offset_rad = table.number("offset_rad", kAngle, 0.0);
    const auto check = [&](const char* key, double value) {
      if (!table.isGood("range_rad") || !table.isGood(key)) return;
      if (value < range[0] || value > range[1]) {
        table.fail(key, "is outside the joint's own range",
                   between(range[0], range[1], "rad").remedy());
      }
    };
    check("rest_rad", joint.rest_rad);
    check("offset_rad", joint.offset_rad);
    hand.joints.push_back(joint);
  }
}

/// `[synergy.<coordinate>]`: joint = ratio.
void readSynergy(TomlTable& root, HandFile& hand) {
  TomlTable synergy = root.table("synergy");
  const std::vector<std::string>& known = handJointNames();
  std::vector<std::pair<std::string, TomlTable>> coordinates;
  std::vector<std::string> used;
  for (const std::string& coordinate : synergy.keys()) {
    coordinates.emplace_back(coordinate, synergy.table(coordinate));
    for (std::string& joint : coordinates.back().second.keys()) used.push_back(std::move(joint));
  }
  for (auto& [coordinate, terms] : coordinates) {
    for (const std::string& joint : terms.keys()) {
      const double ratio = terms.number(joint, between(-10.0, 10.0, "rad per unit"));
      if (std::find(known.begin(), known.end(), joint) == known.end()) {
        const std::string near = nearestUnused(joint, known, used);
        terms.fail(joint, "is not a joint of a hand",
                   near.empty() ? "remove it" : "did you mean " + near + "?");
      } else if (terms.isGood(joint) && ratio == 0.0) {
        terms.fail(joint, "drives nothing", "write a ratio other than 0, or remove it");
      }
      hand.synergy.push_back({joint, coordinate, ratio});
    }
  }
}

/// `[reference]`: coordinate = position.
void readReference(TomlTable& root, HandFile& hand) {
  std::optional<TomlTable> reference = root.optionalTable("reference");
  if (!reference) return;
  for (const std::string& key : reference->keys()) {
    // The key ends in the unit. Coordinates of a hand are angles.
    constexpr std::string_view kUnit = "_rad";
    const double value = reference->number(key, kAngle);
    if (!key.ends_with(kUnit)) {
      reference->fail(key, "has no unit", "write " + key + "_rad");
      continue;
    }
    const std::string coordinate = key.substr(0, key.size() - kUnit.size());
    const bool known =
        std::any_of(hand.synergy.begin(), hand.synergy.end(),
                    [&](const SynergyTerm& term) { return term.coordinate == coordinate; });
    if (!known) {
      reference->fail(key, "is not a coordinate of [synergy]", "remove it or add the coordinate");
    }
    hand.reference.emplace_back(coordinate, value);
  }
}

/// `mirror_of`: everything except the name comes from another file of the folder and is mirrored.
Expected<HandFile> loadMirrored(TomlFile& file, const std::string& path) {
  TomlTable& root = file.root();
  const std::string name = root.text("name");
  const std::string other = root.text("mirror_of");
  if (root.isGood("mirror_of") && other.find_first_of("/\\") != std::string::npos) {
    root.fail("mirror_of", "names no file of this folder",
              "write its name without folder and .toml");
  }
  if (Diagnostics faults = file.finish(); !faults.empty()) return faults;
  const std::string other_path =
      (std::filesystem::path(path).parent_path() / (other + ".toml")).string();
  TomlFile chain(other_path, "hand");
  if (chain.readable() && chain.root().has("mirror_of")) {
    return Diagnostic{path,
                      root.lineOf("mirror_of"),
                      "mirror_of",
                      other,
                      "is itself a mirror image of another hand",
                      "name the file that has the sizes"};
  }
  Expected<HandFile> hand = loadHandFile(other_path);
  if (!hand) {
    Diagnostics faults = hand.errors();
    faults.push_back({path, root.lineOf("mirror_of"), "mirror_of", other, "cannot be read",
                      "correct that file, or name another of the folder"});
    return faults;
  }
  hand->path = path;
  hand->mirrored_path = other_path;
  hand->name = name;
  hand->side = hand->side == Side::kRight ? Side::kLeft : Side::kRight;
  return hand;
}

}  // namespace

Expected<HandFile> loadHandFile(const std::string& path) {
  TomlFile file(path, "hand");
  if (!file.readable()) return file.finish();
  TomlTable& root = file.root();
  if (root.has("mirror_of")) return loadMirrored(file, path);
  HandFile hand;
  hand.path = path;
  hand.name = root.text("name");
  hand.side = root.choice("side", {"right", "left"}) == "left" ? Side::kLeft : Side::kRight;
  // From an infant's hand to the largest on record. Values outside have the wrong unit.
  hand.length_m = root.number("length_m", between(0.05, 0.35, "m"));
  hand.breadth_m = root.number("breadth_m", between(0.02, 0.20, "m"));
  if (root.isGood("length_m") && root.isGood("breadth_m") && hand.breadth_m >= hand.length_m) {
    root.fail("breadth_m", "is not less than length_m",
              "a hand is longer than broad: exchange the two if they are mixed up");
  }
  hand.mass_kg = root.number("mass_kg", between(0.01, 5.0, "kg"));
  readJoints(root, hand);
  readSynergy(root, hand);
  readReference(root, hand);
  readSelfContacts(root, hand);
  if (Diagnostics faults = file.finish(); !faults.empty()) return faults;
  if (Diagnostics faults = checkSelfContacts(hand); !faults.empty()) {
    return firstFaults(std::move(faults), path);
  }
  return hand;
}

namespace {

using Eigen::AngleAxisd;
using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Base links are not part of the hand's mass, but an engine needs more than zero.
constexpr double kCarrierMass_kg = 1e-6;
constexpr double kCarrierInertia_kg_m2 = 1e-9;
/// Keeps the palm's mass and inertia accurate to one per cent.
constexpr double kPalmGrid_m = 2e-3;

/// Builds a hand model from a hand file and a device.
class LinkBuilder {
 public:
  LinkBuilder(const HandFile& hand, const DeviceModel& device) : hand_(hand), device_(device) {}

  HandModel build() {
    model_.name = hand_.name;
    model_.side = hand_.side;
    addBase();
    addPalm();
    addFingers();
    addThumb();
    if (hand_.side == Side::kLeft) mirror();
    scaleMass();
    return std::move(model_);
  }

 private:
  [[nodiscard]] bool isDriven(const std::string& joint) const {
    return std::any_of(hand_.synergy.begin(), hand_.synergy.end(), [&](const SynergyTerm& term) {
      return term.joint == joint && handAxisIndex(device_, term.coordinate) >= 0;
    });
  }

  /// Orientation of the palm in the world; the mirror image in y for a left hand.
  [[nodiscard]] Matrix3d mount() const {
    const double flip = hand_.side == Side::kLeft ? -1.0 : 1.0;
    return (AngleAxisd(flip * device_.mount_yaw_rad, Vector3d::UnitZ()) *
            AngleAxisd(device_.mount_pitch_rad, Vector3d::UnitY()) *
            AngleAxisd(flip * device_.mount_roll_rad, Vector3d::UnitX()))
        .toRotationMatrix();
  }

  int addLink(HandLink link) {
    link.joint = -1;
    if (link.type != JointType::kFixed) {
      link.joint = model_.joint_count++;
      model_.joint_names.push_back(link.name);
    }
    model_.links.push_back(std::move(link));
    return static_cast<int>(model_.links.size()) - 1;
  }

  void addBaseLink(const DeviceAxis& axis, JointType type, const Vector3d& direction,
                   const Matrix3d& rotation) {
    HandLink link;
    link.name = axis.name;
    link.parent = static_cast<int>(model_.links.size()) - 1;
    link.type = type;
    link.parent_to_link.rotation = rotation;
    link.axis = rotation.transpose() * direction;
    link.lower = axis.lower;
    link.upper = axis.upper;
    link.mass_kg = kCarrierMass_kg;
    link.inertia_kg_m2 = kCarrierInertia_kg_m2 * Matrix3d::Identity();
    addLink(std::move(link));
  }

  /// Adds the device's base axes: x, y, z along the world's axes, then roll, pitch, yaw about the
  /// hand's x, y, z. The mount orientation applies to the first link that has the hand's frame: the
  /// first rotation, or the last translation if the device has no rotation.
  void addBase() {
    static const std::array<const char*, 3> kTranslations = {"x", "y", "z"};
    static const std::array<const char*, 3> kRotations = {"roll", "pitch", "yaw"};
    std::vector<int> moves;
    for (const char* name : kTranslations) {
      if (device_.axisIndex(name) >= 0) moves.push_back(device_.axisIndex(name));
    }
    bool turned = false;
    const bool turns = std::any_of(kRotations.begin(), kRotations.end(),
                                   [&](const char* n) { return device_.axisIndex(n) >= 0; });
    for (std::size_t i = 0; i < moves.size(); ++i) {
      const DeviceAxis& axis = device_.axes[moves[i]];
      const bool carries_mount = !turns && i + 1 == moves.size();
      turned = turned || carries_mount;
      addBaseLink(axis, JointType::kPrismatic, Vector3d::Unit(axis.name[0] - 'x'),
                  carries_mount ? mount() : Matrix3d::Identity());
    }
    for (int k = 0; k < 3; ++k) {
      const int i = device_.axisIndex(kRotations[k]);
      if (i < 0) continue;
      const Matrix3d rotation = turned ? Matrix3d::Identity() : mount();
      turned = true;
      // The axis is given in the link frame, whose orientation at zero is `rotation`.
      addBaseLink(device_.axes[i], JointType::kRevolute, rotation * Vector3d::Unit(k), rotation);
    }
    if (!turned) {  // a glove: no base axis
      HandLink link;
      link.name = "palm";
      link.parent_to_link.rotation = mount();
      addLink(std::move(link));
    }
    model_.palm_link = static_cast<int>(model_.links.size()) - 1;
  }

  void addCapsule(const PlacedCapsule& placed, int link) {
    model_.capsules.push_back(
        {placed.name, placed.part, link, placed.a_m, placed.b_m, placed.radius_m});
  }

  static void setMass(HandLink& link, const MassProperties& mass) {
    link.mass_kg = mass.mass_kg;
    link.com_m = mass.com_m;
    link.inertia_kg_m2 = mass.inertia_kg_m2;
  }

  void addPalm() {
    const std::vector<PlacedCapsule> palm = palmCapsules(size_);
    for (const PlacedCapsule& placed : palm) addCapsule(placed, model_.palm_link);
    setMass(model_.links[model_.palm_link], unionMass(palm, kHandDensity_kg_m3, kPalmGrid_m));
  }

  /// Adds a hinge of the hand. A hinge without a driving axis is locked at rest; its rest angle
  /// becomes part of the placement.
  int addHinge(const std::string& name, int parent, const Vector3d& axis, const Pose& placement) {
    const JointRange& joint = *findJoint(hand_, name);
    HandLink link;
    link.name = name;
    link.parent = parent;
    link.axis = axis;
    link.parent_to_link = placement;
    link.lower = joint.lower_rad;
    link.upper = joint.upper_rad;
    if (isDriven(name)) {
      link.type = JointType::kRevolute;
    } else {
      link.parent_to_link.rotation =
          placement.rotation * AngleAxisd(joint.rest_rad, axis).toRotationMatrix();
    }
    return addLink(std::move(link));
  }

  /// Adds the three segments of a digit along x. Each turns about `axis` in its own frame.
  /// @return the link of the first segment
  int addSegments(const Digit& digit, int parent, Pose placement, const Vector3d& axis) {
    int first = -1;
    for (std::size_t k = 0; k < digit.joints.size(); ++k) {
      parent = addHinge(digit.joints[k], parent, axis, placement);
      if (k == 0) first = parent;
      const PlacedCapsule segment = {digit.name + "_" + digit.segments[k],
                                     digit.part,
                                     Vector3d::Zero(),
                                     {digit.segment_m[k], 0.0, 0.0},
                                     digit.radius_m[k]};
      addCapsule(segment, parent);
      setMass(model_.links[parent],
              capsuleMass(segment.a_m, segment.b_m, segment.radius_m, kHandDensity_kg_m3));
      placement = Pose{};
      placement.translation_m = Vector3d(digit.joint_to_joint_m[k], 0.0, 0.0);
    }
    return first;
  }

  void addFingers() {
    const std::array<Digit, 4> digits = fingers(size_);
    const std::array<PlacedCapsule, 3> webs = fingerWebs(size_);
    for (std::size_t i = 0; i < digits.size(); ++i) {
      Pose base;
      base.translation_m = digits[i].base_m;
      base.rotation = (AngleAxisd(digits[i].abduction_rad, Vector3d::UnitZ()) *
                       AngleAxisd(digits[i].tilt_rad, Vector3d::UnitX()))
                          .toRotationMatrix();
      // Turning about +y (radial) takes x (distal) to -z (palmar): flexion is positive.
      const int first = addSegments(digits[i], model_.palm_link, base, Vector3d::UnitY());
      if (i < webs.size()) addCapsule(webs[i], first);
    }
  }

  void addThumb() {
    const Digit digit = thumb(size_);
    Pose base;
    base.translation_m = digit.base_m;
    base.rotation = AngleAxisd(thumbRestCircumduction(), -Vector3d::UnitX()).toRotationMatrix();
    const int carrier = addHinge("thumb_circumduction", model_.palm_link, -Vector3d::UnitX(), base);
    const PlacedCapsule thenar = thenarCapsule(size_);
    addCapsule(thenar, carrier);
    setMass(model_.links[carrier],
            capsuleMass(thenar.a_m, thenar.b_m, thenar.radius_m, kHandDensity_kg_m3));
    Pose pointing;
    pointing.rotation = AngleAxisd(thumbPointing(), Vector3d::UnitZ()).toRotationMatrix();
    addSegments(digit, carrier, pointing, -Vector3d::UnitZ());
  }

  /// Mirrors the palm and every link after it in y; the device's links stay unchanged. A rotation
  /// axis is a pseudo-vector, so mirroring also reverses its sign.
  void mirror() {
    const Vector3d flip(1.0, -1.0, 1.0);
    const auto s = flip.asDiagonal();
    for (std::size_t i = 0; i < model_.links.size(); ++i) {
      HandLink& link = model_.links[i];
      if (static_cast<int>(i) > model_.palm_link) {
        link.parent_to_link.rotation = s * link.parent_to_link.rotation * s;
        link.parent_to_link.translation_m = s * link.parent_to_link.translation_m;
        link.axis = -(s * link.axis);
      }
      link.com_m = s * link.com_m;
      link.inertia_kg_m2 = s * link.inertia_kg_m2 * s;
    }
    for (Capsule& capsule : model_.capsules) {
      capsule.a_m = s * capsule.a_m;
      capsule.b_m = s * capsule.b_m;
    }
  }

  /// Scales all links of the hand by one factor to the file's mass; base links stay unchanged.
  void scaleMass() {
    const std::size_t palm = model_.palm_link;
    double carriers_kg = 0.0;
    double hand_kg = 0.0;
    for (std::size_t i = 0; i < model_.links.size(); ++i) {
      (i < palm ? carriers_kg : hand_kg) += model_.links[i].mass_kg;
    }
    const double scale = (hand_.mass_kg - carriers_kg) / hand_kg;
    for (std::size_t i = palm; i < model_.links.size(); ++i) {
      model_.links[i].mass_kg *= scale;
      model_.links[i].inertia_kg_m2 *= scale;
    }
    model_.total_mass_kg = hand_.mass_kg;
  }

  const HandFile& hand_;
  const DeviceModel& device_;
  const Proportions size_ = proportions(hand_.length_m, hand_.breadth_m);
  HandModel model_;
};

/// Slack of the range check: numbers in files are rounded.
constexpr double kRangeSlack_rad = 1e-6;

/// Combines a hand file with a device.
class Assembly {
 public:
  Assembly(const HandFile& hand, const DeviceModel& device) : hand_(hand), device_(device) {}

  Expected<HandModel> build() {
    checkAxes();
    if (!faults_.empty()) return firstFaults(std::move(faults_), hand_.path);
    model_ = buildLinks(hand_, device_);
    model_.axis_count = device_.axisCount();
    for (const DeviceAxis& axis : device_.axes) model_.axis_names.push_back(axis.name);
    addSynergy();
    setTravel();
    setReference();
    checkRanges();
    addSelfContacts(hand_, model_, faults_);
    if (!faults_.empty()) return firstFaults(std::move(faults_), hand_.path);
    return std::move(model_);
  }

 private:
  void fail(const std::string& file, std::string key, std::string problem, std::string remedy) {
    faults_.push_back({file, 0, std::move(key), "", std::move(problem), std::move(remedy)});
  }

  [[nodiscard]] bool drives(const DeviceAxis& axis) const {
    if (axis.group == AxisGroup::kBase) return true;  // the loader has checked the six names
    return std::any_of(hand_.synergy.begin(), hand_.synergy.end(),
                       [&](const SynergyTerm& term) { return term.coordinate == axis.name; });
  }

  void checkAxes() {
    for (const DeviceAxis& axis : device_.axes) {
      if (drives(axis)) continue;
      fail(device_.path, "axes[" + axis.name + "]",
           "drives nothing of the hand " + printable(hand_.path),
           "add [synergy." + axis.name + "] to the hand file, or remove the axis");
    }
    const std::vector<std::string>& names = handJointNames();
    for (const SynergyTerm& term : hand_.synergy) {
      if (std::find(names.begin(), names.end(), term.joint) != names.end()) continue;
      fail(hand_.path, "synergy." + term.coordinate + "." + term.joint, "is not a joint of a hand",
           "remove it");
    }
    for (const std::string& name : names) {
      if (findJoint(hand_, name) == nullptr) {
        fail(hand_.path, "joints." + name, "is missing", "give the joint its range and rest");
      }
    }
  }

  void addSynergy() {
    model_.theta0 = JointPosition(model_.joint_count);
    model_.synergy = JointAxisMatrix::Zero(model_.joint_count, model_.axis_count);
    for (int j = 0; j < model_.joint_count; ++j) {
      const std::string& name = model_.joint_names[j];
      if (const JointRange* joint = findJoint(hand_, name)) model_.theta0[j] = joint->offset_rad;
      const int axis = device_.axisIndex(name);
      if (axis >= 0 && device_.axes[axis].group == AxisGroup::kBase) {
        model_.synergy(j, axis) = 1.0;
      }
      for (const SynergyTerm& term : hand_.synergy) {
        const int driver = handAxisIndex(device_, term.coordinate);
        if (term.joint == name && driver >= 0) model_.synergy(j, driver) += term.ratio;
      }
    }
  }

  void setTravel() {
    model_.axis_lower = model_.axis_upper = AxisPosition(model_.axis_count);
    for (int i = 0; i < model_.axis_count; ++i) {
      model_.axis_lower[i] = device_.axes[i].lower;
      model_.axis_upper[i] = device_.axes[i].upper;
    }
  }

  void setReference() {
    model_.reference = AxisPosition(model_.axis_count);
    for (int i = 0; i < model_.axis_count; ++i) {
      const DeviceAxis& axis = device_.axes[i];
      double value = 0.0;
      for (const auto& [coordinate, position] : hand_.reference) {
        if (coordinate == axis.name) value = position;
      }
      model_.reference[i] = std::clamp(value, axis.lower, axis.upper);
    }
  }

  /// The device's whole range must stay within the range of every driven joint.
  void checkRanges() {
    for (int j = 0; j < model_.joint_count; ++j) {
      const JointRange* joint = findJoint(hand_, model_.joint_names[j]);
      if (joint == nullptr) continue;
      double low = model_.theta0[j];
      double high = low;
      for (int i = 0; i < model_.axis_count; ++i) {
        const DeviceAxis& axis = device_.axes[i];
        const double g = model_.synergy(j, i);
        low += std::min(g * axis.lower, g * axis.upper);
        high += std::max(g * axis.lower, g * axis.upper);
      }
      if (low >= joint->lower_rad - kRangeSlack_rad && high <= joint->upper_rad + kRangeSlack_rad) {
        continue;
      }
      fail(hand_.path, "joints." + joint->joint + ".range_rad",
           "is exceeded when the device " + printable(device_.path) + " moves through its range",
           fmt::format("the joint goes through [{:.5g}, {:.5g}] rad: widen its range or lower its "
                       "ratio in [synergy]",
                       low, high));
    }
  }

  const HandFile& hand_;
  const DeviceModel& device_;
  HandModel model_;
  Diagnostics faults_;
};

}  // namespace

int handAxisIndex(const DeviceModel& device, const std::string& name) {
  const int i = device.axisIndex(name);
  const bool found = i >= 0 && device.axes[i].group == AxisGroup::kHand;
  return found ? i : -1;
}

const JointRange* findJoint(const HandFile& hand, const std::string& joint) {
  const auto found = std::find_if(hand.joints.begin(), hand.joints.end(),
                                  [&](const JointRange& r) { return r.joint == joint; });
  return found == hand.joints.end() ? nullptr : &*found;
}

HandModel buildLinks(const HandFile& hand, const DeviceModel& device) {
  return LinkBuilder(hand, device).build();
}

Expected<HandModel> assembleHand(const HandFile& hand, const DeviceModel& device) {
  return Assembly(hand, device).build();
}

}  // namespace wholehand
