// What a stop of the real engine feels like over frequency, at every axis of every shipped device
// by itself, against the prediction for a rigid one: `certify --impedance` measures contact in the
// analytic world, which has no shapes.
#include "certify/impedance.hpp"
#include "rig/ball_clearance.hpp"
#include "support/rig_tools.hpp"
#include "support/seed.hpp"
#include "support/shipped.hpp"
#include "support/test_names.hpp"
#include "support/tolerance.hpp"

#include <cmath>
#include <complex>
#include <numbers>

namespace wholehand::test {
namespace {

using Complex = std::complex<double>;

constexpr int kWindow = 1000, kSettle = 6000;  // ticks of 1 ms; the slowest pole fades in 0.25 s
constexpr std::array<int, 7> kLines = {1, 3, 7, 13, 29, 61, 97};  // [Hz], whole turns of the window
constexpr double kPreload_n = 2.0, kLine_n = 0.05, kSoft_n_m = 1e-6;
constexpr double kLever_m = 0.08;

/// Leans on a device of one axis, then pushes to and fro besides, through an arm too soft to be
/// felt.
class LeaningPlayer final : public Player {
 public:
  explicit LeaningPlayer(double scale) : scale_(scale) {}
  [[nodiscard]] AxisPosition start() const override { return AxisPosition(1); }
  void reset() override { tick_ = 0; }
  void advance(double, AxisPosition& q, AxisVelocity& qd) noexcept override {
    ++tick_;
    qd = AxisVelocity(1);
    const double grown = std::min(1.0, tick_ / 1000.0);
    double push_n = kPreload_n;
    for (std::size_t i = 0; i < kLines.size(); ++i) {
      const double turns = static_cast<double>(kLines[i] * tick_ % kWindow) / kWindow;
      push_n += kLine_n * std::sin(2.0 * std::numbers::pi * turns + 2.0 * static_cast<double>(i));
    }
    q = AxisPosition(1, scale_ * grown * push_n / kSoft_n_m);
  }
  void see(const TickRecord&) noexcept override {}

 private:
  double scale_;  ///< its sign says which way, a lever arm makes torque of force
  int tick_ = 0;
};

/// An axis of a shipped device, pushed one way.
struct FeltSide {
  std::string device, axis;
  int sign = 1;
};

std::vector<FeltSide> everySide() {
  std::vector<FeltSide> sides;
  for (const std::string& device : shipped("devices")) {
    for (const DeviceAxis& axis : load(shippedFiles(device)).device.axes) {
      sides.push_back({device, axis.name, 1});
      // A hand's axis begins at its open end.
      if (axis.group == AxisGroup::kBase) sides.push_back({device, axis.name, -1});
    }
  }
  return aTenth(sides);
}

/// The axis by itself, without what is not linear: dry friction, encoder, adaptive damping.
Models linearAxis(const FeltSide& side) {
  Models m = load(shippedFiles(side.device));
  keepAxes(m, {side.axis});
  m.device.axes[0].coulomb = m.device.axes[0].encoder_step = 0.0;
  m.rendering.axes[0].effort_dead = 1e6;  // Φ = 0
  m.rendering.axes[0].effort_full = 2e6;
  return m;
}

/// Fixed, in the way of the hand 2 mm on: a wall before a translation, before a rotation a small
/// ball at the bare point of the hand that it moves furthest.
SceneBody stopOf(const Models& m, int sign) {
  constexpr double kGap_m = 0.002, kBall_m = 0.004, kStep_rad = 1e-5;
  const AxisPosition at(1);
  if (m.device.axes[0].kind == AxisKind::kTranslation) {
    const auto axis = m.device.axes[0].name.front() - 'x';
    const Eigen::Vector3d along = sign * Eigen::Vector3d::Unit(axis);
    return wall(along, reach(m.hand, at, along) + kGap_m);
  }
  const ArticulatedBody here = handAt(m.hand, at);
  const ArticulatedBody there = handAt(m.hand, AxisPosition(1, sign * kStep_rad));
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  double furthest_m = 0.0;
  for (const Capsule& c : m.hand.capsules) {
    for (const Eigen::Vector3d& end : {c.a_m, c.b_m}) {
      const Eigen::Vector3d p = here.linkPose(c.link) * end;
      const Eigen::Vector3d way = there.linkPose(c.link) * end - p;
      const Eigen::Vector3d ball_m = p + (c.radius_m + kBall_m + kGap_m) * way.normalized();
      if (way.norm() <= furthest_m || clearance_m(here, ball_m, kBall_m) < 0.9 * kGap_m) continue;
      furthest_m = way.norm();
      center = ball_m;
    }
  }
  return ball(center, kBall_m, 0.0);
}

class FeltStop : public testing::TestWithParam<FeltSide> {};

TEST_P(FeltStop, OfTheRealEngine_FeelsAsPredictedForARigidStop) {
  const FeltSide& side = GetParam();
  Models m = linearAxis(side);
  m.scene.bodies = {stopOf(m, side.sign)};
  // Of a rotation: the same at a lever arm.
  const double lever = m.device.axes[0].kind == AxisKind::kTranslation ? 1.0 : kLever_m;
  m.patient.axes[0].mass = m.patient.axes[0].damping = 0.0;
  m.patient.axes[0].stiffness = kSoft_n_m;
  const auto rig =
      orThrow(buildRig(m, std::make_unique<LeaningPlayer>(side.sign * lever), RigOptions{}));
  ASSERT_TRUE(rig->renderer->arm());
  std::array<Complex, kLines.size()> effort{}, position{};
  runTicks(*rig->renderer, kSettle + kWindow, [&](const TickRecord& r) {
    if (r.tick < kSettle) return;
    ASSERT_GT(r.contact_count, 0);
    ASSERT_EQ(r.tank_effort[0], 0.0);
    ASSERT_EQ(r.phi[0], 0.0);
    for (std::size_t i = 0; i < kLines.size(); ++i) {
      const double turn =
          2.0 * std::numbers::pi * kLines[i] / kWindow * static_cast<double>(r.tick);
      effort[i] += r.patient_effort[0] * std::polar(1.0, -turn);
      position[i] += r.q_m[0] * std::polar(1.0, -turn);
    }
  });
  AxisLoop loop = axisLoop(m.device, rig->gains, 0, 1e-3);
  loop.phi_k_dm = 0.0;
  double worst_db = 0.0, worst_deg = 0.0;
  for (std::size_t i = 0; i < kLines.size(); ++i) {
    const double f_hz = kLines[i];
    const Complex measured = effort[i] * linearHoldGain(loop, f_hz) /
                             (Complex(0.0, 2.0 * std::numbers::pi * f_hz) * position[i]);
    const Complex ratio =
        measured / feltImpedance(feltUncoupled(loop), ContactCase::kRigid, f_hz).felt;
    worst_db = std::max(worst_db, std::abs(20.0 * std::log10(std::abs(ratio))));
    worst_deg = std::max(worst_deg, std::abs(std::arg(ratio)) * 180.0 / std::numbers::pi);
  }
  const std::string where = side.device + ", " + side.axis + (side.sign > 0 ? " +" : " -");
  figure("stop of the engine against a rigid one, " + where, worst_db, "dB");
  figure("the same, phase, " + where, worst_deg, "degrees");
  EXPECT_LE(worst_db, tolerance(1.0));  // the figure that is promised
  EXPECT_LE(worst_deg, tolerance(5.0));
}
INSTANTIATE_TEST_SUITE_P(EveryAxis, FeltStop, testing::ValuesIn(everySide()),
                         [](const auto& tested) {
                           const FeltSide& side = tested.param;
                           return withoutHyphens(side.device + "_" + side.axis +
                                                 (side.sign > 0 ? "_Plus" : "_Minus"));
                         });

}  // namespace
}  // namespace wholehand::test
