// The loop at 1, 2, 4 and 8 kHz: one setting, and the same physical bounds at each.
#include "experiments/grasp_trial.hpp"
#include "support/rig_tools.hpp"
#include "support/tolerance.hpp"

#include <filesystem>

namespace wholehand::test {
namespace {

namespace fs = std::filesystem;

class Rates : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Hz, Rates, testing::Values(1000, 2000, 4000, 8000),
                         testing::PrintToStringParamName());

GraspTrial cylinderInGravity() {
  for (const GraspTrial& trial : tunedTrials()) {
    if (trial.shape == "cylinder" && trial.gravity) return trial;
  }
  throw std::runtime_error("no cylinder among the tuned trials");
}

TEST_P(Rates, CylinderGraspedInGravity_IsHeldAndFeltAsItActs) {
  const fs::path folder =
      fs::temp_directory_path() / ("wholehand-rates-" + std::to_string(::getpid()));
  fs::create_directories(folder);
  GraspPlan plan;
  plan.setup.folder = folder.string();
  plan.hold_s = 10.0;
  plan.setup.rig.period_s = 1.0 / GetParam();
  const GraspResult r = orThrow(runGrasp(cylinderInGravity(), shippedFiles(), plan));
  fs::remove_all(folder);
  figure("slip over a hold of 10 s", r.slip_m * 1e3, "mm");
  figure("felt against acted", r.felt_error * 100.0, "%");
  figure("noise in the hold", r.force_noise_n, "N");
  // What grasp_trial_test.cpp asks for at 1 kHz.
  EXPECT_FALSE(r.dropped);
  EXPECT_FALSE(r.faulted);
  EXPECT_LE(r.slip_m, tolerance(1e-4));
  EXPECT_LE(r.force_noise_n, tolerance(0.005));
  EXPECT_LE(r.contact_residual, tolerance(0.01));
  EXPECT_LE(r.felt_error, tolerance(0.01));
  EXPECT_GT(r.contact_force_n, 1.0);
}

}  // namespace
}  // namespace wholehand::test
