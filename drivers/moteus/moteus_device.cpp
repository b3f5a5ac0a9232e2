#include "moteus_device.hpp"

#include "drive_settings.hpp"
#include "fault_text.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <utility>

namespace wholehand::moteus {
namespace {

constexpr int kHomed = 2;                     // home state: the position is that of the output
constexpr std::int64_t kLate_ns = 3'000'000;  // a later answer is no longer expected
constexpr std::int64_t kIdle_ns = 2'000'000;  // time without writes after which the state is
                                              // requested
constexpr std::int64_t kAnswer_ns = 200'000'000;
constexpr int kAttempts = 5;  // before a drive counts as not answering
constexpr std::int64_t kEnabling_ns = 500'000'000;

}  // namespace

MoteusDevice::MoteusDevice(Settings settings, std::unique_ptr<CanBus> bus,
                           std::unique_ptr<BusClock> clock, Report report)
    : settings_(std::move(settings)),
      map_(settings_.motors, settings_.axes),
      bus_(std::move(bus)),
      clock_(std::move(clock)),
      report_(std::move(report)),
      round_(settings_.motors, *bus_, *clock_) {}

MoteusDevice::~MoteusDevice() {
  (void)disable();
}

std::string MoteusDevice::nameOf(std::size_t motor) const {
  return "drive " + std::to_string(settings_.motors[motor].id) + " (" +
         settings_.motors[motor].name + ")";
}

Expected<Done> MoteusDevice::check() {
  Diagnostics why;
  if (!queryAll()) return fileFault("", "the CAN adapter takes nothing", "plug it in again");
  for (std::size_t i = 0; i < settings_.motors.size(); ++i) {
    if (!round_.state(i).answered) {
      why.push_back(keyFault("", nameOf(i), "", "does not answer",
                             "look at its power, its cable and its identifier (servo id.id)"));
      continue;
    }
    Diagnostics unsafe = checkDrive(*bus_, *clock_, settings_.motors[i]);
    why.insert(why.end(), unsafe.begin(), unsafe.end());
  }
  if (!why.empty()) return why;
  if (!queryAll() || !round_.complete()) {
    return fileFault("", "the drives stopped answering", "look at their cables");
  }
  return Done{};
}

// Repeated, because an adapter may lose frames sent just after it was plugged in.
bool MoteusDevice::queryAll() {
  for (int i = 0; i < kAttempts; ++i) {
    if (!round_.sendQueries()) return false;
    if (awaitRound()) return true;
  }
  return true;
}

void MoteusDevice::identify(wh_identity& identity) {
  std::uint64_t digest = 0xcbf29ce484222325U;  // FNV-1a of 64 bits, over the words in order
  std::string firmware, all;
  bool alike = true;
  for (std::size_t i = 0; i < settings_.motors.size(); ++i) {
    const auto drive = identifyDrive(*bus_, *clock_, settings_.motors[i].id);
    if (!drive) return;
    // The firmware is reported once if it is the same on all drives, which is usual.
    std::array<char, 16> version{};
    std::snprintf(version.data(), version.size(), "%x", drive->firmware);
    if (i == 0) firmware = all = version.data();
    if (i > 0) all += std::string("+") + version.data();
    alike = alike && firmware == version.data();
    for (const std::uint32_t word : drive->serial) {
      for (unsigned shift = 0; shift < 32; shift += 8) {
        digest = (digest ^ (word >> shift & 0xffU)) * 0x100000001b3U;
      }
    }
  }
  std::snprintf(identity.serial, sizeof identity.serial, "%zu drives %016llx",
                settings_.motors.size(), static_cast<unsigned long long>(digest));
  std::snprintf(identity.firmware, sizeof identity.firmware, "%s",
                alike ? firmware.c_str() : all.c_str());
  std::snprintf(identity.sdk, sizeof identity.sdk, "register protocol");
}

void MoteusDevice::describe(wh_axis* axes, std::uint32_t capacity, std::uint32_t& count) const {
  count = static_cast<std::uint32_t>(map_.size());
  for (std::size_t a = 0; a < map_.size() && a < capacity; ++a) {
    const MotorAxis& from = map_.axes()[a];
    wh_axis& to = axes[a];
    std::strncpy(to.name, from.name.c_str(), sizeof to.name - 1);
    to.name[sizeof to.name - 1] = 0;
    to.kind = WH_ROTATION;
    to.effort_meaning = WH_EFFORT;
    to.lower = from.lower_rad;
    to.upper = from.upper_rad;
    to.effort_limit = from.effort_limit_nm;
    to.resolution = map_.resolution(a);
    to.delay_s = settings_.delay_s;
    to.silence_s = kWatchdog_s;
  }
}

bool MoteusDevice::awaitRound() {
  const std::int64_t until_ns = clock_->now_ns() + kAnswer_ns;
  while (clock_->now_ns() < until_ns) {
    if (!round_.receive()) return false;
    if (round_.complete()) return true;
    clock_->rest();
  }
  return false;
}

// Reports stops of drives since the last call of control(); read() and write() may not report.
void MoteusDevice::reportStop() {
  for (std::size_t i = 0; i < settings_.motors.size(); ++i) {
    const DriveState& state = round_.state(i);
    if (state.mode == kModeFault) {
      report_(nameOf(i) + " has stopped itself: fault " + std::to_string(state.fault) + ", " +
              faultText(state.fault));
    } else if (state.mode == kModeTimeout) {
      report_(nameOf(i) + " has let go: no command came within its watchdog's time");
    } else if (state.answered && state.home != kHomed) {
      report_(nameOf(i) + " is not homed (home state " + std::to_string(state.home) +
              "): give it an output encoder, or set its output position with moteus_tool");
    }
  }
}

int MoteusDevice::control(std::uint32_t verb) {
  (void)round_.receive();
  reportStop();
  switch (verb) {
    case WH_ENABLE:
      return enable();
    case WH_DISABLE:
      return disable();
    case WH_DROP_WATCHDOG:
      feeds_ = false;
      return WH_OK;
    case WH_SELF_TEST: {
      if (enabled_) return WH_UNSUPPORTED;
      const Expected<Done> checked = check();
      if (!checked) {
        for (const Diagnostic& why : checked.errors()) report_(format(why));
      }
      return checked ? WH_OK : WH_FAILED;
    }
    default:
      return WH_UNSUPPORTED;
  }
}

int MoteusDevice::enable() {
  enabled_ = false;
  pending_ = false;
  feeds_ = true;
  if (!round_.sendStops() || !awaitRound()) {
    report_("the drives do not answer");
    return WH_FAILED;
  }
  for (std::size_t i = 0; i < settings_.motors.size(); ++i) {
    if (round_.state(i).home != kHomed) return WH_FAILED;  // control() has reported it
  }
  if (awaitPositionMode()) {
    enabled_ = true;
    return WH_OK;
  }
  reportStop();
  report_(
      "the drives do not come into position mode, or answer later than 3 ms after the question");
  (void)round_.sendStops();
  (void)awaitRound();
  return WH_FAILED;
}

// Sends zero torque repeatedly, until the drives have measured their currents, are ready, and
// answer before read() gives up a round: a later answer is not a sample.
bool MoteusDevice::awaitPositionMode() {
  const std::int64_t until_ns = clock_->now_ns() + kEnabling_ns;
  while (clock_->now_ns() < until_ns) {
    if (!round_.sendTorques({}, kArmingWatchdog_s) || !awaitRound()) return false;
    bool all = true;
    for (std::size_t i = 0; i < settings_.motors.size(); ++i) {
      if (round_.state(i).mode == kModeFault) return false;
      all = all && round_.state(i).mode == kModePosition;
    }
    if (all && clock_->now_ns() - round_.begun_ns() <= kLate_ns) return true;
    clock_->rest();
  }
  return false;
}

int MoteusDevice::disable() {
  pending_ = false;
  if (std::exchange(enabled_, false)) {
    (void)round_.sendTorques({}, kWatchdog_s);
    (void)awaitRound();
  }
  return round_.sendStops() && awaitRound() ? WH_OK : WH_FAILED;
}

std::uint32_t MoteusDevice::status() const noexcept {
  std::uint32_t status = WH_HOMED;
  bool all_on = enabled_;
  for (std::size_t i = 0; i < settings_.motors.size(); ++i) {
    const DriveState& state = round_.state(i);
    if (state.home != kHomed) status &= ~static_cast<std::uint32_t>(WH_HOMED);
    if (state.mode == kModeFault) status |= WH_DRIVE_FAULT;
    if (state.mode == kModeTimeout) status |= WH_SILENCED;
    if (isDerating(state.fault)) status |= WH_DERATING;
    if (isLimit(state.fault) && !isDerating(state.fault)) status |= WH_SATURATED;
    all_on = all_on && state.mode == kModePosition;
  }
  if (all_on) status |= WH_ENABLED;
  return status;
}

// Fault code of a drive that has stopped itself; if none has, the code of a limited one.
std::int32_t MoteusDevice::vendorCode() const noexcept {
  std::int32_t code = 0;
  for (std::size_t i = 0; i < settings_.motors.size(); ++i) {
    const DriveState& state = round_.state(i);
    if (state.mode == kModeFault) return state.fault;
    if (code == 0) code = state.fault;
  }
  return code;
}

bool MoteusDevice::mayBegin() const noexcept {
  return round_.complete() || clock_->now_ns() - round_.begun_ns() > kLate_ns;
}

bool MoteusDevice::sendPending() noexcept {
  if (!pending_ || !mayBegin()) return true;
  pending_ = false;  // each command is sent once: without a new one, the watchdog releases
  return round_.sendTorques(torque_nm_, kWatchdog_s);
}

int MoteusDevice::read(wh_sample& sample) noexcept {
  failed_ = failed_ || !round_.receive() || !sendPending();
  if (!failed_ && mayBegin() && clock_->now_ns() - round_.begun_ns() > kIdle_ns) {
    failed_ = !round_.sendQueries();
  }
  if (failed_ || round_.completed() == 0) return WH_FAILED;
  PerMotor position_rad{}, torque_nm{};
  for (std::size_t i = 0; i < settings_.motors.size(); ++i) {
    position_rad[i] = round_.completedState(i).position_rad;
    torque_nm[i] = round_.completedState(i).torque_nm;
  }
  const PerMotor q = map_.positions(position_rad), effort = map_.axisEfforts(torque_nm);
  sample.status = status();
  sample.vendor_code = vendorCode();
  sample.sequence = round_.completed();
  sample.monotonic_ns = round_.completedBegun_ns();
  sample.valid = 0;
  for (std::size_t a = 0; a < map_.size(); ++a) {
    sample.position[a] = q[a];
    sample.effort[a] = effort[a];
    sample.temperature_c[a] = round_.completedState(map_.axes()[a].motor).temperature_c;
    if (std::isfinite(q[a])) sample.valid |= 1U << a;
  }
  return std::exchange(reported_, round_.completed()) == round_.completed() ? WH_NOTHING_NEW
                                                                            : WH_OK;
}

int MoteusDevice::write(const wh_command& command) noexcept {
  if (!enabled_ || failed_ || command.axes != map_.size()) return WH_FAILED;
  PerMotor effort_nm{};
  for (std::size_t a = 0; a < map_.size(); ++a) {
    if (!std::isfinite(command.effort[a])) return WH_FAILED;
    const double limit_nm = map_.axes()[a].effort_limit_nm;
    effort_nm[a] = std::clamp(command.effort[a], -limit_nm, limit_nm);
  }
  if (!feeds_) return WH_OK;
  torque_nm_ = map_.torques(effort_nm);
  pending_ = true;
  failed_ = !sendPending();
  return failed_ ? WH_FAILED : WH_OK;
}

}  // namespace wholehand::moteus
