// The other side of a device host as a process, for tests that lose it:
//   host_partner loop NAME KIND   commands efforts at 1 kHz through the host NAME, and after 100
//                                 ticks does what KIND says: forever, deadlock, runaway
//   host_partner host NAME DRIVER SETTINGS DEVICE_FILE   runs such a host
//   host_partner hold NAME        holds the name and does nothing
#include "devices/host/hosted_driver.hpp"
#include "devices/plugin/plugin_driver.hpp"
#include "files/device/device_file.hpp"
#include "host_tools.hpp"

#include <cmath>
#include <cstdio>
#include <mutex>

namespace wholehand::test {
namespace {

constexpr int kLostAfter = 100;

// Reports the longest time between two commands, by the loop's own clock, in the effort of an axis
// that does not exist.
void noteGap(wh_command& command) {
  static LongestGap gap;
  gap.note();
  command.effort[kGapAt] = gap.longest_ms();
}

// Efforts that are never neutral and change with every tick.
wh_command commandOf(int tick, std::size_t axes) {
  wh_command command{};
  command.size = sizeof(command);
  command.axes = static_cast<std::uint32_t>(axes);
  command.sequence = static_cast<std::uint64_t>(tick) + 1;
  for (std::size_t i = 0; i < axes; ++i) {
    const double sign = i % 2 == 0 ? 1.0 : -1.0;
    command.effort[i] = sign * (4.0 + 2.0 * std::sin(0.1 * tick + static_cast<double>(i)));
  }
  return command;
}

[[noreturn]] void spin() {
  for (volatile std::uint64_t turns = 0;;) turns = turns + 1;
}

[[noreturn]] void waitForItself() {
  std::timed_mutex mutex;  // a lock that the loop itself holds
  mutex.lock();
  std::thread([&mutex] { mutex.lock(); }).join();
  std::abort();
}

int loop(const std::string& name, const std::string& kind) {
  auto driver = orThrow(HostedDriver::connect(name));
  (void)orThrow(driver->control(WH_ENABLE, 0.0));
  PeriodicThreadConfig config;
  config.setup.lock_memory = false;
  int tick = 0;
  PeriodicThread thread(config, [&](std::uint32_t, std::int64_t) {
    wh_sample sample{};
    (void)driver->read(sample);
    wh_command command = commandOf(tick, driver->axes().size());
    noteGap(command);
    (void)driver->write(command);
    if (++tick < kLostAfter) return true;
    if (kind == "deadlock") waitForItself();
    if (kind == "runaway") spin();
    return true;
  });
  (void)orThrow(thread.start());
  thread.join();
  return 0;
}

int host(const std::string& name, const DriverLocation& location, const std::string& file) {
  std::shared_ptr<DeviceDriver> driver =
      orThrow(PluginDriver::load(location, nullptr, CalledBy::kHost));
  HostThread held(name, driver, orThrow(loadDeviceFile(file)));
  for (;;) ::pause();
}

int hold(const std::string& name) {
  const auto lock = orThrow(HostLock::take(name));
  for (;;) ::pause();
}

int partner(const std::vector<std::string>& words) {
  if (words.size() == 4 && words[1] == "loop") return loop(words[2], words[3]);
  if (words.size() == 6 && words[1] == "host") {
    return host(words[2], {words[3], "", words[4]}, words[5]);
  }
  if (words.size() == 3 && words[1] == "hold") return hold(words[2]);
  std::fprintf(stderr, "see the head of host_partner.cpp\n");
  return 2;
}

}  // namespace
}  // namespace wholehand::test

int main(int argc, char** argv) {
  try {
    return wholehand::test::partner({argv, argv + argc});
  } catch (const std::exception& error) {
    std::fprintf(stderr, "host_partner: %s\n", error.what());
    return 1;
  }
}
