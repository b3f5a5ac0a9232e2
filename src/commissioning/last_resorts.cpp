// Steps that test the watchdog and the emergency stop, which act when this program cannot.
#include "commissioning/commissioning.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>

namespace wholehand {
namespace {

constexpr double kWatchdogSlack_s = 0.05;
constexpr double kPressWithin_s = 20.0;
constexpr int kSilentLooks = 20;  // ticks without a new sample that count as silence

// What the samples showed while the emergency stop was to be pressed.
struct StopSeen {
  enum What { kNever, kEnabled, kCut, kWatchdog } what = kNever;
  std::uint64_t sequence = 0;
  int ticks = 0, still = 0;  // in all; in a row without a new sample
};

StopSeen lookAtStop(StopSeen seen, int result, const wh_sample& sample) {
  const bool fresh = result >= 0 && (seen.sequence == 0 || sample.sequence > seen.sequence);
  ++seen.ticks;
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

// The person holds the key and presses the stop: it is enabled under the key only, and the move
// ends as soon as it is cut off.
Expected<Done> Commissioning::emergencyStop() {
  StopSeen seen;
  const double most_ticks = kPressWithin_s / bench_.period_s();
  const auto rested = bench_.rest(
      {Motion::What::kEmergencyStop, "press the emergency stop while you hold it", "", 0.0},
      [&](int result, const wh_sample& sample) {
        using Seen = Bench::Seen;
        seen = lookAtStop(seen, result, sample);
        if (seen.what == StopSeen::kCut || seen.what == StopSeen::kWatchdog) return Seen::kOver;
        if (seen.still >= kSilentLooks || seen.ticks > most_ticks) return Seen::kOver;
        return seen.still > 0 ? Seen::kWait : Seen::kJudge;
      });
  if (!rested) return rested;
  const auto refuse = [](const char* why, const char* remedy) {
    return Diagnostic{"", 0, "step", "emergency-stop", why, remedy};
  };
  if (seen.what == StopSeen::kWatchdog) {
    return refuse(
        "its watchdog let go first, since this program was late: of the stop nothing was seen",
        "let nothing else run on this machine, and repeat the step");
  }
  if (seen.still >= kSilentLooks) {
    return refuse("the device fell silent with the stop: nothing says that its motors are off",
                  "let the stop cut the power of the motors, not that of their controller");
  }
  if (seen.what == StopSeen::kEnabled) {
    return refuse("the device stayed enabled: the emergency stop does not cut it off",
                  "wire it so that it cuts the power of the motors, and repeat the step");
  }
  const auto released =
      bench_.askWhile({Question::About::kEmergencyStop, "It cut the device off. Release it; Enter",
                       "", "", 0.0, 0.0},
                      [](const auto&) {});
  if (!released) return released.errors();
  return Done{};
}

}  // namespace wholehand
