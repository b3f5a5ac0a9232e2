#include "drivers/frame/carrier.hpp"

#include "drivers/frame/carriers.hpp"

namespace wholehand {
namespace {

constexpr const char* kRemedy =
    "give --device-at udp:HOST:PORT, serial:/dev/ttyX, serial:/dev/ttyX:BAUD or shm:NAME";

bool takePrefix(std::string& text, const char* prefix) {
  const std::string begin = prefix;
  if (text.compare(0, begin.size(), begin) != 0) return false;
  text.erase(0, begin.size());
  return true;
}

}  // namespace

Diagnostic noCarrier(const std::string& locator, const std::string& problem,
                     const std::string& remedy) {
  return {"", 0, "--device-at", locator, problem, remedy};
}

Expected<std::unique_ptr<Carrier>> openCarrier(const std::string& locator) {
  std::string rest = locator;
  if (takePrefix(rest, "udp:")) {
    const std::size_t colon = rest.rfind(':');
    if (colon != std::string::npos && colon > 0 && colon + 1 < rest.size()) {
      return openUdp(locator, rest.substr(0, colon), rest.substr(colon + 1));
    }
  }
  if (takePrefix(rest, "serial:") && !rest.empty()) {
    const std::size_t colon = rest.rfind(':');
    if (colon == std::string::npos) return openSerial(locator, rest, "1000000");
    return openSerial(locator, rest.substr(0, colon), rest.substr(colon + 1));
  }
  if (takePrefix(rest, "shm:")) return openShared(locator, rest);
  return noCarrier(locator, "names no carrier", kRemedy);
}

}  // namespace wholehand
