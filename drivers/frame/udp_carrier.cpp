#include "drivers/frame/carriers.hpp"

#include <cerrno>
#include <cstring>
#include <netdb.h>
#include <sys/socket.h>
#include <unistd.h>

namespace wholehand {
namespace {

// A connected socket receives only from its device. A device that does not answer is not an error
// of the line: its samples stand still.
class UdpCarrier final : public Carrier {
 public:
  explicit UdpCarrier(int fd) : fd_(fd) {}
  ~UdpCarrier() override { ::close(fd_); }
  UdpCarrier(const UdpCarrier&) = delete;
  UdpCarrier& operator=(const UdpCarrier&) = delete;

  [[nodiscard]] bool send(const std::uint8_t* bytes, std::size_t count) noexcept override {
    (void)::send(fd_, bytes, count, MSG_DONTWAIT | MSG_NOSIGNAL);
    return true;
  }
  [[nodiscard]] int receive(std::uint8_t* bytes, std::size_t capacity) noexcept override {
    const ssize_t count = ::recv(fd_, bytes, capacity, MSG_DONTWAIT);
    return count > 0 ? static_cast<int>(count) : 0;
  }
  [[nodiscard]] int descriptor() const noexcept override { return fd_; }

 private:
  int fd_;
};

}  // namespace

Expected<std::unique_ptr<Carrier>> openUdp(const std::string& locator, const std::string& host,
                                           const std::string& port) {
  const bool digits = port.size() <= 5 && port.find_first_not_of("0123456789") == std::string::npos;
  if (!digits || std::stoi(port) < 1 || std::stoi(port) > 65535) {
    return noCarrier(locator, port + " is no port", "give a port from 1 to 65535");
  }
  addrinfo hints{};
  hints.ai_family = AF_UNSPEC;
  hints.ai_socktype = SOCK_DGRAM;
  hints.ai_flags = AI_NUMERICSERV;
  addrinfo* found = nullptr;
  const int failed = ::getaddrinfo(host.c_str(), port.c_str(), &hints, &found);
  if (failed != 0) {
    return noCarrier(locator, std::string("leads nowhere: ") + ::gai_strerror(failed),
                     "give a name or an address");
  }
  const int fd = ::socket(found->ai_family, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  const bool connected = fd >= 0 && ::connect(fd, found->ai_addr, found->ai_addrlen) == 0;
  const int why = errno;
  ::freeaddrinfo(found);
  if (!connected) {
    if (fd >= 0) ::close(fd);
    return noCarrier(locator, std::string("cannot be reached: ") + std::strerror(why),
                     "look at the network");
  }
  return Expected<std::unique_ptr<Carrier>>(std::make_unique<UdpCarrier>(fd));
}

}  // namespace wholehand
