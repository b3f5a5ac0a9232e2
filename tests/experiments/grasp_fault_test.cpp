// A grasp trial that a fault stops.
#include "experiments/grasp_trial.hpp"
#include "support/rig_tools.hpp"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <unistd.h>

namespace wholehand::test {
namespace {

namespace fs = std::filesystem;

/// The shipped hand, but thumb flexion moves the joint that circumduction moves: its reduced
/// inertia is singular. The joint has no end in reach: it would hold what the tick throws about.
std::string singularHand(const std::string& folder) {
  std::ifstream in(shippedFiles().hand);
  std::string text{std::istreambuf_iterator<char>(in), {}};
  const auto replace = [&](const std::string& what, const std::string& by) {
    const std::size_t at = text.find(what);
    if (at == std::string::npos) throw std::runtime_error(what + " is not in the hand's file");
    text.replace(at, what.size(), by);
  };
  replace("thumb_circumduction = 1.0", "thumb_circumduction = 0.5");
  replace("thumb_cmc_flexion = 0.30\nthumb_mcp_flexion = 0.35\nthumb_ip_flexion = 0.35",
          "thumb_circumduction = 0.4");
  replace("thumb_circumduction = { range_rad = [0.0, 1.5708]",
          "thumb_circumduction = { range_rad = [-3.0, 3.1]");
  std::string path = folder + "/singular.toml";
  std::ofstream(path) << text;
  return path;
}

/// The shipped gains without the armature that would keep it regular.
std::string gainsWithoutArmature(const std::string& folder) {
  std::ifstream in(shippedFiles().rendering);
  std::string text{std::istreambuf_iterator<char>(in), {}};
  const std::string name = "name = \"thumb_flexion\"\n";
  text.insert(text.find(name) + name.size(), "armature_kg_m2 = 0.0\n");
  std::string path = folder + "/light.toml";
  std::ofstream(path) << text;
  return path;
}

TEST(Grasping, FaultThatStopsATrial_IsTold) {
  const fs::path folder =
      fs::temp_directory_path() / ("wholehand-grasp-fault-" + std::to_string(::getpid()));
  fs::create_directories(folder);
  // The certificate refuses such a hand; past it, the tick's fault must stop the trial.
  ModelFiles files = shippedFiles();
  files.hand = singularHand(folder.string());
  files.rendering = gainsWithoutArmature(folder.string());
  GraspPlan plan;
  plan.setup.folder = folder.string();
  plan.setup.rig.uncertified = true;
  plan.hold_s = 0.1;
  const auto result = runGrasp(tunedTrials().front(), files, plan);
  fs::remove_all(folder);
  ASSERT_TRUE(result) << format(result.errors());
  EXPECT_TRUE(result->faulted);
  EXPECT_TRUE(result->dropped);
  EXPECT_FALSE(result->interrupted);
}

}  // namespace
}  // namespace wholehand::test
