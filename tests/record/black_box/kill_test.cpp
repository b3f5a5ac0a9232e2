#include "loop/patient/player.hpp"
#include "record/black_box/box_tools.hpp"
#include "record/black_box/child_tools.hpp"
#include "record/black_box/run_tools.hpp"
#include "support/seed.hpp"
#include "support/watched_main.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <thread>
#include <unistd.h>

/// Real runs of the bar on the real clock, recorded, in separate processes that are killed at a
/// random moment.
namespace wholehand::test {
namespace {

using std::chrono::milliseconds;
using synthetic::Folder;

/// Progress of the loop, in memory that outlives the process.
struct Progress {
  std::atomic<std::uint64_t> ticks{0};              ///< ticks that have ended
  std::atomic<std::uint64_t> crash_at{UINT64_MAX};  ///< the process crashes itself within this tick
};
static_assert(std::atomic<std::uint64_t>::is_always_lock_free);

class ReportingListener final : public TickListener {
 public:
  ReportingListener(Player& player, Progress& progress) : listening_(player), progress_(progress) {}
  void beforeTick(const TickRecord& record) noexcept override {
    if (record.tick >= progress_.crash_at) writeToNowhere();
  }
  void afterTick(const TickRecord& record) noexcept override {
    listening_.afterTick(record);
    progress_.ticks.store(record.tick + 1, std::memory_order_release);
  }

 private:
  ListeningPlayer listening_;
  Progress& progress_;
};

class KilledRun : public testing::Test {
 protected:
  void SetUp() override {
    progress_ = new (::mmap(nullptr, sizeof(Progress), PROT_READ | PROT_WRITE,
                            MAP_SHARED | MAP_ANONYMOUS, -1, 0)) Progress;
    Models models = bar();
    auto player = models.exercise->makePlayer({1});
    ASSERT_NE(player, nullptr);
    auto reporting = std::make_unique<ReportingListener>(*player, *progress_);
    rig_ = orThrow(buildRig(std::move(models), std::move(player), RigOptions{}));
    rig_->listener = std::move(reporting);
  }
  void TearDown() override { ::munmap(progress_, sizeof(Progress)); }

  /// Starts a run in a child and returns when it ticks.
  pid_t start(const std::string& recording) {
    seesRealTime();
    progress_->ticks = 0;
    std::fflush(nullptr);
    const pid_t child = ::fork();
    if (child == 0) {
      run(recording);
      ::_exit(99);
    }
    const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(300);
    while (progress_->ticks == 0 && std::chrono::steady_clock::now() < until) {
      std::this_thread::sleep_for(milliseconds(5));
    }
    EXPECT_GT(progress_->ticks, 0U) << "the run did not begin";
    return child;
  }
  /// Waits for the child's end. @return the last tick it reached
  std::uint64_t end(pid_t child, int signal) {
    int status = 0;
    ::waitpid(child, &status, 0);
    EXPECT_TRUE(WIFSIGNALED(status)) << "exit code " << WEXITSTATUS(status);
    EXPECT_EQ(WTERMSIG(status), signal);
    return progress_->ticks;
  }

  Progress* progress_ = nullptr;

 private:
  void run(const std::string& recording) {
    const rlimit none{0, 0};
    ::setrlimit(RLIMIT_CORE, &none);
    ::alarm(300);
    ::close(STDERR_FILENO);
    RunPlan plan;
    plan.title = "killed";
    plan.duration_ticks = 60'000;
    plan.record = recording;
    plan.black_box = blackBoxPath(recording);
    (void)runAndRecord(*rig_, plan);
  }

  std::unique_ptr<Rig> rig_;
};

/// Number of runs: all that the issue requires with WHOLEHAND_FULL.
int runs(int few) {
  return std::getenv("WHOLEHAND_FULL") != nullptr ? 100 : few;
}

/// Checks that every tick up to the last one exists. @return the number of the last + 1
std::uint64_t expectWholeUpTo(RecordingReader& recording) {
  TickRecord record;
  std::uint64_t next = 0;
  for (std::uint64_t i = 0; i < recording.size(); ++i) {
    EXPECT_TRUE(recording.read(i, record)) << i;
    EXPECT_TRUE(i == 0 || record.tick == next + record.elapsed_periods - 1)
        << kAlways << record.tick;
    next = record.tick + 1;
  }
  return next;
}

TEST_F(KilledRun, KillMinusNineAtARandomMoment_LosesAtMostASecondAndAHalf) {
  auto random = seededRandom(4108);
  std::vector<double> lost_s;
  for (int i = 0; i < runs(4); ++i) {
    const Folder folder;
    const std::string path = folder.file("run.h5");
    const pid_t child = start(path);
    std::this_thread::sleep_for(milliseconds(random() % 2500));
    ::kill(child, SIGKILL);
    const std::uint64_t done = end(child, SIGKILL);
    const auto recording = RecordingReader::open(path);
    ASSERT_TRUE(recording.ok()) << format(recording.errors());
    const std::uint64_t kept = expectWholeUpTo(**recording);
    EXPECT_LE(kept, done + 1) << kAlways;
    EXPECT_GE(kept + 1500, done) << "killed after " << done << " ticks";
    lost_s.push_back(1e-3 * (static_cast<double>(done) - static_cast<double>(kept)));
    EXPECT_FALSE(std::filesystem::exists(folder.file("run.wbb")));
  }
  std::sort(lost_s.begin(), lost_s.end());
  std::printf("kill -9, %zu times: lost %.2f s at the median, %.2f s at most\n", lost_s.size(),
              lost_s[lost_s.size() / 2], lost_s.back());
}

/// A random thread of the process.
pid_t anyThread(pid_t process, std::mt19937_64& random) {
  std::vector<pid_t> threads;
  for (const auto& entry :
       std::filesystem::directory_iterator("/proc/" + std::to_string(process) + "/task")) {
    threads.push_back(static_cast<pid_t>(std::stol(entry.path().filename().string())));
  }
  return threads[random() % threads.size()];
}

// Half of the signals go to a random thread at a random moment; the others are a null pointer
// within a random tick.
TEST_F(KilledRun, SegmentationFault_LeavesAFileThatIsAlwaysReproduced) {
  auto random = seededRandom(4109);
  const int count = runs(6), again = runs(2) >= 100 ? 10 : 2;
  int readable = 0, same = 0;
  std::uint64_t ticks = 0;
  for (int i = 0; i < count; ++i) {
    const Folder folder;
    const bool by_itself = i % 2 == 0;
    progress_->crash_at = by_itself ? 1 + random() % 2500 : UINT64_MAX;
    const pid_t child = start(folder.file("run.h5"));
    if (!by_itself) {
      std::this_thread::sleep_for(milliseconds(random() % 2500));
      ::syscall(SYS_tgkill, child, anyThread(child, random), SIGSEGV);
    }
    const std::uint64_t done = end(child, SIGSEGV);
    const auto box = opened(folder.file("run.wbb"));
    ASSERT_NE(box, nullptr);
    EXPECT_EQ(box->cause().signal, SIGSEGV);
    EXPECT_EQ(box->meta().title, "killed");
    EXPECT_TRUE(box->inputsWhole()) << kAlways;
    const std::uint64_t kept = expectWholeUpTo(*box);
    // The loop may have continued while the black box file was written.
    EXPECT_GT(kept, 0U);
    EXPECT_GE(kept + 1500, done);
    EXPECT_GE(box->inputTicks(), box->size());
    EXPECT_TRUE(!by_itself || kept == done) << kept << " of " << done << " ticks";
    ++readable;
    ticks += box->size();
    if (i % (count / again) != 0) continue;
    expectSameRerun(folder.file("run.wbb"));
    ++same;
  }
  std::printf("SIGSEGV, %d times: %d boxes readable, %llu ticks in them; %d run again, all same\n",
              count, readable, static_cast<unsigned long long>(ticks), same);
}

}  // namespace
}  // namespace wholehand::test
