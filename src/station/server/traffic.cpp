#include "station/server/traffic.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

namespace wholehand {

namespace {

/// Age of the newest record above which a rendering loop counts as stalled [s].
constexpr double kStale_s = 1.0;

void head(std::string& out, const char* name, const char* type, const char* help) {
  out += fmt::format("# HELP wholehand_{0} {1}\n# TYPE wholehand_{0} {2}\n", name, help, type);
}

void metric(std::string& out, const char* name, const char* type, const char* help, auto value) {
  head(out, name, type, help);
  out += fmt::format("wholehand_{} {}\n", name, static_cast<double>(value));
}

void line(std::string& out, const char* name, const char* label, const auto& of, auto value) {
  out += fmt::format("wholehand_{}{{{}=\"{}\"}} {}\n", name, label, of, value);
}

void byReason(std::string& out, const char* name, const char* help,
              const std::map<std::string, std::uint64_t>& counts) {
  head(out, name, "counter", help);
  for (const auto& [reason, count] : counts) line(out, name, "reason", reason, count);
}

// Makes a metric label: "device read failed" -> "device_read_failed".
std::string label(std::string name) {
  std::replace_if(
      name.begin(), name.end(), [](char c) { return c == ' ' || c == '-'; }, '_');
  return name;
}

/// Writes a gauge per state: 1 for the present state, 0 for the others.
template <class State>
void byState(std::string& out, const char* name, const char* help, State now, int states) {
  head(out, name, "gauge", help);
  for (int i = 0; i < states; ++i) {
    const auto state = static_cast<State>(i);
    line(out, name, "state", nameOf(state), state == now ? 1 : 0);
  }
}

using Quantiles = std::initializer_list<std::pair<const char*, double>>;

void tickMetric(std::string& out, const char* name, const char* type, const char* help,
                Quantiles cpu_us) {
  head(out, name, type, help);
  for (const auto& [share, us] : cpu_us) line(out, name, "quantile", share, us * 1e-6);
}

void safetyMetrics(std::string& out, const LoopStatus& s) {
  byState(out, "safety_state", "1 for the state that the safety supervisor is in.", s.safety_state,
          kSafetyStates);
  head(out, "fault_ticks_total", "counter", "Ticks of the session in which a reason was given.");
  for (std::size_t i = 0; i < kFaultTable.size(); ++i) {
    out += fmt::format("wholehand_fault_ticks_total{{reason=\"{}\",stops=\"{}\"}} {}\n",
                       label(kFaultTable[i].name),
                       kFaultTable[i].reaction == FaultReaction::kStops ? "yes" : "no",
                       s.fault_ticks[i]);
  }
  if (s.rehearsal_p999_us <= 0.0) return;
  tickMetric(
      out, "rehearsal_tick_cpu_seconds", "gauge", "CPU time of a tick with the worst contacts.",
      {{"0.5", s.rehearsal_p50_us}, {"0.999", s.rehearsal_p999_us}, {"1", s.rehearsal_max_us}});
}

void loopMetrics(std::string& out, const LoopHealth& p) {
  const LoopStatus& s = p.status;
  metric(out, "ticks_total", "counter", "Ticks since the session began.", s.ticks);
  metric(out, "missed_deadlines_total", "counter", "Periods skipped because a tick was late.",
         s.missed_deadlines);
  metric(out, "dropped_records_total", "counter", "Records for which there was no room.",
         s.dropped_records);
  metric(out, "session", "gauge", "Counts from 1 with every arming.", s.session);
  metric(out, "recording_bytes", "gauge", "Of the recording under way.", s.recording_bytes);
  if (p.record_age_s >= 0.0) {
    metric(out, "record_age_seconds", "gauge", "Since the newest record came.", p.record_age_s);
  }
  metric(out, "loop_silent", "gauge", "1 while the loop or the device does not answer.",
         s.silent ? 1 : 0);
  byState(out, "run_state", "1 for the state that the loop is in.", s.run_state, kRunStates);
  safetyMetrics(out, s);
  tickMetric(out, "tick_cpu_seconds", "summary", "CPU time of a tick.",
             {{"0.5", s.cpu_p50_us},
              {"0.99", s.cpu_p99_us},
              {"0.999", s.cpu_p999_us},
              {"1", s.cpu_max_us}});
}

}  // namespace

void Traffic::addAge(std::int64_t age_ns) {
  ages_ns_[age_count_ % ages_ns_.size()] = age_ns;
  ++age_count_;
}

double Traffic::ageQuantile_s(double share) const {
  const std::size_t n = std::min<std::uint64_t>(age_count_, ages_ns_.size());
  if (n == 0) return 0.0;
  std::vector<std::int64_t> sorted(ages_ns_.begin(),
                                   ages_ns_.begin() + static_cast<std::ptrdiff_t>(n));
  std::sort(sorted.begin(), sorted.end());
  const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(n)));
  return 1e-9 * static_cast<double>(sorted[std::clamp<std::size_t>(rank, 1, n) - 1]);
}

bool healthy(const LoopHealth& p) {
  if (p.status.silent || p.status.run_state == RunState::kFaulted) return false;
  return p.status.run_state != RunState::kRendering || p.record_age_s <= kStale_s;
}

std::string healthJson(const LoopHealth& p) {
  nlohmann::json json = {{"healthy", healthy(p)},
                         {"run_state", nameOf(p.status.run_state)},
                         {"safety_state", nameOf(p.status.safety_state)},
                         {"session", p.status.session},
                         {"ticks", p.status.ticks},
                         {"record_age_s", nullptr},
                         {"loop_age_s", nullptr},
                         {"alarm", nullptr}};
  if (p.record_age_s >= 0.0) json["record_age_s"] = p.record_age_s;
  if (p.status.loop_age_s >= 0.0) json["loop_age_s"] = p.status.loop_age_s;
  if (const char* alarm = alarmOf(p.status)) json["alarm"] = alarm;
  return json.dump() + "\n";
}

std::string metricsText(const LoopHealth& pulse, const Traffic& t) {
  std::string out;
  loopMetrics(out, pulse);
  metric(out, "clients", "gauge", "WebSocket clients now.", t.clients);
  metric(out, "clients_total", "counter", "WebSocket clients since the start.", t.clients_seen);
  metric(out, "sent_bytes_total", "counter", "Written to WebSocket clients.", t.bytes_sent);
  metric(out, "skipped_states_total", "counter", "States that a busy client did not get.",
         t.states_skipped);
  metric(out, "dropped_events_total", "counter", "Events for which there was no room.",
         pulse.events_dropped);
  metric(out, "http_requests_total", "counter", "HTTP requests answered.", t.http_requests);
  byReason(out, "dropped_clients_total", "Clients cut off.", t.dropped);
  byReason(out, "refused_total", "Messages and requests refused.", t.refused);
  const char* const sent = "record_to_send_seconds";
  head(out, sent, "summary", "From a record's arrival to its written state.");
  for (const char* share : {"0.5", "0.99", "0.999"}) {
    line(out, sent, "quantile", share, t.ageQuantile_s(std::stod(share)));
  }
  return out;
}

const char* udpIgnoredName(UdpIgnored reason) noexcept {
  static constexpr std::array<const char*, static_cast<std::size_t>(UdpIgnored::kCount)> kNames = {
      "too_short", "too_long", "magic", "version", "checksum",
      "header",    "key",      "stale", "message", "rate"};
  const auto i = static_cast<std::size_t>(reason);
  return i < kNames.size() ? kNames[i] : "";
}

std::string udpMetricsText(const UdpCounters& c) {
  std::string out;
  metric(out, "udp_games", "gauge", "Games that are heard over UDP.", c.peers.load());
  const auto count = [&](const char* name, const char* help, const UdpCounters::Counter& of) {
    metric(out, name, "counter", help, of.load());
  };
  count("udp_received_total", "Datagrams received.", c.received);
  count("udp_states_total", "States sent.", c.states_sent);
  count("udp_dropped_total", "Datagrams dropped since the socket was full.", c.dropped_full);
  count("udp_send_errors_total", "Datagrams that the system refused to send.", c.send_errors);
  count("udp_stops_total", "Emergency stops obeyed.", c.stops);
  count("udp_exceptions_total", "Orders and rounds that the program gave up.", c.exceptions);
  count("udp_games_lost_total", "Games that were not heard for a second.", c.peers_lost);
  head(out, "udp_ignored_total", "counter", "Datagrams ignored, by reason.");
  for (int i = 0; i < static_cast<int>(UdpIgnored::kCount); ++i) {
    const auto reason = static_cast<UdpIgnored>(i);
    line(out, "udp_ignored_total", "reason", udpIgnoredName(reason), c.ignoredFor(reason));
  }
  return out;
}

}  // namespace wholehand
