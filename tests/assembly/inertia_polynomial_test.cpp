// The inertia that a recording describes is that of the hand, in every posture.
#include "assembly/inertia_polynomial.hpp"

#include "support/rig_tools.hpp"
#include "support/seed.hpp"
#include "telemetry/posture_inertia.hpp"

namespace wholehand::test {
namespace {

TEST(InertiaPolynomial, RandomPostures_HaveTheInertiaOfTheHand) {
  const Models models = load(shippedFiles("lambda-pride", "four-shapes"));
  const int axes = models.device.axisCount();
  AxisInertia armature(axes);
  for (int i = 0; i < axes; ++i) armature[i] = 1e-5 * (i + 1);
  const RecordedInertia described = inertiaPolynomial(models.hand, models.device, armature);
  ASSERT_FALSE(described.coefficients.empty());
  std::printf("figure: %zu terms\n", described.degrees.size() / static_cast<std::size_t>(axes));

  recording::PostureInertia polynomial(described, static_cast<std::size_t>(axes));
  ArticulatedBody body(models.hand, armature);
  const Synergy synergy(models.hand);
  std::mt19937_64 random(seed());
  double largest = 0.0;
  for (int n = 0; n < 500; ++n) {
    AxisPosition q(axes);
    for (int a = 0; a < axes; ++a) {
      const DeviceAxis& axis = models.device.axes[a];
      const double beyond = 0.1 * (axis.upper - axis.lower);
      q[a] = std::uniform_real_distribution(axis.lower - beyond, axis.upper + beyond)(random);
    }
    JointPosition theta;
    synergy.expand(q, theta);
    ASSERT_TRUE(
        body.update(theta, JointVelocity(models.hand.joint_count), Eigen::Vector3d::Zero()));
    const AxisMatrix& m = body.reducedInertia();
    const std::vector<double>& got = polynomial.at({q.begin(), q.end()});
    for (int i = 0; i < axes; ++i) {
      for (int j = 0; j <= i; ++j) {
        const double scale = std::sqrt(m(i, i) * m(j, j));
        largest = std::max(largest, std::abs(got[i * (i + 1) / 2 + j] - m(i, j)) / scale);
      }
    }
  }
  std::printf("figure: %.1e of the inertia off at most\n", largest);
  EXPECT_LT(largest, 1e-13);
}

}  // namespace
}  // namespace wholehand::test
