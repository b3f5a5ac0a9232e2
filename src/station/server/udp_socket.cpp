#include "station/server/udp_socket.hpp"

#include <arpa/inet.h>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <netdb.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

namespace wholehand {

namespace {

/// Receive buffer that holds a second of commands while this program is delayed.
constexpr int kReceiveBuffer_bytes = 1 << 20;

sockaddr_in toSystem(const UdpEndpoint& endpoint) noexcept {
  sockaddr_in a{};
  a.sin_family = AF_INET;
  a.sin_addr.s_addr = htonl(endpoint.address);
  a.sin_port = htons(endpoint.port);
  return a;
}

UdpEndpoint fromSystem(const sockaddr_in& a) noexcept {
  return {ntohl(a.sin_addr.s_addr), ntohs(a.sin_port)};
}

Diagnostic systemError(const UdpEndpoint& local, const char* what) {
  return keyFault("", "UDP address", format(local), std::string(what) + ": " + std::strerror(errno),
                  "choose another port, or an address of this machine");
}

}  // namespace

std::string format(const UdpEndpoint& endpoint) {
  char text[INET_ADDRSTRLEN] = "";
  const in_addr address{htonl(endpoint.address)};
  inet_ntop(AF_INET, &address, text, sizeof text);
  return std::string(text) + ":" + std::to_string(endpoint.port);
}

Expected<UdpEndpoint> parseUdpEndpoint(const std::string& text) {
  const auto bad = [&](std::string problem) {
    return keyFault("", "UDP address", text, std::move(problem),
                    "write host:port, as in 127.0.0.1:8090");
  };
  UdpEndpoint endpoint;
  std::string host = text;
  if (const auto colon = text.rfind(':'); colon != std::string::npos) {
    host = text.substr(0, colon);
    const char* end = text.data() + text.size();
    const auto [rest, error] = std::from_chars(text.data() + colon + 1, end, endpoint.port);
    if (error != std::errc() || rest != end)
      return bad("has a port that is not a number from 0 to 65535");
  }
  if (host.empty()) return bad("has no host");
  addrinfo wanted{};
  wanted.ai_family = AF_INET;
  wanted.ai_socktype = SOCK_DGRAM;
  addrinfo* found = nullptr;
  if (const int error = getaddrinfo(host.c_str(), nullptr, &wanted, &found); error != 0) {
    return bad("names no IPv4 host (" + std::string(gai_strerror(error)) + ")");
  }
  sockaddr_in a{};
  std::memcpy(&a, found->ai_addr, sizeof a);
  freeaddrinfo(found);
  endpoint.address = fromSystem(a).address;
  return endpoint;
}

UdpSocket::~UdpSocket() {
  if (socket_ >= 0) ::close(socket_);
  if (wake_ >= 0) ::close(wake_);
}

Expected<Done> UdpSocket::open(const UdpEndpoint& local) {
  socket_ = ::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  wake_ = ::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
  if (socket_ < 0 || wake_ < 0) return systemError(local, "the system gives no socket");
  setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &kReceiveBuffer_bytes, sizeof kReceiveBuffer_bytes);
  const sockaddr_in a = toSystem(local);
  if (::bind(socket_, reinterpret_cast<const sockaddr*>(&a), sizeof a) != 0) {
    return systemError(local, "cannot be listened to");
  }
  return Done{};
}

UdpSent UdpSocket::send(const UdpEndpoint& to, std::span<const std::uint8_t> bytes) noexcept {
  const sockaddr_in a = toSystem(to);
  const auto* where = reinterpret_cast<const sockaddr*>(&a);
  // Sends again once, because the first call may return a pending error of an earlier datagram to a
  // game that has gone.
  for (int attempt = 0; attempt < 2; ++attempt) {
    if (::sendto(socket_, bytes.data(), bytes.size(), MSG_DONTWAIT | MSG_NOSIGNAL, where,
                 sizeof a) >= 0) {
      return UdpSent::kSent;
    }
    if (errno == EAGAIN || errno == EWOULDBLOCK || errno == ENOBUFS) return UdpSent::kFull;
    if (errno != ECONNREFUSED && errno != EINTR) return UdpSent::kFailed;
  }
  return UdpSent::kFailed;
}

long UdpSocket::receive(UdpEndpoint& from, std::span<std::uint8_t> buffer) noexcept {
  sockaddr_in a{};
  socklen_t size = sizeof a;
  while (true) {
    const long n = ::recvfrom(socket_, buffer.data(), buffer.size(), MSG_DONTWAIT | MSG_TRUNC,
                              reinterpret_cast<sockaddr*>(&a), &size);
    if (n >= 0) {
      from = fromSystem(a);
      return n;
    }
    if (errno != EINTR && errno != ECONNREFUSED) return -1;
  }
}

void UdpSocket::wait(int timeout_ms) noexcept {
  pollfd waiting[] = {{socket_, POLLIN, 0}, {wake_, POLLIN, 0}};
  ::poll(waiting, 2, timeout_ms);
  std::uint64_t woken = 0;
  [[maybe_unused]] const auto n = ::read(wake_, &woken, sizeof woken);
}

void UdpSocket::wake() noexcept {
  const std::uint64_t one = 1;
  [[maybe_unused]] const auto n = ::write(wake_, &one, sizeof one);
}

UdpEndpoint UdpSocket::local() const noexcept {
  sockaddr_in a{};
  socklen_t size = sizeof a;
  ::getsockname(socket_, reinterpret_cast<sockaddr*>(&a), &size);
  return fromSystem(a);
}

}  // namespace wholehand
