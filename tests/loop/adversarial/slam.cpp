#include "loop/adversarial/slam.hpp"

#include "loop/patient/motion.hpp"

#include <cmath>

namespace wholehand::test {
namespace {

constexpr double kSlamGap_m = 5e-4;  // between the hand, when it is let go, and the wall

AxisPosition startOf(const Throw& how, const DeviceModel& device) {
  AxisPosition q(device.axisCount());
  for (int a = 0; a < q.size(); ++a) {
    const DeviceAxis& axis = device.axes[a];
    if (axis.name == how.axis) q[a] = how.towards_upper ? axis.lower : axis.upper;
    if (axis.name == "finger_flexion") q[a] = how.fingers_rad;
    if (axis.name == "thumb_circumduction") q[a] = how.circumduction_rad;
  }
  return q;
}

/// Runs the throw against a wall, or without one (NaN) to find where the hand is let go.
Bounce flung(const Throw& how, double wall_m = std::numeric_limits<double>::quiet_NaN()) {
  Models m = thrown(how);
  const bool free = std::isnan(wall_m);
  const Eigen::Vector3d ahead = how.ahead();
  if (!free) m.scene.bodies = {wall(ahead, wall_m)};
  const int axis = m.device.axisIndex(how.axis);
  const double sign = how.towards_upper ? 1.0 : -1.0;
  auto device = std::make_unique<SimulatedDevice>(
      m.device, m.patient, Intention::throughWaypoints({{0.0, startOf(how, m.device)}}), 1e-3);
  const SimulatedDevice& mechanism = *device;
  const auto rig = build(std::move(m), std::move(device));
  EXPECT_TRUE(rig->renderer->arm());
  Bounce out;
  bool let_go = false, touched = false;
  runTicks(*rig->renderer, 1000, [&](const TickRecord& r) {
    const double speed = sign * mechanism.velocity()[axis];
    if (!std::exchange(let_go, mechanism.person().hasLetGo()) && mechanism.person().hasLetGo()) {
      out.face_m = reach(rig->models.hand, r.q_s, ahead);
    }
    if (free) return;
    if (!touched && r.contact_count == 0) {  // the last such tick is the one before the touch
      out.impact_m_s = speed;
      out.stretch_m = sign * (r.q_m[axis] - r.q_s[axis]);
    }
    out.faults |= r.faults & kStoppingFaults;
    if (!(touched = touched || r.contact_count > 0)) return;
    out.rebound_m_s = std::max(out.rebound_m_s, -speed);
    out.peak_n = std::max(out.peak_n, std::abs(r.sent[axis]));
    out.phi = std::max(out.phi, r.phi[axis]);
    out.depth_m = std::max(out.depth_m, reach(rig->models.hand, r.q_s, ahead) - wall_m);
    for (const double effort : r.tank_effort) out.tank_n = std::max(out.tank_n, std::abs(effort));
  });
  return out;
}

}  // namespace

Eigen::Vector3d Throw::ahead() const {
  return (towards_upper ? 1.0 : -1.0) * Eigen::Vector3d::Unit(axis.front() - 'x');
}

Models thrown(const Throw& how) {
  Models m = load(shippedFiles(how.device, "empty", how.hand, "no-arm"));
  if (how.alone) keepAxes(m, {how.axis});
  const DeviceAxis& axis = flungAxis(m, how);
  m.patient.slam = {how.axis, how.towards_upper, 0.3, how.speed_m_s / axis.speed_limit,
                    how.effort_share};
  for (AxisRendering& gains : m.rendering.axes) {
    if (!how.adaptive) gains.k_dm = 0.0;
    if (!how.palm_contact) gains.palm_contact = false;
  }
  return m;
}

const DeviceAxis& flungAxis(const Models& m, const Throw& how) {
  return m.device.axes[m.device.axisIndex(how.axis)];
}

Bounce slammed(const Throw& how) {
  return flung(how, flung(how).face_m + kSlamGap_m);
}

Pair withAndWithout(Throw how) {
  Pair pair;
  how.adaptive = true;
  pair.with = slammed(how);
  how.adaptive = false;
  pair.without = slammed(how);
  return pair;
}

}  // namespace wholehand::test
