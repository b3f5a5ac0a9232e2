// Counts everything that the loop's thread does in a live session, as a station runs it, with
// recording and commands.
#include "loop/patient/steered_player.hpp"
#include "realtime_guarantees/tick_watch.hpp"
#include "rig/run/run.hpp"
#include "support/rig_tools.hpp"
#include "support/watched_main.hpp"

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <sys/mman.h>
#include <thread>
#include <unistd.h>

namespace wholehand::test {
namespace {

namespace fs = std::filesystem;

/// A player that acts like another and counts everything that the loop's thread does from one tick
/// to a later one.
class CountingPlayer final : public Player {
 public:
  static constexpr std::uint64_t kFrom = kWarmTicks, kTo = 3000;

  CountingPlayer(std::unique_ptr<Player> inner, Counts& counted)
      : inner_(std::move(inner)), counted_(counted) {}
  [[nodiscard]] AxisPosition start() const override { return inner_->start(); }
  void reset() override { inner_->reset(); }
  void advance(double period_s, AxisPosition& q, AxisVelocity& qd) noexcept override {
    inner_->advance(period_s, q, qd);
  }
  void onRecord(const TickRecord& record) noexcept override {
    inner_->onRecord(record);
    if (!begun_ && record.tick >= kFrom) {
      begun_ = true;
      before_ = countsOfThisThread();
    } else if (begun_ && !ended_ && record.tick >= kTo) {
      ended_ = true;
      const Counts now = countsOfThisThread();
      for (std::size_t k = 0; k < kKinds; ++k) counted_[k] = now[k] - before_[k];
    }
  }

 private:
  std::unique_ptr<Player> inner_;
  Counts& counted_;
  Counts before_{};
  bool begun_ = false, ended_ = false;
};

TEST(LiveLoop, LoopWithRecordingAndCommands_OnlyTicksAndSleeps) {
  seesRealTime();
  ModelFiles files = shippedFiles();
  files.scene.clear();
  files.exercise = std::string(WHOLEHAND_SOURCE_DIR) + "/config/exercises/cocktail-bar.toml";
  Models models = load(files);
  Counts counted;
  counted.fill(-1);
  RunPlan plan;
  const fs::path recording =
      fs::temp_directory_path() / ("wholehand-proof-" + std::to_string(::getpid()) + ".h5");
  plan.record = recording.string();
  plan.duration_ticks = CountingPlayer::kTo + 100;
  auto player = std::make_unique<CountingPlayer>(models.exercise->makePlayer({1}), counted);
  auto steered = std::make_unique<SteeredPlayer>(std::move(player), models.device);
  std::shared_ptr<Rig> rig = orThrow(buildRig(models, std::move(steered), {}));
  plan.black_box = blackBoxPath(plan.record);
  const auto live = orThrow(Run::prepare(std::move(rig), plan));
  ASSERT_TRUE(live->begin());
  Command command;
  command.type = CommandType::kParameter;
  for (int i = 0; live->running(); ++i) {
    command.value = i % 2 == 0 ? 5.0 : 10.0;
    (void)live->tryCommand(command);
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  live->finish();
  munlockall();
  EXPECT_GT(fs::file_size(recording), 100'000U);
  fs::remove(recording);
  ASSERT_GE(of(counted, Kind::kAllocation), 0) << "the loop did not get there";
  const auto ticks = static_cast<std::int64_t>(CountingPlayer::kTo - CountingPlayer::kFrom);
  std::printf("live session with a recording and commands, %lld ticks, the loop's whole thread\n",
              static_cast<long long>(ticks));
  for (const Kind kind :
       {Kind::kAllocation, Kind::kRelease, Kind::kLock, Kind::kWait, Kind::kWake, Kind::kMinorFault,
        Kind::kMajorFault, Kind::kVoluntarySwitch, Kind::kInvoluntarySwitch}) {
    std::printf("  %-30s %14lld\n", kindName(kind), static_cast<long long>(of(counted, kind)));
  }
  if (!counting()) return;
  for (const Kind kind :
       {Kind::kAllocation, Kind::kRelease, Kind::kLock, Kind::kWait, Kind::kWake}) {
    EXPECT_EQ(of(counted, kind), 0) << kAlways << kindName(kind);
  }
  EXPECT_EQ(of(counted, Kind::kMajorFault), 0);
  if (granted(live->setup(), "locked memory")) {
    EXPECT_EQ(of(counted, Kind::kMinorFault), 0);
  }
  EXPECT_LE(of(counted, Kind::kVoluntarySwitch), ticks) << "it sleeps once a tick";
}

}  // namespace
}  // namespace wholehand::test
