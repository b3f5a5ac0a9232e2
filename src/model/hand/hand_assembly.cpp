#include "core/printable.hpp"
#include "model/hand/anthropometry.hpp"
#include "model/hand/hand_file.hpp"
#include "model/hand/hand_links.hpp"
#include "model/hand/self_contacts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

namespace wholehand {
namespace {

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

Expected<HandModel> assembleHand(const HandFile& hand, const DeviceModel& device) {
  return Assembly(hand, device).build();
}

}  // namespace wholehand
