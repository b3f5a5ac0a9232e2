// Steps that test the watchdog and the emergency stop, which act when this program cannot.
#include "commissioning/commissioning.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>

namespace wholehand {
namespace {

constexpr double kWatchdogSlack_s = 0.05;

// What the samples showed while the emergency stop was to be pressed.
struct StopSeen {
  enum What { kNever, kEnabled, kCut, kWatchdog } what = kNever;
  std::uint64_t sequence = 0;
  int still = 0;  // consecutive reads without a new sample
};
constexpr int kSilentLooks = 20;

StopSeen lookAtStop(StopSeen seen, int result, const wh_sample& sample) {
  if (seen.what != StopSeen::kNever && seen.what != StopSeen::kEnabled) return seen;
  const bool fresh = result >= 0 && (seen.sequence == 0 || sample.sequence > seen.sequence);
  seen.still = fresh ? 0 : seen.still + 1;
  if (!fresh) return seen;
  seen.sequence = sample.sequence;
  const bool enabled = (sample.status & WH_ENABLED) != 0;
  const bool fault = (sample.status & WH_DRIVE_FAULT) != 0;
  if (seen.what == StopSeen::kEnabled && (!enabled || fault)) {
    // A drive whose watchdog let go may report disabled without an emergency stop.
    const bool silenced = (sample.status & WH_SILENCED) != 0;
    seen.what = silenced && !fault ? StopSeen::kWatchdog : StopSeen::kCut;
  }
  if (enabled && !fault) seen.what = StopSeen::kEnabled;
  return seen;
}

}  // namespace

Expected<Done> Commissioning::watchdog() {
  double silence_s = 0.0;
  for (const wh_axis& a : bench_.driver().axes()) silence_s = std::max(silence_s, a.silence_s);
  const auto took = bench_.dropWatchdog(silence_s + kWatchdogSlack_s);
  if (!took) return took.errors();
  tell(fmt::format("  the drive let go after {:.0f} ms of silence", 1e3 * *took),
       {{"", "let-go-after", "ms", 1e3 * *took, 1e3 * *took}});
  return Done{};
}

Expected<Done> Commissioning::emergencyStop() {
  StopSeen seen;
  const auto answer = bench_.askEnabled(
      {Question::About::kEmergencyStop, "Press the emergency stop; Enter. Release it afterwards",
       "", "", 0.0, 0.0},
      [&](int result, const wh_sample& sample) { seen = lookAtStop(seen, result, sample); });
  if (!answer) return answer.errors();
  const auto refuse = [](const char* why, const char* remedy) {
    return Diagnostic{"", 0, "step", "emergency-stop", why, remedy};
  };
  switch (seen.what) {
    case StopSeen::kCut:
      return Done{};
    case StopSeen::kWatchdog:
      return refuse(
          "its watchdog let go first, since this program was late: of the stop nothing "
          "was seen",
          "let nothing else run on this machine, and repeat the step");
    case StopSeen::kNever:
      return refuse("the device was not enabled before the stop was pressed", "repeat the step");
    case StopSeen::kEnabled:
      break;
  }
  if (seen.still < kSilentLooks) {
    return refuse("the device stayed enabled: the emergency stop does not cut it off",
                  "wire it so that it cuts the power of the motors, and repeat the step");
  }
  return refuse("the device fell silent with the stop: nothing says that its motors are off",
                "let the stop cut the power of the motors, not that of their controller");
}

}  // namespace wholehand
