#include "drivers/frame/carriers.hpp"
#include "drivers/one_owner.hpp"

#include <array>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>
#include <utility>

namespace wholehand {
namespace {

constexpr std::array<std::pair<const char*, speed_t>, 13> kBauds{{{"115200", B115200},
                                                                  {"230400", B230400},
                                                                  {"460800", B460800},
                                                                  {"500000", B500000},
                                                                  {"576000", B576000},
                                                                  {"921600", B921600},
                                                                  {"1000000", B1000000},
                                                                  {"1152000", B1152000},
                                                                  {"1500000", B1500000},
                                                                  {"2000000", B2000000},
                                                                  {"2500000", B2500000},
                                                                  {"3000000", B3000000},
                                                                  {"4000000", B4000000}}};

// An unplugged line reads 0 bytes or EIO for good. VMIN 1 keeps 0 from also meaning "nothing yet".
class SerialCarrier final : public Carrier {
 public:
  explicit SerialCarrier(int fd) : fd_(fd) {}
  ~SerialCarrier() override { ::close(fd_); }
  SerialCarrier(const SerialCarrier&) = delete;
  SerialCarrier& operator=(const SerialCarrier&) = delete;

  [[nodiscard]] bool send(const std::uint8_t* bytes, std::size_t count) noexcept override {
    return ::write(fd_, bytes, count) >= 0 || isPassing(errno);
  }
  [[nodiscard]] std::size_t waiting() const noexcept override {
    int bytes = 0;
    return ::ioctl(fd_, TIOCOUTQ, &bytes) == 0 && bytes > 0 ? static_cast<std::size_t>(bytes) : 0;
  }
  [[nodiscard]] int receive(std::uint8_t* bytes, std::size_t capacity) noexcept override {
    const ssize_t count = ::read(fd_, bytes, capacity);
    if (count > 0) return static_cast<int>(count);
    return count < 0 && isPassing(errno) ? 0 : -1;
  }
  [[nodiscard]] int descriptor() const noexcept override { return fd_; }

 private:
  static bool isPassing(int why) noexcept {
    return why == EAGAIN || why == EWOULDBLOCK || why == EINTR;
  }
  int fd_;
};

bool makeRaw(int fd, speed_t baud) {
  termios raw{};
  if (::tcgetattr(fd, &raw) != 0) return false;
  ::cfmakeraw(&raw);
  raw.c_cflag |= CLOCAL | CREAD;
  raw.c_cflag &= ~static_cast<tcflag_t>(CRTSCTS | CSTOPB);
  raw.c_cc[VMIN] = 1;
  raw.c_cc[VTIME] = 0;
  if (::cfsetispeed(&raw, baud) != 0 || ::cfsetospeed(&raw, baud) != 0) return false;
  return ::tcsetattr(fd, TCSANOW, &raw) == 0 && ::tcflush(fd, TCIOFLUSH) == 0;
}

}  // namespace

Expected<std::unique_ptr<Carrier>> openSerial(const std::string& locator, const std::string& path,
                                              const std::string& baud) {
  const auto* speed = kBauds.begin();
  while (speed != kBauds.end() && baud != speed->first) ++speed;
  if (speed == kBauds.end()) {
    std::string known;
    for (const auto& [text, constant] : kBauds)
      known += (known.empty() ? "" : ", ") + std::string(text);
    return noCarrier(locator, baud + " baud is not known here", "give one of " + known);
  }
  const int fd = ::open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (fd < 0 && errno == EBUSY) return noCarrier(locator, path + " " + kTaken, kEndTheOther);
  if (fd < 0) {
    return noCarrier(locator, path + " cannot be opened: " + std::strerror(errno),
                     "is it plugged in, and are you in the group dialout?");
  }
  auto carrier = std::make_unique<SerialCarrier>(fd);
  if (!takeAlone(fd)) return noCarrier(locator, path + " " + kTaken, kEndTheOther);
  if (::ioctl(fd, TIOCEXCL) != 0 || !makeRaw(fd, speed->second)) {
    return noCarrier(locator, path + " is no serial line: " + std::strerror(errno),
                     "give the device's own tty");
  }
  return Expected<std::unique_ptr<Carrier>>(std::move(carrier));
}

}  // namespace wholehand
