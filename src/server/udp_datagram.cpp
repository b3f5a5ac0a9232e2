#include "server/udp_datagram.hpp"

#include "core/crc32.hpp"

#include <bit>
#include <cstring>

namespace wholehand::udp {

static_assert(std::endian::native == std::endian::little, "numbers are copied as they are");

namespace {

// Offsets of the header.
constexpr std::size_t kVersionAt = 4, kKindAt = 6, kFlagsAt = 7, kKeyAt = 8, kSequenceAt = 16,
                      kNumberAt = 20, kSentAt = 24, kEchoAt = 32, kEchoAgeAt = 40, kChecksumAt = 44;

template <class T>
void put(std::uint8_t* at, T value) noexcept {
  std::memcpy(at, &value, sizeof value);
}

template <class T>
T get(const std::uint8_t* at) noexcept {
  T value;
  std::memcpy(&value, at, sizeof value);
  return value;
}

/// CRC-32 of everything except the checksum itself.
std::uint32_t checksum(std::span<const std::uint8_t> datagram) noexcept {
  const auto bytes = std::as_bytes(datagram), payload = bytes.subspan(kHeaderSize);
  return crc32(crc32(0, bytes.data(), kChecksumAt), payload.data(), payload.size());
}

bool isSound(const Header& h, std::uint8_t flags, std::size_t payload) noexcept {
  switch (h.kind) {
    case Kind::kCommand:
      return flags == 0 && h.rate_or_stop <= kHighestRate_hz && payload > 0;
    case Kind::kAlive:
      return flags == 0 && h.rate_or_stop <= kHighestRate_hz && payload == 0;
    case Kind::kState:
      return flags <= 1 && payload > 0;
    case Kind::kPresent:
      return flags <= 1 && payload == 0;
  }
  return false;
}

}  // namespace

std::size_t write(Datagram& datagram, const Header& header,
                  std::span<const std::uint8_t> payload) noexcept {
  std::uint8_t* d = datagram.data();
  const std::size_t size = kHeaderSize + payload.size();
  put(d, kMagic);
  put(d + kVersionAt, kVersion);
  put(d + kKindAt, static_cast<std::uint8_t>(header.kind));
  put(d + kFlagsAt, static_cast<std::uint8_t>(header.holds_controls ? 1 : 0));
  put(d + kKeyAt, header.key);
  put(d + kSequenceAt, header.sequence);
  put(d + kNumberAt, header.rate_or_stop);
  put(d + kSentAt, header.sent_ns);
  put(d + kEchoAt, header.echo_ns);
  put(d + kEchoAgeAt, header.echo_age_us);
  if (!payload.empty()) std::memcpy(d + kHeaderSize, payload.data(), payload.size());
  put(d + kChecksumAt, checksum({d, size}));
  return size;
}

Received read(std::span<const std::uint8_t> bytes) noexcept {
  const std::uint8_t* d = bytes.data();
  Received r;
  const auto flawed = [&](Flaw flaw) {
    r.flaw = flaw;
    return r;
  };
  if (bytes.size() < kHeaderSize) return flawed(Flaw::kTooShort);
  if (bytes.size() > kLargestDatagram) return flawed(Flaw::kTooLong);
  if (get<std::uint32_t>(d) != kMagic) return flawed(Flaw::kWrongMagic);
  if (get<std::uint16_t>(d + kVersionAt) != kVersion) return flawed(Flaw::kWrongVersion);
  if (get<std::uint32_t>(d + kChecksumAt) != checksum(bytes)) return flawed(Flaw::kWrongChecksum);
  const auto flags = d[kFlagsAt];
  r.header.kind = static_cast<Kind>(d[kKindAt]);
  r.header.holds_controls = flags == 1;
  r.header.key = get<std::uint64_t>(d + kKeyAt);
  r.header.sequence = get<std::uint32_t>(d + kSequenceAt);
  r.header.rate_or_stop = get<std::uint32_t>(d + kNumberAt);
  r.header.sent_ns = get<std::int64_t>(d + kSentAt);
  r.header.echo_ns = get<std::int64_t>(d + kEchoAt);
  r.header.echo_age_us = get<std::uint32_t>(d + kEchoAgeAt);
  if (!isSound(r.header, flags, bytes.size() - kHeaderSize)) return flawed(Flaw::kBadHeader);
  r.payload = bytes.subspan(kHeaderSize);
  return r;
}

}  // namespace wholehand::udp
