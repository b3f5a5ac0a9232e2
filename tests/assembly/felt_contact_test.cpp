// What a wall of the real engine feels like over frequency, against the prediction for a rigid
// stop: `certify --impedance` measures contact in the analytic world, which has no shapes.
#include "control/impedance.hpp"
#include "support/rig_tools.hpp"
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

/// Leans on the axis, then pushes to and fro besides, through an arm too soft to be felt.
class LeaningPlayer final : public Player {
 public:
  LeaningPlayer(int axes, int axis, double sign) : axes_(axes), axis_(axis), sign_(sign) {}
  [[nodiscard]] AxisPosition start() const override { return AxisPosition(axes_); }
  void reset() override { tick_ = 0; }
  void advance(double, AxisPosition& q, AxisVelocity& qd) noexcept override {
    ++tick_;
    q = AxisPosition(axes_);
    qd = AxisVelocity(axes_);
    const double grown = std::min(1.0, tick_ / 1000.0);
    double push_n = sign_ * kPreload_n;
    for (std::size_t i = 0; i < kLines.size(); ++i) {
      const double turns = static_cast<double>(kLines[i] * tick_ % kWindow) / kWindow;
      push_n += kLine_n * std::sin(2.0 * std::numbers::pi * turns + 2.0 * static_cast<double>(i));
    }
    q[axis_] = grown * push_n / kSoft_n_m;
  }
  void see(const TickRecord&) noexcept override {}

 private:
  int axes_, axis_, tick_ = 0;
  double sign_;
};

Models linearDesktop() {
  Models m = load(shippedFiles("desktop-3axis"));  // its hand's joints are locked
  for (DeviceAxis& axis : m.device.axes) axis.coulomb = axis.encoder_step = 0.0;
  for (AxisRendering& axis : m.rendering.axes) {
    axis.effort_dead = 1e6;  // Φ = 0
    axis.effort_full = 2e6;
  }
  return m;
}

class FeltWall : public testing::TestWithParam<std::pair<int, int>> {};

TEST_P(FeltWall, OfTheRealEngine_FeelsAsPredictedForARigidStop) {
  const int axis = GetParam().first, sign = GetParam().second;
  Models m = linearDesktop();
  const int axes = m.device.axisCount();
  const Eigen::Vector3d along = sign * Eigen::Vector3d::Unit(axis);
  m.scene.bodies = {wall(along, reach(m.hand, AxisPosition(axes), along) + 0.002)};
  for (int a = 0; a < axes; ++a) {
    m.patient.axes[a].mass = 0.0;
    m.patient.axes[a].damping = a == axis ? 0.0 : 1e4;  // the others are held
    m.patient.axes[a].stiffness = a == axis ? kSoft_n_m : 1e7;
  }
  const auto rig =
      orThrow(buildRig(m, std::make_unique<LeaningPlayer>(axes, axis, sign), RigOptions{}));
  ASSERT_TRUE(rig->renderer->arm());
  std::array<Complex, kLines.size()> effort{}, position{};
  runTicks(*rig->renderer, kSettle + kWindow, [&](const TickRecord& r) {
    if (r.tick < kSettle) return;
    ASSERT_GT(r.contact_count, 0);
    ASSERT_EQ(r.tank_effort[axis], 0.0);
    ASSERT_EQ(r.phi[axis], 0.0);
    for (std::size_t i = 0; i < kLines.size(); ++i) {
      const double turn =
          2.0 * std::numbers::pi * kLines[i] / kWindow * static_cast<double>(r.tick);
      effort[i] += r.patient_effort[axis] * std::polar(1.0, -turn);
      position[i] += r.q_m[axis] * std::polar(1.0, -turn);
    }
  });
  AxisLoop loop = axisLoop(m.device, rig->gains, axis, 1e-3);
  loop.phi_k_dm = 0.0;
  double worst_db = 0.0, worst_deg = 0.0;
  for (std::size_t i = 0; i < kLines.size(); ++i) {
    const double f_hz = kLines[i];
    const Complex measured = effort[i] * linearHoldGain(loop, f_hz) /
                             (Complex(0.0, 2.0 * std::numbers::pi * f_hz) * position[i]);
    const Complex ratio = measured / feltImpedance(feltAlone(loop), ContactCase::kRigid, f_hz).felt;
    worst_db = std::max(worst_db, std::abs(20.0 * std::log10(std::abs(ratio))));
    worst_deg = std::max(worst_deg, std::abs(std::arg(ratio)) * 180.0 / std::numbers::pi);
  }
  const std::string where = std::string(sign > 0 ? "+" : "-") + "xyz"[axis];
  figure("wall of the engine against a rigid stop, " + where, worst_db, "dB");
  figure("wall of the engine against a rigid stop, " + where, worst_deg, "degrees");
  EXPECT_LE(worst_db, tolerance(1.0));  // the figure that is promised
  EXPECT_LE(worst_deg, tolerance(5.0));
}
INSTANTIATE_TEST_SUITE_P(Sides, FeltWall,
                         testing::Values(std::pair{0, 1}, std::pair{1, -1}, std::pair{2, -1}),
                         [](const auto& tested) {
                           return std::string(tested.param.second > 0 ? "Plus" : "Minus") +
                                  "XYZ"[tested.param.first];
                         });

}  // namespace
}  // namespace wholehand::test
