#pragma once

#include "core/expected.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace wholehand {

/// An IPv4 address and port, in the byte order of the machine.
struct UdpEndpoint {
  std::uint32_t address = 0;
  std::uint16_t port = 0;

  [[nodiscard]] bool isLoopback() const noexcept { return address >> 24U == 127; }
  bool operator==(const UdpEndpoint&) const = default;
};

/// "127.0.0.1:8090"
[[nodiscard]] std::string format(const UdpEndpoint& endpoint);
/// Reads "host:port", or "host" (port 0: any); names are looked up.
[[nodiscard]] Expected<UdpEndpoint> parseUdpEndpoint(const std::string& text);

enum class UdpSent { kSent, kFull, kFailed };

/// A bound socket that never waits to send. One thread may receive while another one sends.
class UdpSocket {
 public:
  UdpSocket() = default;
  ~UdpSocket();
  UdpSocket(const UdpSocket&) = delete;
  UdpSocket& operator=(const UdpSocket&) = delete;

  /// Port 0: the system chooses one.
  [[nodiscard]] Expected<Done> open(const UdpEndpoint& local);
  [[nodiscard]] UdpSent send(const UdpEndpoint& to, std::span<const std::uint8_t> bytes) noexcept;
  /// The next datagram's length, which may be more than fits into the buffer; -1: none waits.
  [[nodiscard]] long receive(UdpEndpoint& from, std::span<std::uint8_t> buffer) noexcept;
  /// Waits until a datagram is there, wake() is called, or the time is over.
  void wait(int timeout_ms) noexcept;
  /// Ends a wait, also the next one. Any thread.
  void wake() noexcept;
  /// Where it is bound. @pre open() succeeded
  [[nodiscard]] UdpEndpoint local() const noexcept;

 private:
  int socket_ = -1;
  int wake_ = -1;
};

}  // namespace wholehand
