#include "diagnostic_channel.hpp"

#include "bus_wait.hpp"
#include "registers.hpp"

#include <algorithm>
#include <span>
#include <string_view>

namespace wholehand::moteus {
namespace {

constexpr std::int64_t kLongest_ns = 1'000'000'000;
constexpr std::int64_t kPoll_ns = 200'000'000;
constexpr std::uint8_t kMostPerPoll = 48;
constexpr int kAttempts = 3;

class Channel {
 public:
  Channel(CanBus& bus, BusClock& clock, int drive) : bus_(bus), clock_(clock), drive_(drive) {}

  // The frames have no reply bit, because the drive does not answer a text.
  bool write(std::string_view text) {
    for (; !text.empty(); text.remove_prefix(std::min<std::size_t>(text.size(), kMostPerPoll))) {
      CanFrame frame;
      frame.id = static_cast<std::uint32_t>(drive_);
      FrameWriter(frame).diagnosticWrite(text.substr(0, kMostPerPoll));
      if (bus_.send(frame) != BusResult::kDone) return false;
    }
    return true;
  }

  // Reads text from the drive; empty when the drive does not answer or the bus failed.
  std::optional<std::string> poll() {
    CanFrame frame;
    frame.id = commandId(drive_);
    FrameWriter(frame).diagnosticPoll(kMostPerPoll);
    if (bus_.send(frame) != BusResult::kDone) return std::nullopt;
    return receiveUntil(
        bus_, clock_, kPoll_ns, [this](const CanFrame& answer) -> std::optional<std::string> {
          const auto text = diagnosticAnswer(std::span(answer.data).first(answer.size));
          if (answer.id != answerId(drive_) || !text) return std::nullopt;
          return std::string(*text);
        });
  }

 private:
  CanBus& bus_;
  BusClock& clock_;
  int drive_;
};

// Asks once. A lost answer would leave a gap in the text, so the result is then empty.
std::optional<std::string> askOnce(CanBus& bus, BusClock& clock, int drive,
                                   const std::string& question) {
  Channel channel(bus, clock, drive);
  const std::int64_t until_ns = clock.now_ns() + kLongest_ns;
  for (auto left = channel.poll(); !left || !left->empty(); left = channel.poll()) {
    if (!left || clock.now_ns() > until_ns) return std::nullopt;
  }
  if (!channel.write(question + "\n")) return std::nullopt;
  std::string said;
  while (clock.now_ns() < until_ns) {
    const auto more = channel.poll();
    if (!more) return std::nullopt;
    said += *more;
    const std::size_t begin = said.find_first_not_of("\r\n");
    if (begin == std::string::npos) continue;
    const std::size_t end = said.find_first_of("\r\n", begin);
    if (end != std::string::npos) return said.substr(begin, end - begin);
  }
  return std::nullopt;
}

}  // namespace

std::optional<std::string> askDrive(CanBus& bus, BusClock& clock, int drive,
                                    const std::string& question) {
  std::optional<std::string> line;
  for (int i = 0; i < kAttempts && !line; ++i) line = askOnce(bus, clock, drive, question);
  return line;
}

}  // namespace wholehand::moteus
