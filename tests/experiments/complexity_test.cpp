// Scenes of growing size: that they have the stated properties, and the evaluation of the measured
// times.
#include "experiments/complexity_trial.hpp"
#include "experiments/grasp_trial.hpp"
#include "files/scene/separation.hpp"
#include "support/contains.hpp"
#include "support/folder.hpp"
#include "support/rig_tools.hpp"
#include "support/tolerance.hpp"

#include <cmath>

namespace wholehand::test {
namespace {

ComplexityPlan shortPlan(const std::string& only) {
  ComplexityPlan plan;
  plan.files = shippedFiles();
  plan.ticks = 200;
  plan.passes = 1;
  plan.only = only;
  return plan;
}

TEST(ComplexityScenes, BodiesAtTheStart_DoNotOverlapAndTouchInAPile) {
  const Models models = load(shippedFiles());
  for (int i = 0; i < kComplexityKinds; ++i) {
    const auto kind = static_cast<ComplexityKind>(i);
    if (kind == ComplexityKind::kContacts) continue;  // fixed balls may overlap
    const SceneModel scene = orThrow(complexityScene(kind, 50, models));
    for (std::size_t a = 0; a < scene.bodies.size(); ++a) {
      double nearest_m = 1.0;
      for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
        if (a == b) continue;
        const double apart_m = separation(scene.bodies[a], scene.bodies[b]);
        EXPECT_GT(apart_m, -1e-4) << complexityName(kind) << ' ' << a << ' ' << b;
        nearest_m = std::min(nearest_m, apart_m);
      }
      if (kind == ComplexityKind::kPile) {
        EXPECT_LT(nearest_m, 1e-4) << a;
      }
    }
  }
}

TEST(ComplexityScenes, SmallestScenes_CanBeArmed) {
  for (int i = 0; i < kComplexityKinds; ++i) {
    const auto kind = static_cast<ComplexityKind>(i);
    const int fewest = kind == ComplexityKind::kVertices ? 10 : 0;
    Models models = load(shippedFiles());
    models.scene = orThrow(complexityScene(kind, fewest, models));
    Intention aim = swayingHand(models.device, 1.0);
    const auto rig = orThrow(buildRig(std::move(models), std::move(aim), {}));
    const auto armed = rig->renderer->arm();
    EXPECT_TRUE(armed.ok()) << complexityName(kind) << ": " << format(armed.errors());
  }
}

TEST(ComplexityTrial, TrialOfAPile_TouchesItWithoutFaults) {
  const ComplexityResult result = orThrow(measureComplexity(shortPlan("pile")));
  ASSERT_EQ(result.curves.size(), 1U);
  for (const ComplexityPoint& p : result.curves[0].points) {
    EXPECT_FALSE(p.faulted) << p.count;
    EXPECT_EQ(p.dropped, 0) << p.count;
    EXPECT_EQ(p.bodies, p.count + 1);  // including the tray
    if (p.count >= 16) {
      EXPECT_GT(p.contacts, 0) << p.count;
    }
    EXPECT_GT(p.p50_us, 0.0);
    EXPECT_LE(p.p50_us, p.p999_us);
  }
}

TEST(ComplexityCurve, CurveOfAPowerLaw_HasItsExponentAndCount) {
  ComplexityCurve curve;
  for (const int n : {0, 8, 16, 32, 64}) {
    ComplexityPoint& p = curve.points.emplace_back();
    p.count = n;
    p.p50_us = 20.0 + 2.0 * std::pow(n, 1.5);
    p.p999_us = 10.0 * n;
  }
  EXPECT_NEAR(curve.exponent(), 1.5, tolerance(1e-12));
  bool all = false;
  EXPECT_EQ(curve.admitted(500.0, all), 50.0);  // between 32 and 64: 10 n = 500
  EXPECT_FALSE(all);
  EXPECT_EQ(curve.admitted(1000.0, all), 64.0);
  EXPECT_TRUE(all);
  EXPECT_EQ(curve.admitted(-1.0, all), -1.0);
}

TEST(ComplexityTrial, UnknownKind_IsRefusedWithTheKnownNames) {
  const auto refused = measureComplexity(shortPlan("tower"));
  EXPECT_TRUE(refusedWith(refused, "pile"));
}

// The loop at 1, 2, 4 and 8 kHz, with the same setting and the same physical bounds.

class Rates : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Hz, Rates,
                         testing::ValuesIn(kReducedCounts
                                               ? std::vector<int>{2000}
                                               : std::vector<int>{1000, 2000, 4000, 8000}),
                         testing::PrintToStringParamName());

GraspTrial cylinderInGravity() {
  for (const GraspTrial& trial : tunedTrials()) {
    if (trial.shape == "cylinder" && trial.gravity) return trial;
  }
  throw std::runtime_error("no cylinder among the tuned trials");
}

TEST_P(Rates, CylinderGraspedInGravity_IsHeldAndRenderedEffortMatchesContacts) {
  const Folder folder;
  GraspPlan plan;
  plan.setup.folder = folder.path();
  plan.hold_s = kReducedCounts ? 1.0 : 10.0;
  plan.setup.rig.period_s = 1.0 / GetParam();
  const GraspResult r = orThrow(runGrasp(cylinderInGravity(), shippedFiles(), plan));
  figure("slip over a hold of 10 s", r.slip_m * 1e3, "mm");
  figure("felt against acted", r.felt_error * 100.0, "%");
  figure("noise in the hold", r.force_noise_n, "N");
  // The bounds of grasp_trial_test.cpp at 1 kHz.
  EXPECT_FALSE(r.dropped);
  EXPECT_FALSE(r.faulted);
  EXPECT_LE(r.slip_m, tolerance(3.3e-5));
  EXPECT_LE(r.force_noise_n, tolerance(0.005));
  EXPECT_LE(r.contact_residual, tolerance(0.01));
  EXPECT_LE(r.felt_error, tolerance(0.01));
  EXPECT_GT(r.contact_force_n, 1.0);
}

}  // namespace
}  // namespace wholehand::test
