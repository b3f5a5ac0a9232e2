// What free motion feels like through the whole renderer, against closed forms.
#include "support/rig_tools.hpp"
#include "support/test_names.hpp"
#include "support/tolerance.hpp"

#include <cmath>

namespace wholehand::test {
namespace {

AxisPosition middle(const DeviceModel& device) {
  AxisPosition q(device.axisCount());
  for (int a = 0; a < q.size(); ++a) q[a] = 0.5 * (device.axes[a].lower + device.axes[a].upper);
  return q;
}

struct FeltMass {
  double measured = 0.0, expected = 0.0;
};

/// Moves one axis with constant acceleration and reads the effort that is sent.
FeltMass feltMass(const std::string& device, int axis, double gamma) {
  Models m = load(shippedFiles(device));
  for (AxisRendering& a : m.rendering.axes) a.gamma = gamma;
  const bool translation = m.device.axes[axis].kind == AxisKind::kTranslation;
  const double acceleration = translation ? 0.15 : 0.5;  // [m/s² or rad/s²]
  const AxisPosition start = middle(m.device);
  RigOptions options;
  options.uncertified = true;  // γ = 0 generates power on some devices
  const auto rig = buildScripted(
      std::move(m),
      [=](int read) {
        AxisPosition q = start;
        q[axis] += 0.5 * acceleration * 1e-6 * read * read;
        return q;
      },
      options);
  if (!rig->renderer->arm()) throw std::runtime_error("not armed");
  const auto last = runTicks(*rig->renderer, 500);
  const CouplingGains& g = rig->gains;
  // Felt mass of the coupling, K_pm (1 + (1−γ) k_d τ_f) / k_p: the avatar trails the device by
  // a (1 + k_d τ_f) / k_p because the filtered velocity lags by τ_f, and the γ term gives back
  // γ K_pm (k_d / k_p) a τ_f.
  ArticulatedBody body(rig->models.hand, g.armature);
  EXPECT_TRUE(body.update(last->theta, JointVelocity(rig->models.hand.joint_count),
                          Eigen::Vector3d::Zero()));
  const double k_p = g.k_pm[axis] / body.reducedInertia()(axis, axis);  // in this posture
  const double k_d = 2.0 * std::sqrt(k_p) - 1e-3 * k_p;                 // Eq. (14)
  return {-last->sent[axis] / acceleration,
          g.k_pm[axis] * (1.0 + (1.0 - gamma) * k_d * g.filter_tau_s[axis]) / k_p};
}

class FreeMotion : public testing::TestWithParam<std::string> {};

TEST_P(FreeMotion, ConstantAcceleration_FeelsTheMassOfTheCoupling) {
  const DeviceModel device = load(shippedFiles(GetParam())).device;
  double worst = 0.0;
  for (double gamma : {0.0, 0.3}) {
    for (int a = 0; a < device.axisCount(); ++a) {
      const FeltMass mass = feltMass(GetParam(), a, gamma);
      EXPECT_NEAR(mass.measured, mass.expected, tolerance(0.01) * mass.expected)
          << device.axes[a].name << ", gamma " << gamma;
      worst = std::max(worst, std::abs(mass.measured / mass.expected - 1.0));
    }
  }
  figure("felt mass against K_pm (1 + (1-gamma) k_d tau_f) / k_p, " + GetParam(), worst * 100.0,
         "%");
}

TEST_P(FreeMotion, SlowOnAllAxesAtOnce_IsNotDamped) {
  Models m = load(shippedFiles(GetParam()));
  const DeviceModel device = m.device;
  const AxisPosition center = middle(device);
  // Through nearly all ranges at once the thumb meets the fingers; free motion is without that.
  m.hand.self_contacts.clear();
  // Every axis swings with a peak of exactly 0.2 m/s or 1 rad/s over 90 % of its range, each with a
  // frequency of its own, seen through the device's encoder.
  const auto script = [=](int read) {
    AxisPosition q = center;
    for (int a = 0; a < q.size(); ++a) {
      const DeviceAxis& axis = device.axes[a];
      const double peak = axis.kind == AxisKind::kTranslation ? 0.2 : 1.0;
      const double amplitude = 0.45 * (axis.upper - axis.lower);
      q[a] -= amplitude * std::cos(peak / amplitude * 1e-3 * read);  // from rest
      if (axis.encoder_step > 0.0) q[a] = std::round(q[a] / axis.encoder_step) * axis.encoder_step;
    }
    return q;
  };
  const auto rig = buildScripted(std::move(m), script);
  ASSERT_TRUE(rig->renderer->arm());
  double phi = 0.0;
  runTicks(*rig->renderer, 20000, [&](const TickRecord& r) {
    for (double p : r.phi) phi = std::max(phi, p);
  });
  figure("largest damping share in slow free motion, " + GetParam(), phi, "");
  EXPECT_LT(phi, tolerance(0.05));
}
INSTANTIATE_TEST_SUITE_P(Devices, FreeMotion,
                         testing::Values("lambda-pride", "desktop-3axis", "wrist-9axis"),
                         [](const auto& tested) { return withoutHyphens(tested.param); });

TEST(SlowFreeMotion, TheSameSwingTenTimesFaster_IsDamped) {
  // The figure above can fail: the damping does rise with the effort of fast motion.
  Models m = load(shippedFiles("desktop-3axis"));
  const auto script = [](int read) {
    AxisPosition q(3);
    q[0] = 0.04 * std::sin(2.0 / 0.04 * 1e-3 * read);
    return q;
  };
  const auto rig = buildScripted(std::move(m), script);
  ASSERT_TRUE(rig->renderer->arm());
  EXPECT_GT(runTicks(*rig->renderer, 2000)->phi[0], 0.05);
}

}  // namespace
}  // namespace wholehand::test
