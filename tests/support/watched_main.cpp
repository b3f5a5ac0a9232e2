// main() of programs with real-time tests. Additional threads only sleep, one per processor; one
// more passes a byte over a terminal while a test uses a terminal. A test that called
// seesRealTime() and fails while one of these threads was kept waiting is reported as not judged
// and fails nothing. Every other failure counts, as do crashes, sanitizer reports and hangs. No
// test is repeated.
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

/// A pseudo-terminal for the test.
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
  /// Passes a byte from one end to the other.
  void pass() const {
    char byte = '.';
    if (ready_ && ::write(near_, &byte, 1) == 1) (void)!::read(far_, &byte, 1);
  }

 private:
  int near_, far_ = -1;
  bool ready_ = false;
};

/// One thread per processor, bound to it, that sleeps a millisecond at a time. A thread that may
/// move would wake on an idle processor while the test waits for a busy one. The threads have
/// ordinary priority, as the clients and servers in the tests do; with real-time priority they
/// would run where the others do not. One more thread is unbound and has a terminal. The threads
/// are never joined: a child that a test forks has no such threads and may end in any way.
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
  /// Longest delay of a sleeper since begin() [ms].
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
    /// Measures the present sleep; of a sleep that began before the test only the part within the
    /// test counts.
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

class Verdicts final : public testing::EmptyTestEventListener {
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
  /// Failures outside of tests are never excused.
  void OnTestSuiteEnd(const testing::TestSuite& suite) override {
    failed_ = failed_ || suite.ad_hoc_test_result().Failed();
  }
  void OnTestProgramEnd(const testing::UnitTest& all) override {
    failed_ = failed_ || all.ad_hoc_test_result().Failed();
    std::printf("real time: %d judged, %d not judged\n", judged_, not_judged_);
    std::fflush(stdout);
  }
  /// @param of_gtest result of RUN_ALL_TESTS()
  [[nodiscard]] int exitCode(int of_gtest) const {
    return of_gtest == 0 || (!failed_ && not_judged_ > 0) ? 0 : 1;
  }

 private:
  Sleepers sleepers_;
  std::string failure_;  ///< first failure of the running test
  bool excusable_ = true, failed_ = false;
  int judged_ = 0, not_judged_ = 0;
};

}  // namespace
}  // namespace wholehand::test

int main(int count, char** arguments) {
  testing::InitGoogleTest(&count, arguments);
  if (testing::GTEST_FLAG(list_tests)) return RUN_ALL_TESTS();
  // Never destroyed: its thread continues until the program ends.
  auto* verdicts = new wholehand::test::Verdicts;
  testing::UnitTest::GetInstance()->listeners().Append(verdicts);
  const int of_gtest = RUN_ALL_TESTS();
  testing::UnitTest::GetInstance()->listeners().Release(verdicts);  // it would delete it at exit
  return verdicts->exitCode(of_gtest);
}
