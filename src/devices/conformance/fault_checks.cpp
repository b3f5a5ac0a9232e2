// Checks that faults are reported to a person.
#include "devices/conformance/conformance.hpp"

#include <algorithm>

namespace wholehand {
namespace {

constexpr const char* kNowhere = "no device is called this";
constexpr std::size_t kLongestLine = 200;

CheckFinding noDriveFault(DriverBench& bench) {
  const SampleRead now = bench.read();
  if (now.result < 0) return skipped("no sample");
  if ((now.sample.status & WH_DRIVE_FAULT) == 0) return passed();
  return failed("a drive is in fault, code " + std::to_string(now.sample.vendor_code));
}

CheckFinding homed(DriverBench& bench) {
  const SampleRead now = bench.read();
  if (now.result < 0) return skipped("no sample");
  return (now.sample.status & WH_HOMED) != 0 ? passed() : failed("is not homed");
}

CheckFinding faultHasCode(DriverBench& bench) {
  for (const SampleRead& s : bench.samples()) {
    if ((s.sample.status & WH_DRIVE_FAULT) != 0 && s.sample.vendor_code == 0) {
      return failed("WH_DRIVE_FAULT comes without a vendor_code");
    }
  }
  return passed();
}

CheckFinding notSilenced(DriverBench& bench) {
  const SampleRead now = bench.read();
  if (now.result < 0) return skipped("no sample");
  return (now.sample.status & WH_SILENCED) == 0 ? passed()
                                                : failed("is silenced before it was enabled");
}

CheckFinding coolAtRest(DriverBench& bench) {
  const SampleRead now = bench.read();
  if (now.result < 0) return skipped("no sample");
  return (now.sample.status & (WH_HOT | WH_DERATING)) == 0 ? passed()
                                                           : failed("is hot before it was enabled");
}

// Opens a device with a name that does not exist. A driver may ignore the name.
CheckFinding failedOpenGivesNothing(DriverBench& bench) {
  wh_device* device = nullptr;
  const int result = bench.openAnother(kNowhere, &device);
  if (result >= 0 && device != nullptr) {
    bench.plugin().close(device);
    return skipped("opens whatever the name is");
  }
  if (result >= 0) return failed("open succeeds and gives no device");
  return device == nullptr ? passed() : failed("open fails and gives a device");
}

CheckFinding failedOpenSaysWhy(DriverBench& bench) {
  const std::size_t lines = bench.hostLines().size();
  wh_device* device = nullptr;
  if (bench.openAnother(kNowhere, &device) >= 0) {
    if (device != nullptr) bench.plugin().close(device);
    return skipped("opens whatever the name is");
  }
  return bench.hostLines().size() > lines ? passed(bench.hostLines().back())
                                          : failed("open fails and does not say why");
}

CheckFinding linesAreLines(DriverBench& bench) {
  for (const std::string& line : bench.hostLines()) {
    if (line.empty() || line.size() > kLongestLine) return failed("a line of no or over 200 bytes");
    const bool plain = std::none_of(line.begin(), line.end(),
                                    [](char c) { return static_cast<unsigned char>(c) < 0x20; });
    if (!plain) return failed("a line with control characters");
  }
  return passed();
}

CheckFinding readsAfterDisable(DriverBench& bench) {
  (void)bench.control(WH_DISABLE);
  return bench.read().result >= 0 ? passed() : failed("no sample comes after WH_DISABLE");
}

CheckFinding noneAfterUse(DriverBench& bench) {
  const std::vector<SampleRead> samples = bench.idle(100, true);
  for (const SampleRead& s : samples) {
    if (s.result < 0) return failed("a read fails while commands come");
    if ((s.sample.status & WH_DRIVE_FAULT) != 0) return failed("a drive goes into fault");
  }
  return passed();
}

using enum DriverStage;

}  // namespace

std::span<const Check> faultChecks() {
  static constexpr Check kChecks[] = {
      {"faults.drive", "no drive is in fault", "clear it as its maker says", noDriveFault},
      {"faults.homed", "the device is homed", "home it first", homed},
      {"faults.code", "WH_DRIVE_FAULT comes with the maker's code", "set vendor_code",
       faultHasCode},
      {"faults.silenced", "it is not silenced before it was enabled",
       "set WH_SILENCED when the watchdog has let go, not before", notSilenced},
      {"faults.cool", "it is not hot before it was enabled", "let it cool", coolAtRest},
      {"faults.open_nothing", "an open that fails gives no device",
       "set *device where open succeeds only", failedOpenGivesNothing},
      {"faults.open_says", "an open that fails says why", "call host->say before returning",
       failedOpenSaysWhy},
      {"faults.lines", "what it says is one line of at most 200 bytes a call",
       "one call of say a line, without its end", linesAreLines},
      {"faults.read_disabled", "samples come after WH_DISABLE", "only write needs WH_ENABLE",
       readsAfterDisable},
      {"faults.in_use", "neutral commands for 0.1 s bring no fault", "look at the drive's own log",
       noneAfterUse, kEnabled},
  };
  return kChecks;
}

}  // namespace wholehand
