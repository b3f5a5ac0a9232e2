// A grasp trial that a fault stops.
#include "experiments/grasp_trial.hpp"
#include "support/file_bytes.hpp"
#include "support/folder.hpp"
#include "support/rig_tools.hpp"

namespace wholehand::test {
namespace {

/// The shipped hand, but thumb flexion moves the joint that circumduction moves: its reduced
/// inertia is singular. The joint has no end in reach: it would hold what the tick throws about.
std::string singularHand() {
  std::string text = replaced(bytesOfFile(shippedFiles().hand), "thumb_circumduction = 1.0",
                              "thumb_circumduction = 0.5");
  text =
      replaced(text, "thumb_cmc_flexion = 0.30\nthumb_mcp_flexion = 0.35\nthumb_ip_flexion = 0.35",
               "thumb_circumduction = 0.4");
  return replaced(text, "thumb_circumduction = { range_rad = [0.0, 1.5708]",
                  "thumb_circumduction = { range_rad = [-3.0, 3.1]");
}

TEST(Grasping, FaultThatStopsATrial_IsTold) {
  const Folder folder;
  // The certificate refuses such a hand; past it, the tick's fault must stop the trial.
  ModelFiles files = shippedFiles();
  files.hand = folder.write("singular.toml", singularHand());
  // Without the armature that would keep it regular.
  const std::string name = "name = \"thumb_flexion\"\n";
  files.rendering = folder.write(
      "light.toml", replaced(bytesOfFile(files.rendering), name, name + "armature_kg_m2 = 0.0\n"));
  GraspPlan plan;
  plan.setup.folder = folder.path();
  plan.setup.rig.uncertified = true;
  plan.hold_s = 0.1;
  const auto result = orThrow(runGrasp(tunedTrials().front(), files, plan));
  EXPECT_TRUE(result.faulted);
  EXPECT_TRUE(result.dropped);
  EXPECT_FALSE(result.interrupted);
}

}  // namespace
}  // namespace wholehand::test
