#include "drivers/composite/composite.hpp"

#include "loop/core/sha256.hpp"

#include <algorithm>
#include <utility>

namespace wholehand {
namespace {

// Status bits that need both parts. Any other bit is set if one part sets it.
constexpr std::uint32_t kOfBoth = WH_ENABLED | WH_HOMED;

}  // namespace

Expected<std::unique_ptr<Composite>> Composite::make(const CompositeConfig& config,
                                                     const Parts& parts) {
  std::unique_ptr<Composite> whole(new Composite(parts, config.longest_skew_s));
  Diagnostics refused;
  for (std::size_t p = 0; p < parts.size(); ++p) {
    const std::vector<wh_axis>& has = parts[p]->axes();
    for (const std::string& name : config.parts[p].axes) {
      const auto found = std::find_if(has.begin(), has.end(),
                                      [&](const wh_axis& axis) { return name == axis.name; });
      if (found == has.end()) {
        std::string names;
        for (const wh_axis& axis : has)
          names += (names.empty() ? "" : ", ") + std::string(axis.name);
        refused.push_back(keyFault(config.path, "parts[" + std::to_string(p) + "].axes", name,
                                   parts[p]->where() + " has no such axis", "it has " + names));
        continue;
      }
      whole->axes_.push_back(*found);
      whole->places_.push_back({p, static_cast<std::size_t>(found - has.begin())});
    }
  }
  if (whole->axes_.size() > WH_MAX_AXES) {
    refused.push_back(keyFault(config.path, "parts", std::to_string(whole->axes_.size()),
                               "are too many axes", "at most " + std::to_string(WH_MAX_AXES)));
  }
  if (!refused.empty()) return refused;
  return whole;
}

DriverIdentity Composite::identity() const {
  const DriverIdentity &first = parts_[0]->identity(), &second = parts_[1]->identity();
  const bool known = !first.serial.empty() && !second.serial.empty();
  DriverIdentity both{known ? first.serial + " + " + second.serial : "",
                      first.firmware + " + " + second.firmware, first.sdk + " + " + second.sdk, ""};
  // A passport must also depend on the files of both drivers.
  const std::string drivers = first.driver_sha256 + second.driver_sha256;
  if (!drivers.empty()) both.sdk += " " + sha256(drivers).substr(0, 12);
  return both;
}

Expected<Done> Composite::control(std::uint32_t verb, double argument) {
  if (verb == WH_DROP_WATCHDOG) return dropWatchdogs();
  if (verb == WH_ENABLE) return enable(wh_command{});
  if (verb == WH_DISABLE) {
    dropped_ = false;
    starved_ = {};
  }
  Diagnostics refused;
  for (const auto& part : parts_) {
    if (auto done = part->control(verb, argument); !done) {
      refused.insert(refused.end(), done.errors().begin(), done.errors().end());
    }
  }
  if (refused.empty()) return Done{};
  return refused;
}

bool Composite::enablesAtNeutral() const noexcept {
  return parts_[0]->enablesAtNeutral() && parts_[1]->enablesAtNeutral();
}

Expected<Done> Composite::enable(const wh_command& neutral) {
  lost_ = begun_ = starved_ = {};
  dropped_ = false;
  const std::array<wh_command, 2> commands = divide(neutral);
  for (std::size_t p = 0; p < parts_.size(); ++p) {
    Expected<Done> enabled = parts_[p]->enable(commands[p]);
    if (enabled) continue;
    for (const auto& part : parts_) (void)part->control(WH_DISABLE, 0.0);
    return enabled;
  }
  return Done{};
}

Expected<Done> Composite::dropWatchdogs() {
  dropped_ = true;
  for (std::size_t p = 0; p < parts_.size(); ++p) {
    starved_[p] = !parts_[p]->control(WH_DROP_WATCHDOG, 0.0).ok();
  }
  return Done{};
}

std::uint32_t Composite::statusOfBoth() const noexcept {
  const std::uint32_t first = newest_[0].status, second = newest_[1].status;
  const std::uint32_t status = (first & second & kOfBoth) | ((first | second) & ~kOfBoth);
  if (!dropped_) return status;
  const auto let_go = [](std::uint32_t part) {
    return (part & WH_SILENCED) != 0 || (part & WH_ENABLED) == 0;
  };
  if (let_go(first) && let_go(second)) return status | WH_SILENCED;
  return (status & ~static_cast<std::uint32_t>(WH_SILENCED)) | WH_ENABLED;
}

// Reads a part; true when the sample is new. The part is lost when the read fails or its samples
// run backwards.
bool Composite::readPart(std::size_t part) noexcept {
  wh_sample sample{};
  sample.size = sizeof(sample);
  const wh_sample& last = newest_[part];
  if (parts_[part]->read(sample) < 0) {
    lost_[part] = true;
    return false;
  }
  const bool backwards = sample.sequence < last.sequence || sample.monotonic_ns < last.monotonic_ns;
  if (begun_[part] && backwards) lost_[part] = true;
  const bool fresh = !begun_[part] || sample.sequence > last.sequence;
  begun_[part] = true;
  newest_[part] = sample;
  return fresh && !lost_[part];
}

// Parts whose axes are valid: not lost, and not too far behind the other part.
std::array<bool, 2> Composite::agreeing() noexcept {
  std::array<bool, 2> valid = {!lost_[0], !lost_[1]};
  if (!valid[0] || !valid[1]) return valid;
  const std::int64_t ahead_ns = newest_[0].monotonic_ns - newest_[1].monotonic_ns;
  const std::int64_t skew_ns = ahead_ns < 0 ? -ahead_ns : ahead_ns;
  largest_skew_ns_ = std::max(largest_skew_ns_, skew_ns);
  if (skew_ns > longest_skew_ns_) valid[ahead_ns > 0 ? 1 : 0] = false;
  return valid;
}

int Composite::read(wh_sample& sample) noexcept {
  const bool first_fresh = readPart(0), second_fresh = readPart(1);
  if (lost_[0] && lost_[1]) return WH_FAILED;
  const bool fresh = first_fresh || second_fresh;
  if (fresh) ++samples_;
  const std::array<bool, 2> valid = agreeing();
  sample.status = statusOfBoth();
  if (lost_[0] || lost_[1]) sample.status &= ~static_cast<std::uint32_t>(WH_ENABLED);
  sample.sequence = samples_;
  const std::size_t old = lost_[0] || newest_[1].monotonic_ns < newest_[0].monotonic_ns ? 1 : 0;
  sample.monotonic_ns = newest_[lost_[1] ? 0 : old].monotonic_ns;
  sample.vendor_code =
      newest_[0].vendor_code != 0 ? newest_[0].vendor_code : newest_[1].vendor_code;
  sample.valid = 0;
  for (std::size_t i = 0; i < places_.size(); ++i) {
    const Place at = places_[i];
    const wh_sample& from = newest_[at.part];
    if (valid[at.part] && (from.valid >> at.axis & 1U) != 0) sample.valid |= 1U << i;
    sample.position[i] = from.position[at.axis];
    sample.effort[i] = from.effort[at.axis];
    sample.temperature_c[i] = from.temperature_c[at.axis];
  }
  return fresh ? WH_OK : WH_NOTHING_NEW;
}

std::array<wh_command, 2> Composite::divide(const wh_command& command) const noexcept {
  std::array<wh_command, 2> commands{};
  for (std::size_t p = 0; p < parts_.size(); ++p) {
    commands[p].size = sizeof(wh_command);
    commands[p].axes = static_cast<std::uint32_t>(parts_[p]->axes().size());
    commands[p].sequence = command.sequence;
  }
  for (std::size_t i = 0; i < places_.size(); ++i) {
    commands[places_[i].part].effort[places_[i].axis] = command.effort[i];
  }
  return commands;
}

int Composite::write(const wh_command& command) noexcept {
  if (command.axes != places_.size()) return WH_FAILED;
  const std::array<wh_command, 2> commands = divide(command);
  for (std::size_t p = 0; p < parts_.size(); ++p) {
    if (starved_[p]) continue;
    // While the watchdog is tested, a released drive may refuse the command.
    if (parts_[p]->write(commands[p]) < 0 && !dropped_) lost_[p] = true;
  }
  // Not a failure while one part is healthy: otherwise the loop would not know that this part
  // follows its ramp. The next sample reports the loss.
  return lost_[0] && lost_[1] ? WH_FAILED : WH_OK;
}

}  // namespace wholehand
