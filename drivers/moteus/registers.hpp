#pragma once

#include "can_bus.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

/// The register protocol of moteus: subframes that write, read and answer registers.
/// Source: docs/protocol/can.md and docs/protocol/registers.md of mjbots/moteus. Pure functions;
/// real-time safe.
namespace wholehand::moteus {

enum Register : std::uint32_t {
  kMode = 0x000,
  kPosition = 0x001,
  kVelocity = 0x002,
  kTorque = 0x003,
  kTrajectoryComplete = 0x00b,
  kHomeState = 0x00c,
  kVoltage = 0x00d,
  kTemperature = 0x00e,
  kFault = 0x00f,
  kPwmPhaseA = 0x010,  ///< and phases B and C
  kCommandPosition = 0x020,
  kIntegralLimitScale = 0x02b,
  kFirmwareVersion = 0x101,
  kSerialNumber = 0x120  ///< three words
};

enum class RegisterType : std::uint8_t { kInt8 = 0, kInt16 = 1, kInt32 = 2, kFloat = 3 };

/// Value of a register in an answer, in its own unit: rev, rev/s, N.m, V, degrees Celsius; NaN when
/// the drive has no value. For other registers it is the transmitted number.
struct RegisterValue {
  std::uint32_t reg = 0;
  RegisterType type = RegisterType::kInt8;
  double value = 0.0;
};

/// Contents of an answer frame.
struct Answer {
  static constexpr std::size_t kMost = 64;
  std::array<RegisterValue, kMost> values{};
  std::size_t count = 0;
  int errors = 0;  ///< registers that the drive refused to write or read
  [[nodiscard]] std::optional<double> of(std::uint32_t reg) const noexcept;
};

/// Parses the answer of a drive. False when it is malformed: an unknown subframe, or one that ends
/// after the frame. `answer` then holds the values before it.
[[nodiscard]] bool readAnswer(std::span<const std::uint8_t> data, Answer& answer) noexcept;

/// Writes subframes into a frame, one after the other. Subframes that do not fit are omitted;
/// whole() tells.
class FrameWriter {
 public:
  explicit FrameWriter(CanFrame& frame) noexcept : frame_(frame) { frame_.size = 0; }

  /// Write consecutive registers from `first` on.
  void writeInt8(std::uint32_t first, std::span<const std::int8_t> values) noexcept;
  void writeInt16(std::uint32_t first, std::span<const std::int16_t> values) noexcept;
  void writeFloat(std::uint32_t first, std::span<const float> values) noexcept;
  void read(RegisterType type, std::uint32_t first, std::uint8_t count) noexcept;
  /// Text for the diagnostic channel; or a request for up to `most` bytes of its answer.
  void diagnosticWrite(std::string_view text) noexcept;
  void diagnosticPoll(std::uint8_t most) noexcept;
  /// False when a subframe did not fit.
  [[nodiscard]] bool whole() const noexcept { return whole_; }

 private:
  void head(std::uint8_t base, std::size_t count, std::uint32_t first) noexcept;
  void varuint(std::uint32_t value) noexcept;
  void byte(std::uint8_t value) noexcept;
  void raw(const void* bytes, std::size_t count) noexcept;

  CanFrame& frame_;
  bool whole_ = true;
};

/// Text in an answer on the diagnostic channel; empty when the frame is no such answer.
[[nodiscard]] std::optional<std::string_view> diagnosticAnswer(
    std::span<const std::uint8_t> data) noexcept;

/// CAN identifiers. The host has number 0 and requests an answer.
[[nodiscard]] constexpr std::uint32_t commandId(int drive) noexcept {
  return 0x8000U | static_cast<std::uint32_t>(drive);
}
[[nodiscard]] constexpr std::uint32_t answerId(int drive) noexcept {
  return static_cast<std::uint32_t>(drive) << 8U;
}

}  // namespace wholehand::moteus
