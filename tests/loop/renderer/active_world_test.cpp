// A world that makes energy is damped, then stopped; a passive world never empties the tank.
#include "loop/device/simulated/simulated_device.hpp"
#include "loop/patient/motion.hpp"
#include "support/rig_tools.hpp"
#include "support/seed.hpp"
#include "support/test_names.hpp"

#include <cmath>
#include <numbers>

namespace wholehand::test {
namespace {

/// The first body has a hidden motor that pushes it back and forth along x.
class MotorWorld final : public PhysicsWorld {
 public:
  MotorWorld(PhysicsWorld& world, double mass_kg, double force_n, double frequency_hz)
      : world_(world), mass_kg_(mass_kg), force_n_(force_n), frequency_hz_(frequency_hz) {}

  [[nodiscard]] Expected<Done> placeHand(const AxisPosition& q_s) override {
    return world_.placeHand(q_s);
  }
  [[nodiscard]] Fault observe(PhysicsState& state) noexcept override {
    const Fault fault = world_.observe(state);
    body_ = state.bodies[0];
    return fault;
  }
  void placeBodies(const BodyPlacements& placements) noexcept override {
    world_.placeBodies(placements);
  }
  [[nodiscard]] Fault step(const HandDrive& drive, double period_s) noexcept override {
    time_s_ += period_s;
    BodyPlacements pushed;
    pushed.count = 1;
    BodyPlacement& body = pushed.items[0];
    body.body = 0;
    body.position_m = body_.position_m;
    body.orientation_xyzw = body_.orientation_xyzw;
    if (time_s_ < 0.5) return world_.step(drive, period_s);  // no force before rendering begins
    const double turn = std::sin(2.0 * std::numbers::pi * frequency_hz_ * time_s_);
    body.velocity_m_s.x =
        body_.velocity_m_s.x - period_s * force_n_ / mass_kg_ * (turn + 0.3);  // towards the hand
    world_.placeBodies(pushed);
    return world_.step(drive, period_s);
  }
  void contacts(ContactList& contacts) const noexcept override { world_.contacts(contacts); }
  void selfForces(SelfForces& forces) const noexcept override { world_.selfForces(forces); }

 private:
  PhysicsWorld& world_;
  double mass_kg_, force_n_, frequency_hz_;
  double time_s_ = 0.0;
  BodyState body_;
};

/// A person who holds a position.
std::unique_ptr<HapticDevice> staying(const Models& m, double period_s) {
  return std::make_unique<SimulatedDevice>(
      m.device, m.patient,
      std::make_unique<ScriptedPlayer>(
          Intention::throughWaypoints({{0.0, AxisPosition(m.device.axisCount())}})),
      period_s);
}

struct PushOutcome {
  double most_j = 0.0;   ///< energy given to the person, less the device's own damping
  double tanks_j = 0.0;  ///< Ĥ, the capacity of the tanks
  bool stopped = false;  ///< stopped because the world made energy
};

PushOutcome pushWith(const std::string& engine, double force_n, double frequency_hz, double rate_hz,
                     bool with_tank, double seconds = 20.0) {
  Models m = load(shippedFiles());
  const int axes = m.device.axisCount();
  const double face_m = reach(m.hand, AxisPosition(axes), Eigen::Vector3d::UnitX());
  SceneBody plate = fixedBox({face_m + 0.0105, 0.0, 0.0}, {0.02, 0.4, 0.4});
  plate.fixed = false;
  plate.mass_kg = 1.0;
  plate.inertia_kg_m2 = 0.02 * Eigen::Matrix3d::Identity();
  m.scene.bodies = {plate};
  m.scene.gravity_m_s2.setZero();
  RigOptions options;
  options.period_s = 1.0 / rate_hz;
  options.engine = engine;
  auto device = staying(m, options.period_s);
  const auto rig = build(std::move(m), std::move(device), options);
  MotorWorld world(*rig->world, 1.0, force_n, frequency_hz);
  RendererConfig config = rig->renderer->config();
  PushOutcome out;
  out.tanks_j = config.safety.tank.hand_capacity;
  if (!with_tank) config.safety.tank = {};
  HapticRenderer renderer(*rig->device, world, rig->models.hand, rig->models.scene, config);
  EXPECT_TRUE(renderer.arm());
  double given_j = 0.0;
  TickRecord before;
  runTicks(renderer, static_cast<int>(seconds * rate_hz), [&](const TickRecord& r) {
    if (r.tick > 0 && before.authority == 1.0) {
      for (int a = 0; a < axes; ++a) {
        const double way = r.q_m[a] - before.q_m[a];
        given_j += before.sent[a] * way -
                   rig->models.device.axes[a].damping * way * way / options.period_s;
      }
    }
    out.most_j = std::max(out.most_j, given_j);
    out.stopped = out.stopped || any(r.faults & kStoppingFaults);
    before = r;
  });
  return out;
}

class ActiveWorld : public testing::TestWithParam<std::string> {};

TEST_P(ActiveWorld, MotorWorld_GivesTwiceTheTanksCapacityAtMostAndIsStopped) {
  auto random = seededRandom(91);
  double most_j = 0.0, without_j = 0.0;
  int stopped = 0;
  const int draws = fullCounts() ? 60 : 6;
  for (int i = 0; i < draws; ++i) {
    // Every second motor pumps slowly: it need not empty the tank, but must not give more either.
    const bool slow = i % 2 == 1;
    const double force_n = slow ? uniform(random, 0.2, 5.0) : uniform(random, 5.0, 60.0);
    const double frequency_hz = slow ? uniform(random, 0.05, 0.5) : uniform(random, 0.5, 4.0);
    const double rate_hz = 1000.0 * std::pow(2.0, static_cast<double>(random() % 3U));
    SCOPED_TRACE(std::to_string(force_n) + " N at " + std::to_string(frequency_hz) + " Hz, " +
                 std::to_string(rate_hz) + " Hz");
    const PushOutcome with =
        pushWith(GetParam(), force_n, frequency_hz, rate_hz, true, slow ? 60.0 : 20.0);
    EXPECT_LE(with.most_j, 2.0 * with.tanks_j + 0.05);  // Ĥ until the tank is empty, and Ĥ of debt
    stopped += with.stopped ? 1 : 0;
    most_j = std::max(most_j, with.most_j);
    if (i == 0) without_j = pushWith(GetParam(), force_n, frequency_hz, rate_hz, false).most_j;
  }
  figure("energy that a motor in the world gives a person at most, " + GetParam(), most_j, "J");
  figure("the same without the tank, the first motor", without_j, "J");
  figure("of so many motors stopped", stopped, ("of " + std::to_string(draws)).c_str());
  EXPECT_GT(stopped, 0);
}
INSTANTIATE_TEST_SUITE_P(Engines, ActiveWorld, testing::ValuesIn(builtEngines()),
                         [](const auto& tested) { return withoutHyphens(tested.param); });

/// Power of friction at its limit that drove a slip along a fixed wall, in the step between two
/// records [W].
double powerOfDrivenSlip(const Models& m, const ArticulatedBody& hand, const TickRecord& before,
                         const TickRecord& now) {
  double power_w = 0.0;
  for (int i = 0; i < before.contact_count; ++i) {
    const Contact& c = before.contacts[i];
    const Eigen::Vector3d normal = c.normal.eigen(), force_n = c.force_n.eigen();
    const double pressed_n = force_n.dot(normal);
    const Eigen::Vector3d rubs_n = force_n - pressed_n * normal;
    const double friction = std::sqrt(m.scene.hand_friction *
                                      m.scene.bodies[static_cast<std::size_t>(c.body)].friction);
    if (rubs_n.norm() < 0.9 * friction * pressed_n || rubs_n.norm() < 0.1) continue;
    std::array<double, kMaxAxes> row{};
    hand.reducedPointRow(c.link, c.point_m.eigen(), rubs_n.normalized(), row.data());
    double along_m_s = 0.0;
    for (int a = 0; a < now.qd_s.size(); ++a) along_m_s += row[a] * now.qd_s[a];
    power_w += rubs_n.norm() * std::max(along_m_s, 0.0);
  }
  return power_w;
}

/// A person presses and rubs the hand in random postures against walls around it. While an axis is
/// saturated, more drives the avatar than the person feels: then the tank may damp, and once in
/// thousands of runs it stops.
TEST(PassiveWorld, PressedAndRubbedAnywhere_NeverEmptiesTheTank) {
  auto random = seededRandom(92);
  int touched = 0, stopped = 0;
  double rubbed_m = 0.0, driven_j = 0.0, tank_j = 0.0;
  const int draws = fullCounts() ? 1500 : 40;
  for (int i = 0; i < draws; ++i) {
    SCOPED_TRACE("draw " + std::to_string(i));
    Models m = load(shippedFiles("lambda-pride", "empty",
                                 i % 2 == 0 ? "adult-median-right" : "adult-median-left"));
    const int axes = m.device.axisCount();
    const auto anywhere = [&](double share) {
      AxisPosition q(axes);
      for (int a = 0; a < axes; ++a) {
        const DeviceAxis& axis = m.device.axes[a];
        const bool base = axis.group == AxisGroup::kBase;
        q[a] = base ? uniform(random, share * axis.lower, share * axis.upper)
                    : (random() % 3U == 0 ? 0.0 : uniform(random, 0.0, axis.upper));
      }
      return q;
    };
    const AxisPosition start = anywhere(0.1);
    for (const double side : {1.0, -1.0}) {
      for (int k = 0; k < 3; ++k) {
        if (random() % 2U == 0) continue;
        const Eigen::Vector3d along = side * Eigen::Vector3d::Unit(k);
        const double face_m = reach(m.hand, start, along) + uniform(random, 0.002, 0.03);
        m.scene.bodies.push_back(wall(along, face_m));
        m.scene.bodies.back().name += std::to_string(m.scene.bodies.size());
        m.scene.bodies.back().friction = uniform(random, 0.0, 1.5);
      }
    }
    std::vector<Waypoint> way{{0.4, start}};
    for (double t = 0.9; t < 3.0; t += uniform(random, 0.2, 0.8)) way.push_back({t, anywhere(1.0)});
    RigOptions options;
    options.period_s = 1e-3 / std::pow(2.0, static_cast<double>(random() % 3U));
    auto device = std::make_unique<SimulatedDevice>(
        m.device, m.patient, std::make_unique<ScriptedPlayer>(Intention::throughWaypoints(way)),
        options.period_s);
    const auto rig = build(std::move(m), std::move(device), options);
    if (!rig->renderer->arm()) continue;  // the hand starts inside itself
    TickRecord before;
    before.q_s = start;
    ArticulatedBody hand(rig->models.hand);
    bool saturated = false, gave = false;
    double driven_here_j = 0.0;
    tank_j = rig->renderer->config().safety.tank.hand_capacity;
    runTicks(*rig->renderer, static_cast<int>(3.5 / options.period_s), [&](const TickRecord& r) {
      saturated = saturated || any(r.faults & Fault::kEffortLimit);
      gave = gave || any(r.faults & Fault::kWorldGivesEnergy);
      const Fault empty = Fault::kTankEmpty | Fault::kWorldGivesEnergy;
      ASSERT_FALSE(any(r.faults & empty) && !saturated) << r.time_s << " s";
      touched += r.contact_count > 0 ? 1 : 0;
      if (before.contact_count > 0 && r.authority == 1.0) {  // a stopped avatar stays
        hand.updateKinematics(before.theta);
        driven_here_j += options.period_s * powerOfDrivenSlip(rig->models, hand, before, r);
        rubbed_m += std::abs(r.q_s[1] - before.q_s[1]);
      }
      before = r;
    });
    if (HasFatalFailure()) return;
    stopped += gave ? 1 : 0;
    driven_j = std::max(driven_j, driven_here_j);
  }
  figure("energy that friction at its limit gave along walls, most in 3.5 s", driven_j, "J");
  figure("stopped while saturated", stopped, ("of " + std::to_string(draws)).c_str());
  EXPECT_LE(driven_j, 0.1 * tank_j);
  EXPECT_LE(stopped, 1 + draws / 500);
  EXPECT_GT(touched, 1000);
  EXPECT_GT(rubbed_m, 0.1);
}

}  // namespace
}  // namespace wholehand::test
