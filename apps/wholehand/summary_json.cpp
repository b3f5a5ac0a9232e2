#include "summary_json.hpp"

namespace wholehand {
namespace {

nlohmann::ordered_json transitionJson(const DeviceModel& device, const SafetyTransition& t) {
  nlohmann::ordered_json json = {{"tick", t.tick},
                                 {"time_s", t.time_s},
                                 {"from", safetyStateName(t.from)},
                                 {"to", safetyStateName(t.to)},
                                 {"cause", t.cause}};
  for (const FaultFacts& fault : kFaultTable) {
    if (any(t.faults & fault.bit)) json["reasons"].push_back(fault.name);
  }
  if (t.axis >= 0) json["axis"] = device.axes[t.axis].name;
  if (t.limit != 0.0) {
    json["value"] = t.value;
    json["limit"] = t.limit;
    json["unit"] = t.unit;
  }
  return json;
}

nlohmann::ordered_json rehearsalJson(const Rehearsal& r) {
  return {{"cpu_us", microseconds(r.summary.cpu)},
          {"limit_us", r.limit_us},
          {"slowest_stage", stageName(r.slowest)},
          {"heaviest_body", r.heaviest},
          {"contacts_max", r.summary.contacts_max},
          {"bodies", r.bodies},
          {"bodies_touched", r.bodies_touched},
          {"ticks", r.summary.records},
          {"attempts", r.attempts}};
}

}  // namespace

nlohmann::ordered_json microseconds(const Percentiles& p) {
  return {{"p50", p.p50_ns / 1e3},
          {"p99", p.p99_ns / 1e3},
          {"p999", p.p999_ns / 1e3},
          {"max", p.max_ns / 1e3}};
}

nlohmann::ordered_json summaryJson(const DeviceModel& device, const RunOutcome& outcome,
                                   const RunSafety& safety) {
  const TickSummary& s = outcome.summary;
  nlohmann::ordered_json json;
  json["engine"] = outcome.engine;
  json["ticks"] = s.ticks;
  json["missed_deadlines"] = s.missed_deadlines;
  json["faults"] = s.stopping_faults;
  json["faulted"] = outcome.faulted;
  if (!outcome.exercise.empty()) {
    json["exercise"] = {{"name", outcome.exercise}, {"level", outcome.level}};
    auto& results = json["exercise"]["results"] = nlohmann::ordered_json::object();
    for (const ResultValue& result : outcome.results) results[result.name] = result.value;
  }
  for (int bit = 0; bit < kFaultBits; ++bit) {
    const auto at = static_cast<std::size_t>(bit);
    if (s.faults[at] > 0) json["fault_ticks"][faultName(bit)] = s.faults[at];
    for (std::size_t a = 0; a < device.axes.size(); ++a) {
      const std::uint64_t count = s.fault_axes[at][a];
      if (count > 0) json["fault_axes"][faultName(bit)][device.axes[a].name] = count;
    }
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
  json["uncertified"] = outcome.uncertified;
  json["interrupted"] = outcome.interrupted;
  json["safety"] = nlohmann::ordered_json::array();
  for (const SafetyTransition& t : safety.transitions) {
    json["safety"].push_back(transitionJson(device, t));
  }
  if (safety.rehearsal) json["rehearsal"] = rehearsalJson(*safety.rehearsal);
  return json;
}

}  // namespace wholehand
