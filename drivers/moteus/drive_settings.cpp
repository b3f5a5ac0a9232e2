#include "drive_settings.hpp"

#include "bus_wait.hpp"
#include "diagnostic_channel.hpp"
#include "registers.hpp"

#include <array>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <span>
#include <utility>

namespace wholehand::moteus {
namespace {

std::string text(double value) {
  std::array<char, 32> out{};
  std::snprintf(out.data(), out.size(), "%g", value);
  return out.data();
}

// Parses a line that consists of one number; nan is a number, too.
std::optional<double> numberIn(const std::string& line) {
  char* end = nullptr;
  const double value = std::strtod(line.c_str(), &end);
  if (end == line.c_str() || *end != 0) return std::nullopt;
  return value;
}

class SettingsCheck {
 public:
  SettingsCheck(CanBus& bus, BusClock& clock, const Motor& motor)
      : bus_(bus), clock_(clock), motor_(motor) {}

  // Checks a setting. `accepts` decides about its value; `safe` names the values to which it may be
  // set.
  template <class Accepts>
  void hold(const std::string& setting, Accepts accepts, const std::string& problem,
            const std::string& safe) {
    const std::optional<std::string> line =
        askDrive(bus_, clock_, motor_.id, "conf get " + setting);
    const std::optional<double> value = line ? numberIn(*line) : std::nullopt;
    if (value && accepts(*value)) return;
    out_.push_back(
        keyFault("", "drive " + std::to_string(motor_.id) + " (" + motor_.name + ") " + setting,
                 line.value_or(""),
                 value  ? problem
                 : line ? "is no number"
                        : "cannot be read: the drive does not answer",
                 value ? "set it with tview: conf set " + setting + " " + safe + ", conf write"
                       : "look at the cable and the drive's firmware"));
  }
  [[nodiscard]] Diagnostics take() { return std::move(out_); }

 private:
  CanBus& bus_;
  BusClock& clock_;
  const Motor& motor_;
  Diagnostics out_;
};

}  // namespace

Diagnostics checkDrive(CanBus& bus, BusClock& clock, const Motor& motor) {
  SettingsCheck check(bus, clock, motor);
  const double most_nm = motor.max_torque_nm;
  check.hold(
      "servo.default_timeout_s", [](double s) { return s > 0.0 && s <= kLongestTimeout_s; },
      "is no watchdog of at most " + text(kLongestTimeout_s) + " s", text(kLongestTimeout_s));
  check.hold(
      "servo.timeout_mode", [](double mode) { return mode == 0.0 || mode == 12.0; },
      "holds or brakes when nobody commands", "12");
  check.hold(
      "servo.timeout_max_torque_Nm", [&](double nm) { return nm >= 0.0 && nm <= most_nm; },
      "is above max_torque_nm of the motor, " + text(most_nm), text(most_nm));
  check.hold(
      "servo.fixed_voltage_mode", [](double on) { return on == 0.0; }, "ignores torques", "0");
  check.hold(
      "servo.inertia_feedforward", [](double gain) { return gain == 0.0; }, "adds to the torque",
      "0");
  return check.take();
}

std::optional<DriveIdentity> identifyDrive(CanBus& bus, BusClock& clock, int drive) {
  constexpr std::int64_t kAnswer_ns = 1'000'000'000;
  CanFrame question;
  question.id = commandId(drive);
  FrameWriter writer(question);
  writer.read(RegisterType::kInt32, kFirmwareVersion, 1);
  writer.read(RegisterType::kInt32, kSerialNumber, 3);
  if (bus.send(question) != BusResult::kDone) return std::nullopt;
  const auto identity = [drive](const CanFrame& frame) -> std::optional<DriveIdentity> {
    Answer answer;
    if (frame.id != answerId(drive) ||
        !readAnswer(std::span(frame.data).first(frame.size), answer)) {
      return std::nullopt;
    }
    const auto word = [&answer](std::uint32_t reg) -> std::optional<std::uint32_t> {
      const std::optional<double> value = answer.of(reg);
      if (!value) return std::nullopt;
      return static_cast<std::uint32_t>(static_cast<std::int64_t>(*value));
    };
    const auto firmware = word(kFirmwareVersion), first = word(kSerialNumber),
               second = word(kSerialNumber + 1), third = word(kSerialNumber + 2);
    if (firmware && first && second && third) {
      return DriveIdentity{{*first, *second, *third}, *firmware};
    }
    return std::nullopt;
  };
  return receiveUntil(bus, clock, kAnswer_ns, identity);
}

}  // namespace wholehand::moteus
