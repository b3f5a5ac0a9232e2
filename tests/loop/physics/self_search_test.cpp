// The search for capsules of a hand that are near each other: closed form, and skipped searches.
#include "files/hand/self_contacts.hpp"
#include "files/scene/separation.hpp"
#include "loop/model/capsule_gap.hpp"
#include "loop/physics/engine_bench.hpp"
#include "loop/physics/self_contact_search.hpp"
#include "support/seed.hpp"

#include <cmath>

namespace wholehand::test {
namespace {

using Random = std::mt19937_64;

Eigen::Vector3d anywhere(Random& random, double half_m) {
  const double x = uniform(random, -half_m, half_m), y = uniform(random, -half_m, half_m);
  return {x, y, uniform(random, -half_m, half_m)};
}

/// The same capsules through separation(), which uses another algorithm.
double bySeparation(const PlacedSegment& a, const PlacedSegment& b) {
  const auto shape = [](const PlacedSegment& s, Pose& at) {
    Shape out;
    out.type = ShapeType::kCapsule;
    out.radius_m = s.radius_m;
    out.length_m = (s.b_m - s.a_m).norm();
    at.translation_m = 0.5 * (s.a_m + s.b_m);
    at.rotation = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), s.b_m - s.a_m)
                      .toRotationMatrix();
    return out;
  };
  Pose at_a, at_b;
  const Shape form_a = shape(a, at_a), form_b = shape(b, at_b);
  return separation(form_a, at_a, form_b, at_b);
}

TEST(CapsuleGap, RandomCapsules_GiveTheirSeparation) {
  Random random = seededRandom(71);
  double worst_m = 0.0;
  for (int i = 0; i < 2000; ++i) {
    PlacedSegment a{anywhere(random, 0.05), anywhere(random, 0.05), 0.008};
    PlacedSegment b{anywhere(random, 0.05), anywhere(random, 0.05), 0.009};
    if (i % 5 == 0) b.b_m = b.a_m + 0.8 * (a.b_m - a.a_m);  // parallel
    const CapsuleGap gap = capsuleGap(a, b);
    worst_m = std::max(worst_m, std::abs(gap.distance_m - bySeparation(a, b)));
    EXPECT_NEAR(gap.normal.norm(), 1.0, tolerance(1e-12));
    // Moving one along the normal increases the distance by the same amount.
    const Eigen::Vector3d away_m = 1e-3 * gap.normal;
    const PlacedSegment moved{a.a_m + away_m, a.b_m + away_m, a.radius_m};
    EXPECT_LE(capsuleGap(moved, b).distance_m, gap.distance_m + 1e-3 + tolerance(1e-12));
    EXPECT_GE(capsuleGap(moved, b).distance_m, gap.distance_m + 1e-3 - tolerance(1e-4));
  }
  EXPECT_LE(worst_m, tolerance(1e-9));
}

TEST(CapsuleGap, CrossingAxesAndPoints_HaveANormal) {
  const PlacedSegment along{{-0.02, 0, 0}, {0.02, 0, 0}, 0.01};
  const PlacedSegment across{{0, -0.02, 0}, {0, 0.02, 0}, 0.01};
  const CapsuleGap crossing = capsuleGap(along, across);
  EXPECT_NEAR(crossing.distance_m, -0.02, tolerance(1e-15));
  EXPECT_NEAR(std::abs(crossing.normal.z()), 1.0, tolerance(1e-15));
  const PlacedSegment point{{0, 0, 0}, {0, 0, 0}, 0.01};
  EXPECT_NEAR(capsuleGap(point, point).normal.norm(), 1.0, tolerance(1e-15));
  EXPECT_NEAR(capsuleGap(point, {{0.03, 0, 0}, {0.03, 0, 0}, 0.005}).distance_m, 0.015,
              tolerance(1e-15));
}

TEST(SelfContactSearch, AlongAnyMotion_ReportsEveryNearPair) {
  const Models m = load(shippedFiles());
  const HandModel& hand = m.hand;
  Random random = seededRandom(72);
  int reported = 0;
  for (int run = 0; run < cases(20); ++run) {
    SelfContactSearch search(hand);
    AxisPosition from(6), to(6);
    from[4] = uniform(random, 0.0, 1.5);
    search.reset(&handAt(hand, from).linkPose(0), from);
    for (int leg = 0; leg < 5; ++leg) {
      for (int a = 0; a < 6; ++a) to[a] = uniform(random, hand.axis_lower[a], hand.axis_upper[a]);
      if (leg % 2 == 0) {  // towards a fist, so that there is something to report
        to[3] = hand.axis_upper[3];
        to[5] = hand.axis_upper[5];
      }
      for (int k = 1; k <= 100; ++k) {
        AxisPosition q(6);
        for (int a = 0; a < 6; ++a) q[a] = from[a] + (to[a] - from[a]) * (k / 100.0);
        const ArticulatedBody body = handAt(hand, q);
        search.update(&body.linkPose(0), q);
        int i = 0;
        for (std::size_t p = 0; p < hand.self_contacts.size(); ++p) {
          const auto placed = [&](int capsule) -> PlacedSegment {
            const Capsule& c = hand.capsules[capsule];
            return {body.linkPose(c.link) * c.a_m, body.linkPose(c.link) * c.b_m, c.radius_m};
          };
          const CapsuleGap gap = capsuleGap(placed(hand.self_contacts[p].capsule_a),
                                            placed(hand.self_contacts[p].capsule_b));
          if (gap.distance_m >= SelfContactSearch::kNear_m) continue;
          ASSERT_LT(i, search.count()) << "a pair that is near was not reported";
          EXPECT_EQ(search.near(i).pair, static_cast<int>(p));
          EXPECT_EQ(search.near(i).gap.distance_m, gap.distance_m);
          ++i;
          ++reported;
        }
        EXPECT_EQ(i, search.count());
      }
      from = to;
    }
  }
  if (kStatisticsMeaningful) EXPECT_GT(reported, 100);
}

}  // namespace
}  // namespace wholehand::test
