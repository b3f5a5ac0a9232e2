// The whole hand is thrown into a fixed wall at 0.6 m/s and nobody holds it. The throw decides
// which part of the hand hits and whether it gives way.
#include "loop/adversarial/slam.hpp"
#include "support/constants.hpp"
#include "support/test_names.hpp"

#include <cmath>

namespace wholehand::test {
namespace {

/// Rebound share below which fingers or thumb have folded and absorbed the blow. There is then
/// little rebound left to lower.
constexpr double kFolds = 0.45;

struct Posture {
  const char* name;
  double fingers_rad, circumduction_rad;
};
constexpr Posture kStraight{"straight", 0.0, 0.0};
constexpr Posture kReaching{"reaching", 65.0 * kDeg, 5.0 * kDeg};  // as in `experiment exercise`

Throw throwOf(const std::string& device, const std::string& hand, const Posture& posture,
              const std::string& axis, bool towards_upper) {
  return {.device = device,
          .hand = hand,
          .axis = axis,
          .towards_upper = towards_upper,
          .fingers_rad = posture.fingers_rad,
          .circumduction_rad = posture.circumduction_rad};
}

void print(const Throw& how, const Posture& posture, const Pair& pair) {
  const bool rebounds = pair.without.rebound_m_s > 1e-3;  // false: there is no rebound to lower
  const std::string lowered =
      rebounds ? std::to_string(static_cast<int>(std::lround(100.0 * pair.loweredBy()))) : "-";
  std::printf(
      "figure: slam, %s, %s, %s%s %s: rebound undamped -> damped = %.3f -> %.3f m/s (lowered %s "
      "%%), "
      "effort %.1f -> %.1f N%s%s\n",
      how.device.c_str(), how.hand.c_str(), how.axis.c_str(), how.towards_upper ? "+" : "-",
      posture.name, pair.without.rebound_m_s, pair.with.rebound_m_s, lowered.c_str(),
      pair.without.peak_n, pair.with.peak_n, pair.without.share() < kFolds ? ", folds" : "",
      any(pair.without.faults) ? ", undamped stopped by the speed limit" : "");
}

/// Checks that the two throws differ in the damping alone and that no device limit acts.
void expectAFairComparison(const Throw& how, const Pair& pair) {
  EXPECT_EQ(pair.with.faults, Fault::kNone);
  // Without damping, a folding hand may push an axis past its speed limit, which stops the device.
  EXPECT_TRUE(pair.without.faults == Fault::kNone || pair.without.faults == Fault::kSpeedLimit);
  // The last reading before the touch may be up to a tick (0.6 mm, and its slowing down) earlier.
  EXPECT_NEAR(pair.with.impact_m_s, 0.6, 0.016);
  EXPECT_NEAR(pair.with.impact_m_s, pair.without.impact_m_s, 0.016);
  const Models m = thrown(how);
  EXPECT_LT(std::max(pair.with.peak_n, pair.without.peak_n), flungAxis(m, how).effort_limit);
  EXPECT_EQ(pair.with.tank_n + pair.without.tank_n,
            0.0);  // the effect is the damping's, not the tank's
  EXPECT_LT(std::max(pair.with.depth_m, pair.without.depth_m), 1e-3);
}

class WholeHandSlam : public testing::TestWithParam<const char*> {};

TEST_P(WholeHandSlam, EveryDirectionAtSixTenths_ReboundIsThirtyPercentLowerOrTheHandFolds) {
  const std::vector<Posture> postures =
      thrown(throwOf(GetParam(), "adult-median-right", kStraight, "x", true)).device.axisCount() > 3
          ? std::vector<Posture>{kStraight, kReaching}
          : std::vector<Posture>{kStraight};  // no finger axes
  for (const Posture& posture : postures) {
    for (const char* axis : {"x", "y", "z"}) {
      for (const bool towards_upper : {true, false}) {
        const Throw how = throwOf(GetParam(), "adult-median-right", posture, axis, towards_upper);
        const Pair pair = withAndWithout(how);
        print(how, posture, pair);
        SCOPED_TRACE(std::string(axis) + (towards_upper ? "+ " : "- ") + posture.name);
        expectAFairComparison(how, pair);
        if (pair.without.share() >= kFolds) {
          EXPECT_LE(pair.with.rebound_m_s,
                    0.7 * pair.without.rebound_m_s);  // the bound that the issue requires
        } else {
          // Damped fingers fold less; the rebound that this adds is a small share of the impact
          // speed.
          EXPECT_LT(pair.with.rebound_m_s, pair.without.rebound_m_s + 0.05 * pair.with.impact_m_s);
        }
      }
    }
  }
}
INSTANTIATE_TEST_SUITE_P(Devices, WholeHandSlam,
                         testing::Values("lambda-pride", "wrist-9axis", "desktop-3axis"),
                         [](const auto& tested) { return withoutHyphens(tested.param); });

TEST(WholeHandSlam, StraightFingersFirst_EveryHandReboundsThirtyPercentSlower) {
  double least = 1.0;
  for (const char* hand : {"adult-median-left", "man-p95-right", "woman-p05-right"}) {
    const Throw how = throwOf("lambda-pride", hand, kStraight, "x", true);
    const Pair pair = withAndWithout(how);
    print(how, kStraight, pair);
    SCOPED_TRACE(hand);
    expectAFairComparison(how, pair);
    EXPECT_EQ(pair.with.phi, 1.0);
    least = std::min(least, pair.loweredBy());
  }
  figure("slam of the whole hand at 0.6 m/s, straight fingers first, rebound lowered by at least",
         100.0 * least, "%");
  EXPECT_GE(least, 0.3);  // the bound that the issue requires
}

/// The reason why the shipped gains let an effort on the arm raise its own damping: the blow passes
/// through the straight fingers into the arm, and the efforts of the finger axes do not fill Φ.
TEST(WholeHandSlam, DampedByFingerEffortsAlone_PhiIsNotFilledAndReboundIsHardlyLower) {
  Throw how = throwOf("lambda-pride", "adult-median-right", kStraight, "x", true);
  how.palm_contact = false;
  const Pair pair = withAndWithout(how);
  expectAFairComparison(how, pair);
  figure("the same by the fingers' efforts alone, largest phi", pair.with.phi, "");
  figure("the same by the fingers' efforts alone, rebound lowered by", 100.0 * pair.loweredBy(),
         "%");
  EXPECT_LT(pair.with.phi, 0.8);
  EXPECT_LT(pair.loweredBy(), 0.25);
}

}  // namespace
}  // namespace wholehand::test
