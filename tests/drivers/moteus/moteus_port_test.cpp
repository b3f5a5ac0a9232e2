// The driver as a program loads it, over the port of a fake adapter.
#include "devices/plugin/plugin_driver.hpp"
#include "hand_settings.hpp"
#include "loop/realtime/allocation_counter.hpp"
#include "pty_adapter.hpp"
#include "support/contains.hpp"
#include "support/figure.hpp"
#include "support/watched_main.hpp"

#include <gtest/gtest.h>

#include <cerrno>
#include <chrono>
#include <stdexcept>
#include <sys/socket.h>
#include <unistd.h>

namespace wholehand::test {
namespace {

using Protocol = moteus::TtyBus::Protocol;

class Port {
 public:
  explicit Port(Protocol protocol = Protocol::kFdcanusb)
      : adapter(protocol), kind_(protocol == Protocol::kSlcan ? "slcan:" : "fdcanusb:") {}
  [[nodiscard]] std::string locator() const { return kind_ + adapter.port(); }
  Expected<std::shared_ptr<PluginDriver>> load() { return load(locator()); }
  Expected<std::shared_ptr<PluginDriver>> load(const std::string& locator) {
    auto loaded = PluginDriver::load(
        {std::string(WHOLEHAND_BINARY_DIR) + "/drivers/moteus.so", locator, settingsFile(folder_)},
        [this](const std::string& line) { said += line + "\n"; });
    if (loaded) driver = *loaded;
    return loaded;
  }
  /// Enables the device. Throws on failure, since the rest of the test depends on it.
  void enable() {
    if (!orThrow(load())->control(WH_ENABLE, 0.0)) throw std::runtime_error(said);
  }
  // Ticks until `done`, for up to 300 s, so that the speed of the machine does not matter.
  template <class Done>
  bool ticksUntil(Done done, double effort_nm = 0.0) {
    const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(300);
    while (std::chrono::steady_clock::now() < until) {
      read = driver->read(sample);
      wh_command command{};
      command.axes = 3;
      command.effort[0] = effort_nm;
      wrote = driver->write(command);
      if (done()) return true;
      ::usleep(500);
      adapter.pass(100'000);
    }
    return false;
  }
  double torque_nm() {
    return adapter.with([](auto& drives) { return drives[0].torque_nm(); });
  }

  PtyAdapter adapter;
  std::shared_ptr<PluginDriver> driver;
  std::string said;
  wh_sample sample{};
  int read = 0, wrote = 0;

 private:
  Folder folder_;
  std::string kind_;
};

class MoteusPort : public testing::TestWithParam<Protocol> {};

TEST_P(MoteusPort, Hand_IsFoundCheckedEnabledAndPushed) {
  Port port(GetParam());
  port.adapter.with([](auto& drives) { drives[0].position_rev = 0.05; });
  port.enable();
  ASSERT_TRUE(port.ticksUntil([&] { return std::abs(port.torque_nm() - 0.5) < 1e-6; }, 0.5));
  ASSERT_TRUE(port.ticksUntil([&] { return port.read == WH_OK; }, 0.5));
  EXPECT_EQ(port.sample.status, static_cast<std::uint32_t>(WH_ENABLED | WH_HOMED));
  EXPECT_NEAR(port.sample.position[0], 0.05 * 2.0 * 3.141592653589793 + 1.5, 1e-6);
  const std::vector<std::string> opened = GetParam() == Protocol::kSlcan
                                              ? std::vector<std::string>{"C", "S8", "Y5", "O"}
                                              : std::vector<std::string>{};
  EXPECT_EQ(port.adapter.others(), opened);
}

TEST_P(MoteusPort, LinesInPiecesAmongInvalidBytes_AreRead) {
  Port port(GetParam());
  port.adapter.chunk = 7;
  port.adapter.babbles = true;
  port.enable();
  EXPECT_TRUE(port.ticksUntil([&] { return std::abs(port.torque_nm() - 0.25) < 1e-6; }, 0.25));
  EXPECT_EQ(port.sample.status, static_cast<std::uint32_t>(WH_ENABLED | WH_HOMED));
}

INSTANTIATE_TEST_SUITE_P(Protocols, MoteusPort,
                         testing::Values(Protocol::kFdcanusb, Protocol::kSlcan),
                         [](const auto& tested) {
                           return tested.param == Protocol::kSlcan ? "slcan" : "fdcanusb";
                         });

// Regression test: `device inspect` beside a session once opened the line and stopped the rendering
// drives.
TEST_P(MoteusPort, PortOfASession_IsRefusedToASecondProgramThatWritesNothing) {
  Port port(GetParam());
  port.enable();
  ASSERT_TRUE(port.ticksUntil([&] { return port.torque_nm() > 0.4; }, 0.5));
  const auto heard = port.adapter.others();
  std::string said;
  Folder folder;
  const auto locator = port.locator();
  const auto second = PluginDriver::load(
      {std::string(WHOLEHAND_BINARY_DIR) + "/drivers/moteus.so", locator, settingsFile(folder)},
      [&said](const std::string& line) { said += line + "\n"; });
  ASSERT_FALSE(second);
  EXPECT_TRUE(contains(said + format(second.errors()), "is held by another program"));
  EXPECT_EQ(port.adapter.others(), heard) << kAlways;
  EXPECT_TRUE(port.ticksUntil([&] { return port.torque_nm() > 0.4 && port.read == WH_OK; }, 0.5));
  port.driver.reset();
  EXPECT_TRUE(port.load()) << "its owner is gone";
}

TEST(MoteusPortLost, AdapterUnpluggedInMidLine_FailsReadsAndWrites) {
  Port port;
  port.enable();
  ASSERT_TRUE(port.ticksUntil([&] { return port.torque_nm() > 0.4; }, 0.5));
  port.adapter.unplug();
  EXPECT_TRUE(port.ticksUntil([&] { return port.read == WH_FAILED && port.wrote == WH_FAILED; }));
  EXPECT_FALSE(port.driver->control(WH_ENABLE, 0.0));
  const auto again = port.load();
  ASSERT_FALSE(again);
}

// Tests send and receive separately, since the device calls both and either would detect the loss.
TEST(TtyBus, LostPort_FailsTheFirstCall) {
  for (const bool sends : {false, true}) {
    PtyAdapter adapter;
    const auto bus = orThrow(moteus::TtyBus::open(adapter.port(), Protocol::kFdcanusb));
    moteus::CanFrame frame;
    EXPECT_EQ(bus->receive(frame), moteus::BusResult::kNothing);
    adapter.unplug();
    const auto ask = [&] { return sends ? bus->send(frame) : bus->receive(frame); };
    EXPECT_EQ(ask(), moteus::BusResult::kFailed) << (sends ? "send" : "receive");
    EXPECT_EQ(ask(), moteus::BusResult::kFailed) << "it stays so";
  }
}

// Nobody reads: the pseudo terminal takes some 17 KB, then the bus buffers 4 KiB, and then send
// fails.
TEST(TtyBus, AdapterThatReadsNothing_FailsInsteadOfBlocking) {
  PtyAdapter adapter;
  const auto bus = orThrow(moteus::TtyBus::open(adapter.port(), Protocol::kFdcanusb));
  adapter.with([&](auto&) {  // holds the lock on which the adapter's thread waits
    moteus::CanFrame frame;
    frame.size = 64;
    int sent = 0;
    while (sent < 10'000 && bus->send(frame) == moteus::BusResult::kDone) ++sent;
    EXPECT_GT(sent, 4096 / 140);
    EXPECT_LT(sent, 10'000);
    return 0;
  });
}

TEST(MoteusPortTick, ReadsAndWrites_AllocateNothing) {
  Port port;
  port.enable();
  ASSERT_TRUE(port.ticksUntil([&] { return port.read == WH_OK; }));
  const std::uint64_t before = threadAllocations();
  wh_command command{};
  command.axes = 3;
  for (int i = 0; i < 200; ++i) {
    (void)port.driver->read(port.sample);
    (void)port.driver->write(command);
    ::usleep(100);
  }
  EXPECT_EQ(threadAllocations(), before) << kAlways;
}

TEST(MoteusPortRefused, UnsafeDrive_IsReportedByTheDriver) {
  Port port;
  port.adapter.with([](auto& drives) { drives[0].conf["servo.default_timeout_s"] = "nan"; });
  ASSERT_FALSE(port.load()) << kAlways;
  EXPECT_TRUE(contains(port.said, "drive 1 (fingers) servo.default_timeout_s = nan"));
}

TEST(MoteusPortRefused, LocatorWithoutATarget_IsReportedByTheDriver) {
  for (const auto& [locator, why] : {std::pair{"", "must be fdcanusb:PORT"},
                                     {"usb:0", "must be fdcanusb:PORT"},
                                     {"fdcanusb:", "must be fdcanusb:PORT"},
                                     {"fdcanusb:/dev/no-such-port", "cannot be opened"},
                                     {"slcan:/dev/null", "is no serial port"}}) {
    Port port;
    ASSERT_FALSE(port.load(locator));
    EXPECT_TRUE(contains(port.said, why));
  }
}

TEST(SocketCan, MissingInterface_IsReportedWithTheReason) {
  const int probe = ::socket(AF_CAN, SOCK_RAW, 1);
  const bool kernel_has_can = probe >= 0 || errno != EAFNOSUPPORT;
  if (probe >= 0) ::close(probe);
  const char* why = kernel_has_can ? "is no interface" : "no CAN in this kernel";
  Port port;
  ASSERT_FALSE(port.load("socketcan:no-such-can"));
  EXPECT_TRUE(contains(port.said, why));
}

}  // namespace
}  // namespace wholehand::test
