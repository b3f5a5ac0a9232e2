#include "server/udp_counters.hpp"

#include <fmt/format.h>

namespace wholehand {

const char* udpIgnoredName(UdpIgnored reason) noexcept {
  static constexpr std::array<const char*, static_cast<std::size_t>(UdpIgnored::kCount)> kNames = {
      "too_short", "too_long", "magic", "version", "checksum",
      "header",    "key",      "stale", "message", "rate"};
  const auto i = static_cast<std::size_t>(reason);
  return i < kNames.size() ? kNames[i] : "";
}

std::string udpMetricsText(const UdpCounters& c) {
  std::string out;
  const auto add = [&](const char* name, const char* type, const char* help, std::uint64_t value) {
    out += fmt::format(
        "# HELP wholehand_udp_{0} {1}\n# TYPE wholehand_udp_{0} {2}\nwholehand_udp_{0} {3}\n", name,
        help, type, value);
  };
  add("games", "gauge", "Games that are heard over UDP.", c.peers);
  add("received_total", "counter", "Datagrams received.", c.received);
  add("states_total", "counter", "States sent.", c.states_sent);
  add("dropped_total", "counter", "Datagrams dropped since the socket was full.", c.dropped_full);
  add("send_errors_total", "counter", "Datagrams that the system refused to send.", c.send_errors);
  add("stops_total", "counter", "Emergency stops obeyed.", c.stops);
  add("exceptions_total", "counter", "Orders and rounds that the program gave up.", c.exceptions);
  add("games_lost_total", "counter", "Games that were not heard for a second.", c.peers_lost);
  out +=
      "# HELP wholehand_udp_ignored_total Datagrams ignored, by reason.\n"
      "# TYPE wholehand_udp_ignored_total counter\n";
  for (int i = 0; i < static_cast<int>(UdpIgnored::kCount); ++i) {
    const auto reason = static_cast<UdpIgnored>(i);
    out += fmt::format("wholehand_udp_ignored_total{{reason=\"{}\"}} {}\n", udpIgnoredName(reason),
                       c.ignoredFor(reason));
  }
  return out;
}

}  // namespace wholehand
