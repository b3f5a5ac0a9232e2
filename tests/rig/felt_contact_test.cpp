// Rendered impedance of a stop in the real engine over frequency, on every single axis of every
// shipped device, compared with the prediction for a rigid stop. `certify --impedance` measures
// contact in the analytic world, which has no shapes.
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

constexpr int kWindow = 1000, kSettle = 6000;  // ticks of 1 ms; the slowest pole decays in 0.25 s
constexpr std::array<int, 7> kLines = {1,  3,  7, 13,
                                       29, 61, 97};  // [Hz], whole cycles in the window
constexpr double kPreload_n = 2.0, kLine_n = 0.05, kSoft_n_m = 1e-6;
constexpr double kLever_m = 0.08;

/// Leans on a device of one axis and additionally pushes back and forth, through an arm too soft to
/// influence the result.
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
  void onRecord(const TickRecord&) noexcept override {}

 private:
  double scale_;  ///< its sign is the direction; a lever arm converts force to torque
  int tick_ = 0;
};

/// An axis of a shipped device, pushed in one direction.
struct FeltSide {
  std::string device, axis;
  int sign = 1;
};

std::vector<FeltSide> everySide() {
  std::vector<FeltSide> sides;
  for (const std::string& device : shipped("devices")) {
    for (const DeviceAxis& axis : load(shippedFiles(device)).device.axes) {
      sides.push_back({device, axis.name, 1});
      // A hand axis starts at its open end, so it is pushed in one direction only.
      if (axis.group == AxisGroup::kBase) sides.push_back({device, axis.name, -1});
    }
  }
  return sampleTenth(sides);
}

/// The single axis without nonlinear parts: dry friction, encoder, adaptive damping.
Models linearAxis(const FeltSide& side) {
  Models m = load(shippedFiles(side.device));
  keepAxes(m, {side.axis});
  m.device.axes[0].coulomb = m.device.axes[0].encoder_step = 0.0;
  m.rendering.axes[0].effort_dead = 1e6;  // Φ = 0
  m.rendering.axes[0].effort_full = 2e6;
  return m;
}

/// A fixed stop 2 mm in front of the hand: a wall for a translation, a small ball for a rotation at
/// the free point of the hand that moves farthest.
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

TEST_P(FeltStop, RealEngine_RendersThePredictedRigidStop) {
  const FeltSide& side = GetParam();
  Models m = linearAxis(side);
  m.scene.bodies = {stopOf(m, side.sign)};
  // A rotation has the same quantities at a lever arm.
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
  EXPECT_LE(worst_db, tolerance(1.0));  // the figure that the documentation states
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
