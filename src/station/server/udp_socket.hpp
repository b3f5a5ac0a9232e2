#pragma once

#include "loop/core/expected.hpp"

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

/// Formats as "127.0.0.1:8090".
[[nodiscard]] std::string format(const UdpEndpoint& endpoint);
/// Parses "host:port", or "host" (port 0: any). Resolves names.
[[nodiscard]] Expected<UdpEndpoint> parseUdpEndpoint(const std::string& text);

enum class UdpSent { kSent, kFull, kFailed };

/// Bound socket whose send never waits. One thread may receive while another sends.
class UdpSocket {
 public:
  UdpSocket() = default;
  ~UdpSocket();
  UdpSocket(const UdpSocket&) = delete;
  UdpSocket& operator=(const UdpSocket&) = delete;

  /// Creates and binds the socket. Port 0: the system chooses one.
  [[nodiscard]] Expected<Done> open(const UdpEndpoint& local);
  [[nodiscard]] UdpSent send(const UdpEndpoint& to, std::span<const std::uint8_t> bytes) noexcept;
  /// Receives a datagram. Returns its length, which may exceed the buffer; -1: none waits.
  [[nodiscard]] long receive(UdpEndpoint& from, std::span<std::uint8_t> buffer) noexcept;
  /// Waits until a datagram arrives, wake() is called, or the timeout expires.
  void wait(int timeout_ms) noexcept;
  /// Ends the current wait, or the next one. Any thread.
  void wake() noexcept;
  /// Bound address. @pre open() succeeded
  [[nodiscard]] UdpEndpoint local() const noexcept;

 private:
  int socket_ = -1;
  int wake_ = -1;
};

}  // namespace wholehand
