#include "drivers/composite/composite.hpp"

#include "loop/core/sha256.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace wholehand {
namespace {

constexpr std::int64_t kAhead_ns = 1'000'000;  // a sample may be so far in the future

bool isFinite(const wh_command& command) noexcept {
  return std::all_of(command.effort, command.effort + command.axes,
                     [](double effort) { return std::isfinite(effort); });
}

}  // namespace

Expected<std::unique_ptr<Composite>> Composite::make(const CompositeConfig& config,
                                                     const Parts& parts,
                                                     std::int64_t (*now_ns)() noexcept) {
  std::unique_ptr<Composite> whole(new Composite(parts, config.longest_skew_s, now_ns));
  Diagnostics refused;
  for (std::size_t p = 0; p < parts.size(); ++p) {
    whole->state_[p].longest_gap_ns = std::llround(config.parts[p].longest_gap_s * 1e9);
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
  if (verb == WH_DISABLE) beginAnew(false);
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

// Forgets losses and tests of the last session.
void Composite::beginAnew(bool enabled) noexcept {
  enabled_ = enabled;
  commanded_ = dropped_ = false;
  for (PartState& part : state_) {
    part.lost = part.starved = part.current = false;
    if (enabled) part.begun = false;
  }
}

Expected<Done> Composite::enable(const wh_command& neutral) {
  beginAnew(false);
  const std::array<wh_command, 2> commands = divide(neutral);
  for (std::size_t p = 0; p < parts_.size(); ++p) {
    Expected<Done> enabled = parts_[p]->enable(commands[p]);
    if (enabled) continue;
    for (const auto& part : parts_) (void)part->control(WH_DISABLE, 0.0);
    return enabled;
  }
  beginAnew(true);
  return Done{};
}

Expected<Done> Composite::dropWatchdogs() {
  dropped_ = true;
  for (std::size_t p = 0; p < parts_.size(); ++p) {
    state_[p].starved = !parts_[p]->control(WH_DROP_WATCHDOG, 0.0).ok();
  }
  return Done{};
}

std::uint32_t Composite::statusOfBoth() const noexcept {
  const std::uint32_t first = state_[0].newest.status, second = state_[1].newest.status;
  // Bits that need both parts; any other is set if one part sets it. A part that stays enabled
  // after WH_DISABLE must not be hidden by the other.
  const std::uint32_t of_both = enabled_ ? WH_ENABLED | WH_HOMED : WH_HOMED;
  std::uint32_t status = (first & second & of_both) | ((first | second) & ~of_both);
  if (dropped_) {
    const auto let_go = [](std::uint32_t part) {
      return (part & WH_SILENCED) != 0 || (part & WH_ENABLED) == 0;
    };
    const bool both = let_go(first) && let_go(second);
    status &= ~static_cast<std::uint32_t>(WH_SILENCED);
    status |= both ? WH_SILENCED : WH_ENABLED;
  }
  const bool lost = state_[0].lost || state_[1].lost;
  return enabled_ && lost ? status & ~static_cast<std::uint32_t>(WH_ENABLED) : status;
}

// True when the samples of a part stand still, are too old or of the future. Times are compared
// from the first new sample on: some drives send one only after a command.
bool Composite::isOverdue(const PartState& part) noexcept {
  if (part.read_ns - part.new_ns > part.longest_gap_ns) return true;
  const std::int64_t age_ns = part.read_ns - part.newest.monotonic_ns;
  return part.current && (age_ns > part.longest_gap_ns || age_ns < -kAhead_ns);
}

// Reads a part; true when the sample is new. The part may be lost by what it reads.
bool Composite::readPart(std::size_t at) noexcept {
  PartState& part = state_[at];
  if (!enabled_) part.lost = false;
  wh_sample sample{};
  sample.size = sizeof(sample);
  if (parts_[at]->read(sample) < 0) {
    part.lost = true;
    return false;
  }
  const std::int64_t now_ns = now_ns_();  // taken late, because a part of a host may wait
  // Before the first command nobody may have read for a while.
  const bool paused = !commanded_ && now_ns - part.read_ns > part.longest_gap_ns;
  const bool backwards = part.begun && (sample.sequence < part.newest.sequence ||
                                        sample.monotonic_ns < part.newest.monotonic_ns);
  const bool newer = part.begun && sample.sequence > part.newest.sequence;
  const bool fresh = newer || !part.begun;
  part.current = newer || (part.current && !paused);
  if (fresh || paused) part.new_ns = now_ns;
  part.begun = true;
  part.read_ns = now_ns;
  part.newest = sample;
  if (backwards || isOverdue(part)) part.lost = true;
  // A command must not bring back a part that was silenced; the other part would hide it.
  if (enabled_ && part.current && (sample.status & WH_SILENCED) != 0) part.starved = true;
  return fresh && !part.lost;
}

// Parts whose axes are valid: not lost, and not too far behind the other part.
std::array<bool, 2> Composite::agreeing() noexcept {
  std::array<bool, 2> valid = {!state_[0].lost, !state_[1].lost};
  if (!valid[0] || !valid[1]) return valid;
  const std::int64_t ahead_ns = state_[0].newest.monotonic_ns - state_[1].newest.monotonic_ns;
  const std::int64_t skew_ns = ahead_ns < 0 ? -ahead_ns : ahead_ns;
  largest_skew_ns_ = std::max(largest_skew_ns_, skew_ns);
  if (skew_ns > longest_skew_ns_) valid[ahead_ns > 0 ? 1 : 0] = false;
  return valid;
}

int Composite::read(wh_sample& sample) noexcept {
  const bool first_fresh = readPart(0), second_fresh = readPart(1);
  if (bothLost()) return WH_FAILED;
  const bool fresh = first_fresh || second_fresh;
  if (fresh) ++samples_;
  const std::array<bool, 2> valid = agreeing();
  const wh_sample &first = state_[0].newest, &second = state_[1].newest;
  sample.status = statusOfBoth();
  sample.sequence = samples_;
  const bool second_counts =
      state_[0].lost || (!state_[1].lost && second.monotonic_ns < first.monotonic_ns);
  sample.monotonic_ns = (second_counts ? second : first).monotonic_ns;
  sample.vendor_code = first.vendor_code != 0 ? first.vendor_code : second.vendor_code;
  sample.valid = sample.derating = 0;
  for (std::size_t i = 0; i < places_.size(); ++i) {
    const Place at = places_[i];
    const wh_sample& from = state_[at.part].newest;
    if (valid[at.part] && (from.valid >> at.axis & 1U) != 0) sample.valid |= 1U << i;
    const bool derates = (from.status & WH_DERATING) != 0 &&
                         (from.derating == 0 || (from.derating >> at.axis & 1U) != 0);
    if (derates) sample.derating |= 1U << i;
    sample.position[i] = from.position[at.axis];
    sample.effort[i] = from.effort[at.axis];
    sample.temperature_c[i] = from.temperature_c[at.axis];
  }
  // Only an axis that the whole does not have derates. A mask of 0 would mean that any may.
  if ((sample.status & WH_DERATING) != 0 && sample.derating == 0) {
    sample.status &= ~static_cast<std::uint32_t>(WH_DERATING);
    sample.status |= WH_HOT;
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
  if (!enabled_ || command.axes != places_.size() || !isFinite(command)) return WH_FAILED;
  commanded_ = true;
  const std::array<wh_command, 2> commands = divide(command);
  for (std::size_t p = 0; p < parts_.size(); ++p) {
    if (state_[p].starved) continue;
    // While the watchdog is tested, a released drive may refuse the command.
    if (parts_[p]->write(commands[p]) < 0 && !dropped_) state_[p].lost = true;
  }
  // Not a failure while one part is healthy: otherwise the loop would not know that this part
  // follows its ramp. The next sample reports the loss.
  return bothLost() ? WH_FAILED : WH_OK;
}

}  // namespace wholehand
