#pragma once

#include "loop/core/expected.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

namespace wholehand {

/// Carries bytes between this machine and a device. Nothing waits; not thread-safe.
class Carrier {
 public:
  virtual ~Carrier() = default;
  /// A whole frame. What has no room is lost, as on a line. False: the other side is gone for good.
  [[nodiscard]] virtual bool send(const std::uint8_t* bytes, std::size_t count) noexcept = 0;
  /// Bytes that were accepted and have not gone out yet. What is sent now comes after them.
  [[nodiscard]] virtual std::size_t waiting() const noexcept { return 0; }
  /// What has come, at most `capacity` bytes; 0: nothing; -1: the other side is gone for good.
  [[nodiscard]] virtual int receive(std::uint8_t* bytes, std::size_t capacity) noexcept = 0;
  /// To poll for input; -1: there is none.
  [[nodiscard]] virtual int descriptor() const noexcept = 0;
};

/// Opens what a locator names; nobody need answer yet. Not real-time safe.
///   udp:HOST:PORT            one or more whole frames a datagram; HOST a name or an address
///   serial:/dev/ttyX[:BAUD]  8 data bits, no parity, 1 stop bit, raw; 1,000,000 baud where none
///                            is said
///   shm:NAME                 memory that a device of this machine shares (firmware/shared_ring.h)
[[nodiscard]] Expected<std::unique_ptr<Carrier>> openCarrier(const std::string& locator);

}  // namespace wholehand
