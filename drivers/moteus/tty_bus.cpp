#include "tty_bus.hpp"

#include "drivers/one_owner.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <string_view>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

namespace wholehand::moteus {
namespace {

// Closes, sets 1 Mbit/s, and 5 Mbit/s in the data phase, and opens: the rates of moteus.
constexpr std::string_view kOpenSlcan = "C\rS8\rY5\rO\r";

// Sets raw mode. A read without data gives EAGAIN, so that 0 bytes mean that the port is gone.
bool makeRaw(int descriptor) {
  termios settings{};
  if (::tcgetattr(descriptor, &settings) != 0) return false;
  ::cfmakeraw(&settings);
  settings.c_cflag |= CLOCAL | CREAD;
  settings.c_cc[VMIN] = 1;
  settings.c_cc[VTIME] = 0;
  return ::tcsetattr(descriptor, TCSANOW, &settings) == 0 && ::tcflush(descriptor, TCIFLUSH) == 0;
}

}  // namespace

Expected<std::unique_ptr<CanBus>> TtyBus::open(const std::string& port, Protocol protocol) {
  const int descriptor = ::open(port.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0) {
    const int error = errno;
    if (error == EBUSY) return fileFault(port, kTaken, kEndTheOther);
    return fileFault(port, std::string("cannot be opened: ") + std::strerror(error),
                     error == EACCES ? "become a member of the group that owns it (dialout)"
                                     : "name the port of the CAN adapter");
  }
  if (!takeAlone(descriptor)) {
    ::close(descriptor);
    return fileFault(port, kTaken, kEndTheOther);
  }
  if (::ioctl(descriptor, TIOCEXCL) != 0 || !makeRaw(descriptor)) {
    ::close(descriptor);
    return fileFault(port, "is no serial port", "name the port of the CAN adapter");
  }
  auto bus = std::make_unique<TtyBus>(descriptor, protocol);
  if (protocol == Protocol::kSlcan &&
      !(bus->queue(kOpenSlcan.data(), kOpenSlcan.size()) && bus->flush())) {
    return fileFault(port, "takes nothing", "plug the CAN adapter in again");
  }
  return Expected<std::unique_ptr<CanBus>>(std::move(bus));
}

TtyBus::TtyBus(int descriptor, Protocol protocol) noexcept
    : descriptor_(descriptor), protocol_(protocol) {}

TtyBus::~TtyBus() {
  ::close(descriptor_);
}

BusResult TtyBus::fail() noexcept {
  failed_ = true;
  return BusResult::kFailed;
}

bool TtyBus::queue(const char* text, std::size_t length) noexcept {
  if (length > out_.size() - out_end_) return false;
  std::memcpy(out_.data() + out_end_, text, length);
  out_end_ += length;
  return true;
}

bool TtyBus::flush() noexcept {
  std::size_t sent = 0;
  while (sent < out_end_) {
    const ssize_t n = ::write(descriptor_, out_.data() + sent, out_end_ - sent);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0 && errno == EAGAIN) break;
    if (n <= 0) return false;
    sent += static_cast<std::size_t>(n);
  }
  std::memmove(out_.data(), out_.data() + sent, out_end_ - sent);
  out_end_ -= sent;
  return true;
}

BusResult TtyBus::send(const CanFrame& frame) noexcept {
  if (failed_) return BusResult::kFailed;
  LineBuffer line;
  const std::size_t length =
      protocol_ == Protocol::kSlcan ? writeSlcan(frame, line) : writeFdcanusb(frame, line);
  return queue(line.data(), length) && flush() ? BusResult::kDone : fail();
}

BusResult TtyBus::receive(CanFrame& frame) noexcept {
  if (failed_) return BusResult::kFailed;
  for (;;) {
    while (in_begin_ < in_end_) {
      if (!splitter_.take(in_[in_begin_++])) continue;
      const LineMeaning meaning = protocol_ == Protocol::kSlcan
                                      ? readSlcan(splitter_.line(), frame)
                                      : readFdcanusb(splitter_.line(), frame);
      if (meaning == LineMeaning::kFrame) return BusResult::kDone;
      if (meaning != LineMeaning::kAccepted) ++errors_;
    }
    const ssize_t n = ::read(descriptor_, in_.data(), in_.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0 && errno == EAGAIN) return BusResult::kNothing;
    if (n <= 0) return fail();
    in_begin_ = 0;
    in_end_ = static_cast<std::size_t>(n);
  }
}

}  // namespace wholehand::moteus
