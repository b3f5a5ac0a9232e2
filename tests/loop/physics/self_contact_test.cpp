// A hand that touches itself, through the whole renderer: a pinch without an object and a fist.
#include "loop/physics/bullet/bullet_world.hpp"
#include "loop/realtime/allocation_counter.hpp"
#include "support/rig_tools.hpp"
#include "support/seed.hpp"
#include "support/shipped.hpp"
#include "support/tolerance.hpp"

#include <cmath>
#include <cstring>

namespace wholehand::test {
namespace {

struct ClosingHand {
  const char* name;
  double fingers, circumduction, thumb;  ///< the person's target [rad]
};
// Found by closing in steps: thumb tip on the index; on index and middle; a fist around the thumb.
constexpr std::array<ClosingHand, 3> kClosings{
    {{"pinch", 2.3, 1.2, 1.39}, {"three tips", 2.3, 1.4, 1.39}, {"fist", 3.14, 1.57, 1.39}}};

/// Moves from the open hand with an opposed thumb to the posture in half a second, then holds it.
ScriptedDevice::Script close(const ClosingHand& c, int ticks = 500) {
  return [c, ticks](int read) {
    const double u = std::min(1.0, static_cast<double>(read) / ticks);
    AxisPosition q(6);
    q[3] = u * c.fingers, q[4] = c.circumduction, q[5] = u * c.thumb;
    return q;
  };
}

std::unique_ptr<Rig> closingRig(const ClosingHand& c,
                                const std::string& hand = "adult-median-right") {
  Models m = load(shippedFiles("lambda-pride", "empty", hand));
  m.scene.gravity_m_s2.setZero();
  return buildScripted(std::move(m), close(c));
}

SelfForces forcesOf(const Rig& rig) {
  SelfForces forces;
  rig.world->selfForces(forces);
  return forces;
}

TEST(SelfContact, HeldClosed_RendersTheVirtualWorkOfItsForcesAndPushesNoArm) {
  double worst = 0.0, base = 0.0, deepest_m = 0.0;
  for (const ClosingHand& c : kClosings) {
    SCOPED_TRACE(c.name);
    const auto rig = closingRig(c);
    ASSERT_TRUE(rig->renderer->arm());
    const auto last = runTicks(*rig->renderer, 4000, [&](const TickRecord&) {
      const SelfForces now = forcesOf(*rig);
      for (int i = 0; i < now.count; ++i) {
        deepest_m = std::max(deepest_m, -now.touches[i].distance_m);
      }
    });
    const SelfForces forces = forcesOf(*rig);
    ASSERT_GT(forces.count, 0);
    EXPECT_EQ(last->contact_count, 0) << "nothing else is there to be touched";
    EXPECT_LE(last->coupling_error_rad, tolerance(1e-9)) << "no load on the coupling";
    double largest = 0.0, off = 0.0;
    for (int a = 3; a < 6; ++a) {
      const double acted = virtualWork(rig->models.hand, last->q_s, forces)[a];
      largest = std::max(largest, std::abs(acted));
      off = std::max(off, std::abs(last->coupling[a] - acted));
    }
    // The contact keeps the thumb and the fingers from closing.
    EXPECT_LT(last->coupling[3], -0.02);
    EXPECT_LT(last->coupling[5], -0.02);
    EXPECT_GT(largest, 0.05);
    worst = std::max(worst, off / largest);
    // Inner forces have no resultant, so at rest the base has no effort from them.
    for (int a = 0; a < 3; ++a) {
      base = std::max(base, std::abs(last->coupling[a]) / largest);
      EXPECT_NEAR(virtualWork(rig->models.hand, last->q_s, forces)[a], 0.0, tolerance(1e-8));
    }
  }
  figure("closed hand: felt effort against virtual work, share of the largest", worst, "");
  figure("closed hand: felt on x, y, z over felt on the hand's axes", base, "1/m");
  figure("closed hand: deepest overlap", deepest_m * 1e3, "mm");
  EXPECT_LE(worst, tolerance(0.02));
  EXPECT_LE(base, tolerance(1e-9));
  EXPECT_LE(deepest_m, tolerance(5e-4));
}

TEST(SelfContact, RowsOfTheBase_AreExactlyZero) {
  // Action and reaction act at one point, so an axis that carries both links has a row of exact
  // zeros.
  const Models m = load(shippedFiles());
  AxisPosition q(6);
  q[0] = 0.013, q[1] = -0.07, q[3] = 2.2, q[4] = 1.2, q[5] = 1.1;
  const ArticulatedBody body = handAt(m.hand, q);
  ASSERT_FALSE(m.hand.self_contacts.empty());
  for (const SelfPair& pair : m.hand.self_contacts) {
    const int a = m.hand.capsules[pair.capsule_a].link;
    const int b = m.hand.capsules[pair.capsule_b].link;
    const Eigen::Vector3d at(0.05, 0.02, -0.03), n = Eigen::Vector3d(0.3, -0.8, 0.52).normalized();
    std::array<double, kMaxAxes> of_a{}, of_b{};
    body.reducedPointRow(a, at, n, of_a.data());
    body.reducedPointRow(b, at, n, of_b.data());
    for (int axis = 0; axis < 3; ++axis) EXPECT_EQ(of_a[axis] - of_b[axis], 0.0);
  }
}

TEST(SelfContact, AtTheSpeedLimit_NeitherOverlapsNorPassesThrough) {
  double deepest_m = 0.0;
  for (const ClosingHand& c : kClosings) {
    SCOPED_TRACE(c.name);
    Models m = load(shippedFiles());
    m.scene.gravity_m_s2.setZero();
    // 10 rad/s is the speed limit of finger and thumb; afterwards their efforts are at their
    // limits.
    const auto rig = buildScripted(std::move(m), close(c, 330));
    ASSERT_TRUE(rig->renderer->arm());
    int touching = 0;
    const auto last = runTicks(*rig->renderer, 1000, [&](const TickRecord& r) {
      EXPECT_EQ(r.faults & kStoppingFaults, Fault::kNone);
      const SelfForces now = forcesOf(*rig);
      touching += now.count > 0 ? 1 : 0;
      for (int i = 0; i < now.count; ++i) {
        deepest_m = std::max(deepest_m, -now.touches[i].distance_m);
      }
    });
    EXPECT_GT(touching, 500);
    EXPECT_LT(last->q_s[5], c.thumb - 0.02) << "the thumb is stopped";
    EXPECT_LT(last->q_s[3], c.fingers - 0.02) << "and so are the fingers";
  }
  figure("hand closed at its speed limit: deepest overlap", deepest_m * 1e3, "mm");
  EXPECT_LE(deepest_m, tolerance(5e-4));
}

TEST(SelfContact, HeldForAMinute_GainsNoEnergy) {
  const std::uint64_t ticks = kReducedCounts ? 6'000 : 60'000;  // a sanitizer does not check energy
  for (const int i : sampleOne(0, 2)) {
    const ClosingHand& c = kClosings[i];
    SCOPED_TRACE(c.name);
    const auto rig = closingRig(c);
    ASSERT_TRUE(rig->renderer->arm());
    ArticulatedBody body(rig->models.hand);
    // Energy of the avatar and its spring; the device stands still, so nothing may add to it.
    double early_j = 0.0, late_j = 0.0, fastest = 0.0;
    runTicks(*rig->renderer, static_cast<int>(ticks), [&](const TickRecord& r) {
      if (r.tick < 3000) return;
      JointVelocity still(rig->models.hand.joint_count);
      ASSERT_TRUE(body.update(r.theta, still, Eigen::Vector3d::Zero()));
      double energy_j = 0.5 * r.qd_s.vec().dot(body.reducedInertia() * r.qd_s.vec());
      for (int a = 0; a < 6; ++a) {
        energy_j += 0.5 * rig->gains.k_pm[a] * (r.q_m[a] - r.q_s[a]) * (r.q_m[a] - r.q_s[a]);
      }
      (r.tick < 13000 ? early_j : late_j) = std::max(r.tick < 13000 ? early_j : late_j, energy_j);
      if (r.tick + 10'000 >= ticks) fastest = std::max(fastest, r.qd_s.vec().cwiseAbs().maxCoeff());
    });
    figure(std::string(c.name) + " held: fastest axis in the last 10 s of 60", fastest,
           "m/s or rad/s");
    figure(std::string(c.name) + " held: energy gained", late_j - early_j, "J");
    EXPECT_LE(late_j, early_j + tolerance(1e-9));
  }
}

TEST(SelfContact, PersonOnTheDevice_ComesToRest) {
  // The whole loop: the device's mass, friction, delay and encoders, and a person who keeps
  // closing. A rigid stop is one of the passive objects that the gains are certified with.
  for (const std::string& patient :
       sampleTenth<std::string>({"relaxed-adult", "stiff-adult", "spastic"})) {
    for (const int i : sampleOne(0, 2)) {
      const ClosingHand& c = kClosings[i];
      SCOPED_TRACE(patient + ", " + c.name);
      Models m = load(shippedFiles("lambda-pride", "empty", "adult-median-right", patient));
      const AxisPosition open = close(c)(0), shut = close(c)(500);
      const auto rig = orThrow(buildRig(
          std::move(m), Intention::throughWaypoints({{0.0, open}, {0.5, open}, {1.5, shut}}), {}));
      ASSERT_TRUE(rig->renderer->arm());
      AxisPosition first;
      double wandered = 0.0;
      int touching = 0;
      runTicks(*rig->renderer, 10000, [&](const TickRecord& r) {
        ASSERT_EQ(r.faults & kStoppingFaults, Fault::kNone);
        touching += forcesOf(*rig).count > 0 ? 1 : 0;
        if (r.tick == 7000) first = r.q_m;
        if (r.tick < 7000) return;
        wandered = std::max(wandered, (r.q_m.vec() - first.vec()).cwiseAbs().maxCoeff());
      });
      EXPECT_GT(touching, 7000);
      figure(std::string(c.name) + " held: wandered in the last 3 s, " + patient, wandered,
             "m or rad");
      EXPECT_LE(wandered, tolerance(1e-3));
    }
  }
}

TEST(SelfContact, RunAgain_GivesTheSameBits) {
  const auto run = [] {
    std::vector<double> bits;
    const auto rig = closingRig(kClosings[1]);
    EXPECT_TRUE(rig->renderer->arm());
    runTicks(*rig->renderer, 1500, [&](const TickRecord& r) {
      for (int a = 0; a < 6; ++a) bits.insert(bits.end(), {r.q_s[a], r.qd_s[a], r.sent[a]});
    });
    return bits;
  };
  const std::vector<double> first = run(), second = run();
  ASSERT_EQ(first.size(), second.size());
  EXPECT_EQ(std::memcmp(first.data(), second.data(), first.size() * sizeof(double)), 0);
}

TEST(SelfContact, FistAgainstTheFingersEnds_DoesNotAllocate) {
  if (!allocationCountingAvailable()) GTEST_SKIP() << "malloc is not ours to count";
  const ClosingHand c = kClosings[2];
  Models m = load(shippedFiles());
  // Fingers pressed open against their ends, then a fist, then again.
  const auto rig = buildScripted(std::move(m), [c](int read) {
    const double u = 0.5 - 0.5 * std::cos(0.004 * read);
    AxisPosition q(6);
    q[3] = u * c.fingers - 0.01, q[4] = c.circumduction, q[5] = u * c.thumb;
    return q;
  });
  ASSERT_TRUE(rig->renderer->arm());
  auto record = std::make_unique<TickRecord>();
  int touching = 0, at_end = 0;
  std::uint64_t allocations = 0;
  for (std::uint64_t k = 0; k < 4000; ++k) {
    record->tick = k;
    const AllocationScope scope;
    rig->renderer->tick(1, *record);
    allocations += scope.allocations() + scope.releases();
    const SelfForces forces = forcesOf(*rig);
    touching += forces.count > 0 ? 1 : 0;
    at_end += forces.joint_ends[3] > 0.0 ? 1 : 0;
  }
  EXPECT_GT(touching, 100);
  EXPECT_GT(at_end, 30);
  EXPECT_EQ(allocations, 0U);
}

TEST(SelfContact, ArmedClosed_IsNotPushedOpenAndTouchesAfterItHasParted) {
  const ClosingHand c = kClosings[2];
  Models m = load(shippedFiles());
  m.scene.gravity_m_s2.setZero();
  // Closed for 0.5 s, open at 1 s, closed again at 1.5 s.
  const auto rig = buildScripted(std::move(m), [c](int read) {
    const double u = std::clamp(std::abs(read - 1000) / 500.0, 0.0, 1.0);
    AxisPosition q(6);
    q[3] = u * c.fingers, q[4] = c.circumduction, q[5] = u * c.thumb;
    return q;
  });
  ASSERT_TRUE(rig->renderer->arm());
  double pushed = 0.0;
  const auto last = runTicks(*rig->renderer, 2500, [&](const TickRecord& r) {
    if (r.tick < 500) pushed = std::max(pushed, r.coupling.vec().cwiseAbs().maxCoeff());
  });
  EXPECT_LE(pushed, tolerance(1e-9));
  EXPECT_GT(forcesOf(*rig).count, 0);
  EXPECT_LT(last->coupling[5], -0.02);
}

TEST(SelfContact, EveryShippedHand_RendersAFist) {
  for (const std::string& name : sampleTenth(shipped("hands"))) {
    SCOPED_TRACE(name);
    const auto rig = closingRig(kClosings[2], name);
    ASSERT_TRUE(rig->renderer->arm());
    const auto last = runTicks(*rig->renderer, 1500);
    EXPECT_GT(forcesOf(*rig).count, 0);
    EXPECT_LT(last->coupling[3], -0.02);
    EXPECT_LT(last->coupling[5], -0.02);
  }
}

}  // namespace
}  // namespace wholehand::test
