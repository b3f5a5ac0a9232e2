#pragma once

#include "loop/core/expected.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

namespace wholehand {

/// Carries bytes between this machine and a device. No call waits; not thread-safe.
class Carrier {
 public:
  virtual ~Carrier() = default;
  /// Sends a whole frame. A frame that does not fit is lost, as on a line. False: the other side is
  /// gone for good.
  [[nodiscard]] virtual bool send(const std::uint8_t* bytes, std::size_t count) noexcept = 0;
  /// Bytes that were accepted but not sent yet. Later bytes follow them.
  [[nodiscard]] virtual std::size_t waiting() const noexcept { return 0; }
  /// Receives at most `capacity` bytes; 0: none; -1: the other side is gone for good.
  [[nodiscard]] virtual int receive(std::uint8_t* bytes, std::size_t capacity) noexcept = 0;
  /// File descriptor to poll for input; -1: there is none.
  [[nodiscard]] virtual int descriptor() const noexcept = 0;
};

/// Opens the carrier that a locator names; the device need not answer yet. Not real-time safe.
///   udp:HOST:PORT            one or more whole frames per datagram; HOST is a name or an address
///   serial:/dev/ttyX[:BAUD]  8 data bits, no parity, 1 stop bit, raw; default 1,000,000 baud
///   shm:NAME                 memory shared by a device on this machine (firmware/shared_ring.h)
[[nodiscard]] Expected<std::unique_ptr<Carrier>> openCarrier(const std::string& locator);

}  // namespace wholehand
