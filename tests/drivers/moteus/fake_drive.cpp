#include "fake_drive.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace wholehand::test {
namespace {

double decode(const std::uint8_t* at, int type) {
  if (type == 0) return static_cast<std::int8_t>(*at);
  if (type == 1) return static_cast<std::int16_t>(at[0] | at[1] << 8);
  float value = 0.0F;
  std::memcpy(&value, at, sizeof value);
  return static_cast<double>(value);
}

std::uint32_t varuint(const std::vector<std::uint8_t>& data, std::size_t& at) {
  std::uint32_t value = 0;
  for (unsigned shift = 0;; shift += 7) {
    value |= static_cast<std::uint32_t>(data.at(at) & 0x7f) << shift;
    if ((data.at(at++) & 0x80) == 0) return value;
  }
}

}  // namespace

// Gains that a command leaves on add 0.3 N.m, so that a driver that forgets to set one fails the
// test.
double FakeDrive::torque_nm() const {
  if (mode != 10) return 0.0;
  double torque = command_.torque_nm;
  if (command_.kp_scale != 0.0 || command_.kd_scale != 0.0 || command_.integral_scale != 0.0 ||
      std::isfinite(command_.position)) {
    torque += 0.3;
  }
  const double most_nm = std::isnan(command_.most_nm) ? 5.0 : command_.most_nm;
  return std::clamp(torque, -most_nm, most_nm);
}

void FakeDrive::advance(std::int64_t now_ns) {
  if (mode == 3 && now_ns >= enabled_ns_) mode = 10;
  const double watchdog_s = command_.watchdog_s == 0.0
                                ? std::stod(conf.at("servo.default_timeout_s"))
                                : command_.watchdog_s;
  if (mode == 10 && static_cast<double>(now_ns - fed_ns_) * 1e-9 > watchdog_s) mode = 11;
}

void FakeDrive::restart() {
  mode = 0;
  fault = 0;
  home = 0;
  command_ = {};
}

void FakeDrive::write(std::uint32_t reg, double value, int& wanted_mode, Command& command) {
  static const std::map<std::uint32_t, double Command::*> kRegisters = {
      {0x020, &Command::position},      {0x022, &Command::torque_nm}, {0x023, &Command::kp_scale},
      {0x024, &Command::kd_scale},      {0x025, &Command::most_nm},   {0x027, &Command::watchdog_s},
      {0x02b, &Command::integral_scale}};
  if (reg == 0x000) wanted_mode = static_cast<int>(value);
  if (const auto found = kRegisters.find(reg); found != kRegisters.end()) {
    command.*found->second = value;
  }
}

void FakeDrive::apply(int wanted_mode, const Command& command, std::int64_t now_ns) {
  ++commands;
  if (wanted_mode == 0) {
    mode = 0;
    fault = 0;
    return;
  }
  if (wanted_mode != 10 || mode == 1 || mode == 11) return;  // latched until a stop
  command_ = command;
  fed_ns_ = now_ns;
  if (mode == 0) {
    mode = 3;
    enabled_ns_ = now_ns + enabling_ns;
  }
}

double FakeDrive::valueOf(std::uint32_t reg) const {
  const std::map<std::uint32_t, double> values = {
      {0x000, mode},          {0x001, position_rev},
      {0x003, torque_nm()},   {0x00c, home},
      {0x00d, 24.0 / 0.5},  // as an int8: half volts
      {0x00e, temperature_c}, {0x00f, fault},
      {0x101, firmware},      {0x120, 4'000'000'000.0},  // beyond the range of int32
      {0x121, serial_word},   {0x122, id_}};
  const auto found = values.find(reg);
  return found == values.end() ? 0.0 : found->second;
}

void FakeDrive::read(std::uint32_t first, std::uint32_t count, int type,
                     std::vector<std::uint8_t>& out) {
  out.push_back(static_cast<std::uint8_t>(0x20 | type << 2));
  out.push_back(static_cast<std::uint8_t>(count));
  for (std::uint32_t rest = first; out.push_back(rest & 0x7fU), rest > 0x7fU; rest >>= 7U) {
    out.back() |= 0x80U;
  }
  for (std::uint32_t reg = first; reg < first + count; ++reg) {
    if (type == 0) {
      out.push_back(static_cast<std::uint8_t>(static_cast<std::int8_t>(valueOf(reg))));
      continue;
    }
    const auto value = static_cast<float>(valueOf(reg));
    const std::uint32_t word = type == 2 ? static_cast<std::uint32_t>(valueOf(reg)) : 0;
    std::uint8_t bytes[4];
    std::memcpy(bytes, type == 2 ? static_cast<const void*>(&word) : &value, sizeof bytes);
    out.insert(out.end(), bytes, bytes + 4);
  }
}

void FakeDrive::receive(const std::string& text) {
  received_ += text;
  for (std::size_t end = received_.find('\n'); end != std::string::npos;
       end = received_.find('\n')) {
    const std::string line = received_.substr(0, end);
    received_.erase(0, end + 1);
    const auto found = line.rfind("conf get ", 0) == 0 ? conf.find(line.substr(9)) : conf.end();
    answer_ += found == conf.end() ? "ERR error reading\r\n" : found->second + "\r\n";
  }
}

std::optional<std::vector<std::uint8_t>> FakeDrive::take(const std::vector<std::uint8_t>& data,
                                                         bool reply, std::int64_t now_ns) {
  advance(now_ns);
  if (!answers) return std::nullopt;
  std::vector<std::uint8_t> out;
  Command command;
  int wanted_mode = -1;
  for (std::size_t at = 0; at < data.size();) {
    const std::uint8_t head = data[at++];
    if (head == 0x50) continue;
    if (head == 0x40) {
      ++at;
      const std::uint32_t size = varuint(data, at);
      receive(std::string(data.begin() + static_cast<std::ptrdiff_t>(at),
                          data.begin() + static_cast<std::ptrdiff_t>(at + size)));
      at += size;
      continue;
    }
    if (head == 0x42) {
      const std::string part = answer_.substr(0, data.at(at + 1));
      answer_.erase(0, part.size());
      at += 2;
      out.insert(out.end(), {0x41, 0x01, static_cast<std::uint8_t>(part.size())});
      out.insert(out.end(), part.begin(), part.end());
      continue;
    }
    const int type = head >> 2 & 3;
    std::uint32_t count = head & 3;
    if (count == 0) count = varuint(data, at);
    const std::uint32_t first = varuint(data, at);
    if (head >= 0x10) {
      if (wanted_mode >= 0) apply(wanted_mode, command, now_ns);
      wanted_mode = -1;
      read(first, count, type, out);
      continue;
    }
    const std::size_t bytes = type == 0 ? 1 : type == 1 ? 2 : 4;
    for (std::uint32_t i = 0; i < count; ++i, at += bytes) {
      (void)data.at(at + bytes - 1);
      write(first + i, decode(data.data() + at, type), wanted_mode, command);
    }
  }
  if (wanted_mode >= 0) apply(wanted_mode, command, now_ns);
  if (!reply || out.empty()) return std::nullopt;
  return out;
}

void FakeBusState::deliver(std::int64_t now_ns) {
  for (FakeDrive& drive : drives) drive.advance(now_ns);
  for (; !sent.empty() && sent.front().first <= now_ns; sent.pop_front()) {
    const moteus::CanFrame& frame = sent.front().second;
    for (FakeDrive& drive : drives) {
      if ((frame.id & 0x7f) != static_cast<std::uint32_t>(drive.id())) continue;
      const auto answer = drive.take({frame.data.begin(), frame.data.begin() + frame.size},
                                     (frame.id & 0x8000) != 0, sent.front().first);
      if (answer) inject(static_cast<std::uint32_t>(drive.id()) << 8, *answer, sent.front().first);
    }
  }
}

void FakeBusState::inject(std::uint32_t id, const std::vector<std::uint8_t>& data,
                          std::int64_t now_ns) {
  moteus::CanFrame frame;
  frame.id = id;
  frame.size = static_cast<std::uint8_t>(data.size());
  std::copy(data.begin(), data.end(), frame.data.begin());
  answers.emplace_back(now_ns + latency_ns / 2, frame);
}

moteus::BusResult FakeBus::send(const moteus::CanFrame& frame) noexcept {
  if (state_.unplugged) return moteus::BusResult::kFailed;
  const int before = state_.frames++ - state_.loses_from;
  if (before >= 0 && before < state_.loses) return moteus::BusResult::kDone;
  state_.sent.emplace_back(time_.now_ns + state_.latency_ns / 2, frame);
  return moteus::BusResult::kDone;
}

moteus::BusResult FakeBus::receive(moteus::CanFrame& frame) noexcept {
  if (state_.unplugged) return moteus::BusResult::kFailed;
  if (!state_.by_hand) state_.deliver(time_.now_ns);
  if (state_.answers.empty() || state_.answers.front().first > time_.now_ns) {
    return moteus::BusResult::kNothing;
  }
  frame = state_.answers.front().second;
  state_.answers.pop_front();
  return moteus::BusResult::kDone;
}

}  // namespace wholehand::test
