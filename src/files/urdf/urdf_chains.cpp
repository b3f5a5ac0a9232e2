#include "files/urdf/urdf_chains.hpp"

#include "loop/core/printable.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>

namespace wholehand {
namespace {

constexpr double kLeastRatio = 1e-6;  // a joint with a smaller ratio does not move

int indexOf(const std::vector<LinkedJoint>& joints, const std::string& name) {
  const auto at = std::find_if(joints.begin(), joints.end(),
                               [&](const LinkedJoint& joint) { return joint.name == name; });
  return at == joints.end() ? -1 : static_cast<int>(at - joints.begin());
}

/// Finds the leading joint of one that mimics, through any others between. Returns a remark without
/// a problem when there is one.
JointRemark findLeader(std::vector<LinkedJoint>& joints, int index) {
  LinkedJoint& of = joints[index];
  JointRemark wrong{index, true, of.leader, "", ""};
  double ratio = 1.0, offset = 0.0;
  int at = index;
  for (std::size_t steps = 0; joints[at].mimics; ++steps) {
    const LinkedJoint& one = joints[at];
    offset += ratio * one.offset;
    ratio *= one.ratio;
    const int next = indexOf(joints, one.leader);
    if (next < 0) {
      wrong.problem = "there is no joint of that name";
      wrong.remedy = "name one of the file's joints";
    } else if (steps == joints.size() || next == index) {
      wrong.problem = "follows itself";
      wrong.remedy = "one of the joints must follow none: take its <mimic> out";
    } else if (!joints[next].movable) {
      wrong.problem = "is a joint that does not move";
      wrong.remedy = "make this joint fixed, too, or name one that moves";
    } else if (std::abs(ratio) < kLeastRatio) {
      wrong.problem = fmt::format("moves it by {:g} of its own way", ratio);
      wrong.remedy = "give a multiplier other than 0, or make the joint fixed";
    }
    if (!wrong.problem.empty()) return wrong;
    at = next;
  }
  of.follows = at;
  of.ratio = ratio;
  of.offset = offset;
  return wrong;
}

/// Narrows the leader's range to that of a follower, unless they have no place in common: then the
/// multiplier's sign is not that of the follower's range, and other programs do not apply it.
void narrow(std::vector<LinkedJoint>& joints, int index, JointRemarks& remarks) {
  const LinkedJoint& of = joints[index];
  SceneJoint& leader = *joints[of.follows].joint;
  double least = (of.joint->least - of.offset) / of.ratio;
  double most = (of.joint->most - of.offset) / of.ratio;
  if (of.ratio < 0.0) std::swap(least, most);
  // Values that are rounded in the file differ by less.
  const double rounding = 1e-3 * (most - least);
  if (!(least > leader.least + rounding) && !(most < leader.most - rounding)) return;
  // 0.0 is added to show -0 as 0.
  least = std::max(least, leader.least) + 0.0, most = std::min(most, leader.most) + 0.0;
  const std::string range = fmt::format("{:g} .. {:g}", of.joint->least, of.joint->most);
  if (!(least < most)) {
    remarks.notices.push_back({index, false, range,
                               fmt::format("is not applied: it has no place in common with '{}', "
                                           "which the joint follows",
                                           printable(joints[of.follows].name)),
                               "correct the two <limit>s, or the <mimic>"});
    return;
  }
  remarks.notices.push_back({index, false, range,
                             fmt::format("ends the range of '{}', which it follows: {:g} .. {:g}",
                                         printable(joints[of.follows].name), least, most),
                             "widen its <limit> if the other shall go on"});
  leader.least = least, leader.most = most;
}

/// Refuses joints beyond the number of coordinates that may move each other.
void countCoordinates(const std::vector<LinkedJoint>& joints, JointRemarks& remarks) {
  std::vector<int> first(joints.size());
  std::iota(first.begin(), first.end(), 0);
  const auto root = [&](int joint) {
    while (first[joint] != joint) joint = first[joint];
    return joint;
  };
  for (std::size_t i = 0; i < joints.size(); ++i) {
    for (const int other : {joints[i].carrier, joints[i].follows}) {
      if (other >= 0) first[root(static_cast<int>(i))] = root(other);
    }
  }
  std::vector<std::vector<std::string>> leaders(joints.size());
  std::vector<int> members(joints.size(), 0);
  for (std::size_t i = 0; i < joints.size(); ++i) {
    if (!joints[i].movable) continue;
    const int tree = root(static_cast<int>(i));
    if (++members[tree] == 2) {
      remarks.notices.push_back(
          {static_cast<int>(i), false, "",
           "moves together with other joints: links of one object do not meet "
           "each other",
           "let the joints' ranges end where their links would meet"});
    }
    if (joints[i].mimics) continue;
    std::vector<std::string>& names = leaders[tree];
    names.push_back("'" + printable(joints[i].name) + "'");
    if (names.size() != kMostCoordinates + 1) continue;
    remarks.faults.push_back({static_cast<int>(i), false, "",
                              fmt::format("is one of more than {} that move each other: {}",
                                          kMostCoordinates, fmt::join(names, ", ")),
                              "make one of them fixed, or let it follow another one by a <mimic>"});
  }
}

}  // namespace

JointRemarks linkJoints(std::vector<LinkedJoint>& joints) {
  JointRemarks remarks;
  const std::vector<LinkedJoint> as_read = joints;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    if (!joints[i].mimics) continue;
    std::vector<LinkedJoint> from = as_read;
    JointRemark wrong = findLeader(from, static_cast<int>(i));
    joints[i] = from[i];
    if (!wrong.problem.empty()) remarks.faults.push_back(std::move(wrong));
  }
  if (!remarks.faults.empty()) return remarks;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    if (joints[i].mimics) narrow(joints, static_cast<int>(i), remarks);
  }
  countCoordinates(joints, remarks);
  return remarks;
}

}  // namespace wholehand
