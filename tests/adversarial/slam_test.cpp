// The mechanism flung into a fixed wall, and nobody holds it: what the adaptive damping is worth.
#include "device/simulated/simulated_device.hpp"
#include "patient/scripted_player.hpp"
#include "support/rig_tools.hpp"
#include "support/tolerance.hpp"

#include <cmath>

namespace wholehand::test {
namespace {

constexpr double kGap_m = 5e-4;  // between the hand, as it is let go, and the wall
const Eigen::Vector3d kAhead = Eigen::Vector3d::UnitX();

struct Throw {
  double speed_share = 0.4;   ///< of the speed limit
  double effort_share = 0.5;  ///< pushed gently, the simulated hand is not left behind
  bool adaptive = true;       ///< else Φ K_dm = 0
};

struct Bounce {
  double impact_m_s = 0.0;   ///< of the device, when the hand touches
  double stretch_m = 0.0;    ///< of the coupling's spring then: the hand lags behind the device
  double rebound_m_s = 0.0;  ///< of the device, fastest away from the wall
  double peak_n = 0.0;       ///< largest effort sent after the touch
  double phi = 0.0;          ///< largest Φ after the touch
  double depth_m = 0.0;      ///< of the hand's surface in the wall
  Fault faults = Fault::kNone;
  double face_m = 0.0;  ///< of the hand, as it was let go
};

/// The shipped device with its x axis alone, gains as shipped, nobody on it.
Models thrown(const Throw& how) {
  Models m = load(shippedFiles("lambda-pride", "empty", "adult-median-right", "no-arm"));
  keepAxes(m, {"x"});
  m.patient.slam = {"x", true, 0.3, how.speed_share, how.effort_share};
  if (!how.adaptive) m.rendering.axes[0].k_dm = 0.0;
  return m;
}

Bounce flung(const Throw& how, double face_m = 0.0) {
  Models m = thrown(how);
  if (face_m != 0.0) m.scene.bodies = {wall(kAhead, face_m)};
  const AxisPosition start(1, m.device.axes[0].lower);
  auto device = std::make_unique<SimulatedDevice>(
      m.device, m.patient, Intention::throughWaypoints({{0.0, start}}), 1e-3);
  const SimulatedDevice& mechanism = *device;
  const auto rig = build(std::move(m), std::move(device));
  EXPECT_TRUE(rig->renderer->arm());
  Bounce out;
  bool touched = false;
  runTicks(*rig->renderer, 1000, [&](const TickRecord& r) {
    const double speed = mechanism.velocity()[0];
    if (mechanism.person().hasLetGo() && out.face_m == 0.0) {
      out.face_m = reach(rig->models.hand, r.q_s, kAhead);
    }
    if (!touched && r.contact_count == 0) {  // at last just before the touch
      out.impact_m_s = speed;
      out.stretch_m = r.q_m[0] - r.q_s[0];
    }
    out.faults |= r.faults & kStopping;
    if (!(touched = touched || r.contact_count > 0)) return;
    out.rebound_m_s = std::max(out.rebound_m_s, -speed);
    out.peak_n = std::max(out.peak_n, std::abs(r.sent[0]));
    out.phi = std::max(out.phi, r.phi[0]);
    out.depth_m = std::max(out.depth_m, reach(rig->models.hand, r.q_s, kAhead) - face_m);
  });
  return out;
}

/// Once without a wall, to learn where it is let go; then with one there.
Bounce slammed(const Throw& how) {
  return flung(how, flung(how).face_m + kGap_m);
}

void print(const std::string& what, const Bounce& with, const Bounce& without) {
  figure(what + ", impact", with.impact_m_s, "m/s");
  figure(what + ", impact without damping", without.impact_m_s, "m/s");
  figure(what + ", rebound", with.rebound_m_s, "m/s");
  figure(what + ", rebound without damping", without.rebound_m_s, "m/s");
  figure(what + ", rebound lowered by", 100.0 * (1.0 - with.rebound_m_s / without.rebound_m_s),
         "%");
  figure(what + ", peak effort", with.peak_n, "N");
  figure(what + ", peak effort without damping", without.peak_n, "N");
  figure(what + ", deepest in the wall", 1e3 * with.depth_m, "mm");
}

TEST(Slam, AtSixTenths_AdaptiveDampingLowersTheReboundByThirtyPercent) {
  Throw how;
  const Bounce with = slammed(how);
  how.adaptive = false;
  const Bounce without = slammed(how);
  print("slam at 0.6 m/s", with, without);
  EXPECT_EQ(with.faults | without.faults, Fault::kNone);
  // The same throw, and not limited by the device: a figure of the damping alone.
  EXPECT_NEAR(with.impact_m_s, 0.6, 0.015);
  EXPECT_NEAR(with.impact_m_s, without.impact_m_s, 0.005);
  const double limit_n = thrown(how).device.axes[0].effort_limit;
  EXPECT_LT(std::max(with.peak_n, without.peak_n), limit_n);
  EXPECT_EQ(with.phi, 1.0);
  EXPECT_LE(with.rebound_m_s, 0.7 * without.rebound_m_s);  // the figure
}

/// A mass on the coupling's spring and γ damping of Eq. (3), sampled, filtered and late as those of
/// the device, the hand standing still in the wall from the touch on.
double reboundOfAMass(const DeviceAxis& axis, const CouplingGains& gains, const Bounce& start) {
  constexpr int kSteps = 100;
  constexpr double kPeriod_s = 1e-3, kStep_s = kPeriod_s / kSteps;
  const double b_gamma =
      gains.gamma[0] * gains.k_pm[0] * gains.k_ds_per_s[0] / gains.k_ps_per_s2[0];
  double q = start.stretch_m, v = start.impact_m_s, filtered = v, sent = 0.0, acting = 0.0,
         rebound = 0.0;
  for (int tick = 0; tick < 200; ++tick) {
    acting = std::exchange(sent, -gains.k_pm[0] * q - b_gamma * filtered);  // a tick late
    for (int i = 0; i < kSteps; ++i) {
      const double friction = axis.damping * v + std::copysign(axis.coulomb, v);
      v += kStep_s * (acting - friction) / axis.mass;
      q += kStep_s * v;
    }
    filtered += kPeriod_s / (gains.filter_tau_s[0] + kPeriod_s) * (v - filtered);
    rebound = std::max(rebound, -v);
  }
  return rebound;
}

TEST(Slam, WithoutDamping_ReboundsAsAMassOnTheCouplingsSpring) {
  Throw how;
  how.adaptive = false;
  const Models m = thrown(how);
  const Bounce bounce = slammed(how);
  const double expected =
      reboundOfAMass(m.device.axes[0], orThrow(checkGains(m, 1e-3)).gains, bounce);
  figure("slam without damping, rebound of a mass on a spring", expected, "m/s");
  EXPECT_NEAR(bounce.rebound_m_s, expected, tolerance(0.05) * expected);
}

TEST(Slam, JustBelowTheSpeedLimit_StaysWithinTheEffortLimitAndTheWallHolds) {
  Throw how;
  how.speed_share = 0.98;
  how.effort_share = 2.0;  // an arm that is stronger than the device
  const Bounce with = slammed(how);
  how.adaptive = false;
  const Bounce without = slammed(how);
  print("slam at the speed limit", with, without);
  const DeviceAxis axis = thrown(how).device.axes[0];
  for (const Bounce& bounce : {with, without}) {
    EXPECT_EQ(bounce.faults, Fault::kNone);
    EXPECT_GT(bounce.impact_m_s, 0.95 * axis.speed_limit);
    EXPECT_LE(bounce.peak_n, axis.effort_limit + 1e-9);
    EXPECT_LT(bounce.rebound_m_s, bounce.impact_m_s);
    EXPECT_LT(bounce.depth_m, 5e-3);  // of a wall of 100 mm
  }
}

}  // namespace
}  // namespace wholehand::test
