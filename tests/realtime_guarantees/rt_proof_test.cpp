// The tick does nothing that may make it late: counted over whole sessions, on both clocks.
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

/// A rig and its virtual patient, who hears of every tick.
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

/// A cylinder on a pedestal is grasped with the whole hand, lifted and held.
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

/// What makes the run worth looking at: the exercise has pushed, things were touched and moved.
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

/// What the kernel may do to a thread on its own account, the machine excuses.
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
  /// Runs that long on the simulated clock; warm once `kWarmTicks` have passed.
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

  /// The same in real time, with a thread of its own and telemetry beside it.
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
    // Between ticks it hands the record on and sleeps; nothing else.
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

TEST_F(RealTimeProof, CocktailBarOnTheSimulatedClock_DoesNothingThatMayMakeItLate) {
  Story story;
  simulated("cocktail bar", cocktailBar(), 8000, story);
  EXPECT_GT(story.pushing, 200U);
  EXPECT_GT(story.touching, 200U);
}

/// A minute where every large count is asked for, else until the first dispenser is squeezed.
TEST_F(RealTimeProof, CocktailBarAt8kHz_DoesNothingThatMayMakeItLate) {
  const std::uint64_t ticks = std::getenv("WHOLEHAND_FULL") != nullptr ? 480'000 : 40'000;
  Story story;
  simulated("cocktail bar at 8 kHz", cocktailBar(8000.0), ticks, story);
  EXPECT_GT(story.pushing, 1000U);
}

TEST_F(RealTimeProof, CocktailBarInRealTime_DoesNothingThatMayMakeItLate) {
  Story story;
  inRealTime("cocktail bar", cocktailBar(), 4000, story);
  EXPECT_GT(story.records, 1000U);
}

TEST_F(RealTimeProof, GraspingOnTheSimulatedClock_DoesNothingThatMayMakeItLate) {
  Story story;
  simulated("free grasping", freeGrasping(), 8000, story);
  EXPECT_GT(story.touching, 4000U);  // from 2.8 s on it is held
}

TEST_F(RealTimeProof, GraspingInRealTime_DoesNothingThatMayMakeItLate) {
  Story story;
  inRealTime("free grasping", freeGrasping(), 4000, story);
  EXPECT_GT(story.records, 1000U);
}

/// Does in one tick everything that none may.
class Sinner final : public TickListener {
 public:
  static constexpr std::uint64_t kTick = 50;
  static constexpr std::size_t kPages = 5;

  Sinner()
      : pages_(static_cast<volatile char*>(mmap(nullptr, kPages * 4096, PROT_READ | PROT_WRITE,
                                                MAP_PRIVATE | MAP_ANONYMOUS, -1, 0))) {
    (void)madvise(const_cast<char*>(pages_), kPages * 4096, MADV_NOHUGEPAGE);
  }
  ~Sinner() override { munmap(const_cast<char*>(pages_), kPages * 4096); }
  Sinner(const Sinner&) = delete;
  Sinner& operator=(const Sinner&) = delete;

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

TEST_F(RealTimeProof, EverySin_IsCounted) {
  if (!counting()) GTEST_SKIP() << "a sanitizer owns malloc and the locks";
  Played played = freeGrasping();
  orThrow(played.rig->renderer->arm());
  Sinner sinner;
  TickWatch watch(sinner, {40, 59});
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
  EXPECT_GE(of(watch.inTick(), Kind::kMinorFault), std::int64_t{Sinner::kPages});
  EXPECT_EQ(watch.lastTickWith(Kind::kLock), std::int64_t{Sinner::kTick});
  if (watch.noSystemCalls().empty()) {
    EXPECT_EQ(of(watch.inTick(), Kind::kSleep), 1);
    EXPECT_EQ(of(watch.inTick(), Kind::kSystemCall), 1);
  }
}

}  // namespace
}  // namespace wholehand::test
