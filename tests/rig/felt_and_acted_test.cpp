// Rendered effort compared with contact effort: every shipped device with every hand in random
// postures, on every axis.
#include "rig/ball_clearance.hpp"
#include "support/rig_tools.hpp"
#include "support/seed.hpp"
#include "support/shipped.hpp"

#include <cmath>

namespace wholehand::test {
namespace {

/// A world that stands still and keeps the drive of the hand.
class StandingWorld final : public PhysicsWorld {
 public:
  /// @pre world outlives this
  explicit StandingWorld(PhysicsWorld& world) : world_(world) {}
  [[nodiscard]] Expected<Done> placeHand(const AxisPosition& q_s) override {
    return world_.placeHand(q_s);
  }
  [[nodiscard]] Fault observe(PhysicsState& state) noexcept override {
    return world_.observe(state);
  }
  void placeBodies(const BodyPlacements&) noexcept override {}
  [[nodiscard]] Fault step(const HandDrive& drive, double) noexcept override {
    drive_ = drive;
    return Fault::kNone;
  }
  void contacts(ContactList& contacts) const noexcept override { world_.contacts(contacts); }
  void selfForces(SelfForces& forces) const noexcept override { world_.selfForces(forces); }
  [[nodiscard]] const HandDrive& drive() const { return drive_; }

 private:
  PhysicsWorld& world_;
  HandDrive drive_;
};

class Draw {
 public:
  explicit Draw(unsigned stream) : random_(seededRandom(stream)) {}
  double between(double from, double to) {
    return from + (to - from) * static_cast<double>(random_() >> 11U) * 0x1.0p-53;
  }
  Eigen::Vector3d direction() {
    const double z = between(-1.0, 1.0), turn = between(-M_PI, M_PI);
    const double r = std::sqrt(1.0 - z * z);
    return {r * std::cos(turn), r * std::sin(turn), z};
  }
  /// A random posture in the middle nine tenths of every range.
  AxisPosition posture(const DeviceModel& device) {
    AxisPosition q(device.axisCount());
    for (int a = 0; a < q.size(); ++a) {
      const DeviceAxis& axis = device.axes[a];
      const double edge = 0.05 * (axis.upper - axis.lower);
      q[a] = between(axis.lower + edge, axis.upper - edge);
    }
    return q;
  }
  std::size_t below(std::size_t count) { return random_() % count; }

 private:
  std::mt19937_64 random_;
};

/// Files of every shipped device with every hand; a tenth of them under a sanitizer.
std::vector<ModelFiles> everyHandOnEveryDevice() {
  std::vector<ModelFiles> all;
  for (const std::string& device : shipped("devices")) {
    for (const std::string& hand : shipped("hands")) {
      all.push_back(shippedFiles(device, "empty", hand));
    }
  }
  return sampleTenth(all);
}

/// Gᵀ (τ - h) + A a: the effort on the hand in the person's coordinates, computed by separate
/// dynamics.
AxisEffort acting(const HandModel& hand, const AxisPosition& q_s, const HandDrive& drive) {
  ArticulatedBody body(hand);
  JointPosition theta;
  Synergy(hand).expand(q_s, theta);
  EXPECT_TRUE(body.update(theta, JointVelocity(hand.joint_count), {0.0, 0.0, -9.81}));
  AxisEffort out(q_s.size());
  out.vec() = hand.synergy.transpose() * (drive.torque.vec() - body.bias().vec());
  for (int a = 0; a < drive.armature_effort.size(); ++a) out[a] += drive.armature_effort[a];
  return out;
}

/// Largest |rendered / acting - 1| of a hand that cannot move, while the device is displaced on
/// every axis by a third of what the effort limit allows.
double worstShare(const ModelFiles& files, Draw& draw) {
  Models m = load(files);
  const AxisPosition at = draw.posture(m.device);
  AxisPosition off = at;
  for (int a = 0; a < at.size(); ++a) {
    const double most = 0.3 * m.device.axes[a].effort_limit / m.rendering.axes[a].k_pm;
    const DeviceAxis& axis = m.device.axes[a];
    const bool up = at[a] < 0.5 * (axis.lower + axis.upper);  // inwards: the range is the device's
    const double way = std::min(most, 0.5 * (axis.upper - axis.lower));
    off[a] += (up ? 1.0 : -1.0) * draw.between(0.3, 1.0) * way;
  }
  const auto rig = buildScripted(std::move(m), moveAndHold(at, off, 100));
  StandingWorld world(*rig->world);
  HapticRenderer renderer(*rig->device, world, rig->models.hand, rig->models.scene,
                          rig->renderer->config());
  if (!renderer.arm()) throw std::runtime_error("not armed");
  const auto last = runTicks(renderer, 500);
  EXPECT_EQ(last->safety_state, SafetyState::kRendering);
  EXPECT_EQ(last->faults, Fault::kNone);
  const AxisEffort acts = acting(rig->models.hand, last->q_s, world.drive());
  const AxisEffort neutral = rig->models.device.neutral();
  double worst = 0.0;
  for (int a = 0; a < acts.size(); ++a) {
    worst = std::max(worst, std::abs(-(last->sent[a] - neutral[a]) / acts[a] - 1.0));
  }
  return worst;
}

TEST(FeltAndActed, HandThatIsHeld_RendersItsDriveOnEveryAxis) {
  Draw draw(71);
  double worst = 0.0;
  int postures = 0;
  for (const ModelFiles& files : everyHandOnEveryDevice()) {
    SCOPED_TRACE(files.device + ", " + files.hand);
    for (int n = 0; n < cases(17); ++n, ++postures) {
      const double share = worstShare(files, draw);
      worst = std::max(worst, share);
      ASSERT_LE(share, tolerance(0.005));
    }
  }
  figure("felt over acting, less 1, worst axis of all postures", worst, "");
  figure("postures of every device and hand", postures, "");
}

/// Small fixed balls 1 mm off the skin, near some capsules of the hand.
std::vector<SceneBody> ballsAbout(const HandModel& hand, const AxisPosition& q, Draw& draw) {
  constexpr double kRadius_m = 0.008, kGap_m = 0.001;
  constexpr int kBalls = 5;
  const ArticulatedBody body = handAt(hand, q);
  std::vector<SceneBody> balls;
  for (int tries = 0; tries < 1000 && balls.size() < kBalls; ++tries) {
    const Capsule& c = hand.capsules[draw.below(hand.capsules.size())];
    const Pose& pose = body.linkPose(c.link);
    const Eigen::Vector3d on = pose * (c.a_m + draw.between(0.0, 1.0) * (c.b_m - c.a_m));
    const Eigen::Vector3d at = on + (c.radius_m + kRadius_m + kGap_m) * draw.direction();
    if (clearance_m(body, at, kRadius_m) < 0.9 * kGap_m) continue;
    balls.push_back(ball(at, kRadius_m, 0.0));
    balls.back().name = "ball " + std::to_string(balls.size());
  }
  return balls;
}

/// Virtual work of the hand's self-contacts and joint ends, per axis.
AxisEffort workOfTheHandItself(const Rig& rig, const AxisPosition& q_s) {
  SelfForces own;
  rig.world->selfForces(own);
  AxisEffort work = virtualWork(rig.models.hand, q_s, own);
  for (int a = 0; a < own.joint_ends.size(); ++a) work[a] += own.joint_ends[a];
  return work;
}

struct Hold {
  int contacts = 0;
  double speed = 0.0;  ///< of the fastest axis at the end [rad/s or m/s]
  double worst = 0.0;  ///< largest |rendered effort - virtual work| relative to the load of the
                       ///< axis or its kind
};

/// Moves the hand among fixed balls on every axis at once and holds it until it rests, for at most
/// 10 s.
Hold hold(const ModelFiles& files, Draw& draw) {
  Models m = load(files);
  const AxisPosition at = draw.posture(m.device);
  AxisPosition off = at;
  for (int a = 0; a < at.size(); ++a) {
    const DeviceAxis& axis = m.device.axes[a];
    const double most = 0.5 * axis.effort_limit / m.rendering.axes[a].k_pm;
    off[a] = std::clamp(at[a] + draw.between(-most, most), axis.lower, axis.upper);
  }
  m.scene.bodies = ballsAbout(m.hand, at, draw);
  const auto rig = buildScripted(std::move(m), moveAndHold(at, off, 400));
  if (!rig->renderer->arm()) throw std::runtime_error("not armed");
  const auto speed = [](const TickRecord& r) { return r.qd_s.vec().cwiseAbs().maxCoeff(); };
  constexpr int kTicks = 1000, kMostTicks = 10000;
  auto last = runTicks(*rig->renderer, kTicks);
  for (int from = kTicks; speed(*last) > 1e-5 && from < kMostTicks; from += kTicks) {
    last = runTicks(*rig->renderer, kTicks, {}, from);
  }
  EXPECT_EQ(last->safety_state, SafetyState::kRendering);
  const AxisEffort bodies = virtualWork(rig->models.hand, last->q_s, *last);
  const AxisEffort itself = workOfTheHandItself(*rig, last->q_s);
  const AxisEffort neutral = rig->models.device.neutral();
  std::array<double, 2> largest{};  // of translations, of rotations
  for (int a = 0; a < at.size(); ++a) {
    double& most = largest[static_cast<std::size_t>(rig->models.device.axes[a].kind)];
    most = std::max(most, std::abs(bodies[a] + itself[a]));
  }
  Hold out{last->contact_count, speed(*last)};
  for (int a = 0; a < at.size(); ++a) {
    const double acted = bodies[a] + itself[a];
    const double kind = largest[static_cast<std::size_t>(rig->models.device.axes[a].kind)];
    // An axis with almost no load is measured against a tenth of its kind's load.
    const double scale = std::max({std::abs(acted), 0.1 * kind, 1e-3});
    out.worst = std::max(out.worst, std::abs(last->sent[a] - neutral[a] - acted) / scale);
  }
  return out;
}

TEST(FeltAndActed, HandHeldAmongBalls_RendersTheVirtualWorkOfAllForcesOnEveryAxis) {
  Draw draw(72);
  // Rendered and contact efforts differ by inertia: a hand that still slides after 10 s is no
  // static hold, and another posture is drawn.
  constexpr double kRests = 5e-4;  // rad/s, m/s
  double worst = 0.0;
  int held = 0, contacts = 0, slid = 0;
  for (const ModelFiles& files : everyHandOnEveryDevice()) {
    SCOPED_TRACE(files.device + ", " + files.hand);
    for (int n = 0; n < cases(1);) {
      const Hold one = hold(files, draw);
      if (one.speed > kRests) {
        ASSERT_LE(++slid, 3 + held / 10) << "holds that rest are rare";
        continue;
      }
      ++n, ++held;
      contacts += one.contacts > 0 ? 1 : 0;
      worst = std::max(worst, one.worst);
      EXPECT_LE(one.worst, tolerance(0.02)) << "hold " << n;
    }
  }
  figure("hand held among balls: felt effort against virtual work, worst axis", worst * 100.0, "%");
  figure("holds that slid on and were drawn again", slid, "");
  figure("holds of every device and hand", held, "");
  figure("of these with a body touched", contacts, "");
  EXPECT_GE(2 * contacts, held);
}

}  // namespace
}  // namespace wholehand::test
