#include "force_dimension_device.hpp"

#include "drivers/identity_text.hpp"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstring>
#include <string_view>
#include <utility>

namespace wholehand::force_dimension {
namespace {

constexpr std::string_view kSerial = "serial:";
constexpr std::int32_t kControllerError =
    16;  // added to the cause: the controller reports an error

std::int64_t now_ns() {
  return std::chrono::steady_clock::now().time_since_epoch() / std::chrono::nanoseconds(1);
}

std::string_view orEmpty(const char* text) {
  return text != nullptr ? text : "";
}

}  // namespace

Expected<std::unique_ptr<ForceDimensionDevice>> ForceDimensionDevice::open(
    Sdk sdk, const ForceSettings& settings, const std::string& locator, Report report) {
  std::unique_ptr<ForceDimensionDevice> device(
      new ForceDimensionDevice(std::move(sdk), settings, std::move(report)));
  if (Diagnostics why = device->find(locator); !why.empty()) return why;
  if (Diagnostics why = device->prepare(); !why.empty()) return why;
  return Expected<std::unique_ptr<ForceDimensionDevice>>(std::move(device));
}

ForceDimensionDevice::~ForceDimensionDevice() {
  if (!id_) return;
  (void)disable();
  (void)sdk_.drdClose(*id_);
}

Diagnostics ForceDimensionDevice::find(const std::string& locator) {
  if (locator.empty()) {
    if (sdk_.drdOpenID(0) < 0) {
      return {fileFault("", "no device: " + std::string(orEmpty(sdk_.dhdErrorGetLastStr())),
                        "look at its power, its cable and the rights to its USB port")};
    }
    id_ = 0;
    return {};
  }
  const char* const end = locator.data() + locator.size();
  unsigned serial = 0;
  const bool named = locator.starts_with(kSerial);
  const auto read = named ? std::from_chars(locator.data() + kSerial.size(), end, serial)
                          : std::from_chars_result{};
  if (!named || read.ec != std::errc() || read.ptr != end) {
    return {keyFault("", "--device-at", locator, "names no device",
                     "leave it out for the first one, or write serial:NUMBER")};
  }
  return openSerial(serial);
}

Diagnostics ForceDimensionDevice::openSerial(unsigned wanted) {
  std::string seen;
  const int count = sdk_.dhdGetDeviceCount();
  for (int i = 0; i < count && i < 127; ++i) {
    const char id = static_cast<char>(i);
    unsigned short serial = 0;
    if (sdk_.drdOpenID(id) < 0) continue;
    if (sdk_.dhdGetSerialNumber(&serial, id) >= 0 && serial == wanted) {
      id_ = id;
      return {};
    }
    (void)sdk_.drdClose(id);
    seen += (seen.empty() ? "" : ", ") + std::to_string(serial);
  }
  return {fileFault("", "no device has the serial number " + std::to_string(wanted),
                    "there are: " + (seen.empty() ? "none" : seen))};
}

Diagnostics ForceDimensionDevice::prepare() {
  if (settings_.gripper && !sdk_.dhdHasGripper(*id_)) {
    return {fileFault("", std::string(orEmpty(sdk_.dhdGetSystemName(*id_))) + " has no gripper",
                      "take [gripper] out of " + settings_.path)};
  }
  left_handed_ = sdk_.dhdIsLeftHanded(*id_);
  homed_ = sdk_.drdIsInitialized(*id_);
  cos_yaw_ = std::cos(settings_.yaw_rad);
  sin_yaw_ = std::sin(settings_.yaw_rad);
  report_(std::string(orEmpty(sdk_.dhdGetSystemName(*id_))) + ", SDK " + sdk_.version +
          (homed_ ? "" : "; not homed: homing moves it"));
  return {};
}

void ForceDimensionDevice::describe(wh_axis* axes, std::uint32_t capacity,
                                    std::uint32_t& count) const {
  constexpr std::array<const char*, 3> kNames = {"x", "y", "z"};
  count = this->axes();
  for (std::uint32_t a = 0; a < count && a < capacity; ++a) {
    wh_axis& axis = axes[a];
    std::memset(axis.name, 0, sizeof axis.name);
    axis.effort_meaning = WH_EFFORT;
    axis.delay_s = settings_.delay_s;
    axis.silence_s = settings_.watchdog_s;
    if (a < 3) {
      std::strncpy(axis.name, kNames[a], sizeof axis.name - 1);
      axis.kind = WH_TRANSLATION;
      axis.lower = -settings_.half_travel_m;
      axis.upper = settings_.half_travel_m;
      axis.effort_limit = settings_.force_limit_n;
      axis.resolution = settings_.step_m;
      continue;
    }
    const GripperSettings& gripper = *settings_.gripper;
    const double ratio = gripper.flexion_rad / (gripper.open_rad - gripper.closed_rad);
    std::strncpy(axis.name, gripper.axis.c_str(), sizeof axis.name - 1);
    axis.kind = WH_ROTATION;
    axis.lower = 0.0;
    axis.upper = gripper.flexion_rad;
    axis.effort_limit = gripper.force_limit_n * gripper.lever_m / ratio;
    axis.resolution = gripper.step_rad * ratio;
  }
}

int ForceDimensionDevice::failed(const char* what) {
  report_(std::string(what) + ": " + std::string(orEmpty(sdk_.dhdErrorGetLastStr())));
  return WH_FAILED;
}

int ForceDimensionDevice::control(std::uint32_t verb) {
  switch (verb) {
    case WH_ENABLE:
      return enable();
    case WH_DISABLE:
      reportForceOff();
      return disable();
    case WH_HOME:
      return home();
    case WH_DROP_WATCHDOG:
      feeds_ = false;
      return WH_OK;
    default:
      return WH_UNSUPPORTED;
  }
}

// Devices with a force button stay off until a person presses it: that is no failure, and the
// sample says it.
int ForceDimensionDevice::enable() {
  feeds_ = true;
  wanted_on_ = false;
  (void)send({});  // whatever another program left: zero comes first
  if (sdk_.dhdEnableForce(1, *id_) < 0) return failed("force cannot be switched on");
  if (send({}) != WH_OK) return failed("takes no force");
  wanted_on_ = true;
  reportForceOff();
  return WH_OK;
}

int ForceDimensionDevice::disable() {
  wanted_on_ = false;
  (void)send({});
  return sdk_.dhdEnableForce(0, *id_) < 0 ? failed("force cannot be switched off") : WH_OK;
}

// The SDK moves the device by itself, and its regulation ends before anything else is asked.
int ForceDimensionDevice::home() {
  if (wanted_on_) {
    report_("is enabled: disable it before homing");
    return WH_FAILED;
  }
  homed_ = false;
  const bool done = sdk_.drdAutoInit(*id_) >= 0;
  if (!done) (void)failed("homing failed");
  const bool stopped = sdk_.drdStop(false, *id_) >= 0;  // and leaves no force on
  if (!stopped) (void)failed("regulation does not end");
  if (!done || !stopped || disable() != WH_OK) return WH_FAILED;
  homed_ = sdk_.drdIsInitialized(*id_);
  if (!homed_) report_("is still not homed");
  return homed_ ? WH_OK : WH_FAILED;
}

void ForceDimensionDevice::reportForceOff() {
  std::array<int, kStatusRoom> status{};
  if (!wanted_on_ || sdk_.dhdGetStatus(status.data(), *id_) < 0 || status[kForce] != 0) return;
  report_(std::string("force is off: ") + forceOffText(status[kForceOffCause]) +
          "; where the device has a force button, press it");
}

int ForceDimensionDevice::send(const std::array<double, 4>& effort) {
  double gripper_n = 0.0;
  if (settings_.gripper) {
    const GripperSettings& gripper = *settings_.gripper;
    const double ratio = gripper.flexion_rad / (gripper.open_rad - gripper.closed_rad);
    // Work is the same on both sides: effort dq = force lever d(angle), dq = -s ratio d(angle).
    gripper_n = -gripperSign() * ratio * effort[3] / gripper.lever_m;
  }
  const int returned = sdk_.dhdSetForceAndTorqueAndGripperForce(
      cos_yaw_ * effort[0] + sin_yaw_ * effort[1], cos_yaw_ * effort[1] - sin_yaw_ * effort[0],
      effort[2], 0.0, 0.0, 0.0, gripper_n, *id_);
  saturated_ = returned == kMotorSaturated;
  return returned < 0 ? WH_FAILED : WH_OK;
}

int ForceDimensionDevice::write(const wh_command& command) {
  if (!wanted_on_ || command.axes != axes()) return WH_FAILED;
  std::array<double, 4> effort{};
  for (std::uint32_t a = 0; a < axes(); ++a) {
    if (!std::isfinite(command.effort[a])) return WH_FAILED;
    const double limit = a < 3 ? settings_.force_limit_n
                               : settings_.gripper->force_limit_n * settings_.gripper->lever_m *
                                     (settings_.gripper->open_rad - settings_.gripper->closed_rad) /
                                     settings_.gripper->flexion_rad;
    effort[a] = std::clamp(command.effort[a], -limit, limit);
  }
  return feeds_ ? send(effort) : WH_OK;
}

bool ForceDimensionDevice::readPositions(wh_sample& sample, bool& nothing_new) {
  double x_m = 0.0, y_m = 0.0, z_m = 0.0, angle_rad = 0.0;
  const int position = sdk_.dhdGetPosition(&x_m, &y_m, &z_m, *id_);
  const int gripper =
      settings_.gripper ? sdk_.dhdGetGripperAngleRad(&angle_rad, *id_) : static_cast<int>(kFine);
  if (position < 0 || gripper < 0) return false;
  nothing_new = position == kTimeGuard || gripper == kTimeGuard;
  sample.position[0] = cos_yaw_ * x_m - sin_yaw_ * y_m;
  sample.position[1] = sin_yaw_ * x_m + cos_yaw_ * y_m;
  sample.position[2] = z_m;
  if (settings_.gripper) {
    const GripperSettings& g = *settings_.gripper;
    sample.position[3] =
        (g.open_rad - gripperSign() * angle_rad) * g.flexion_rad / (g.open_rad - g.closed_rad);
  }
  return true;
}

std::uint32_t ForceDimensionDevice::statusBits(const std::array<int, kStatusRoom>& status) {
  const int cause = status[kForceOffCause];
  const bool on = status[kForce] != 0;
  if (status[kReset] != 0) homed_ = false;  // it was switched off and on
  std::uint32_t bits = 0;
  if (homed_) bits |= WH_HOMED;
  if (wanted_on_ && on && status[kPower] != 0) bits |= WH_ENABLED;
  if (wanted_on_ && !on && cause == kWatchdog) bits |= WH_SILENCED;
  if (wanted_on_ && !on && cause == kVelocity) bits |= WH_DRIVE_FAULT;
  if (status[kError] != 0) bits |= WH_DRIVE_FAULT;
  if (saturated_) bits |= WH_SATURATED;
  return bits;
}

int ForceDimensionDevice::read(wh_sample& sample) {
  std::array<int, kStatusRoom> status{};
  if (sdk_.dhdGetStatus(status.data(), *id_) < 0 || status[kConnected] == 0) return WH_FAILED;
  bool nothing_new = false;
  wh_sample now = last_;
  if (!readPositions(now, nothing_new)) return WH_FAILED;
  nothing_new = nothing_new && sequence_ != 0;
  if (nothing_new) std::copy_n(last_.position, WH_MAX_AXES, now.position);
  if (!nothing_new) {
    now.sequence = ++sequence_;
    now.monotonic_ns = now_ns();
    now.valid = 0;
    for (std::uint32_t a = 0; a < axes(); ++a) {
      if (std::isfinite(now.position[a])) now.valid |= 1U << a;
    }
  }
  now.status = statusBits(status);
  now.vendor_code = status[kForce] == 0 ? status[kForceOffCause] : 0;
  if (status[kError] != 0) now.vendor_code += kControllerError;
  last_ = now;
  now.size = sample.size;
  sample = now;
  for (std::uint32_t a = 0; a < WH_MAX_AXES; ++a) {
    sample.effort[a] = sample.temperature_c[a] = std::nan("");
  }
  return nothing_new ? WH_NOTHING_NEW : WH_OK;
}

void ForceDimensionDevice::identify(wh_identity& identity) {
  unsigned short serial = 0;
  if (sdk_.dhdGetSerialNumber(&serial, *id_) >= 0) fill(identity.serial, std::to_string(serial));
  fill(identity.sdk, sdk_.version);
}

}  // namespace wholehand::force_dimension
