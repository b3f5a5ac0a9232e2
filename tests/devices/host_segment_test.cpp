// The shared memory and the names of a host and its loop, and all possible defects of them.
#include "hosted_tools.hpp"
#include "support/contains.hpp"
#include "support/open_enabled.hpp"

#include <gtest/gtest.h>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>

namespace wholehand::test {
namespace {

std::string whyNoHost(const std::string& name) {
  const auto driver = HostedDriver::connect(name);
  return driver ? "connected" : format(driver.errors());
}

TEST(NoHost, NoHostOfTheName_IsReportedWithHowToStartOne) {
  const std::string said = whyNoHost("test-nobody");
  EXPECT_TRUE(contains(said, "test-nobody"));
  EXPECT_TRUE(contains(said, "does not run"));
  EXPECT_TRUE(contains(said, "wholehand device-host"));
}

TEST(NoHost, InvalidName_IsRefused) {
  for (const char* name :
       {"", "a/b", "../x", "Desk", "a name", "123456789012345678901234567890123"}) {
    EXPECT_NE(whyNoHost(name).find("is no name of a host"), std::string::npos) << name;
    EXPECT_FALSE(HostLock::take(name)) << name;
  }
}

TEST(TwoLoops, SecondLoopOfAHost_IsRefusedWithTheFirstsProcess) {
  const std::string name = hostName("twice");
  HostThread host(name, faultyDriver(""), desktop());
  auto first = orThrow(HostedDriver::connect(name));
  ASSERT_TRUE(openEnabled(*deviceOf(first)));
  const std::string said = whyNoHost(name);
  EXPECT_TRUE(contains(said, "is in use by another loop, process " + std::to_string(::getpid())));
  first.reset();
  EXPECT_TRUE(HostedDriver::connect(name)) << "free again";
}

// Whether the lock is held; does not take it.
bool isHeld(const std::string& name) {
  const int fd = ::shm_open(("/wholehand-" + name + ".lock").c_str(), O_RDWR, 0);
  if (fd < 0) return false;
  struct flock lock {};
  lock.l_type = F_WRLCK;
  const bool held = ::fcntl(fd, F_GETLK, &lock) == 0 && lock.l_type != F_UNLCK;
  ::close(fd);
  return held;
}

TEST(TwoHosts, SecondHostOfAName_IsRefusedWithTheFirstsProcess) {
  const std::string name = hostName("pair");
  Partner first({"hold", name});
  for (int i = 0; i < 5000 && !isHeld(name); ++i) sleepMs(1);
  const auto second = HostLock::take(name);
  ASSERT_FALSE(second);
  const std::string said = format(second.errors());
  EXPECT_TRUE(contains(said, "runs already, as process " + std::to_string(first.pid())));
  first.send(SIGKILL);
  first.wait();
  EXPECT_TRUE(HostLock::take(name)) << "a dead host holds nothing";
  ::shm_unlink(("/wholehand-" + name + ".lock").c_str());
}

// Shared memory that was not made by a host of this version.
class ForeignMemory : public testing::Test {
 protected:
  ForeignMemory() : name_(hostName("foreign")), path_("/wholehand-" + name_) {}
  ~ForeignMemory() override { ::shm_unlink(path_.c_str()); }

  // Creates the memory that a live host of this process would have made.
  SharedFrame* make(std::size_t bytes = sizeof(SharedFrame)) {
    const int fd = ::shm_open(path_.c_str(), O_RDWR | O_CREAT, 0600);
    EXPECT_EQ(::ftruncate(fd, static_cast<off_t>(bytes)), 0);
    void* const at =
        ::mmap(nullptr, sizeof(SharedFrame), PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
    ::close(fd);
    auto* const frame = static_cast<SharedFrame*>(at);
    if (bytes < sizeof(SharedFrame)) return frame;
    frame->magic.store(kFrameMagic);
    frame->layout = kFrameLayout;
    frame->size = sizeof(SharedFrame);
    frame->host_pid = ::getpid();
    frame->axis_count = 3;
    return frame;
  }
  void expectRefused(const std::string& with) const {
    const std::string said = whyNoHost(name_);
    EXPECT_TRUE(contains(said, name_));
    EXPECT_TRUE(contains(said, with));
  }

  std::string name_, path_;
};

TEST_F(ForeignMemory, Empty_IsRefused) {
  make(0);
  expectRefused("another size");
}
TEST_F(ForeignMemory, Short_IsRefused) {
  make(sizeof(SharedFrame) - 8);
  expectRefused("another size");
}
TEST_F(ForeignMemory, Long_IsRefused) {
  make(sizeof(SharedFrame) + 4096);
  expectRefused("another size");
}
TEST_F(ForeignMemory, NotSetUp_IsRefused) {
  make()->magic.store(0);
  expectRefused("is not set up by a host");
}
TEST_F(ForeignMemory, OtherLayoutVersion_IsRefusedWithBothVersions) {
  make()->layout = kFrameLayout + 1;
  expectRefused("version " + std::to_string(kFrameLayout + 1) + ", this is " +
                std::to_string(kFrameLayout));
}
TEST_F(ForeignMemory, OtherStatedSize_IsRefused) {
  make()->size = 77;
  expectRefused("another size");
}
TEST_F(ForeignMemory, WithoutAxes_IsRefused) {
  make()->axis_count = 0;
  expectRefused("0 axes");
}
TEST_F(ForeignMemory, WithTooManyAxes_IsRefused) {
  make()->axis_count = 4'000'000'000U;
  expectRefused("4000000000 axes");
}
TEST_F(ForeignMemory, UnterminatedAxisName_IsRefused) {
  SharedFrame* const frame = make();
  std::fill(std::begin(frame->axes[2].name), std::end(frame->axes[2].name), 'x');
  expectRefused("a name without end");
}
TEST_F(ForeignMemory, MemoryOfADeadHost_IsRefused) {
  Partner gone({"hold", name_});
  make()->host_pid = gone.pid();
  gone.send(SIGKILL);
  gone.wait();
  expectRefused("is gone");
}
TEST_F(ForeignMemory, MemoryOfAHostThatStandsStill_IsRefused) {
  make();
  expectRefused("stands still");
}
TEST_F(ForeignMemory, MemoryOfADeadHost_IsReplacedAndItsLoopGetsNoDevice) {
  SharedFrame* const old = make();
  HostThread host(name_, faultyDriver(""), desktop());
  EXPECT_TRUE(HostedDriver::connect(name_));
  HostCommand command{};
  command.session = 1;
  command.sequence = 1;
  old->command.publish(command);
  HostCommand seen{};
  EXPECT_FALSE(host.frame().command.take(seen));
  struct stat file {};
  const int fd = ::shm_open(path_.c_str(), O_RDONLY, 0);
  ASSERT_EQ(::fstat(fd, &file), 0);
  EXPECT_EQ(file.st_mode & 0777U, 0600U) << "nobody else reads or writes it";
  ::close(fd);
}

TEST(HostsLock, ChildProcessThatOutlivesTheHost_HoldsNoLock) {
  const std::string name = hostName("forks");
  Partner host({"host", name, built("may_wait"), "forks@10", deviceFile()});
  std::shared_ptr<HostedDriver> loop;
  for (int i = 0; i < 5000 && !loop; ++i) {
    if (auto connected = HostedDriver::connect(name)) loop = *connected;
    sleepMs(1);
  }
  ASSERT_TRUE(loop);
  sleepMs(100);  // 10 samples of the host take 3 ms
  host.send(SIGKILL);
  host.wait();
  EXPECT_TRUE(HostLock::take(name));
  ::shm_unlink(("/wholehand-" + name).c_str());
  ::shm_unlink(("/wholehand-" + name + ".lock").c_str());
}

}  // namespace
}  // namespace wholehand::test
