#include "model/hand/hand_file.hpp"

#include "model/hand/anthropometry.hpp"
#include "model/hand/self_contacts.hpp"
#include "model/toml/toml_file.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <utility>

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
    // As everywhere, the key states the unit; coordinates of a hand are angles.
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
  // From an infant's to the largest hand on record: beyond it, the unit is wrong.
  hand.length_m = root.number("length_m", between(0.05, 0.35, "m"));
  hand.breadth_m = root.number("breadth_m", between(0.02, 0.20, "m"));
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

}  // namespace wholehand
