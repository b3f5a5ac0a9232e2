#pragma once

#include "files/hand/hand_file.hpp"
#include "loop/dynamics/articulated_body.hpp"
#include "loop/dynamics/synergy.hpp"
#include "rig/engines.hpp"
#include "rig/models.hpp"
#include "rig/rig.hpp"
#include "support/ball_shape.hpp"
#include "support/figure.hpp"
#include "support/resting_device.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <functional>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

/// Whole rigs for tests: shipped files, scenes built by tests, scripted devices, printed figures.
namespace wholehand::test {

inline ModelFiles shippedFiles(const std::string& device = "lambda-pride",
                               const std::string& scene = "empty",
                               const std::string& hand = "adult-median-right",
                               const std::string& patient = "relaxed-adult") {
  const std::string config = std::string(WHOLEHAND_SOURCE_DIR) + "/config/";
  ModelFiles files;
  files.scene = config + "scenes/" + scene + ".toml";
  files.hand = config + "hands/" + hand + ".toml";
  files.device = config + "devices/" + device + ".toml";
  files.rendering = config + "rendering/" + device + ".toml";
  files.patient = config + "patients/" + patient + ".toml";
  return files;
}

/// Files of a shipped exercise in its own scene.
inline ModelFiles exerciseFiles(const std::string& exercise, int level = 1,
                                const std::string& hand = "adult-median-right",
                                const std::string& device = "lambda-pride") {
  ModelFiles files = shippedFiles(device, "empty", hand);
  files.scene.clear();
  files.exercise = std::string(WHOLEHAND_SOURCE_DIR) + "/config/exercises/" + exercise + ".toml";
  files.level = level;
  return files;
}

/// The engines that this program is built with; all but the default one are in lab/.
inline std::vector<std::string> builtEngines(bool for_persons = false) {
  std::vector<std::string> names;
  for (const Engine& engine : engines()) {
    if (engine.build && !(for_persons && !engine.persons_refused_because.empty())) {
      names.push_back(engine.name);
    }
  }
  return names;
}

inline Models load(const ModelFiles& files) {
  return orThrow(loadModels(files));
}

/// Removes all other axes from the device; the joints that they drove are locked.
inline void keepAxes(Models& m, const std::vector<std::string>& names) {
  const auto drop = [&](const auto& axis) {
    return std::find(names.begin(), names.end(), axis.name) == names.end();
  };
  std::erase_if(m.device.axes, drop);
  std::erase_if(m.rendering.axes, drop);
  std::erase_if(m.patient.axes, drop);
  m.hand = orThrow(assembleHand(orThrow(loadHandFile(m.files.hand)), m.device));
}

inline SceneBody fixedBox(const Eigen::Vector3d& center_m, const Eigen::Vector3d& size_m) {
  SceneBody body;
  body.name = "box";
  body.fixed = true;
  body.pose.translation_m = center_m;
  Shape shape;
  shape.half_extents_m = 0.5 * size_m;
  body.shapes.push_back(shape);
  return body;
}

/// A ball of uniform density, fixed if it has no mass.
inline SceneBody ball(const Eigen::Vector3d& center_m, double radius_m, double mass_kg) {
  SceneBody body;
  body.name = "ball";
  body.fixed = mass_kg == 0.0;
  body.mass_kg = mass_kg;
  body.inertia_kg_m2 = 0.4 * mass_kg * radius_m * radius_m * Eigen::Matrix3d::Identity();
  body.pose.translation_m = center_m;
  body.shapes.push_back(ballShape(radius_m));
  return body;
}

/// The hand's link poses at q_s.
inline ArticulatedBody handAt(const HandModel& hand, const AxisPosition& q_s) {
  ArticulatedBody body(hand);
  JointPosition theta;
  Synergy(hand).expand(q_s, theta);
  body.updateKinematics(theta);
  return body;
}

/// How far the hand's surface reaches along a direction of the world [m].
inline double reach(const HandModel& hand, const AxisPosition& q_s, const Eigen::Vector3d& along) {
  const ArticulatedBody body = handAt(hand, q_s);
  double furthest_m = -std::numeric_limits<double>::infinity();
  for (const Capsule& c : hand.capsules) {
    const Pose& at = body.linkPose(c.link);
    furthest_m = std::max(
        {furthest_m, along.dot(at * c.a_m) + c.radius_m, along.dot(at * c.b_m) + c.radius_m});
  }
  return furthest_m;
}

/// A wall 10 cm thick whose face is at `face_m` from the origin and faces against `along`.
inline SceneBody wall(const Eigen::Vector3d& along, double face_m) {
  const Eigen::Vector3d thin = along.cwiseAbs();
  return fixedBox((face_m + 0.05) * along, 0.1 * thin + 1.0 * (Eigen::Vector3d::Ones() - thin));
}

/// An ideal device whose position a script sets at each read (0 at arming), whatever effort is
/// sent.
class ScriptedDevice final : public RestingDevice {
 public:
  using Script = std::function<AxisPosition(int read)>;
  explicit ScriptedDevice(Script script) : script_(std::move(script)) {}
  [[nodiscard]] Expected<Done> open() override {
    read_ = 0;
    return Done{};
  }
  /// Declared as simulated: nobody's hand stands as still as a script, so the watchdog would report
  /// it.
  [[nodiscard]] bool simulated() const noexcept override { return true; }
  [[nodiscard]] Fault read(DeviceReading& reading, int elapsed_periods) noexcept override {
    reading.q_m = script_(read_);
    read_ += elapsed_periods;
    return Fault::kNone;
  }

 private:
  Script script_;
  int read_ = 0;
};

inline std::unique_ptr<Rig> build(Models models, std::unique_ptr<HapticDevice> device,
                                  const RigOptions& options = {}) {
  return orThrow(buildRigWithoutPerson(std::move(models), std::move(device), options));
}
inline std::unique_ptr<Rig> buildScripted(Models models, ScriptedDevice::Script script,
                                          const RigOptions& options = {}) {
  return build(std::move(models), std::make_unique<ScriptedDevice>(std::move(script)), options);
}

/// Ticks on the simulated clock; the sink may be empty. @return the last record
inline std::unique_ptr<TickRecord> runTicks(HapticRenderer& renderer, int ticks,
                                            const std::function<void(const TickRecord&)>& sink = {},
                                            int first_tick = 0) {
  auto record = std::make_unique<TickRecord>();
  for (int k = 0; k < ticks; ++k) {
    record->tick = static_cast<std::uint64_t>(first_tick + k);
    record->time_s = static_cast<double>(record->tick) * renderer.config().period_s;
    renderer.tick(1, *record);
    if (sink) sink(*record);
  }
  return record;
}

/// Moves from a to b by minimum jerk over `ticks` reads, then holds b.
inline ScriptedDevice::Script moveAndHold(const AxisPosition& a, const AxisPosition& b, int ticks) {
  return [=](int read) {
    const double u = std::clamp(static_cast<double>(read) / ticks, 0.0, 1.0);
    AxisPosition q = a;
    for (int i = 0; i < q.size(); ++i) {
      q[i] += u * u * u * (10.0 + u * (-15.0 + 6.0 * u)) * (b[i] - a[i]);
    }
    return q;
  };
}

/// Σ Jᵀ f over the contacts of a record, in reduced coordinates. The Jacobian is a central
/// difference of the forward kinematics: virtual work by its definition.
inline AxisEffort virtualWork(const HandModel& hand, const AxisPosition& q_s,
                              const TickRecord& record) {
  constexpr double kStep = 1e-5;
  const ArticulatedBody at = handAt(hand, q_s);
  AxisEffort work(q_s.size());
  for (int a = 0; a < q_s.size(); ++a) {
    AxisPosition ahead = q_s, behind = q_s;
    ahead[a] += kStep;
    behind[a] -= kStep;
    const ArticulatedBody plus = handAt(hand, ahead), minus = handAt(hand, behind);
    for (int i = 0; i < record.contact_count; ++i) {
      const Contact& c = record.contacts[i];
      const Eigen::Vector3d local = at.linkPose(c.link).inverse() * c.point_m.eigen();
      const Pose &p = plus.linkPose(c.link), &m = minus.linkPose(c.link);
      const Eigen::AngleAxisd turn(Eigen::Matrix3d(p.rotation * m.rotation.transpose()));
      work[a] += (c.force_n.eigen().dot(p * local - m * local) +
                  c.torque_nm.eigen().dot(turn.angle() * turn.axis())) /
                 (2.0 * kStep);
    }
  }
  return work;
}

/// The same for the forces between parts of the hand.
inline AxisEffort virtualWork(const HandModel& hand, const AxisPosition& q_s,
                              const SelfForces& own) {
  TickRecord both;  // as contacts with a body, on either side
  for (int i = 0; i < own.count; ++i) {
    const SelfForce& touch = own.touches[i];
    for (const int side : {1, -1}) {
      Contact& c = both.contacts[both.contact_count++];
      c.link = hand.capsules[side > 0 ? touch.capsule_a : touch.capsule_b].link;
      c.point_m = touch.point_m;
      c.force_n = Vec3::from(side * touch.force_n.eigen());
    }
  }
  return virtualWork(hand, q_s, both);
}

}  // namespace wholehand::test
