// main() of programs with tests in real time. Threads beside them only sleep, one a processor, and
// one passes a byte over a terminal while a test speaks over one. A test that said seesRealTime()
// and fails while even one of these was kept waiting is named as not judged, and fails nothing;
// every other failure does, and so do crashes, reports of sanitizers and hangs. Nothing is tried
// again.
#include "support/watched_main.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <memory>
#include <mutex>
#include <optional>
#include <pthread.h>
#include <sched.h>
#include <string>
#include <termios.h>
#include <time.h>
#include <unistd.h>
#include <vector>

namespace wholehand::test {
namespace {

constexpr double kSleep_ms = 1.0;

double now_ms() {
  timespec t{};
  ::clock_gettime(CLOCK_MONOTONIC, &t);
  return 1e3 * static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_nsec);
}

/// A line of the test's own.
class Terminal {
 public:
  Terminal() : near_(::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC)) {
    std::array<char, 64> name{};
    if (near_ < 0 || ::grantpt(near_) != 0 || ::unlockpt(near_) != 0) return;
    if (::ptsname_r(near_, name.data(), name.size()) != 0) return;
    far_ = ::open(name.data(), O_RDWR | O_NOCTTY | O_CLOEXEC);
    termios raw{};
    if (far_ < 0 || ::tcgetattr(far_, &raw) != 0) return;
    ::cfmakeraw(&raw);
    ready_ = ::tcsetattr(far_, TCSANOW, &raw) == 0;
  }
  /// A byte from one end to the other.
  void pass() const {
    char byte = '.';
    if (ready_ && ::write(near_, &byte, 1) == 1) (void)!::read(far_, &byte, 1);
  }

 private:
  int near_, far_ = -1;
  bool ready_ = false;
};

/// One thread a processor, bound to it, that sleeps a millisecond at a time: a thread that may move
/// wakes on a processor that is idle, while the test waits for one that is not. Of ordinary
/// priority, as the threads of clients and servers in the tests are: one of real-time priority
/// would run where these do not. One more is bound to none and has a terminal. They are never
/// joined: a child that a test forks has no such threads and may end as it likes.
class Sleepers {
 public:
  Sleepers() {
    cpu_set_t allowed;
    CPU_ZERO(&allowed);
    ::sched_getaffinity(0, sizeof allowed, &allowed);
    pthread_attr_t attributes;
    ::pthread_attr_init(&attributes);
    ::pthread_attr_setstacksize(&attributes, std::size_t{256} << 10U);  // tests lock all memory
    ::pthread_attr_setdetachstate(&attributes, PTHREAD_CREATE_DETACHED);
    start(attributes, true);
    for (int processor = 0; processor < CPU_SETSIZE; ++processor) {
      if (!CPU_ISSET(processor, &allowed)) continue;
      cpu_set_t one;
      CPU_ZERO(&one);
      CPU_SET(processor, &one);
      ::pthread_attr_setaffinity_np(&attributes, sizeof one, &one);
      start(attributes, false);
    }
    ::pthread_attr_destroy(&attributes);
  }
  void begin() {
    for (const auto& sleeper : sleepers_) {
      const std::lock_guard lock(sleeper->mutex);
      sleeper->begun_ms = now_ms();
      sleeper->longest_ms = 0.0;
    }
  }
  /// The longest that one was kept waiting since then.
  double longest_ms() {
    double longest_ms = 0.0;
    for (const auto& sleeper : sleepers_) {
      const std::lock_guard lock(sleeper->mutex);
      sleeper->look();
      longest_ms = std::max(longest_ms, sleeper->longest_ms);
    }
    return longest_ms;
  }

 private:
  struct Sleeper {
    static void* sleep(void* self) {
      auto& sleeper = *static_cast<Sleeper*>(self);
      for (;;) {
        {
          const std::lock_guard lock(sleeper.mutex);
          sleeper.look();
          sleeper.asleep_ms = now_ms();
        }
        const timespec duration{0, static_cast<long>(1e6 * kSleep_ms)};
        ::nanosleep(&duration, nullptr);
        if (sleeper.terminal && g_sees_terminal) sleeper.terminal->pass();
      }
      return nullptr;
    }
    /// Of a sleep that began before the test, only what reaches into the test counts.
    void look() {
      const double over_ms = now_ms() - std::max(asleep_ms, begun_ms) - kSleep_ms;
      longest_ms = std::max(longest_ms, over_ms);
    }
    std::optional<Terminal> terminal;
    std::mutex mutex;
    double asleep_ms = now_ms(), begun_ms = asleep_ms, longest_ms = 0.0;
  };
  void start(const pthread_attr_t& attributes, bool has_terminal) {
    auto sleeper = std::make_unique<Sleeper>();
    if (has_terminal) sleeper->terminal.emplace();
    pthread_t thread{};
    if (::pthread_create(&thread, &attributes, &Sleeper::sleep, sleeper.get()) == 0) {
      sleepers_.push_back(std::move(sleeper));
    }
  }

  std::vector<std::unique_ptr<Sleeper>> sleepers_;
};

class Judge final : public testing::EmptyTestEventListener {
 public:
  void OnTestStart(const testing::TestInfo&) override {
    failure_.clear();
    excusable_ = true;
    g_sees_real_time = false;
    g_sees_terminal = false;
    sleepers_.begin();
  }
  void OnTestPartResult(const testing::TestPartResult& part) override {
    if (!part.failed()) return;
    if (std::strstr(part.message(), kAlways) != nullptr) excusable_ = false;
    if (!failure_.empty()) return;
    const std::string said = part.message();
    const char* file = part.file_name() != nullptr ? part.file_name() : "?";
    failure_ =
        file + (":" + std::to_string(part.line_number())) + ": " + said.substr(0, said.find('\n'));
  }
  void OnTestEnd(const testing::TestInfo& test) override {
    if (test.result()->Skipped()) return;
    const double waited_ms = sleepers_.longest_ms();
    const bool failed = test.result()->Failed();
    if (!failed || !excusable_ || !g_sees_real_time || waited_ms <= kKeptWaiting_ms) {
      judged_ += g_sees_real_time ? 1 : 0;
      failed_ = failed_ || failed;
      return;
    }
    ++not_judged_;
    std::printf("not judged: %s.%s: this machine kept a sleeper waiting for %.0f ms (%s)\n",
                test.test_suite_name(), test.name(), waited_ms, failure_.c_str());
    std::fflush(stdout);
  }
  /// Outside of a test nothing is excused.
  void OnTestSuiteEnd(const testing::TestSuite& suite) override {
    failed_ = failed_ || suite.ad_hoc_test_result().Failed();
  }
  void OnTestProgramEnd(const testing::UnitTest& all) override {
    failed_ = failed_ || all.ad_hoc_test_result().Failed();
    std::printf("real time: %d judged, %d not judged\n", judged_, not_judged_);
    std::fflush(stdout);
  }
  /// @param of_gtest what RUN_ALL_TESTS() returned
  [[nodiscard]] int exitCode(int of_gtest) const {
    return of_gtest == 0 || (!failed_ && not_judged_ > 0) ? 0 : 1;
  }

 private:
  Sleepers sleepers_;
  std::string failure_;  ///< the first of the test that runs
  bool excusable_ = true, failed_ = false;
  int judged_ = 0, not_judged_ = 0;
};

}  // namespace
}  // namespace wholehand::test

int main(int count, char** arguments) {
  testing::InitGoogleTest(&count, arguments);
  if (testing::GTEST_FLAG(list_tests)) return RUN_ALL_TESTS();
  // Never destroyed: its thread goes on until the program ends.
  auto* judge = new wholehand::test::Judge;
  testing::UnitTest::GetInstance()->listeners().Append(judge);
  const int of_gtest = RUN_ALL_TESTS();
  testing::UnitTest::GetInstance()->listeners().Release(judge);  // which would delete it at exit
  return judge->exitCode(of_gtest);
}
