#include "rig/arming.hpp"

#include "loop/control/energy_tank.hpp"
#include "loop/device/arming_delay.hpp"

#include <algorithm>
#include <string>
#include <utility>

namespace wholehand {
namespace {

const ArmingDelay* delayOf(const HapticDevice& device) {
  const auto* delayed = dynamic_cast<const DelayedDevice*>(&device);
  return delayed != nullptr ? &delayed->armingDelay() : nullptr;
}

constexpr const char* kShorter =
    "give the host a higher --rate-hz, or measure the device behind what stands between (wholehand "
    "device commission --host)";

}  // namespace

RigOptions withDelayOf(const HapticDevice& device, RigOptions options) {
  const ArmingDelay* delay = delayOf(device);
  if (delay == nullptr) return options;
  for (DeviceModel& corner : options.measured) {
    corner.output_delay_ticks = std::max(corner.output_delay_ticks, delay->periods);
  }
  return options;
}

Expected<CheckedGains> checkGainsAtArming(const Models& models, const HapticDevice& device,
                                          const RigOptions& options) {
  Expected<CheckedGains> checked = checkGains(models, options.period_s, options.measured);
  if (!checked || !checked->refused.empty() || options.measured.empty()) return checked;
  const RigOptions now = withDelayOf(device, options);
  if (now.measured[0].output_delay_ticks == options.measured[0].output_delay_ticks) return checked;
  const ArmingDelay& delay = *delayOf(device);
  if (delay.periods > kMostDelayTicks) {
    checked->refused.push_back(keyFault(
        models.device.path, "output_delay_ticks", std::to_string(delay.periods),
        delay.sentence + ": more than " + std::to_string(kMostDelayTicks) + " periods", kShorter));
    return checked;
  }
  checked = checkGains(models, now.period_s, now.measured);
  if (!checked) return checked;
  for (Diagnostic& refused : checked->refused) {
    refused.problem = delay.sentence + "; with it, " + refused.problem;
    refused.remedy = std::string(kShorter) + ", or render softer gains: " + refused.remedy;
  }
  return checked;
}

}  // namespace wholehand
