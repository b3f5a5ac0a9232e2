#include "server/udp_datagram.hpp"

#include "core/crc32.hpp"

#include <algorithm>
#include <bit>
#include <cstring>

namespace wholehand::udp {

static_assert(std::endian::native == std::endian::little, "numbers are copied as they are");

namespace {

// Offsets of the header.
constexpr std::size_t kVersionAt = 4, kKindAt = 6, kFlagsAt = 7, kSessionAt = 8, kSequenceAt = 12,
                      kTimeAt = 16, kIndexAt = 24, kCountAt = 26, kLengthAt = 28, kReservedAt = 30,
                      kChecksumAt = 32;

/// Bits of ReplayWindow::seen_.
constexpr std::int32_t kReplayWindow = 64;

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

/// Of everything but the checksum itself.
std::uint32_t checksum(std::span<const std::uint8_t> datagram) noexcept {
  const auto bytes = std::as_bytes(datagram), payload = bytes.subspan(kHeaderSize);
  return crc32(crc32(0, bytes.data(), kChecksumAt), payload.data(), payload.size());
}

bool isKnown(std::uint8_t kind) noexcept {
  return (kind >= 1 && kind <= 4) || (kind >= 16 && kind <= 19);
}

}  // namespace

std::size_t write(Datagram& datagram, Header header,
                  std::span<const std::uint8_t> payload) noexcept {
  std::uint8_t* d = datagram.data();
  const std::size_t size = kHeaderSize + payload.size();
  put(d, kMagic);
  put(d + kVersionAt, kVersion);
  put(d + kKindAt, static_cast<std::uint8_t>(header.kind));
  put(d + kFlagsAt, std::uint8_t{0});
  put(d + kSessionAt, header.session);
  put(d + kSequenceAt, header.sequence);
  put(d + kTimeAt, header.monotonic_ns);
  put(d + kIndexAt, header.fragment_index);
  put(d + kCountAt, header.fragment_count);
  put(d + kLengthAt, static_cast<std::uint16_t>(payload.size()));
  put(d + kReservedAt, std::uint16_t{0});
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
  if (bytes.size() > kLargestDatagram) return flawed(Flaw::kTooLong);
  if (bytes.size() < kHeaderSize) return flawed(Flaw::kTooShort);
  if (get<std::uint32_t>(d) != kMagic) return flawed(Flaw::kWrongMagic);
  if (get<std::uint16_t>(d + kVersionAt) != kVersion) return flawed(Flaw::kWrongVersion);
  r.header.payload_length = get<std::uint16_t>(d + kLengthAt);
  if (r.header.payload_length != bytes.size() - kHeaderSize) return flawed(Flaw::kWrongLength);
  if (get<std::uint32_t>(d + kChecksumAt) != checksum(bytes)) return flawed(Flaw::kWrongChecksum);
  r.header.session = get<std::uint32_t>(d + kSessionAt);
  r.header.sequence = get<std::uint32_t>(d + kSequenceAt);
  r.header.monotonic_ns = get<std::int64_t>(d + kTimeAt);
  r.header.fragment_index = get<std::uint16_t>(d + kIndexAt);
  r.header.fragment_count = get<std::uint16_t>(d + kCountAt);
  const bool sound = isKnown(d[kKindAt]) && d[kFlagsAt] == 0 &&
                     get<std::uint16_t>(d + kReservedAt) == 0 && r.header.fragment_count >= 1 &&
                     r.header.fragment_count <= kMostFragments &&
                     r.header.fragment_index < r.header.fragment_count;
  if (!sound) return flawed(Flaw::kBadHeader);
  r.header.kind = static_cast<Kind>(d[kKindAt]);
  r.payload = bytes.subspan(kHeaderSize);
  return r;
}

std::uint16_t forEachFragment(
    const Header& header, std::span<const std::uint8_t> message,
    const std::function<void(std::span<const std::uint8_t> datagram)>& send) {
  const std::size_t count =
      std::max<std::size_t>(1, (message.size() + kLargestPayload - 1) / kLargestPayload);
  if (count > kMostFragments) return 0;
  Datagram datagram;
  Header h = header;
  h.fragment_count = static_cast<std::uint16_t>(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t from = i * kLargestPayload;
    h.fragment_index = static_cast<std::uint16_t>(i);
    const std::size_t size =
        write(datagram, h, message.subspan(from, std::min(kLargestPayload, message.size() - from)));
    send({datagram.data(), size});
  }
  return h.fragment_count;
}

bool readHello(std::span<const std::uint8_t> payload, Hello& hello) noexcept {
  if (payload.size() < kHelloSize || payload.size() > kHelloSize + kLongestToken) return false;
  hello.rate_hz = get<std::uint16_t>(payload.data());
  hello.schema_version = get<std::uint16_t>(payload.data() + 2);
  hello.nonce = get<std::uint64_t>(payload.data() + 4);
  hello.token = payload.subspan(kHelloSize);
  return hello.rate_hz <= kHighestRate_hz;
}

std::vector<std::uint8_t> writeHello(const Hello& hello) {
  std::vector<std::uint8_t> payload(kHelloSize + hello.token.size());
  put(payload.data(), hello.rate_hz);
  put(payload.data() + 2, hello.schema_version);
  put(payload.data() + 4, hello.nonce);
  std::copy(hello.token.begin(), hello.token.end(), payload.begin() + kHelloSize);
  return payload;
}

bool ReplayWindow::isNew(std::uint32_t sequence) const noexcept {
  const auto ahead = static_cast<std::int32_t>(sequence - newest_);  // numbers may wrap
  if (!any_ || ahead > 0) return true;
  return ahead > -kReplayWindow && (seen_ >> static_cast<unsigned>(-ahead) & 1U) == 0;
}

void ReplayWindow::accept(std::uint32_t sequence) noexcept {
  const auto ahead = static_cast<std::int32_t>(sequence - newest_);
  if (any_ && ahead <= 0) {
    seen_ |= std::uint64_t{1} << static_cast<unsigned>(-ahead);
    return;
  }
  seen_ = !any_ || ahead >= kReplayWindow ? 1U : (seen_ << static_cast<unsigned>(ahead)) | 1U;
  any_ = true;
  newest_ = sequence;
}

Reassembler::Result Reassembler::add(const Header& header, std::span<const std::uint8_t> payload) {
  const bool last = header.fragment_index + 1 == header.fragment_count;
  const std::size_t from = std::size_t{header.fragment_index} * kLargestPayload;
  // All but the last are full: the place of each is then known whatever the order.
  if (from + payload.size() > largest_ || (!last && payload.size() != kLargestPayload)) {
    return Result::kRefused;
  }
  if (!open_ || header.sequence != sequence_) {
    open_ = true;
    sequence_ = header.sequence;
    count_ = header.fragment_count;
    received_ = 0;
    have_.assign(count_, false);
    message_.clear();
  }
  if (header.fragment_count != count_) return Result::kRefused;
  if (have_[header.fragment_index]) return Result::kRepeated;
  have_[header.fragment_index] = true;
  if (message_.size() < from + payload.size()) message_.resize(from + payload.size());
  std::copy(payload.begin(), payload.end(), message_.begin() + static_cast<std::ptrdiff_t>(from));
  if (++received_ < count_) return Result::kIncomplete;
  open_ = false;
  return Result::kComplete;
}

}  // namespace wholehand::udp
