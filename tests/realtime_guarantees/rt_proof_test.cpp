// The tick does nothing that could delay it: counted over whole sessions, on both clocks.
#include "experiments/grasp_script.hpp"
#include "loop/patient/motion.hpp"
#include "loop/patient/player.hpp"
#include "realtime_guarantees/tick_watch.hpp"
#include "record/hub.hpp"
#include "support/rig_tools.hpp"
#include "support/watched_main.hpp"

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <sys/mman.h>
#include <thread>
#include <unistd.h>

namespace wholehand::test {
namespace {

namespace fs = std::filesystem;

/// A rig and its virtual patient, who is notified of every tick.
struct Played {
  std::unique_ptr<Rig> rig;
  std::unique_ptr<ListeningPlayer> listener;
};

Played played(Models models, std::unique_ptr<Player> player, double rate_hz = 1000.0) {
  Played out;
  RigOptions options;
  options.period_s = 1.0 / rate_hz;
  out.listener = std::make_unique<ListeningPlayer>(*player);
  out.rig = orThrow(buildRig(std::move(models), std::move(player), options));
  return out;
}

Played cocktailBar(double rate_hz = 1000.0) {
  ModelFiles files = shippedFiles();
  files.scene.clear();
  files.exercise = std::string(WHOLEHAND_SOURCE_DIR) + "/config/exercises/cocktail-bar.toml";
  Models models = load(files);
  std::unique_ptr<Player> player = models.exercise->makePlayer({1});
  return played(std::move(models), std::move(player), rate_hz);
}

/// The whole hand grasps, lifts and holds a cylinder on a pedestal.
Played freeGrasping() {
  const auto trials = tunedTrials();
  const auto trial = *std::find_if(trials.begin(), trials.end(), [](const GraspTrial& t) {
    return t.shape == "cylinder" && t.gravity;
  });
  ModelFiles files = shippedFiles();
  const fs::path scene =
      fs::temp_directory_path() / ("wholehand-proof-" + std::to_string(::getpid()) + ".toml");
  std::ofstream(scene) << graspScene(trial, load(files));
  files.scene = scene.string();
  Models models = load(files);
  fs::remove(scene);
  auto player = std::make_unique<ScriptedPlayer>(graspIntention(trial, models));
  return played(std::move(models), std::move(player));
}

/// Shows that the run was representative: the exercise pushed, and bodies were touched.
struct Story {
  std::uint64_t touching = 0, pushing = 0, records = 0;
  void operator()(const TickRecord& r) {
    ++records;
    if (r.contact_count > 0) ++touching;
    for (double effort : r.exercise.effort) {
      if (effort != 0.0) {
        ++pushing;
        break;
      }
    }
  }
};

/// Prefix that forbids retries, empty for events that the kernel may cause on its own.
const char* alwaysFor(Kind kind) {
  return kind == Kind::kMajorFault || kind == Kind::kVoluntarySwitch ? "" : kAlways;
}

void expectNothing(const TickWatch& watch, bool memory_locked) {
  if (!counting()) {
    std::printf("  a sanitizer owns malloc and the locks: the counts prove nothing\n");
    return;
  }
  for (const Kind kind :
       {Kind::kAllocation, Kind::kRelease, Kind::kLock, Kind::kWait, Kind::kWake, Kind::kSystemCall,
        Kind::kSleep, Kind::kMajorFault, Kind::kVoluntarySwitch}) {
    EXPECT_EQ(of(watch.inTick(), kind), 0)
        << alwaysFor(kind) << kindName(kind) << ", last in tick " << watch.lastTickWith(kind);
  }
  if (memory_locked) {
    EXPECT_EQ(of(watch.inTick(), Kind::kMinorFault), 0);
  } else {
    std::printf("  memory is not locked here: minor page faults are printed, not gated\n");
  }
}

class RealTimeProof : public testing::Test {
 protected:
  /// Runs so many ticks on the simulated clock; counting starts after `kWarmTicks`.
  void simulated(const char* title, Played played, std::uint64_t ticks, Story& story) {
    orThrow(played.rig->renderer->arm());
    const SetupLine locked = requestLockedMemory();
    TickWatch watch(*played.listener, {kWarmTicks, ticks - 1});
    SessionConfig config;
    config.listener = &watch;
    config.duration_ticks = ticks;
    Session session(*played.rig->renderer, config);
    session.runSimulated([&](const TickRecord& record) { story(record); });
    munlockall();
    EXPECT_FALSE(any(session.counters().latched));
    EXPECT_EQ(watch.ticks(), ticks - kWarmTicks);
    watch.print(std::string(title) + ", simulated clock");
    expectNothing(watch, locked.granted);
  }

  /// The same in real time, with its own thread and telemetry.
  void inRealTime(const char* title, Played played, std::uint64_t ticks, Story& story) {
    seesRealTime();
    orThrow(played.rig->renderer->arm());
    TickWatch watch(*played.listener, {kWarmTicks, ticks - 1});
    SessionConfig config;
    config.listener = &watch;
    config.duration_ticks = ticks;
    Session session(*played.rig->renderer, config);
    TelemetryHub hub([&](TickRecord& record) { return session.tryPop(record); });
    hub.add([&](const TickRecord& record) { story(record); });
    hub.start();
    const SetupReport setup = orThrow(session.start({}));
    session.join();
    hub.stop();
    munlockall();
    EXPECT_FALSE(any(session.counters().latched));
    watch.print(std::string(title) + ", real clock");
    const std::uint64_t skipped = session.counters().skipped_periods;
    std::printf("  missed deadlines: %llu\n", static_cast<unsigned long long>(skipped));
    ASSERT_GT(watch.ticks(), 0U);
    expectNothing(watch, granted(setup, "locked memory"));
    // Between ticks the thread only passes on the record and sleeps.
    const Counts& between = watch.between();
    for (const Kind kind : {Kind::kAllocation, Kind::kRelease, Kind::kLock, Kind::kWait,
                            Kind::kWake, Kind::kSystemCall}) {
      EXPECT_EQ(of(between, kind), 0) << kAlways << kindName(kind);
    }
    if (watch.noSystemCalls().empty()) {
      EXPECT_LE(of(between, Kind::kSleep), static_cast<std::int64_t>(watch.ticks()));
    }
    EXPECT_LE(of(between, Kind::kVoluntarySwitch), static_cast<std::int64_t>(watch.ticks()));
  }
};

TEST_F(RealTimeProof, CocktailBarOnTheSimulatedClock_DoesNothingThatCouldDelayTheTick) {
  Story story;
  simulated("cocktail bar", cocktailBar(), 8000, story);
  EXPECT_GT(story.pushing, 200U);
  EXPECT_GT(story.touching, 200U);
}

/// Runs a minute in a full run, otherwise until the first dispenser is squeezed.
TEST_F(RealTimeProof, CocktailBarAt8kHz_DoesNothingThatCouldDelayTheTick) {
  const std::uint64_t ticks = std::getenv("WHOLEHAND_FULL") != nullptr ? 480'000 : 40'000;
  Story story;
  simulated("cocktail bar at 8 kHz", cocktailBar(8000.0), ticks, story);
  EXPECT_GT(story.pushing, 1000U);
}

TEST_F(RealTimeProof, CocktailBarInRealTime_DoesNothingThatCouldDelayTheTick) {
  Story story;
  inRealTime("cocktail bar", cocktailBar(), 4000, story);
  EXPECT_GT(story.records, 1000U);
}

TEST_F(RealTimeProof, GraspingOnTheSimulatedClock_DoesNothingThatCouldDelayTheTick) {
  Story story;
  simulated("free grasping", freeGrasping(), 8000, story);
  EXPECT_GT(story.touching, 4000U);  // the cylinder is held from 2.8 s on
}

TEST_F(RealTimeProof, GraspingInRealTime_DoesNothingThatCouldDelayTheTick) {
  Story story;
  inRealTime("free grasping", freeGrasping(), 4000, story);
  EXPECT_GT(story.records, 1000U);
}

/// A listener that does in one tick everything that is forbidden in a tick.
class MisbehavingListener final : public TickListener {
 public:
  static constexpr std::uint64_t kTick = 50;
  static constexpr std::size_t kPages = 5;

  MisbehavingListener()
      : pages_(static_cast<volatile char*>(mmap(nullptr, kPages * 4096, PROT_READ | PROT_WRITE,
                                                MAP_PRIVATE | MAP_ANONYMOUS, -1, 0))) {
    (void)madvise(const_cast<char*>(pages_), kPages * 4096, MADV_NOHUGEPAGE);
  }
  ~MisbehavingListener() override { munmap(const_cast<char*>(pages_), kPages * 4096); }
  MisbehavingListener(const MisbehavingListener&) = delete;
  MisbehavingListener& operator=(const MisbehavingListener&) = delete;

  void beforeTick(const TickRecord&) noexcept override {}
  void afterTick(const TickRecord& record) noexcept override {
    if (record.tick != kTick) return;
    const auto block = std::make_unique<std::uint64_t>(record.tick);
    asm volatile("" : : "g"(block.get()) : "memory");
    { const std::lock_guard lock(mutex_); }
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    (void)!::getppid();
    for (std::size_t i = 0; i < kPages; ++i) pages_[i * 4096] = 1;
  }

 private:
  std::mutex mutex_;
  volatile char* pages_;
};

TEST_F(RealTimeProof, EveryForbiddenCall_IsCounted) {
  if (!counting()) GTEST_SKIP() << "a sanitizer owns malloc and the locks";
  Played played = freeGrasping();
  orThrow(played.rig->renderer->arm());
  MisbehavingListener misbehaving;
  TickWatch watch(misbehaving, {40, 59});
  SessionConfig config;
  config.listener = &watch;
  config.duration_ticks = 60;
  Session session(*played.rig->renderer, config);
  session.runSimulated([](const TickRecord&) {});
  watch.print("a tick that does everything it must not");
  EXPECT_EQ(of(watch.inTick(), Kind::kAllocation), 1);
  EXPECT_EQ(of(watch.inTick(), Kind::kRelease), 1);
  EXPECT_EQ(of(watch.inTick(), Kind::kLock), 1);
  EXPECT_GE(of(watch.inTick(), Kind::kVoluntarySwitch), 1);
  EXPECT_GE(of(watch.inTick(), Kind::kMinorFault), std::int64_t{MisbehavingListener::kPages});
  EXPECT_EQ(watch.lastTickWith(Kind::kLock), std::int64_t{MisbehavingListener::kTick});
  if (watch.noSystemCalls().empty()) {
    EXPECT_EQ(of(watch.inTick(), Kind::kSleep), 1);
    EXPECT_EQ(of(watch.inTick(), Kind::kSystemCall), 1);
  }
}

}  // namespace
}  // namespace wholehand::test
