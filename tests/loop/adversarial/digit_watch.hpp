#pragma once

#include "loop/physics/segment_distance.hpp"
#include "support/rig_tools.hpp"

#include <cmath>

/// Measures, from the tick records, the exercise's effort on digits that touch nothing.
namespace wholehand::test {

/// Finds the capsules that an axis moves relative to the palm, by moving that axis.
inline std::vector<bool> movedCapsules(const HandModel& hand, int axis) {
  AxisPosition open(hand.axis_count), closed(hand.axis_count);
  open[axis] = hand.axis_lower[axis];
  closed[axis] = 0.5 * (hand.axis_lower[axis] + hand.axis_upper[axis]);
  const ArticulatedBody a = handAt(hand, open), b = handAt(hand, closed);
  std::vector<bool> moved;
  for (const Capsule& c : hand.capsules) {
    moved.push_back((a.linkPose(c.link) * c.b_m - b.linkPose(c.link) * c.b_m).norm() > 1e-6);
  }
  return moved;
}

/// Largest efforts of the exercise on untouched digits, as shares of the axis's effort limit.
struct UntouchedEffort {
  /// Effort on a digit that has touched nothing since the exercise's effort began, less the effort
  /// that its own closing since then explains.
  double unasked = 0.0;
  /// Effort on a digit that has been past its first touch (or whose first touch is unknown) for
  /// longer than a light touch takes to let go, and that has touched nothing until the effort of a
  /// grasp has faded.
  double past = 0.0;
  /// Effort on a digit that has touched nothing for that long, less what the lead-in and the
  /// digit's lag behind the device explain.
  double beyond_lead_in = 0.0;
  int digits_past = 0;  ///< number of times that `past` was measured with α > 0
};

class DigitWatch {
 public:
  explicit DigitWatch(const Rig& rig) : rig_(rig) {
    for (const ExerciseWall& wall : rig.models.exercise_walls) {
      digits_.push_back({wall, movedCapsules(rig.models.hand, wall.axis)});
    }
    for (const LiveParameter& p : rig.models.exercise->description().parameters) {
      if (p.name == "lead_in_m") lead_in_m_ = p.value;
    }
  }

  /// Checks a tick. A stop ends the watch, since the effort then falls to neutral whatever the
  /// exercise gives.
  void onRecord(const TickRecord& r) {
    stopped_ = stopped_ || any(r.faults & kStoppingFaults);
    if (stopped_) return;
    for (Digit& digit : digits_) look(digit, r);
  }
  [[nodiscard]] const UntouchedEffort& found() const { return found_; }

 private:
  static constexpr int kFaded = 650,
                       kLetGo = 40;           // [ticks] a grasp that is let go of at its firmest
  static constexpr double kSlack_m = 1.5e-3;  // tolerance of a touch along the fingertip's path

  struct Digit {
    ExerciseWall wall;
    std::vector<bool> capsules;
    int untouched = kFaded + 1, past = 0;  // [ticks]
    bool touched = false;                  // since α rose above 0
    double lowest = 0.0;                   // lowest position since then
  };

  /// True where the digit presses on something or is inside the drawn surface of a soft body.
  bool touches(const Digit& digit, const TickRecord& r) const {
    return insideSoftBody(digit, r) ||
           std::any_of(
               r.contacts.begin(), r.contacts.begin() + r.contact_count, [&](const Contact& c) {
                 return digit.capsules[c.capsule] && c.force_n.eigen().dot(c.normal.eigen()) > 0.0;
               });
  }

  bool insideSoftBody(const Digit& digit, const TickRecord& r) const {
    if (!(r.exercise.effort[digit.wall.axis] < 0.0)) return false;  // no effort to judge
    const ArticulatedBody at = handAt(rig_.models.hand, r.q_s);
    const std::vector<SceneBody>& bodies = rig_.models.scene.bodies;
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      if (!(bodies[b].soft_m > 0.0)) continue;
      const Eigen::Matrix3d turn = r.bodies[b].orientation_xyzw.eigen().toRotationMatrix();
      const Pose in_world{turn, r.bodies[b].position_m.eigen() - turn * bodies[b].com_m};
      for (std::size_t i = 0; i < digit.capsules.size(); ++i) {
        if (!digit.capsules[i]) continue;
        const Capsule& c = rig_.models.hand.capsules[i];
        const Pose link = in_world.inverse() * at.linkPose(c.link);
        const SegmentDistance gap =
            segmentDistance(bodies[b].shapes[0], link * c.a_m, link * c.b_m, c.radius_m, 0.0);
        if (gap.distance_m < 0.0) return true;
      }
    }
    return false;
  }

  void look(Digit& digit, const TickRecord& r) {
    const int a = digit.wall.axis;
    const DeviceAxis& axis = rig_.models.device.axes[a];
    const double limit = axis.effort_limit;
    const double push = -r.exercise.effort[a];  // closing raises the coordinate
    const double damped = digit.wall.damping * std::max(0.0, r.qd_mf[a]);
    const bool touch = touches(digit, r);
    digit.untouched = touch ? 0 : digit.untouched + 1;
    const bool felt = r.exercise.alpha > 0.0;
    digit.touched = felt && (digit.touched || touch);
    digit.lowest = felt ? std::min(digit.lowest, r.q_m[a]) : r.q_m[a];
    const bool known = std::isfinite(r.closure[a]);
    const bool past = !known || r.q_s[a] > r.closure[a] + kSlack_m / axis.lever_arm_m;
    digit.past = past ? digit.past + 1 : 0;

    if (!digit.touched) {
      const double own = digit.wall.stiffness * (r.q_m[a] - digit.lowest) + damped;
      found_.unasked = std::max(found_.unasked, (push - own) / limit);
    }
    if (digit.untouched <= kFaded) return;
    // The wall acts on the device; a digit that closes fast follows it and touches some ms later.
    const double lag = std::max(0.0, r.q_m[a] - r.q_s[a]);
    const double lead_in = digit.wall.stiffness * (lead_in_m_ / axis.lever_arm_m + lag) + damped;
    found_.beyond_lead_in = std::max(found_.beyond_lead_in, (push - lead_in) / limit);
    if (digit.past <= kLetGo || !felt) return;
    found_.past = std::max(found_.past, push / limit);
    if (digit.past == kLetGo + 1) ++found_.digits_past;
  }

  const Rig& rig_;
  std::vector<Digit> digits_;
  double lead_in_m_ = 0.0;
  bool stopped_ = false;
  UntouchedEffort found_;
};

}  // namespace wholehand::test
