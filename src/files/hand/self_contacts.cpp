#include "files/hand/self_contacts.hpp"

#include "files/hand/anthropometry.hpp"
#include "files/hand/hand_file.hpp"
#include "loop/model/capsule_gap.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace wholehand {
namespace {

int capsuleIndex(const HandModel& model, const std::string& name) {
  const auto found = std::find_if(model.capsules.begin(), model.capsules.end(),
                                  [&](const Capsule& c) { return c.name == name; });
  return found == model.capsules.end() ? -1 : static_cast<int>(found - model.capsules.begin());
}

/// The poses of all links [world].
std::vector<Pose> linkPoses(const HandModel& model, const JointPosition& theta) {
  std::vector<Pose> poses;
  for (const HandLink& link : model.links) {
    Pose at = link.parent < 0 ? link.parent_to_link : poses[link.parent] * link.parent_to_link;
    if (link.type == JointType::kRevolute) {
      at.rotation = at.rotation * Eigen::AngleAxisd(theta[link.joint], link.axis);
    } else if (link.type == JointType::kPrismatic) {
      at.translation_m += at.rotation * (theta[link.joint] * link.axis);
    }
    poses.push_back(at);
  }
  return poses;
}

PlacedSegment placed(const HandModel& model, const std::vector<Pose>& poses, int capsule) {
  const Capsule& c = model.capsules[capsule];
  const Pose& at = poses[c.link];
  return {at * c.a_m, at * c.b_m, c.radius_m};
}

/// The nearest link at or above `link` that has a movable joint; -1: the world.
int movingLink(const HandModel& model, int link) {
  while (link >= 0 && model.links[link].type == JointType::kFixed) {
    link = model.links[link].parent;
  }
  return link;
}

bool ofOneLink(const HandModel& model, const SelfPair& pair) {
  const auto link = [&](int capsule) { return movingLink(model, model.capsules[capsule].link); };
  return link(pair.capsule_a) == link(pair.capsule_b);
}

Diagnostic faultOf(const HandFile& hand, const SelfContactEntry& entry, std::string problem,
                   std::string remedy) {
  return {hand.path,   entry.line,         "self_contacts." + entry.capsule,
          entry.other, std::move(problem), std::move(remedy)};
}

Diagnostic overlapFault(const HandFile& hand, const SelfContactEntry& entry, double depth_m) {
  return faultOf(
      hand, entry,
      fmt::format("overlaps {} by {:.1f} mm in the reference posture", entry.capsule,
                  depth_m * 1e3),
      "remove " + entry.other + " from " + entry.capsule + ", or open the hand in [reference]");
}

SelfPair pairOf(const HandModel& model, const SelfContactEntry& entry) {
  return {capsuleIndex(model, entry.capsule), capsuleIndex(model, entry.other)};
}

double depth(const HandModel& model, const std::vector<Pose>& poses, const SelfPair& pair) {
  return -capsuleGap(placed(model, poses, pair.capsule_a), placed(model, poses, pair.capsule_b))
              .distance_m;
}

/// A device that drives every coordinate of the file and carries nothing.
DeviceModel everyCoordinate(const HandFile& hand) {
  DeviceModel device;
  for (const SynergyTerm& term : hand.synergy) {
    if (device.axisIndex(term.coordinate) >= 0) continue;
    DeviceAxis axis;
    axis.name = term.coordinate;
    axis.group = AxisGroup::kHand;
    device.axes.push_back(axis);
  }
  return device;
}

/// θ₀ + G q_ref as the file states them.
JointPosition referenceOf(const HandFile& hand, const HandModel& model) {
  JointPosition theta(model.joint_count);
  for (int j = 0; j < model.joint_count; ++j) {
    const std::string& name = model.joint_names[j];
    if (const JointRange* joint = findJoint(hand, name)) theta[j] = joint->offset_rad;
    for (const SynergyTerm& term : hand.synergy) {
      if (term.joint != name) continue;
      for (const auto& [coordinate, position] : hand.reference) {
        if (coordinate == term.coordinate) theta[j] += term.ratio * position;
      }
    }
  }
  return theta;
}

}  // namespace

void readSelfContacts(TomlTable& root, HandFile& hand) {
  std::optional<TomlTable> table = root.optionalTable("self_contacts");
  if (!table) return;
  const std::vector<std::string>& known = handCapsuleNames();
  const auto check = [&](const std::string& key, const std::string& name) {
    if (std::find(known.begin(), known.end(), name) != known.end()) return true;
    const std::string near = nearestWord(name, known);
    table->fail(key, "names " + name + ", which is not a capsule of a hand",
                near.empty() ? "remove it" : "did you mean " + near + "?");
    return false;
  };
  for (const std::string& capsule : table->keys()) {
    const std::vector<std::string> others = table->texts(capsule);
    if (!check(capsule, capsule)) continue;
    for (const std::string& other : others) {
      if (!check(capsule, other)) continue;
      const auto same = [&](const SelfContactEntry& e) {
        return (e.capsule == capsule && e.other == other) ||
               (e.capsule == other && e.other == capsule);
      };
      if (other == capsule) {
        table->fail(capsule, "lists itself", "remove " + other + " from its own list");
      } else if (std::any_of(hand.self_contacts.begin(), hand.self_contacts.end(), same)) {
        table->fail(capsule, "lists the pair with " + other + " a second time",
                    "remove " + other + " here: a pair counts for both");
      } else {
        hand.self_contacts.push_back({capsule, other, table->lineOf(capsule)});
      }
    }
  }
}

Diagnostics checkSelfContacts(const HandFile& hand) {
  Diagnostics faults;
  if (hand.self_contacts.empty()) return faults;
  const HandModel model = buildLinks(hand, everyCoordinate(hand));
  const std::vector<Pose> poses = linkPoses(model, referenceOf(hand, model));
  for (const SelfContactEntry& entry : hand.self_contacts) {
    const SelfPair pair = pairOf(model, entry);
    if (ofOneLink(model, pair)) {
      faults.push_back(faultOf(hand, entry, "is part of the same rigid link as " + entry.capsule,
                               "remove it: the two never move against each other"));
      continue;
    }
    const double depth_m = depth(model, poses, pair);
    if (depth_m > 0.0) faults.push_back(overlapFault(hand, entry, depth_m));
  }
  return faults;
}

void addSelfContacts(const HandFile& hand, HandModel& model, Diagnostics& faults) {
  if (hand.self_contacts.empty()) return;
  JointPosition theta = model.theta0;
  for (int j = 0; j < model.joint_count; ++j) {
    for (int a = 0; a < model.axis_count; ++a) theta[j] += model.synergy(j, a) * model.reference[a];
  }
  const std::vector<Pose> poses = linkPoses(model, theta);
  for (const SelfContactEntry& entry : hand.self_contacts) {
    const SelfPair pair = pairOf(model, entry);
    if (ofOneLink(model, pair)) continue;  // the joints between are locked with this device
    const double depth_m = depth(model, poses, pair);
    if (depth_m > 0.0) faults.push_back(overlapFault(hand, entry, depth_m));
    model.self_contacts.push_back(pair);
  }
}

}  // namespace wholehand
