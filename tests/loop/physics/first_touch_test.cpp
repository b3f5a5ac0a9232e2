// First touch of a hand axis, compared with the exact separation of the shapes along its whole
// travel.
#include "loop/core/compiler.hpp"
#include "loop/physics/still_hand.hpp"
#include "support/seed.hpp"

#include <cmath>

namespace wholehand::test {
namespace {

Shape box(const Eigen::Vector3d& half_m) {
  Shape s;
  s.half_extents_m = half_m;
  return s;
}
Shape mesh(const Eigen::Vector3d& half_m) {
  Shape s;
  s.type = ShapeType::kConvexMesh;
  for (int i = 0; i < 8; ++i) {
    s.points_m.emplace_back((i & 1 ? 1 : -1) * half_m.x(), (i & 2 ? 1 : -1) * half_m.y(),
                            (i & 4 ? 0.7 : -1) * half_m.z());
  }
  s.points_m.emplace_back(0.0, 0.0, 1.3 * half_m.z());
  return s;
}

struct NamedShape {
  const char* name;
  Shape shape;
};
void PrintTo(const NamedShape& n, std::ostream* out) {
  *out << n.name;
}

// The search itself counts a micrometre as touching.
constexpr double kGraze_m = 1e-6;

/// True if there is no touch in both, both are at the open end, or they are near each other.
bool sameTouch(double a, double b, double within) {
  return (std::isnan(a) && std::isnan(b)) || a == b || std::abs(a - b) < within;
}

struct TouchCounts {
  int touches = 0, misses = 0, open_ends = 0;
};

/// Draws resting hands with a body near them and checks those from `first` to `last`: the first
/// touch that is known of each axis after 50 ticks is compared with the separation along its whole
/// travel.
TouchCounts expectFirstTouches(const NamedShape& named, std::mt19937_64 random, int first,
                               int last) {
  Still still(sceneOf(named.shape));
  still.scene.bodies[0].shapes[0].in_body.translation_m = {0.01, 0.0, 0.0};
  still.closure = AxisClosure(still.model, still.scene);
  still.findMoved();
  const auto draw = [&](double from, double to) {
    return from + (to - from) * static_cast<double>(random() >> 11U) * 0x1.0p-53;
  };
  TouchCounts found;
  int slowest = 0;
  double worst_gap_m = 0.0;
  for (int n = 0; n <= last; ++n) {
    // The body is anywhere about the hollow of the palm, upright or tilted; the hand is anywhere,
    // half closed.
    still.q[0] = draw(-0.08, 0.08), still.q[1] = draw(-0.1, 0.1), still.q[2] = draw(-0.1, 0.1);
    still.q[kFingers] = draw(0.0, 2.5), still.q[kCircumduction] = draw(0.0, 1.5);
    still.q[kThumb] = draw(0.0, 1.3);
    still.body_pose.rotation =
        Eigen::Quaterniond(draw(-1, 1), draw(-1, 1), draw(-1, 1), draw(-1, 1))
            .normalized()
            .toRotationMatrix();
    if (n % 2 == 0) still.body_pose.rotation.setIdentity();
    still.body_pose.translation_m =
        Eigen::Vector3d(still.q[0] + draw(0.02, 0.16), still.q[1] + draw(-0.02, 0.1),
                        still.q[2] + draw(-0.06, 0.08));
    if (n < first) continue;
    still.closure.reset();
    AxisPosition at50 = still.tick();
    for (int k = 1; k < 50; ++k) at50 = still.tick();
    AxisPosition settled = at50;
    for (int k = 0; k < 300; ++k) settled = still.tick();
    still.closure.reset();
    for (int k = 1; k <= 50; ++k) {
      const AxisPosition now = still.tick();
      for (int a = kFingers; a <= kThumb; ++a) {
        if (!sameTouch(now[a], settled[a], 1e-4)) slowest = std::max(slowest, k);
      }
    }
    for (int a = kFingers; a <= kThumb; ++a) {
      SCOPED_TRACE(still.model.axis_names[a] + ", case " + std::to_string(n));
      const double touch = at50[a];
      // 0.1 mm of path, at the lever arm of 8 cm.
      EXPECT_TRUE(sameTouch(touch, settled[a], 1.25e-3)) << touch << " and " << settled[a];
      const double lower = still.model.axis_lower[a], upper = still.model.axis_upper[a];
      // There is no overlap before the first touch,
      const double end = std::isnan(touch) ? upper : touch;
      for (double v = lower; v < end - 1e-5; v += 0.01) {
        const double apart_m = still.separationAt(a, v);
        EXPECT_GT(apart_m, -kGraze_m) << "at " << v << ", said " << touch;
        if (apart_m <= -kGraze_m) break;
      }
      // and the shapes meet there.
      if (std::isnan(touch)) {
        ++found.misses;
      } else if (touch == -kInfinity) {
        ++found.open_ends;
        EXPECT_LE(still.separationAt(a, lower), 1e-6);
      } else {
        ++found.touches;
        const double gap_m = std::abs(still.separationAt(a, touch));
        worst_gap_m = std::max(worst_gap_m, gap_m);
        EXPECT_LE(gap_m, tolerance(2e-6));
      }
    }
  }
  std::printf(
      "figure: %s: %d touches, %d never, %d open ends; slowest %d ticks, worst gap %.2g um\n",
      named.name, found.touches, found.misses, found.open_ends, slowest, worst_gap_m * 1e6);
  EXPECT_LT(slowest, 50);
  return found;
}

class FirstTouch : public testing::TestWithParam<NamedShape> {};

TEST_P(FirstTouch, RestingHand_IsFoundWithin50TicksAndIsTheFirst) {
  const int hands = kReducedCounts ? 6 : 50;
  const TouchCounts found = expectFirstTouches(GetParam(), seededRandom(31), 0, hands - 1);
  if (!kStatisticsMeaningful) return;
  EXPECT_GT(found.touches, hands * 3 / 10);
  EXPECT_GT(found.misses, hands / 10);
  EXPECT_GT(found.open_ends, 0);
}
INSTANTIATE_TEST_SUITE_P(Shapes, FirstTouch,
                         testing::Values(NamedShape{"bottle", cylinder(0.025, 0.2)},
                                         NamedShape{"disk", cylinder(0.04, 0.02)},
                                         NamedShape{"box", box({0.02, 0.03, 0.04})},
                                         NamedShape{"sphere", ballShape(0.03)},
                                         NamedShape{"mesh", mesh({0.03, 0.025, 0.035})}));

// Hands for which an earlier search took 51 to 151 ticks: a capsule passes a face or an edge at 0.1
// mm and hardly approaches it. In the last case the distance was wrong by 2 µm.
TEST(SlowFirstTouch, CapsulePassingAlongAFaceOrAnEdge_IsFoundWithin50TicksAndIsTheFirst) {
  struct Case {
    bool disk;
    unsigned seed;
    int hand;
  };
  const NamedShape disk{"disk", cylinder(0.04, 0.02)}, body{"box", box({0.02, 0.03, 0.04})};
  for (const Case c : {Case{false, 1795506192U, 13}, Case{false, 132U, 18}, Case{true, 21U, 6},
                       Case{true, 47U, 12}, Case{true, 57U, 21}, Case{false, 154U, 17}}) {
    SCOPED_TRACE("seed " + std::to_string(c.seed));
    std::seed_seq mixed{c.seed, 0U, 31U};
    const TouchCounts found =
        expectFirstTouches(c.disk ? disk : body, std::mt19937_64(mixed), c.hand, c.hand);
    EXPECT_EQ(found.touches + found.misses + found.open_ends, 3);
  }
}

}  // namespace
}  // namespace wholehand::test
