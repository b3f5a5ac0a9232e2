#include "summary_json.hpp"

namespace wholehand {
nlohmann::ordered_json microseconds(const Percentiles& p) {
  return {{"p50", p.p50_ns / 1e3},
          {"p99", p.p99_ns / 1e3},
          {"p999", p.p999_ns / 1e3},
          {"max", p.max_ns / 1e3}};
}

nlohmann::ordered_json summaryJson(const DeviceModel& device, const RunOutcome& outcome) {
  const TickSummary& s = outcome.summary;
  nlohmann::ordered_json json;
  json["ticks"] = s.ticks;
  json["missed_deadlines"] = s.missed_deadlines;
  json["faults"] = s.stopping_faults;
  json["faulted"] = outcome.faulted;
  for (int bit = 0; bit < kFaultBits; ++bit) {
    const auto count = s.faults[static_cast<std::size_t>(bit)];
    if (count > 0) json["fault_ticks"][faultName(bit)] = count;
  }
  for (int a = 0; a < s.max_effort.size(); ++a) {
    json["max_effort"][device.axes[a].name] = s.max_effort[a];
  }
  json["contacts_max"] = s.contacts_max;
  json["max_coupling_error_rad"] = s.max_coupling_error_rad;
  json["cpu_us"] = microseconds(s.cpu);
  json["wall_us"] = microseconds(s.wall);
  json["records_dropped"] = outcome.dropped_records + outcome.dropped_writes;
  if (!outcome.failures.empty()) json["telemetry_failures"] = outcome.failures;
  json["interrupted"] = outcome.interrupted;
  return json;
}

}  // namespace wholehand
