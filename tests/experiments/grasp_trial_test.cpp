// The paper's Fig. 5 with device, patient and renderer: the figures that README.md states.
#include "experiments/grasp_trial.hpp"

#include "experiments/grasp_script.hpp"
#include "loop/core/geometry.hpp"
#include "loop/realtime/allocation_counter.hpp"
#include "loop/realtime/monotonic_clock.hpp"
#include "rig/run/run.hpp"
#include "support/file_bytes.hpp"
#include "support/folder.hpp"
#include "support/rig_tools.hpp"
#include "support/seed.hpp"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <fstream>

namespace wholehand::test {
namespace {

namespace fs = std::filesystem;

std::string folder() {
  const fs::path path =
      fs::temp_directory_path() / ("wholehand-grasps-" + std::to_string(::getpid()));
  fs::create_directories(path);
  return path.string();
}

GraspResult grasp(const GraspTrial& trial) {
  GraspPlan plan;
  plan.setup.folder = folder();
  return orThrow(runGrasp(trial, shippedFiles(), plan));
}

/// Worst figures of several trials.
struct Worst {
  double slip_m = 0.0, coupling_rad = 0.0, noise_n = 0.0, residual = 0.0;
  void add(const GraspResult& r) {
    slip_m = std::max(slip_m, r.slip_m);
    coupling_rad = std::max(coupling_rad, r.coupling_error_rad);
    noise_n = std::max(noise_n, r.force_noise_n);
    residual = std::max(residual, r.contact_residual);
  }
  void print(const std::string& of) const {
    figure("slip over a 10 s hold, worst of " + of, slip_m * 1e3, "mm");
    figure("coupling error before correction, worst of " + of, coupling_rad, "rad");
    figure("felt-force noise in the last 2 s, worst of " + of, noise_n, "N");
    figure("contact forces against reduced effort, worst of " + of, residual * 100.0, "%");
  }
};

bool everyLargeCount() {
  return cases(1) > 1;
}

/// Chosen by the seed, one trial of each kind: power without gravity, power with gravity, pinch.
std::vector<GraspTrial> oneOfEachKind(const std::vector<GraspTrial>& trials) {
  auto random = seededRandom(1);
  std::array<std::vector<GraspTrial>, 3> kinds;
  for (const GraspTrial& t : trials) {
    kinds[t.grasp == "pinch" ? 2 : t.gravity ? 1 : 0].push_back(t);
  }
  std::vector<GraspTrial> sample;
  const std::size_t only = random() % kinds.size();
  for (std::size_t k = 0; k < kinds.size(); ++k) {
    if (!kReducedCounts || k == only) sample.push_back(kinds[k].at(random() % kinds[k].size()));
  }
  return sample;
}

constexpr double kSlipAsked_m = 3.3e-5, kSlipOfTunedTrials_m = 1e-5;

TEST(Grasping, TunedTrials_HoldTenSeconds) {
  std::vector<GraspTrial> trials = tunedTrials();
  if (!everyLargeCount()) trials = oneOfEachKind(trials);
  Worst worst;
  for (const GraspTrial& trial : trials) {
    const GraspResult r = grasp(trial);
    SCOPED_TRACE(trial.name());
    std::printf("trial: %s\n", trial.name().c_str());
    EXPECT_FALSE(r.dropped);
    EXPECT_LE(r.slip_m, tolerance(kSlipOfTunedTrials_m));
    EXPECT_LE(r.coupling_error_rad, tolerance(1e-12));
    EXPECT_LE(r.force_noise_n, tolerance(0.005));
    EXPECT_LE(r.contact_residual, tolerance(0.01));
    EXPECT_NEAR(r.object_travel_m, kLift_m, 0.02);  // the object is carried 20 cm
    EXPECT_GT(r.contact_force_n, 1.0);              // held by the hand, not resting on something
    worst.add(r);
  }
  worst.print(std::to_string(trials.size()) + " tuned trials");
}

/// The paper's device turned as the trial is, with room for the lift along every axis.
std::string turnedDevice(const Eigen::Vector3d& rpy) {
  const Eigen::Matrix3d mount =
      rotationFromRpy(rpy.x(), rpy.y(), rpy.z()) * rotationFromRpy(90 * kDeg, 0, 0);
  const Eigen::Vector3d zyx = mount.eulerAngles(2, 1, 0);
  std::string text = bytesOfFile(shippedFiles().device);
  text = replaced(text, "\nroll_rad = 1.5707963267948966",
                  fmt::format("\nroll_rad = {:.17g}", zyx[2]));
  text = replaced(text, "\npitch_rad = 0.0", fmt::format("\npitch_rad = {:.17g}", zyx[1]));
  text = replaced(text, "\nyaw_rad = 0.0", fmt::format("\nyaw_rad = {:.17g}", zyx[0]));
  for (const char* range :
       {"range_m = [-0.085, 0.085]", "range_m = [-0.12, 0.12]", "range_m = [-0.12, 0.12]"}) {
    text = replaced(text, range, "range_m = [-0.3, 0.3]");
  }
  return text;
}

// The orientation of the world must not matter: the whole setup, turned with gravity, is held as
// well at every rate.
TEST(Grasping, TurnedTrials_AreHeldAtEveryRate) {
  auto random = seededRandom(3);
  const std::vector<GraspTrial> tuned = tunedTrials();
  const Folder folder;
  Worst worst;
  const int count = cases(kReducedCounts ? 1 : 4);
  for (int i = 0; i < count; ++i) {
    GraspTrial trial = tuned[random() % tuned.size()];
    trial.turn_rpy_rad = {uniform(random, -180 * kDeg, 180 * kDeg),
                          uniform(random, -90 * kDeg, 90 * kDeg),
                          uniform(random, -180 * kDeg, 180 * kDeg)};
    const double rate_hz = 1000.0 * std::pow(2.0, static_cast<double>(random() % 4));
    ModelFiles files = shippedFiles();
    files.device = folder.write("turned.toml", turnedDevice(trial.turn_rpy_rad));
    GraspPlan plan;
    plan.setup.folder = folder.path();
    plan.setup.rig.period_s = 1.0 / rate_hz;
    const GraspResult r = orThrow(runGrasp(trial, files, plan));
    std::printf("%s at %g Hz, turned by (%.4f, %.4f, %.4f): %.4f mm%s\n", trial.name().c_str(),
                rate_hz, trial.turn_rpy_rad.x(), trial.turn_rpy_rad.y(), trial.turn_rpy_rad.z(),
                r.slip_m * 1e3, r.dropped ? ", dropped" : "");
    EXPECT_FALSE(r.dropped);
    EXPECT_LE(r.slip_m, tolerance(kSlipAsked_m));
    worst.add(r);
  }
  worst.print(std::to_string(count) + " turned trials");
}

struct Jittered {
  int dropped = 0, slipped = 0;
};

Jittered hold(const std::vector<GraspTrial>& trials, const std::string& of) {
  Worst worst;
  Jittered seen;
  for (const GraspTrial& trial : trials) {
    const GraspResult r = grasp(trial);
    seen.dropped += r.dropped ? 1 : 0;
    seen.slipped += r.slip_m > kSlipAsked_m ? 1 : 0;
    if (r.dropped || r.slip_m > kSlipAsked_m) {
      std::printf("%s: trial %td, %s\n", r.dropped ? "dropped" : "slipped", &trial - trials.data(),
                  trial.name().c_str());
    }
    EXPECT_LE(r.coupling_error_rad, tolerance(1e-12)) << trial.name();
    if (!r.dropped) {
      EXPECT_LE(r.force_noise_n, tolerance(0.005)) << trial.name();
    }
    worst.add(r);
  }
  worst.print(of);
  figure("dropped of " + of, seen.dropped, "");
  figure("slipped over 0.033 mm of " + of, seen.slipped, "");
  return seen;
}

/// Seed of the figure in README.md: `wholehand experiment grasping`.
constexpr std::uint64_t kReportedSeed = 1;

TEST(Grasping, JitteredTrials_AreHeld) {
  auto random = seededRandom(2);
  if (everyLargeCount()) {
    for (const std::uint64_t s : {kReportedSeed, std::uint64_t{2 + random() % 1'000'000'000}}) {
      const std::string of = "72 jittered trials of seed " + std::to_string(s);
      const Jittered seen = hold(jitteredTrials(72, s), of);
      // With six other seeds up to 2 were dropped, and one held object slipped further (432
      // trials).
      EXPECT_LE(seen.dropped, s == kReportedSeed ? 0 : 4) << of;
      EXPECT_LE(seen.slipped, s == kReportedSeed ? 0 : 6) << of;
    }
    return;
  }
  const std::vector<GraspTrial> all = jitteredTrials(72, kReportedSeed);
  std::vector<GraspTrial> sample;
  for (const std::size_t i : sampleOf(all.size(), kReducedCounts ? 1 : 4, random)) {
    sample.push_back(all[i]);
    std::printf("jittered trial %zu of 0 .. 71: %s\n", i, all[i].name().c_str());
  }
  const Jittered seen = hold(sample, std::to_string(sample.size()) + " jittered trials");
  // All 72 of this seed are held, so any sample of them is.
  EXPECT_EQ(seen.dropped, 0);
  EXPECT_EQ(seen.slipped, 0);
}

/// A rig of the grasp, to be ticked by the test.
std::unique_ptr<Rig> graspRig(const GraspTrial& trial) {
  ModelFiles files = shippedFiles();
  const Models without = load(files);
  files.scene = folder() + "/counted.toml";
  std::ofstream(files.scene) << graspScene(trial, without);
  Models models = load(files);
  Intention intention = graspIntention(trial, models);
  return orThrow(buildRig(std::move(models), std::move(intention), {}));
}

struct Cost {
  std::uint64_t allocations = 0, releases = 0;
  std::uint64_t first_tick = 0;  ///< first tick that allocated
  int touching_ticks = 0;
  double cpu_s = 0.0;
};

/// Allocations and CPU time of tick() alone.
Cost costOf(Rig& rig, int ticks) {
  if (!rig.renderer->arm()) throw std::runtime_error("not armed");
  Cost cost;
  TickRecord record;
  for (int k = 0; k < ticks; ++k) {
    const AllocationScope scope;
    const std::int64_t began_ns = threadCpuNow_ns();
    rig.renderer->tick(1, record);
    cost.cpu_s += static_cast<double>(threadCpuNow_ns() - began_ns) * 1e-9;
    if (cost.allocations == 0 && scope.allocations() > 0) {
      cost.first_tick = static_cast<std::uint64_t>(k);
    }
    cost.allocations += scope.allocations();
    cost.releases += scope.releases();
    cost.touching_ticks += record.contact_count > 0 ? 1 : 0;
  }
  return cost;
}

#define SKIP_WITHOUT_COUNTING()                                               \
  if (!allocationCountingAvailable()) {                                       \
    GTEST_SKIP() << "a sanitizer owns malloc here: nothing could be counted"; \
  }

TEST(TickAllocations, WholeGrasp_AllocatesNothing) {
  SKIP_WITHOUT_COUNTING();
  const auto rig = graspRig(tunedTrials()[8]);  // a cylinder on its pedestal
  const Cost cost = costOf(*rig, 7000);
  EXPECT_GT(cost.touching_ticks, 3000);
  figure("allocations in 7000 ticks of a grasp", static_cast<double>(cost.allocations), "");
  EXPECT_EQ(cost.allocations, 0U) << "first in tick " << cost.first_tick;
  EXPECT_EQ(cost.releases, 0U);
}

TEST(TickAllocations, BumpedMeshesAndUrdfs_AllocateNothing) {
  SKIP_WITHOUT_COUNTING();
  for (double y : {-0.12, 0.0, 0.1}) {  // positions of mug, prism and sphere, cube and disk
    Models models = load(shippedFiles("lambda-pride", "table"));
    AxisPosition above(6), along(6), beyond(6);
    above[0] = along[0] = -0.08;
    above[1] = along[1] = beyond[1] = y;
    above[2] = 0.11;
    along[2] = beyond[2] = -0.03;
    beyond[0] = 0.08;
    along[3] = beyond[3] = 1.0;
    Intention sweep = Intention::throughWaypoints(
        {{0.0, above}, {1.0, along}, {2.0, beyond}, {3.0, along}, {4.0, beyond}});
    const auto rig = orThrow(buildRig(std::move(models), std::move(sweep), {}));
    const Cost cost = costOf(*rig, 4500);
    EXPECT_GT(cost.touching_ticks, 100) << y;
    figure("allocations in 4500 ticks among meshes and URDFs, y = " + std::to_string(y),
           static_cast<double>(cost.allocations), "");
    EXPECT_EQ(cost.allocations, 0U) << "y " << y << ", first in tick " << cost.first_tick;
    EXPECT_EQ(cost.releases, 0U);
  }
}

TEST(SimulatedClock, OneGraspedObject_RunsTenTimesFasterThanRealTime_slow) {
  const auto rig = graspRig(tunedTrials()[0]);
  constexpr int kTicks = 5000;
  const Cost cost = costOf(*rig, kTicks);
  const double ratio = cost.cpu_s / (kTicks * 1e-3);
  figure("CPU time over simulated time, one object", ratio, "");
#ifdef NDEBUG  // only in a release build; CPU time does not depend on other load
  EXPECT_LE(ratio, 0.1);
#endif
}

// A grasp trial that is stopped by a fault.

/// The shipped hand, except that thumb flexion moves the same joint as circumduction, so its
/// reduced inertia is singular. The joint has no end in reach, which would limit its motion.
std::string singularHand() {
  std::string text = replaced(bytesOfFile(shippedFiles().hand), "thumb_circumduction = 1.0",
                              "thumb_circumduction = 0.5");
  text =
      replaced(text, "thumb_cmc_flexion = 0.30\nthumb_mcp_flexion = 0.35\nthumb_ip_flexion = 0.35",
               "thumb_circumduction = 0.4");
  return replaced(text, "thumb_circumduction = { range_rad = [0.0, 1.5708]",
                  "thumb_circumduction = { range_rad = [-3.0, 3.1]");
}

TEST(Grasping, FaultThatStopsATrial_IsReported) {
  const Folder folder;
  // The certificate refuses such a hand; without the certificate, the tick's fault must stop the
  // trial.
  ModelFiles files = shippedFiles();
  files.hand = folder.write("singular.toml", singularHand());
  // Removes the armature, which would keep the inertia regular.
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
