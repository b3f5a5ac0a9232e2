#include "moteus_round.hpp"

#include "fault_text.hpp"
#include "registers.hpp"

#include <algorithm>
#include <limits>
#include <numbers>
#include <span>

namespace wholehand::moteus {
namespace {

constexpr double kTurn_rad = 2.0 * std::numbers::pi;
constexpr int kMostFrames = 64;  // limit per call, so that a flooding adapter blocks nobody
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

void writeMode(FrameWriter& out, int mode) noexcept {
  const std::array<std::int8_t, 1> value = {static_cast<std::int8_t>(mode)};
  out.writeInt8(kMode, value);
}

// An answer does not name its question. Each round therefore reads a different set of additional
// registers, and an answer contains those of its own round. There are eight different sets. A round
// is given up after 3 ms at the earliest, so an answer could be mistaken for a later one only after
// 24 ms. The answer still fits into a frame of 32 bytes, as without these registers.
constexpr unsigned kMarks = 8, kAfter = kMarks / 2;

void writeQuery(FrameWriter& out, unsigned mark) noexcept {
  const unsigned before = mark / kAfter, after = mark % kAfter;
  out.read(RegisterType::kFloat, kMode, 4);  // mode, position, velocity, torque
  // Home state, voltage, temperature, fault. The mark adds registers: before them whether a
  // trajectory is complete, after them the phases' PWM.
  out.read(RegisterType::kInt8, kHomeState - before, static_cast<std::uint8_t>(4 + before + after));
}

unsigned markOf(const Answer& answer) noexcept {
  unsigned after = 0;
  while (after + 1 < kAfter && answer.of(kPwmPhaseA + after)) ++after;
  return (answer.of(kTrajectoryComplete) ? kAfter : 0) + after;
}

void writeTorque(FrameWriter& out, double torque_nm, double most_nm, double watchdog_s) noexcept {
  // Registers 0x020 to 0x027. The limit of the integral is written separately: zero gains alone
  // would not clear it.
  const std::array<float, 8> command = {kNaN,                           // position: the present one
                                        0.0F,                           // velocity
                                        static_cast<float>(torque_nm),  // feed-forward
                                        0.0F,                           // kp scale
                                        0.0F,                           // kd scale
                                        static_cast<float>(most_nm),    // largest torque
                                        kNaN,                           // stop position: none
                                        static_cast<float>(watchdog_s)};  // watchdog
  const std::array<std::int8_t, 1> no_integral = {0};
  out.writeFloat(kCommandPosition, command);
  out.writeInt8(kIntegralLimitScale, no_integral);
}

}  // namespace

MoteusRound::MoteusRound(const std::vector<Motor>& motors, CanBus& bus, BusClock& clock)
    : motors_(motors), bus_(bus), clock_(clock) {}

void MoteusRound::begin() noexcept {
  awaited_ = (1U << motors_.size()) - 1U;
  mark_ = (mark_ + 1) % kMarks;
  begun_ns_ = clock_.now_ns();
}

bool MoteusRound::send(CanFrame& frame, std::size_t motor) noexcept {
  frame.id = commandId(motors_[motor].id);
  return bus_.send(frame) == BusResult::kDone;
}

template <class Write>
bool MoteusRound::sendToAll(Write write) noexcept {
  begin();
  bool sent = true;
  for (std::size_t i = 0; i < motors_.size(); ++i) {
    CanFrame frame;
    FrameWriter out(frame);
    write(out, i);
    writeQuery(out, mark_);
    sent = send(frame, i) && sent;
  }
  return sent;
}

bool MoteusRound::sendTorques(const PerMotor& torque_nm, double watchdog_s) noexcept {
  return sendToAll([&](FrameWriter& out, std::size_t i) {
    const double most_nm = motors_[i].max_torque_nm;
    writeMode(out, kModePosition);  // first, because the other registers belong to it
    writeTorque(out, std::clamp(torque_nm[i], -most_nm, most_nm), most_nm, watchdog_s);
  });
}

bool MoteusRound::sendStops() noexcept {
  return sendToAll([](FrameWriter& out, std::size_t) { writeMode(out, kModeStopped); });
}

bool MoteusRound::sendQueries() noexcept {
  return sendToAll([](FrameWriter&, std::size_t) {});
}

bool MoteusRound::receive() noexcept {
  for (int i = 0; i < kMostFrames; ++i) {
    CanFrame frame;
    const BusResult result = bus_.receive(frame);
    if (result == BusResult::kNothing) break;
    if (result == BusResult::kFailed) return false;
    take(frame);
  }
  return true;
}

void MoteusRound::take(const CanFrame& frame) noexcept {
  const auto of = std::find_if(motors_.begin(), motors_.end(),
                               [&](const Motor& motor) { return answerId(motor.id) == frame.id; });
  if (of == motors_.end()) {
    ++foreign_;
    return;
  }
  Answer answer;
  const bool whole = readAnswer(std::span(frame.data).first(frame.size), answer);
  const auto mode = answer.of(kMode), position = answer.of(kPosition), torque = answer.of(kTorque),
             home = answer.of(kHomeState), fault = answer.of(kFault),
             temperature = answer.of(kTemperature);
  if (!whole || !mode || !position || !torque || !home || !fault || !temperature ||
      !(*mode >= 0.0 && *mode <= 255.0)) {
    ++malformed_;
    return;
  }
  if (markOf(answer) != mark_) return;  // answer of a round that was given up
  const auto i = static_cast<std::size_t>(of - motors_.begin());
  last_[i] = {static_cast<int>(*mode),
              static_cast<int>(*fault),
              static_cast<int>(*home),
              kTurn_rad * *position,
              *torque,
              *temperature,
              true};
  if (awaited_ == 0) return;
  awaited_ &= ~(1U << i);
  if (awaited_ != 0) return;
  ++completed_;
  completed_begun_ns_ = begun_ns_;
  of_round_ = last_;
}

}  // namespace wholehand::moteus
