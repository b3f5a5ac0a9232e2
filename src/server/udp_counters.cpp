#include "server/udp_counters.hpp"

namespace wholehand {

const char* udpIgnoredName(UdpIgnored reason) noexcept {
  static constexpr std::array<const char*, static_cast<std::size_t>(UdpIgnored::kCount)> kNames = {
      "too_short", "too_long",     "magic",   "version", "length", "checksum",
      "header",    "unknown_peer", "token",   "schema",  "hello",  "session",
      "replayed",  "fragment",     "message", "command"};
  const auto i = static_cast<std::size_t>(reason);
  return i < kNames.size() ? kNames[i] : "";
}

}  // namespace wholehand
