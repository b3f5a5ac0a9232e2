#include "can_bus.hpp"

#include "socketcan_bus.hpp"
#include "tty_bus.hpp"

namespace wholehand::moteus {

Expected<std::unique_ptr<CanBus>> openCanBus(const std::string& locator) {
  const std::size_t colon = locator.find(':');
  const std::string kind = locator.substr(0, colon);
  const std::string where = colon == std::string::npos ? "" : locator.substr(colon + 1);
  if (!where.empty()) {
    if (kind == "fdcanusb") return TtyBus::open(where, TtyBus::Protocol::kFdcanusb);
    if (kind == "slcan") return TtyBus::open(where, TtyBus::Protocol::kSlcan);
    if (kind == "socketcan") return SocketCanBus::open(where);
  }
  return keyFault("", "--device-at", locator, "names no CAN bus",
                  "must be fdcanusb:PORT, slcan:PORT or socketcan:INTERFACE");
}

}  // namespace wholehand::moteus
