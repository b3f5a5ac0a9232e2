#include "socketcan_bus.hpp"

#include "drivers/one_owner.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <linux/can.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

namespace wholehand::moteus {
namespace {

Diagnostic refused(const std::string& interface, const std::string& problem,
                   const std::string& remedy) {
  return fileFault("socketcan:" + interface, problem, remedy);
}

// Reason why the socket cannot be used with this interface; empty when it can.
Diagnostics bindTo(int descriptor, const std::string& interface) {
  ifreq request{};
  if (interface.size() >= sizeof(request.ifr_name)) {
    return {refused(interface, "is too long for an interface", "name one that `ip link` lists")};
  }
  std::copy(interface.begin(), interface.end(), request.ifr_name);
  if (::ioctl(descriptor, SIOCGIFINDEX, &request) != 0) {
    return {refused(interface, "is no interface of this machine", "name one that `ip link` lists")};
  }
  const int on = 1;
  if (::setsockopt(descriptor, SOL_CAN_RAW, CAN_RAW_FD_FRAMES, &on, sizeof on) != 0) {
    return {refused(interface, "has no CAN-FD", "use an adapter that has")};
  }
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = request.ifr_ifindex;
  if (::bind(descriptor, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0) {
    return {refused(interface, std::string("cannot be opened: ") + std::strerror(errno),
                    "set the interface up with `ip link`")};
  }
  return {};
}

}  // namespace

Expected<std::unique_ptr<CanBus>> SocketCanBus::open(const std::string& interface) {
  const int descriptor = ::socket(AF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW);
  if (descriptor < 0) {
    const int error = errno;
    if (error == EAFNOSUPPORT) {
      return refused(interface, "no CAN in this kernel",
                     "load its modules can and can_raw, or use fdcanusb:PORT");
    }
    return refused(interface, std::string("no socket: ") + std::strerror(error), "see the error");
  }
  // The kernel lets several programs write to a bus. A lock on its entry in /sys prevents that.
  const std::string entry = "/sys/class/net/" + interface + "/ifindex";
  const int held = ::open(entry.c_str(), O_RDONLY | O_CLOEXEC);
  auto bus = std::make_unique<SocketCanBus>(descriptor, held);
  if (Diagnostics why = bindTo(descriptor, interface); !why.empty()) return why;
  if (held < 0 || !takeAlone(held)) return refused(interface, kTaken, kEndTheOther);
  return Expected<std::unique_ptr<CanBus>>(std::move(bus));
}

SocketCanBus::~SocketCanBus() {
  ::close(descriptor_);
  if (held_ >= 0) ::close(held_);
}

BusResult SocketCanBus::send(const CanFrame& frame) noexcept {
  canfd_frame out{};
  out.can_id = frame.id > CAN_SFF_MASK ? frame.id | CAN_EFF_FLAG : frame.id;
  out.flags = CANFD_BRS;
  out.len = static_cast<std::uint8_t>(frameBytes(frame.size));
  std::fill(out.data, out.data + out.len, kPadding);
  std::copy_n(frame.data.begin(), frame.size, out.data);
  ssize_t n = -1;
  do {
    n = ::write(descriptor_, &out, sizeof out);
  } while (n < 0 && errno == EINTR);
  return n == static_cast<ssize_t>(sizeof out) ? BusResult::kDone : BusResult::kFailed;
}

BusResult SocketCanBus::receive(CanFrame& frame) noexcept {
  for (;;) {
    canfd_frame in{};
    const ssize_t n = ::read(descriptor_, &in, sizeof in);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0 && errno == EAGAIN) return BusResult::kNothing;
    if (n != CANFD_MTU && n != CAN_MTU) return BusResult::kFailed;
    if ((in.can_id & (CAN_ERR_FLAG | CAN_RTR_FLAG)) != 0 || in.len > CanFrame::kMostBytes) {
      ++errors_;
      continue;
    }
    frame.id = in.can_id & CAN_EFF_MASK;
    frame.size = in.len;
    std::copy_n(in.data, in.len, frame.data.begin());
    return BusResult::kDone;
  }
}

}  // namespace wholehand::moteus
