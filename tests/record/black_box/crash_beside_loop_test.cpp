// A crash in a thread other than the loop's: the loop reaches neutral before the process ends.
#include "loop/realtime/monotonic_clock.hpp"
#include "record/black_box/box_tools.hpp"
#include "record/black_box/child_tools.hpp"
#include "record/black_box/run_tools.hpp"
#include "record/crash_guard.hpp"
#include "support/watched_main.hpp"

#include <array>
#include <atomic>
#include <csignal>
#include <ctime>
#include <sched.h>
#include <sys/mman.h>
#include <thread>

namespace wholehand::test {
namespace {

using synthetic::Folder;

constexpr std::uint64_t kCrashAt = 1400;  // ticks; the hand moves back and forth
constexpr std::uint64_t kMostTicks = 60'000;
constexpr std::uint64_t kNeutralWithin = 100;      // ticks of a millisecond (docs/safety.md)
constexpr std::int64_t kHeldFor_ns = 130'000'000;  // the same page: time that the loop is given

/// Report of the child, in memory that outlives it.
struct Reported {
  struct Tick {
    AxisEffort sent;
    Fault faults = Fault::kNone;
    SafetyState state = SafetyState::kDisarmed;
  };
  std::atomic<std::uint64_t> ticks{0};
  std::atomic<std::int64_t> crashed_ns{0}, dealt_with_ns{0};
  std::atomic<bool> neutral{false}, returned{false};
  std::array<Tick, kMostTicks> log;
};

/// Stores every tick, and holds the tick at which the other thread crashes until it has crashed.
class Logging final : public TickListener {
 public:
  explicit Logging(Reported& reported) : reported_(reported) {}
  void beforeTick(const TickRecord& record) noexcept override {
    while (record.tick == kCrashAt && reported_.crashed_ns == 0) ::sched_yield();
  }
  void afterTick(const TickRecord& record) noexcept override {
    const std::uint64_t n = reported_.ticks;
    if (n >= kMostTicks) return;
    reported_.log[n] = {record.sent, record.faults, record.safety_state};
    reported_.ticks = n + 1;
    if (record.safety_state == SafetyState::kDisarmed) reported_.neutral = true;
  }

 private:
  Reported& reported_;
};

/// Notified of the crash after the black box, whose wait for the loop is over. However little
/// processor time the loop gets, it reaches neutral before the process ends, and its run would
/// return in the half second after that.
class HoldingTheEnd final : public CrashHandler {
 public:
  explicit HoldingTheEnd(Reported& reported) : reported_(reported) {}
  void crashed(int) noexcept override {
    reported_.dealt_with_ns = monotonicNow_ns();
    const timespec a_moment{0, 1'000'000};
    for (int i = 0; i < 30'000 && !reported_.neutral; ++i) ::nanosleep(&a_moment, nullptr);
    for (int i = 0; i < 500 && !reported_.returned; ++i) ::nanosleep(&a_moment, nullptr);
  }

 private:
  Reported& reported_;
};

class CrashBesideTheLoop : public testing::Test {
 protected:
  void SetUp() override {
    void* const shared = ::mmap(nullptr, sizeof(Reported), PROT_READ | PROT_WRITE,
                                MAP_SHARED | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    ASSERT_NE(shared, MAP_FAILED);
    reported_ = new (shared) Reported;
    Models models = load(shippedFiles());
    Intention intention = sweeping(models.device, 0.7);
    rig_ = orThrow(buildRig(std::move(models), std::move(intention), RigOptions{}));
  }
  void TearDown() override { ::munmap(reported_, sizeof(Reported)); }

  /// Runs in the child: the loop runs as fast as it can in one thread while another thread crashes.
  void runAndCrash() {
    rig_->listener = std::make_unique<Logging>(*reported_);
    RunPlan plan;
    plan.title = "crashed beside it";
    plan.duration_ticks = kMostTicks;
    plan.black_box = path();
    plan.simulated_clock = true;
    std::thread loop([&] {
      (void)runAndRecord(*rig_, plan);
      reported_->returned = true;
    });
    std::thread other([this] {
      while (reported_->ticks < kCrashAt) ::sched_yield();
      HoldingTheEnd witness(*reported_);
      const CrashGuard guard(witness);
      reported_->crashed_ns = monotonicNow_ns();
      writeToNowhere();
    });
    loop.join();
    other.join();
  }

  [[nodiscard]] std::string path() const { return folder_.file("run.wbb"); }
  /// Largest distance of an axis's effort from neutral in this tick, as a share of its limit.
  [[nodiscard]] double share(std::uint64_t tick) const {
    double most = 0.0;
    for (int a = 0; a < axes(); ++a) {
      most = std::max(most, away(tick, a) / axis(a).effort_limit);
    }
    return most;
  }
  [[nodiscard]] double away(std::uint64_t tick, int a) const {
    return std::abs(reported_->log[tick].sent[a] - rig_->renderer->config().safety.neutral[a]);
  }
  [[nodiscard]] double change(std::uint64_t tick, int a) const {
    return std::abs(reported_->log[tick].sent[a] - reported_->log[tick - 1].sent[a]);
  }
  [[nodiscard]] int axes() const { return rig_->models.device.axisCount(); }
  [[nodiscard]] const DeviceAxis& axis(int a) const { return rig_->models.device.axes[a]; }

  Reported* reported_ = nullptr;

 private:
  Folder folder_;
  std::unique_ptr<Rig> rig_;
};

TEST_F(CrashBesideTheLoop, SegmentationFault_RampsToNeutralBeforeTheProcessEnds) {
  const int status = inChild([this] { runAndCrash(); });
  expectDiedOf(SIGSEGV, status);
  EXPECT_FALSE(reported_->returned) << kAlways << "the run ended as if nothing had happened";
  EXPECT_GE(reported_->dealt_with_ns - reported_->crashed_ns, kHeldFor_ns);
  ASSERT_TRUE(reported_->neutral);

  const std::uint64_t ticks = reported_->ticks;
  ASSERT_LT(ticks, kMostTicks);
  std::uint64_t stop = kCrashAt;  // the first tick after the crash
  while (stop < ticks && !any(reported_->log[stop].faults & Fault::kEmergencyStop)) ++stop;
  ASSERT_LT(stop, ticks);
  EXPECT_EQ(reported_->log[stop - 1].state, SafetyState::kRendering);
  EXPECT_GT(share(stop - 1), 0.01) << "there was nothing to ramp down";

  for (std::uint64_t k = 1; k < ticks; ++k) {
    for (int a = 0; a < axes(); ++a) {
      ASSERT_LE(change(k, a), axis(a).effort_slew_limit * 1e-3 * (1.0 + 1e-12))
          << kAlways << "tick " << k << ", " << axis(a).name;
      if (k < stop) continue;
      ASSERT_LE(away(k, a), away(k - 1, a) + 1e-12)
          << kAlways << "tick " << k << ", " << axis(a).name;
    }
  }
  ASSERT_LE(ticks - stop, kNeutralWithin) << kAlways;
  EXPECT_EQ(share(ticks - 1), 0.0) << kAlways;
  EXPECT_EQ(reported_->log[ticks - 1].state, SafetyState::kDisarmed);
  figure("ticks from a crash beside the loop to neutral", static_cast<double>(ticks - stop), "");
  figure("effort then, of its limit", share(stop - 1), "");

  const auto box = opened(path());
  ASSERT_NE(box, nullptr);
  EXPECT_EQ(box->cause().signal, SIGSEGV);
  EXPECT_GE(box->inputTicks(), kCrashAt);
}

}  // namespace
}  // namespace wholehand::test
