// Checks of opening, enabling, disabling and closing, in every order that a program may use.
#include "devices/conformance/conformance.hpp"

#include <cmath>
#include <dirent.h>

namespace wholehand {
namespace {

constexpr std::uint32_t kNoVerb = 1000;
constexpr double kSoon_s = 0.5;

bool hasBits(const SampleRead& s, std::uint32_t bits) {
  return s.result >= 0 && (s.sample.status & bits) == bits;
}

// Waits until a sample has the bit set or cleared; false on timeout.
bool reaches(const DriverBench& bench, std::uint32_t bit, bool set) {
  bool reached = false;
  everyMillisecond(kSoon_s, [&] {
    const SampleRead now = bench.read();
    reached = now.result >= 0 && hasBits(now, bit) == set;
    return !reached;
  });
  return reached;
}

int openFiles() {
  int count = 0;
  DIR* const folder = ::opendir("/proc/self/fd");
  while (folder != nullptr && ::readdir(folder) != nullptr) ++count;
  if (folder != nullptr) ::closedir(folder);
  return count;
}

CheckFinding open(DriverBench& bench) {
  return unless(bench.reach(DriverStage::kOpen));
}

CheckFinding openNotEnabled(DriverBench& bench) {
  return hasBits(bench.read(), WH_ENABLED) ? failed("it is enabled as soon as it is open")
                                           : passed();
}

CheckFinding openTwice(DriverBench& bench) {
  wh_device* another = nullptr;
  const int result = bench.openAnother(bench.location().locator.c_str(), &another);
  if (result >= 0 && another == bench.device()) return failed("two opens give one device");
  if (result >= 0 && another != nullptr) bench.plugin().close(another);
  return bench.read().result >= 0
             ? passed(result < 0 ? "refuses a second one" : "opens a second one")
             : failed("the first device is not read any more");
}

CheckFinding closeWithoutEnable(DriverBench& bench) {
  for (int i = 0; i < 3; ++i) {
    if (std::string why = bench.reopen(); !why.empty()) return failed(why);
  }
  return bench.read().result >= 0 ? passed() : failed("is not read after it was opened again");
}

CheckFinding filesClosed(DriverBench& bench) {
  if (std::string why = bench.reopen(); !why.empty()) return failed(why);
  const int before = openFiles();
  for (int i = 0; i < 3; ++i) {
    if (std::string why = bench.reopen(); !why.empty()) return failed(why);
  }
  const int more = openFiles() - before;
  return more <= 0 ? passed() : failed("leaves " + std::to_string(more) + " files open in 3 times");
}

CheckFinding disableFirst(DriverBench& bench) {
  const int result = bench.control(WH_DISABLE);
  return result >= 0 ? passed() : failed("returns " + std::to_string(result));
}

CheckFinding unknownVerb(DriverBench& bench) {
  const int result = bench.control(kNoVerb);
  return result == WH_UNSUPPORTED
             ? passed()
             : failed("verb 1000 returns " + std::to_string(result) + ", not WH_UNSUPPORTED");
}

CheckFinding verb(DriverBench& bench, std::uint32_t which) {
  const int result = bench.control(which);
  if (result >= 0) return passed();
  return result == WH_UNSUPPORTED ? passed("is not supported")
                                  : failed("returns " + std::to_string(result));
}
CheckFinding identify(DriverBench& bench) {
  return verb(bench, WH_IDENTIFY);
}
CheckFinding selfTest(DriverBench& bench) {
  return verb(bench, WH_SELF_TEST);
}

CheckFinding writeDisabled(DriverBench& bench) {
  (void)bench.control(WH_DISABLE);
  for (std::size_t a = 0; a < bench.axes().size(); ++a) {
    if (bench.writeShare(a, kEffortShare) < 0) continue;
    const double effort = bench.read().sample.effort[a];
    if (std::isnan(effort)) return skipped("is taken, and efforts are not measured");
    if (effort != 0.0)
      return failed(std::string(bench.axes()[a].name) + " gives " + number(effort));
  }
  return passed("is refused or without effect");
}

CheckFinding enable(DriverBench& bench) {
  (void)bench.control(WH_DISABLE);
  if (const int result = bench.control(WH_ENABLE); result < 0) {
    return failed("WH_ENABLE returns " + std::to_string(result));
  }
  const bool enabled = reaches(bench, WH_ENABLED, true);
  (void)bench.control(WH_DISABLE);
  return enabled ? passed() : failed("no sample says WH_ENABLED");
}

CheckFinding enableTwice(DriverBench& bench) {
  if (const int result = bench.control(WH_ENABLE); result < 0) {
    return failed("a second WH_ENABLE returns " + std::to_string(result));
  }
  return reaches(bench, WH_ENABLED, true) ? passed() : failed("is not enabled after it");
}

CheckFinding disable(DriverBench& bench) {
  (void)bench.writeNeutral();
  if (const int result = bench.control(WH_DISABLE); result < 0) {
    return failed("WH_DISABLE returns " + std::to_string(result));
  }
  return reaches(bench, WH_ENABLED, false) ? passed() : failed("samples go on to say WH_ENABLED");
}

CheckFinding disableTwice(DriverBench& bench) {
  (void)bench.control(WH_DISABLE);
  const int result = bench.control(WH_DISABLE);
  return result >= 0 ? passed() : failed("a second WH_DISABLE returns " + std::to_string(result));
}

CheckFinding enableAgain(DriverBench& bench) {
  for (int i = 0; i < 3; ++i) {
    if (bench.control(WH_DISABLE) < 0) return failed("WH_DISABLE fails");
    if (bench.control(WH_ENABLE) < 0) return failed("WH_ENABLE fails after WH_DISABLE");
    if (!reaches(bench, WH_ENABLED, true)) return failed("is not enabled any more");
  }
  return passed();
}

CheckFinding closeWhileEnabled(DriverBench& bench) {
  (void)bench.writeNeutral();
  if (std::string why = bench.reopen(); !why.empty()) return failed(why);
  return hasBits(bench.read(), WH_ENABLED) ? failed("is still enabled when it is opened again")
                                           : passed();
}

using enum DriverStage;

}  // namespace

std::span<const Check> lifecycleChecks() {
  static constexpr Check kChecks[] = {
      {"lifecycle.open", "the device opens", "is it connected and switched on? see --device-at",
       open, kPlugin},
      {"lifecycle.open_disabled", "it is not enabled when it is opened",
       "enable it at WH_ENABLE only", openNotEnabled},
      {"lifecycle.open_twice", "a second open is refused or gives a device of its own",
       "keep nothing of a device in static variables", openTwice},
      {"lifecycle.close_unused", "it closes without having been enabled, and opens again",
       "undo in close all that open did", closeWithoutEnable},
      {"lifecycle.files", "closing leaves no file open", "close what open has opened", filesClosed},
      {"lifecycle.disable_first", "WH_DISABLE succeeds where nothing is enabled",
       "return WH_OK where there is nothing to do", disableFirst},
      {"lifecycle.unknown_verb", "a verb that is not known is WH_UNSUPPORTED",
       "return WH_UNSUPPORTED by default", unknownVerb},
      {"lifecycle.identify", "WH_IDENTIFY succeeds or is WH_UNSUPPORTED",
       "return WH_UNSUPPORTED where it cannot show itself", identify},
      {"lifecycle.enable", "WH_ENABLE is followed by samples that say WH_ENABLED",
       "release the emergency stop; report the drive's own state", enable, kOpen, Effect::kMoves},
      {"lifecycle.enable_twice", "WH_ENABLE succeeds where it is enabled",
       "return WH_OK where there is nothing to do", enableTwice, kEnabled},
      {"lifecycle.disable", "WH_DISABLE is followed by samples without WH_ENABLED",
       "report the drive's own state", disable, kEnabled},
      {"lifecycle.disable_twice", "WH_DISABLE succeeds a second time",
       "return WH_OK where there is nothing to do", disableTwice, kEnabled},
      {"lifecycle.enable_again", "it is enabled and disabled again and again",
       "undo at WH_DISABLE all that WH_ENABLE did", enableAgain, kEnabled},
      {"lifecycle.close_enabled", "closing while enabled disables it",
       "take it to neutral and disable it in close", closeWhileEnabled, kEnabled},
      {"lifecycle.write_disabled", "a command is refused or without effect while disabled",
       "return WH_FAILED from write where it is not enabled", writeDisabled, kOpen, Effect::kMoves},
      {"lifecycle.self_test", "WH_SELF_TEST succeeds or is WH_UNSUPPORTED",
       "return WH_UNSUPPORTED where there is none", selfTest, kOpen, Effect::kMoves},
  };
  return kChecks;
}

}  // namespace wholehand
