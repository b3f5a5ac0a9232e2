#include "registers.hpp"

#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

static_assert(std::endian::native == std::endian::little, "the protocol is little endian");

namespace wholehand::moteus {
namespace {

constexpr std::uint8_t kWrite = 0x00, kRead = 0x10, kReply = 0x20, kWriteError = 0x30,
                       kReadError = 0x31, kClientToServer = 0x40, kServerToClient = 0x41,
                       kClientPollsServer = 0x42;
constexpr std::uint8_t kDiagnosticChannel = 1;

class Bytes {
 public:
  explicit Bytes(std::span<const std::uint8_t> data) noexcept : data_(data) {}
  [[nodiscard]] bool empty() const noexcept { return data_.empty(); }
  [[nodiscard]] std::span<const std::uint8_t> rest() const noexcept { return data_; }

  bool byte(std::uint8_t& value) noexcept { return raw(&value, 1); }
  bool varuint(std::uint32_t& value) noexcept {
    std::uint64_t sum = 0;
    for (unsigned shift = 0; shift < 35; shift += 7) {
      std::uint8_t part = 0;
      if (!byte(part)) return false;
      sum |= static_cast<std::uint64_t>(part & 0x7fU) << shift;
      if ((part & 0x80U) != 0) continue;
      value = static_cast<std::uint32_t>(sum);
      return sum <= std::numeric_limits<std::uint32_t>::max();
    }
    return false;
  }
  bool raw(void* out, std::size_t count) noexcept {
    if (count > data_.size()) return false;
    std::memcpy(out, data_.data(), count);
    data_ = data_.subspan(count);
    return true;
  }

 private:
  std::span<const std::uint8_t> data_;
};

// Value of one step of an integer (docs/protocol/registers.md, "Mappings"); 1: not scaled.
double stepOf(std::uint32_t reg, RegisterType type) noexcept {
  const auto of = [type](double int8, double int16, double int32) {
    return type == RegisterType::kInt8 ? int8 : type == RegisterType::kInt16 ? int16 : int32;
  };
  switch (reg) {
    case kPosition:
      return of(0.01, 0.0001, 0.00001);
    case kVelocity:
      return of(0.1, 0.00025, 0.00001);
    case kTorque:
      return of(0.5, 0.01, 0.001);
    case kVoltage:
      return of(0.5, 0.1, 0.001);
    case kTemperature:
      return of(1.0, 0.1, 0.001);
    default:
      return 1.0;
  }
}

template <class Integer>
bool readInteger(Bytes& bytes, RegisterValue& out) noexcept {
  Integer raw{};
  if (!bytes.raw(&raw, sizeof raw)) return false;
  const double step = stepOf(out.reg, out.type);
  // The lowest number means NaN in scaled registers.
  const bool none = step != 1.0 && raw == std::numeric_limits<Integer>::min();
  out.value = none ? std::nan("") : step * static_cast<double>(raw);
  return true;
}

bool readValue(Bytes& bytes, RegisterValue& out) noexcept {
  switch (out.type) {
    case RegisterType::kInt8:
      return readInteger<std::int8_t>(bytes, out);
    case RegisterType::kInt16:
      return readInteger<std::int16_t>(bytes, out);
    case RegisterType::kInt32:
      return readInteger<std::int32_t>(bytes, out);
    case RegisterType::kFloat:
      break;
  }
  float raw = 0.0F;
  if (!bytes.raw(&raw, sizeof raw)) return false;
  out.value = static_cast<double>(raw);
  return true;
}

bool readReply(Bytes& bytes, std::uint8_t head, Answer& answer) noexcept {
  std::uint32_t count = head & 0x3U, reg = 0;
  if (count == 0 && !bytes.varuint(count)) return false;
  if (!bytes.varuint(reg)) return false;
  for (std::uint32_t i = 0; i < count; ++i) {
    RegisterValue value{reg + i, static_cast<RegisterType>(head >> 2U & 0x3U), 0.0};
    if (answer.count == Answer::kMost || !readValue(bytes, value)) return false;
    answer.values[answer.count++] = value;
  }
  return true;
}

}  // namespace

std::optional<double> Answer::of(std::uint32_t reg) const noexcept {
  for (std::size_t i = 0; i < count; ++i) {
    if (values[i].reg == reg) return values[i].value;
  }
  return std::nullopt;
}

bool readAnswer(std::span<const std::uint8_t> data, Answer& answer) noexcept {
  answer.count = 0;
  answer.errors = 0;
  Bytes bytes(data);
  while (!bytes.empty()) {
    std::uint8_t head = 0;
    (void)bytes.byte(head);
    if (head == kPadding) continue;
    if (head == kWriteError || head == kReadError) {
      std::uint32_t reg = 0, error = 0;
      if (!bytes.varuint(reg) || !bytes.varuint(error)) return false;
      ++answer.errors;
      continue;
    }
    if ((head & 0xf0U) != kReply || !readReply(bytes, head, answer)) return false;
  }
  return true;
}

std::optional<std::string_view> diagnosticAnswer(std::span<const std::uint8_t> data) noexcept {
  Bytes bytes(data);
  std::uint8_t head = 0, channel = 0;
  std::uint32_t size = 0;
  if (!bytes.byte(head) || head != kServerToClient) return std::nullopt;
  if (!bytes.byte(channel) || channel != kDiagnosticChannel) return std::nullopt;
  if (!bytes.varuint(size) || size > bytes.rest().size()) return std::nullopt;
  return std::string_view(reinterpret_cast<const char*>(bytes.rest().data()), size);
}

void FrameWriter::byte(std::uint8_t value) noexcept {
  raw(&value, 1);
}

void FrameWriter::raw(const void* bytes, std::size_t count) noexcept {
  if (!whole_ || count > CanFrame::kMostBytes - frame_.size) {
    whole_ = false;
    return;
  }
  std::memcpy(frame_.data.data() + frame_.size, bytes, count);
  frame_.size = static_cast<std::uint8_t>(frame_.size + count);
}

void FrameWriter::varuint(std::uint32_t value) noexcept {
  for (; value > 0x7f; value >>= 7U) byte(static_cast<std::uint8_t>(value | 0x80U));
  byte(static_cast<std::uint8_t>(value));
}

// A count of up to three registers is encoded in the low bits of the subframe's type.
void FrameWriter::head(std::uint8_t base, std::size_t count, std::uint32_t first) noexcept {
  if (count <= 3) {
    byte(static_cast<std::uint8_t>(base | count));
  } else {
    byte(base);
    varuint(static_cast<std::uint32_t>(count));
  }
  varuint(first);
}

void FrameWriter::writeInt8(std::uint32_t first, std::span<const std::int8_t> values) noexcept {
  head(kWrite, values.size(), first);
  raw(values.data(), values.size_bytes());
}

void FrameWriter::writeInt16(std::uint32_t first, std::span<const std::int16_t> values) noexcept {
  head(kWrite | 0x04U, values.size(), first);
  raw(values.data(), values.size_bytes());
}

void FrameWriter::writeFloat(std::uint32_t first, std::span<const float> values) noexcept {
  head(kWrite | 0x0cU, values.size(), first);
  raw(values.data(), values.size_bytes());
}

void FrameWriter::read(RegisterType type, std::uint32_t first, std::uint8_t count) noexcept {
  head(static_cast<std::uint8_t>(kRead | static_cast<unsigned>(type) << 2U), count, first);
}

void FrameWriter::diagnosticWrite(std::string_view text) noexcept {
  byte(kClientToServer);
  byte(kDiagnosticChannel);
  varuint(static_cast<std::uint32_t>(text.size()));
  raw(text.data(), text.size());
}

void FrameWriter::diagnosticPoll(std::uint8_t most) noexcept {
  byte(kClientPollsServer);
  byte(kDiagnosticChannel);
  byte(most);
}

}  // namespace wholehand::moteus
