#pragma once

#include "exercise/finger_walls.hpp"
#include "patient/scripted_player.hpp"
#include "support/constants.hpp"
#include "support/rig_tools.hpp"

namespace wholehand::test {

constexpr int kFingerAxis = 3, kTurnAxis = 4,
              kThumbAxis = 5;  // axes of lambda-pride, after x, y, z

/// One tick of a squeeze: how far an axis has gone, and what the person feels there.
struct Sample {
  double path_m = 0.0, felt_n = 0.0;
};
struct Squeeze {
  std::vector<Sample> samples;  ///< from where the wall begins to where the core is met
  double core_m = 0.0;          ///< path at which it is met
};

/// The hand about an upright cylinder of a scene, palm against it, closes one axis at a speed of
/// the fingertip.
inline Squeeze squeeze(Models models, const std::string& name, int axis, double speed_m_s) {
  const int body = models.scene.bodyIndex(name);
  const Eigen::Vector3d at_m = models.scene.bodies[body].pose.translation_m;
  const DeviceAxis device = models.device.axes[axis];
  const double lever_m = device.lever_arm_m;
  const auto pose = [&](double x, double y, double fingers, double turn, double thumb) {
    AxisPosition q(6);
    q[0] = x, q[1] = y, q[2] = 0.0, q[kFingerAxis] = fingers, q[kTurnAxis] = turn,
    q[kThumbAxis] = thumb;
    return q;
  };
  // A power grasp of an upright cylinder: its axis 49 mm before, 41 mm beside the hand's base.
  const double x = at_m.x() - 0.049, y = at_m.y() - 0.041;
  const AxisPosition back = pose(-0.08, y - 0.024, 0.2, 0.1, 0.0);
  const AxisPosition beside = pose(x, y - 0.024, 0.2, 0.1, 0.0);
  // The other digit holds against it: one side alone opens no nozzle.
  const bool fingers = axis == kFingerAxis;
  const AxisPosition open = pose(x, y, 50.0 * kDeg, 20.0 * kDeg, 0.0);
  const AxisPosition held =
      pose(x, y, (fingers ? 50.0 : 112.0) * kDeg, 20.0 * kDeg, (fingers ? 14.0 : 0.0) * kDeg);
  const double most = axis == kFingerAxis ? 170.0 * kDeg : 70.0 * kDeg;
  const double from_s = 4.0;
  auto player = std::make_shared<ScriptedPlayer>(Intention::throughWaypoints(
      {{0.0, back}, {0.8, beside}, {1.6, open}, {2.6, open}, {3.2, held}, {from_s, held}}));
  AxisPosition q = back;
  AxisVelocity qd(6);
  const auto rig = buildScripted(std::move(models), [=](int read) mutable {
    if (read == 0) {
      player->reset();
      return back;
    }
    player->advance(1e-3, q, qd);
    AxisPosition at = q;
    const double closing_s = 1e-3 * read - from_s;
    if (closing_s > 0.0) at[axis] = std::min(open[axis] + closing_s * speed_m_s / lever_m, most);
    return at;
  });
  Squeeze out;
  if (auto armed = rig->renderer->arm(); !armed) {
    ADD_FAILURE() << format(armed.errors());
    return out;
  }
  const auto capsules = axesOfCapsules(rig->models.hand);
  double wall = 0.0;
  const int ticks = static_cast<int>(1e3 * (from_s + (most - open[axis]) * lever_m / speed_m_s));
  runTicks(*rig->renderer, ticks, [&](const TickRecord& r) {
    if (r.time_s < from_s || out.core_m > 0.0) return;
    EXPECT_EQ(r.exercise.alpha, 1.0) << r.time_s;
    if (!(r.exercise.effort[axis] < 0.0)) return;
    if (out.samples.empty()) wall = r.exercise.wall[axis];
    const double path_m = lever_m * (r.q_m[axis] - wall);
    const double own_n = (device.damping * speed_m_s / lever_m + device.coulomb) / lever_m;
    out.samples.push_back({path_m, -r.sent[axis] / lever_m + own_n});
    if ((touchingAxes(r, body, capsules) >> axis & 1U) != 0U) out.core_m = path_m;
  });
  return out;
}

}  // namespace wholehand::test
