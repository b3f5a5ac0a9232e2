// Steps that test the watchdog and the emergency stop, which act when this program cannot.
#include "commissioning/commissioning.hpp"
#include "commissioning/let_go_proof.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>

namespace wholehand {
namespace {

constexpr double kWatchdogSlack_s = 0.05;
constexpr double kPressWithin_s = 20.0;
constexpr int kProveTicks_ms = 80, kSettles_ms = 20;  // of pushing after the stop cut it off
constexpr int kSilentLooks = 20;  // ticks without a new sample that count as silence

// What the samples showed while the emergency stop was to be pressed.
struct StopSeen {
  enum What { kNever, kEnabled, kCut, kWatchdog } what = kNever;
  std::uint64_t sequence = 0;
  int ticks = 0, still = 0;  // in all; in a row without a new sample
  int cut = 0;               // ticks since it was cut off
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

// The person holds the key and presses the stop: it is enabled under the key only. As soon as it
// says that it is cut off it is pushed a little, and must not move.
Expected<Done> Commissioning::emergencyStop() {
  using Seen = Bench::Seen;
  StopSeen seen;
  LetGoProof proof(bench_.model(), 1e-3 * kProveTicks_ms, kCommissioningShare);
  const double most_ticks = kPressWithin_s / bench_.period_s();
  double sample_s = 0.0;
  auto rested = bench_.move(
      {Motion::What::kEmergencyStop, "press the emergency stop while you hold it", "", 0.0},
      [&](int result, const wh_sample& sample) {
        sample_s = static_cast<double>(sample.monotonic_ns) * 1e-9;
        if (seen.what == StopSeen::kCut) return result < 0 ? Seen::kOver : Seen::kProve;
        seen = lookAtStop(seen, result, sample);
        if (seen.what == StopSeen::kCut) return Seen::kProve;
        if (seen.what == StopSeen::kWatchdog) return Seen::kOver;
        if (seen.still >= kSilentLooks || seen.ticks > most_ticks) return Seen::kOver;
        return seen.still > 0 ? Seen::kWait : Seen::kJudge;
      },
      [&](Bench::Now& now) -> Expected<bool> {
        if (seen.what != StopSeen::kCut) return true;
        now.effort = proof.push(now.position);
        const double pushed_ms = 1e3 * bench_.period_s() * ++seen.cut;
        if (pushed_ms > kSettles_ms) proof.see(sample_s, now.position);
        return pushed_ms < kProveTicks_ms;
      });
  if (!rested) return rested;
  if (seen.what == StopSeen::kCut) {
    Diagnostics acting = proof.acting("while the emergency stop is pressed");
    if (!acting.empty()) return acting;
  }
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
