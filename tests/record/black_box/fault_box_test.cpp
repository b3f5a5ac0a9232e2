#include "loop/device/simulated/simulated_device.hpp"
#include "record/black_box/box_tools.hpp"
#include "record/black_box/run_tools.hpp"
#include "support/contains.hpp"
#include "support/fault_injector.hpp"
#include "support/seed.hpp"
#include "support/tolerance.hpp"

#include <filesystem>

namespace wholehand::test {
namespace {

using synthetic::Folder;

/// A run on the simulated clock through a device with these faults, which wraps `inner`.
struct FaultyRun {
  std::unique_ptr<HapticDevice> inner;
  std::unique_ptr<Rig> rig;
  RunOutcome outcome;
};

FaultyRun runWith(const Folder& folder, const std::vector<InjectedFault>& faults, bool simulated) {
  Models models = load(shippedFiles("lambda-pride", "four-shapes"));
  FaultyRun run;
  run.inner = std::make_unique<SimulatedDevice>(models.device, models.patient,
                                                sweeping(models.device), 1e-3);
  run.rig =
      build(std::move(models), std::make_unique<FaultInjector>(*run.inner, faults, simulated));
  RunPlan plan;
  plan.title = "faulty";
  plan.duration_ticks = 8000;
  plan.record = folder.file("run.h5");
  plan.black_box = blackBoxPath(plan.record);
  plan.simulated_clock = true;
  run.outcome = orThrow(runAndRecord(*run.rig, plan));
  return run;
}

struct Case {
  InjectedKind kind;
  Fault fault;
};

/// Every kind with full counts, otherwise three of them.
TEST(FaultedRun, EveryKindOfFault_LeavesAFileThatIsReproducedBitByBit) {
  const std::vector<Case> cases = {
      {InjectedKind::kReadFails, Fault::kDeviceRead},
      {InjectedKind::kWriteFails, Fault::kDeviceWrite},
      {InjectedKind::kNanPosition, Fault::kNonFinitePosition},
      {InjectedKind::kNegativeInfinitePosition, Fault::kNonFinitePosition},
      {InjectedKind::kShortReading, Fault::kDeviceRead},
      {InjectedKind::kEncoderJump, Fault::kEncoderJump},
      {InjectedKind::kOverSpeed, Fault::kSpeedLimit},
      {InjectedKind::kLeavesWorkspace, Fault::kWorkspace},
  };
  auto random = seededRandom(4107);
  const Models models = load(shippedFiles("lambda-pride", "four-shapes"));
  for (const std::size_t i : sampleOf(cases.size(), underFull() ? cases.size() : 3, random)) {
    const Case& c = cases[i];
    SCOPED_TRACE(static_cast<int>(c.kind));
    const Folder folder;
    const InjectedFault fault =
        faultAtRandom(models.device, 1e-3, c.kind, 5500, 6000, 2000, random());
    const FaultyRun run = runWith(folder, {fault}, false);
    ASSERT_TRUE(run.outcome.faulted);
    EXPECT_EQ(run.outcome.black_box, "the last seconds and what led to them: wholehand replay " +
                                         folder.file("run.wbb") + " --resimulate");
    const auto box = opened(folder.file("run.wbb"));
    ASSERT_NE(box, nullptr);
    EXPECT_TRUE(any(box->cause().faults & c.fault)) << static_cast<unsigned>(box->cause().faults);
    EXPECT_GE(box->size(), 5000U);
    TickRecord last;
    ASSERT_TRUE(box->read(box->size() - 1, last));
    EXPECT_EQ(last.safety_state, SafetyState::kFaulted);
    EXPECT_EQ(last.authority, 0.0) << "written after the ramp";
    EXPECT_NE(expectSameRerun(folder.file("run.wbb")).find(" run again after "), std::string::npos);
  }
}

TEST(FaultedRun, SimulatedDeviceWithoutFault_LeavesNoFile) {
  const Folder folder;
  const FaultyRun run = runWith(folder, {}, true);
  EXPECT_FALSE(run.outcome.faulted);
  EXPECT_EQ(run.outcome.black_box, "");
  EXPECT_FALSE(std::filesystem::exists(folder.file("run.wbb")));
}

TEST(FaultedRun, EmergencyStop_LeavesAFileThatNamesItAndIsReproduced) {
  const Folder folder;
  Models models = load(shippedFiles("lambda-pride", "four-shapes"));
  const Intention intention = sweeping(models.device);
  auto rig = orThrow(buildRig(std::move(models), intention, RigOptions{}));
  RunPlan plan;
  plan.duration_ticks = 3000;
  plan.black_box = folder.file("deep/stop.wbb");
  plan.simulated_clock = true;
  plan.sinks.emplace_back([&rig](const TickRecord& r) {
    if (r.tick == 1234) rig->renderer->requestEmergencyStop();
  });
  const RunOutcome outcome = orThrow(runAndRecord(*rig, plan));
  EXPECT_FALSE(outcome.faulted);
  EXPECT_NE(outcome.black_box, "");
  const BlackBoxCause cause = opened(plan.black_box)->cause();
  EXPECT_EQ(cause.faults, Fault::kEmergencyStop);
  EXPECT_EQ(cause.fault_tick, 1235U);
  expectSameRerun(plan.black_box);
  const ProgramOutput shown = program("replay --speed 1000 '" + plan.black_box + "'");
  EXPECT_EQ(shown.code, 0);
  EXPECT_TRUE(contains(shown.text, "emergency stop, first in tick 1235"));
}

}  // namespace
}  // namespace wholehand::test
