#include "server/traffic.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

namespace wholehand {

namespace {

/// A loop that renders and whose newest record is older than this has stalled.
constexpr double kStale_s = 1.0;

void metric(std::string& out, const char* name, const char* type, const char* help, double value) {
  out += fmt::format("# HELP wholehand_{0} {1}\n# TYPE wholehand_{0} {2}\nwholehand_{0} {3}\n",
                     name, help, type, value);
}

void byReason(std::string& out, const char* name, const char* help,
              const std::map<std::string, std::uint64_t>& counts) {
  out += fmt::format("# HELP wholehand_{0} {1}\n# TYPE wholehand_{0} counter\n", name, help);
  for (const auto& [reason, count] : counts) {
    out += fmt::format("wholehand_{}{{reason=\"{}\"}} {}\n", name, reason, count);
  }
}

// "device read failed" -> "device_read_failed"
std::string label(std::string name) {
  std::replace_if(
      name.begin(), name.end(), [](char c) { return c == ' ' || c == '-'; }, '_');
  return name;
}

void safetyMetrics(std::string& out, const LoopStatus& s) {
  out +=
      "# HELP wholehand_safety_state 1 for the state that the safety supervisor is in.\n"
      "# TYPE wholehand_safety_state gauge\n";
  for (int i = 0; i <= static_cast<int>(SafetyState::kFaulted); ++i) {
    const auto state = static_cast<SafetyState>(i);
    out += fmt::format("wholehand_safety_state{{state=\"{}\"}} {}\n", safetyStateName(state),
                       state == s.safety_state ? 1 : 0);
  }
  out +=
      "# HELP wholehand_fault_ticks_total Ticks of the session in which a reason was given.\n"
      "# TYPE wholehand_fault_ticks_total counter\n";
  for (std::size_t i = 0; i < kFaultTable.size(); ++i) {
    out += fmt::format("wholehand_fault_ticks_total{{reason=\"{}\",stops=\"{}\"}} {}\n",
                       label(kFaultTable[i].name),
                       kFaultTable[i].reaction == FaultReaction::kStops ? "yes" : "no",
                       s.fault_ticks[i]);
  }
  if (s.rehearsal_p999_us <= 0.0) return;
  out +=
      "# HELP wholehand_rehearsal_tick_cpu_seconds CPU time of a tick with the worst contacts.\n"
      "# TYPE wholehand_rehearsal_tick_cpu_seconds gauge\n";
  const std::array<std::pair<const char*, double>, 3> quantiles = {
      {{"0.5", s.rehearsal_p50_us}, {"0.999", s.rehearsal_p999_us}, {"1", s.rehearsal_max_us}}};
  for (const auto& [share, us] : quantiles) {
    out += fmt::format("wholehand_rehearsal_tick_cpu_seconds{{quantile=\"{}\"}} {}\n", share,
                       us * 1e-6);
  }
}

void loopMetrics(std::string& out, const LoopHealth& p) {
  const LoopStatus& s = p.status;
  metric(out, "ticks_total", "counter", "Ticks since the session began.",
         static_cast<double>(s.ticks));
  metric(out, "missed_deadlines_total", "counter", "Periods skipped because a tick was late.",
         static_cast<double>(s.missed_deadlines));
  metric(out, "dropped_records_total", "counter", "Records for which there was no room.",
         static_cast<double>(s.dropped_records));
  metric(out, "session", "gauge", "Counts from 1 with every arming.",
         static_cast<double>(s.session));
  metric(out, "recording_bytes", "gauge", "Of the recording under way.",
         static_cast<double>(s.recording_bytes));
  if (p.record_age_s >= 0.0) {
    metric(out, "record_age_seconds", "gauge", "Since the newest record came.", p.record_age_s);
  }
  out +=
      "# HELP wholehand_run_state 1 for the state that the loop is in.\n"
      "# TYPE wholehand_run_state gauge\n";
  for (int i = 0; i <= static_cast<int>(RunState::kFaulted); ++i) {
    const auto state = static_cast<RunState>(i);
    out += fmt::format("wholehand_run_state{{state=\"{}\"}} {}\n", runStateName(state),
                       state == s.run_state ? 1 : 0);
  }
  safetyMetrics(out, s);
  out +=
      "# HELP wholehand_tick_cpu_seconds CPU time of a tick.\n"
      "# TYPE wholehand_tick_cpu_seconds summary\n";
  const std::array<std::pair<const char*, double>, 4> quantiles = {{{"0.5", s.cpu_p50_us},
                                                                    {"0.99", s.cpu_p99_us},
                                                                    {"0.999", s.cpu_p999_us},
                                                                    {"1", s.cpu_max_us}}};
  for (const auto& [share, us] : quantiles) {
    out += fmt::format("wholehand_tick_cpu_seconds{{quantile=\"{}\"}} {}\n", share, us * 1e-6);
  }
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

const char* runStateName(RunState state) {
  constexpr std::array<const char*, 5> kNames = {"disarmed", "rendering", "stopping", "stopped",
                                                 "faulted"};
  const auto i = static_cast<std::size_t>(state);
  return i < kNames.size() ? kNames[i] : "unknown";
}

bool healthy(const LoopHealth& p) {
  if (p.status.run_state == RunState::kFaulted) return false;
  return p.status.run_state != RunState::kRendering || p.record_age_s <= kStale_s;
}

std::string healthJson(const LoopHealth& p) {
  nlohmann::json json = {{"healthy", healthy(p)},
                         {"run_state", runStateName(p.status.run_state)},
                         {"safety_state", safetyStateName(p.status.safety_state)},
                         {"session", p.status.session},
                         {"ticks", p.status.ticks},
                         {"record_age_s", nullptr}};
  if (p.record_age_s >= 0.0) json["record_age_s"] = p.record_age_s;
  return json.dump() + "\n";
}

std::string metricsText(const LoopHealth& pulse, const Traffic& t) {
  std::string out;
  loopMetrics(out, pulse);
  metric(out, "clients", "gauge", "WebSocket clients now.", static_cast<double>(t.clients));
  metric(out, "clients_total", "counter", "WebSocket clients since the start.",
         static_cast<double>(t.clients_seen));
  metric(out, "sent_bytes_total", "counter", "Written to WebSocket clients.",
         static_cast<double>(t.bytes_sent));
  metric(out, "skipped_states_total", "counter", "States that a busy client did not get.",
         static_cast<double>(t.states_skipped));
  metric(out, "dropped_events_total", "counter", "Events for which there was no room.",
         static_cast<double>(pulse.events_dropped));
  metric(out, "http_requests_total", "counter", "HTTP requests answered.",
         static_cast<double>(t.http_requests));
  byReason(out, "dropped_clients_total", "Clients cut off.", t.dropped);
  byReason(out, "refused_total", "Messages and requests refused.", t.refused);
  out +=
      "# HELP wholehand_record_to_send_seconds From a record's arrival to its written state.\n"
      "# TYPE wholehand_record_to_send_seconds summary\n";
  for (const char* share : {"0.5", "0.99", "0.999"}) {
    out += fmt::format("wholehand_record_to_send_seconds{{quantile=\"{}\"}} {}\n", share,
                       t.ageQuantile_s(std::stod(share)));
  }
  return out;
}

}  // namespace wholehand
