// A run when something fails: what is left open, what is reported, which signals end it gently.
#include "rig/run/run.hpp"

#include "devices/passport/passport.hpp"
#include "loop/runtime/interrupt_scope.hpp"
#include "loop/runtime/statistics.hpp"
#include "replay/resimulation/resimulation.hpp"
#include "rig/watched_device.hpp"
#include "support/contains.hpp"
#include "support/folder.hpp"
#include "support/recorded_run.hpp"

#include <array>
#include <chrono>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <linux/capability.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <thread>
#include <unistd.h>

namespace wholehand::test {
namespace {

namespace fs = std::filesystem;

/// An unused file name; its file is removed at the end.
class TemporaryFile {
 public:
  TemporaryFile()
      : path_(fs::temp_directory_path() / ("wholehand-rig-" + std::to_string(::getpid()) + ".h5")) {
  }
  ~TemporaryFile() {
    std::error_code ignored;
    fs::remove(path_, ignored);
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  [[nodiscard]] std::string path() const { return path_.string(); }

 private:
  fs::path path_;
};

TEST(RunAndRecord, NoThreadOrNoFile_ClosesTheDeviceAndLeavesNoRecording) {
  const TemporaryFile file;
  RunPlan plan;
  plan.duration_ticks = 10;
  plan.record = file.path();
  RigOptions too_fast;
  too_fast.period_s = 5e-6;  // below the thread's 10 µs
  Story story;
  const auto rig = watched(story, std::numeric_limits<int>::max(), too_fast);
  const auto outcome = runAndRecord(*rig, plan);
  ASSERT_FALSE(outcome);
  EXPECT_EQ(outcome.errors().front().key, "period_ns");
  EXPECT_FALSE(story.open);
  EXPECT_FALSE(fs::exists(file.path()));

  Story other;
  const auto second = watched(other);
  plan.record = file.path() + "/no/such/folder.h5";
  EXPECT_FALSE(runAndRecord(*second, plan));
  EXPECT_FALSE(other.open);
  EXPECT_EQ(second->renderer->safetyState(), SafetyState::kDisarmed);
  EXPECT_TRUE(second->renderer->arm());  // arming without a run leaves no state behind
}

// Everything that may wait for a disk happens before the device is enabled: docs/safety.md,
// "Arming".
TEST(Run, EveryFileIsOpen_BeforeTheDeviceIsEnabled) {
  const TemporaryFile file;
  RunPlan plan;
  plan.duration_ticks = 5;
  plan.simulated_clock = true;
  plan.record = file.path();
  plan.black_box = blackBoxPath(file.path());
  Story story;
  bool recording_was_there = false;
  story.at_enable = [&] { recording_was_there = fs::exists(file.path()); };
  orThrow(runAndRecord(*watched(story), plan));
  EXPECT_TRUE(recording_was_there);
  EXPECT_EQ(story.enables, 1);
  EXPECT_FALSE(story.enabled);

  Story no_folder;
  plan.record = file.path() + "/no/such/folder.h5";
  EXPECT_FALSE(runAndRecord(*watched(no_folder), plan));
  EXPECT_EQ(no_folder.enables, 0);
}

TEST(Run, StoppedBeforeItBegins_EnablesNothingOrDisablesItAgain) {
  enum class When { kBeforePreparing, kBetween, kWhileEnabling };
  for (const When when : {When::kBeforePreparing, When::kBetween, When::kWhileEnabling}) {
    for (const bool gentle : {false, true}) {
      Story story;
      const std::shared_ptr<Rig> rig = watched(story);
      const auto stop = [&] {
        gentle ? rig->renderer->requestGentleStop() : rig->renderer->requestEmergencyStop();
      };
      if (when == When::kBeforePreparing) stop();
      auto run = Run::prepare(rig, RunPlan{});
      EXPECT_EQ(run.ok(), when != When::kBeforePreparing);
      if (when == When::kWhileEnabling) story.at_enable = stop;
      if (run) {
        if (when == When::kBetween) stop();
        EXPECT_FALSE((*run)->begin());
      }
      EXPECT_EQ(story.enables, when == When::kWhileEnabling ? 1 : 0);
      EXPECT_FALSE(story.enabled);
      EXPECT_FALSE(story.open);
    }
  }
}

// Capabilities belong to a thread and the threads that it starts; limits belong to the process and
// bind threads without the capability. docs/safety.md, "Arming".
TEST(Run, NoRealTimePriorityOrLockedMemory_EnablesNothingWhereRequired) {
  rlimit priority{}, memory{};
  getrlimit(RLIMIT_RTPRIO, &priority);
  getrlimit(RLIMIT_MEMLOCK, &memory);
  const rlimit no_priority{0, priority.rlim_max}, no_memory{0, memory.rlim_max};
  setrlimit(RLIMIT_RTPRIO, &no_priority);
  setrlimit(RLIMIT_MEMLOCK, &no_memory);
  std::thread([] {
    __user_cap_header_struct header{_LINUX_CAPABILITY_VERSION_3, 0};
    std::array<__user_cap_data_struct, 2> none{};
    ASSERT_EQ(syscall(SYS_capset, &header, none.data()), 0);
    RunPlan plan;
    plan.real_time_required = true;
    Story story;
    auto run = orThrow(Run::prepare(watched(story), plan));
    const Expected<Done> begun = run->begin();
    ASSERT_FALSE(begun);
    EXPECT_TRUE(contains(format(begun.errors()), "a loop that moves a person needs it"));
    EXPECT_TRUE(contains(format(begun.errors()), "wholehand doctor"));
    EXPECT_EQ(story.enables, 0);
    run->finish();
    EXPECT_FALSE(story.open);
  }).join();
  setrlimit(RLIMIT_RTPRIO, &priority);
  setrlimit(RLIMIT_MEMLOCK, &memory);
}

// Data written to a removed file is lost and must be reported as lost.
TEST(RunAndRecord, RecordingRemovedDuringTheRun_IsReportedAndCountsAsDropped) {
  const TemporaryFile file;
  Story story;
  const auto rig = watched(story);
  RunPlan plan;
  plan.duration_ticks = 200;
  plan.simulated_clock = true;
  plan.record = file.path();
  plan.sinks.emplace_back([&](const TickRecord& r) {
    if (r.tick == 50) fs::remove(file.path());
  });
  const RunOutcome outcome = orThrow(runAndRecord(*rig, plan));
  EXPECT_EQ(outcome.written, 0U);
  EXPECT_EQ(outcome.dropped_writes, outcome.summary.records);
  ASSERT_EQ(outcome.failures.size(), 1U);
  EXPECT_TRUE(contains(outcome.failures.front(), "removed"));
}

TEST(BlackBoxPath, AnyRecordingName_GivesAnotherPath) {
  EXPECT_EQ(blackBoxPath("a/run.h5"), "a/run.wbb");
  EXPECT_EQ(blackBoxPath("a/run"), "a/run.wbb");
  EXPECT_EQ(blackBoxPath("a/run.wbb"), "a/run.wbb.wbb");
}

// Without a writable folder the last seconds are kept in the temporary folder.
TEST(BlackBoxPath, NoWritableFolder_UsesTheTemporaryOne) {
  const fs::path here = fs::current_path();
  const fs::path folder =
      fs::temp_directory_path() / ("wholehand-box-" + std::to_string(::getpid()));
  fs::create_directory(folder);
  fs::current_path(folder);
  EXPECT_EQ(fs::path(blackBoxPath("")).parent_path(), "out/blackbox");
  EXPECT_NE(blackBoxPath(""), blackBoxPath("")) << "two programs within one second";
  std::ofstream("out") << "a file where a folder should be";
  const std::string path = blackBoxPath("");
  fs::current_path(here);
  fs::remove_all(folder);
  EXPECT_EQ(fs::path(path).parent_path(), fs::temp_directory_path() / "out/blackbox");
}

TEST(RunAndRecord, FaultWhoseRecordsWereDropped_IsNoSuccess) {
  // A machine that stands still ends a run before its device fails; then the run is done again.
  for (int tries = 0; tries < 10; ++tries) {
    Story story;
    const auto rig = watched(story, 501);  // prepare() is the first read: tick 500
    RunPlan plan;
    plan.duration_ticks = 5000;
    plan.queue_bytes = 0;
    bool first = true;
    std::uint64_t reported = 0;
    plan.sinks.emplace_back([&](const TickRecord& r) {
      // Longer than the run, so all but the first records are dropped.
      if (std::exchange(first, false)) std::this_thread::sleep_for(std::chrono::milliseconds(1000));
      reported += any(r.faults & kStoppingFaults) ? 1 : 0;
    });
    const RunOutcome outcome = orThrow(runAndRecord(*rig, plan));
    if (contains(faultText(outcome.summary), "gap too long")) continue;
    ASSERT_EQ(reported, 0U);
    EXPECT_TRUE(outcome.faulted);
    EXPECT_GT(outcome.dropped_records, 0U);
    EXPECT_GT(outcome.summary.stopping_faults, 0U);
    EXPECT_TRUE(contains(faultText(outcome.summary), faultName(0)));
    // Every tick is counted, although records were dropped.
    EXPECT_EQ(outcome.summary.ticks, outcome.counters.ticks_run + outcome.summary.missed_deadlines);
    EXPECT_EQ(outcome.counters.ticks_run, outcome.summary.records + outcome.dropped_records);
    EXPECT_FALSE(story.open);
    return;
  }
  FAIL() << "this machine stood still in ten runs of half a second";
}

TEST(RunAndRecord, SinkThatThrows_IsReportedAndTheLoopContinues) {
  // A run on the wall clock, which a standing machine may end: tries again.
  for (int attempt = 0; attempt < 10; ++attempt) {
    Story story;
    const auto rig = watched(story);
    RunPlan plan;
    plan.duration_ticks = 100;
    plan.sinks.emplace_back([](const TickRecord&) { throw std::runtime_error("no more paper"); });
    const RunOutcome outcome = orThrow(runAndRecord(*rig, plan));
    ASSERT_EQ(outcome.failures.size(), 1U);
    EXPECT_EQ(outcome.failures.front(), "sink 1 threw: no more paper");
    if (contains(faultText(outcome.summary), "gap too long")) continue;
    EXPECT_FALSE(outcome.faulted);
    EXPECT_GE(outcome.summary.ticks, 100U);
    return;
  }
  FAIL() << "this machine stood still in ten runs of a tenth of a second";
}

/// Runs 200 ticks on the simulated clock and sends a signal in the 50th. @return true if the run
/// ended early
bool isStoppedBy(int signal) {
  Story story;
  const auto rig = watched(story);
  const InterruptScope signals;
  RunPlan plan;
  plan.interrupts = &InterruptScope::shared();
  plan.duration_ticks = 200;
  plan.simulated_clock = true;
  plan.sinks.emplace_back([&](const TickRecord& r) {
    if (r.tick == 50) {
      // Sent to the process, as a person or the system does; a thread other than this one takes it.
      EXPECT_EQ(::kill(::getpid(), signal), 0);
      for (int i = 0; i < 200 && !InterruptScope::interrupted(); ++i) {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
      }
    }
  });
  const RunOutcome outcome = orThrow(runAndRecord(*rig, plan));
  EXPECT_EQ(outcome.interrupted, outcome.summary.ticks < 200);
  return outcome.interrupted;
}

class Signals : public testing::TestWithParam<int> {};

TEST_P(Signals, SignalDuringARun_StopsItUnlessInheritedAsIgnored) {
  const auto before = std::signal(GetParam(), SIG_IGN);  // as nohup does
  EXPECT_FALSE(isStoppedBy(GetParam()));
  std::signal(GetParam(), SIG_DFL);
  EXPECT_TRUE(isStoppedBy(GetParam()));
  EXPECT_EQ(std::signal(GetParam(), before), SIG_DFL);  // restored
}
INSTANTIATE_TEST_SUITE_P(All, Signals,
                         testing::Values(SIGINT, SIGTERM, SIGHUP, SIGTSTP, SIGQUIT, SIGXCPU,
                                         SIGUSR1, SIGUSR2, SIGALRM, SIGVTALRM, SIGPROF, SIGPWR),
                         [](const auto& tested) {
                           return std::string("SIG") + ::sigabbrev_np(tested.param);
                         });

// By default these signals would end the process or freeze it with the last effort held, although
// they do not concern the run: its output is not read, or it was written in the background.
TEST(HarmlessSignals, SignalDuringARun_NeitherEndsNorFreezesIt) {
  for (const int signal : {SIGPIPE, SIGXFSZ, SIGTTOU, SIGTTIN}) {
    const auto before = std::signal(signal, SIG_DFL);
    EXPECT_FALSE(isStoppedBy(signal));
    EXPECT_EQ(std::signal(signal, before), SIG_DFL);  // restored
  }
}

TEST(SignalsOfTheProgram, HandlerOfTheProgram_StaysInstalled) {
  static volatile std::sig_atomic_t heard = 0;
  const auto before = std::signal(SIGUSR1, [](int) { heard = 1; });
  EXPECT_FALSE(isStoppedBy(SIGUSR1));
  EXPECT_EQ(heard, 1);
  std::signal(SIGUSR1, before);
}

TEST(FaultText, NoticesThatDoNotStop_AreReportedApartFromFaults) {
  TickSummary summary;
  summary.faults[6] = 1;  // the bits of loop/core/fault.hpp
  summary.faults[7] = 2;
  summary.faults[10] = 1;  // a request to stop is neither
  EXPECT_EQ(faultText(summary), "none");
  EXPECT_EQ(noticeText(summary), "effort limited in 1 tick, late tick in 2 ticks");
  summary.faults[0] = 3;
  EXPECT_EQ(faultText(summary), "device read failed in 3 ticks");
}

// A recording contains the model files. A program's changes in memory are not in them: the
// recording says so and is not simulated again as if it had none.

Models shippedModels() {
  return load(shippedFiles("lambda-pride", "four-shapes"));
}

TEST(ModelsChanged, ModelsAsInTheFiles_AreSimulatedAgain) {
  const Folder folder;
  const std::string path = recordRest(shippedModels(), folder.file("run.h5"));
  const auto reader = orThrow(RecordingReader::open(path));
  EXPECT_FALSE(reader->meta().models_changed);
  const auto again = resimulate(*reader, path);
  ASSERT_TRUE(again) << format(again.errors());
  EXPECT_GT(again->compared, 100U);
  EXPECT_TRUE(again->same());
  volatile double tiny = std::numeric_limits<double>::min();
  tiny = tiny / 4.0;
  EXPECT_NE(tiny, 0.0) << "the caller's thread flushes denormals from now on";
}

TEST(ModelsChanged, ModelsChangedInMemory_AreReportedAndNotSimulatedAgain) {
  std::vector<std::pair<const char*, void (*)(Models&)>> changes = {
      {"a body is moved", [](Models& m) { m.scene.bodies[0].pose.translation_m.x() += 1e-3; }},
      {"gravity", [](Models& m) { m.scene.gravity_m_s2.z() = -1.62; }},
      {"a longer finger", [](Models& m) { m.hand.capsules.back().b_m *= 1.01; }},
      {"another effort limit", [](Models& m) { m.device.axes[0].effort_limit *= 0.9; }},
      {"softer gains", [](Models& m) { m.rendering.axes[0].k_pm *= 0.9; }},
  };
  for (const auto& [what, change] : changes) {
    SCOPED_TRACE(what);
    const Folder folder;
    Models models = shippedModels();
    change(models);
    const std::string path = recordRest(std::move(models), folder.file("run.h5"));
    const auto reader = orThrow(RecordingReader::open(path));
    EXPECT_TRUE(reader->meta().models_changed);
    const auto again = resimulate(*reader, path);
    EXPECT_TRUE(refusedWith(again, "changed in memory"));
  }
}

// A run with a passport: rendering and its re-simulation use the proven values.

constexpr double kProven = 0.9;  // of the damping that the device file states

Passport passportOf(const DeviceModel& device) {
  Passport out;
  out.identity = {"S-1", "1", "1"};
  out.device = device.name;
  out.device_sha256 = std::string(64, '0');
  out.operator_name = "A";
  out.measured_at = placeTimeNow();
  for (const DeviceAxis& axis : device.axes) {
    PassportAxis measured;
    measured.name = axis.name;
    measured.kind = axis.kind;
    measured.mass = {0.99 * axis.mass, 1.01 * axis.mass};
    measured.damping = {kProven * axis.damping, 1.2 * axis.damping};
    measured.coulomb = {axis.coulomb, axis.coulomb + 0.1};
    measured.gravity = {-0.01, 0.01};
    measured.delay_s = {0.9e-3, 1.1e-3};
    measured.resolution = axis.encoder_step;
    out.axes.push_back(measured);
  }
  return out;
}

// Presses into a body and returns.
// @param periods delay that was measured at arming; 0: none
std::unique_ptr<Rig> measuredRig(const Passport& passport, int periods = 0) {
  Models models = load(shippedFiles("lambda-pride", "four-shapes"));
  RigOptions options;
  options.uncertified = true;  // simulated
  options.measured = worstCorners(models.device, passport, options.period_s);
  for (DeviceModel& corner : options.measured) {
    corner.output_delay_ticks = std::max(corner.output_delay_ticks, periods);
  }
  options.passport = "digest";
  options.passport_text = passportText(passport);
  AxisPosition there(6);
  there[0] = 0.05;
  return orThrow(buildRig(std::move(models),
                          Intention::throughWaypoints({{0.0, AxisPosition(6)}, {0.3, there}}),
                          options));
}

TEST(MeasuredDevice, EnergyTank_UsesTheLowerEndOfTheMeasuredDamping) {
  const Models models = load(shippedFiles("lambda-pride", "four-shapes"));
  const auto rig = measuredRig(passportOf(models.device));
  const EnergyTankConfig& tank = rig->renderer->config().safety.tank;
  for (int i = 0; i < tank.axes; ++i) {
    const double stated = models.device.axes[i].damping;
    EXPECT_DOUBLE_EQ(tank.device_damping[i], kProven * stated);
    EXPECT_EQ(rig->models.device.axes[i].damping, stated) << "the file is as it was";
  }
}

// All parts use the same proven device: ADR 26.
TEST(MeasuredDevice, TankAndSupervisor_UseTheWorseOfFileAndPassport) {
  const Models models = load(shippedFiles("lambda-pride", "four-shapes"));
  Passport passport = passportOf(models.device);
  for (PassportAxis& axis : passport.axes) {
    axis.resolution *= 10.0;
    axis.delay_s = {3.9e-3, 4.0e-3};
    axis.mass = {0.25 * axis.mass.lower, axis.mass.upper};
  }
  const auto rig = measuredRig(passport);
  const SafetyConfig& safety = rig->renderer->config().safety;
  EXPECT_EQ(safety.tank.delay_ticks, 4);
  const EnergyTankConfig worst =
      makeEnergyTank(worstCorners(models.device, passport, 1e-3)[0], 1e-3);
  for (int i = 0; i < safety.tank.axes; ++i) {
    EXPECT_EQ(safety.supervisor.encoder_step[i], passport.axes[i].resolution);
    EXPECT_DOUBLE_EQ(safety.tank.most_damping[i], worst.most_damping[i]);
  }
}

TEST(MeasuredDevice, MeasuredDampingAboveTheFiles_IsNotUsed) {
  const Models models = load(shippedFiles("lambda-pride", "four-shapes"));
  Passport passport = passportOf(models.device);
  for (PassportAxis& axis : passport.axes) axis.damping = {100.0, 120.0};
  const auto rig = measuredRig(passport);
  EXPECT_EQ(rig->renderer->config().safety.tank.device_damping[0], models.device.axes[0].damping);
}

// The tank depends on the delay, so that a replay needs the one of that arming.
TEST(MeasuredDevice, RecordingWithALongerDelayAtArming_IsReproducedToTheBit) {
  const Folder folder;
  const Passport passport = passportOf(load(shippedFiles("lambda-pride", "four-shapes")).device);
  const auto rig = measuredRig(passport, 5);
  ASSERT_EQ(rig->renderer->config().safety.tank.delay_ticks, 5);
  const std::string record = recordTicks(*rig, 500, folder.file("run.h5"));
  const auto reader = orThrow(RecordingReader::open(record));
  const auto corners = orThrow(recordedCorners(reader->meta(), rig->models.device, record));
  EXPECT_EQ(corners[1].output_delay_ticks, 5) << "the passport alone says 1";
  const auto again = resimulate(*reader, record);
  ASSERT_TRUE(again) << format(again.errors());
  EXPECT_TRUE(again->same());
}

TEST(MeasuredDevice, Recording_CarriesThePassportAndIsReproducedToTheBit) {
  const Folder folder;
  const Passport passport = passportOf(load(shippedFiles("lambda-pride", "four-shapes")).device);
  const auto rig = measuredRig(passport);
  const std::string record = recordTicks(*rig, 500, folder.file("run.h5"));
  const auto reader = orThrow(RecordingReader::open(record));
  const auto corners = orThrow(recordedCorners(reader->meta(), rig->models.device, record));
  ASSERT_EQ(corners.size(), 2U);
  EXPECT_NEAR(corners[0].axes[0].damping, kProven * rig->models.device.axes[0].damping, 1e-8);
  const auto again = resimulate(*reader, record);
  ASSERT_TRUE(again) << format(again.errors());
  EXPECT_GT(again->compared, 500U);
  EXPECT_TRUE(again->same());
}

}  // namespace
}  // namespace wholehand::test
