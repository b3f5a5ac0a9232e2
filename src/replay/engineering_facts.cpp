#include "replay/engineering_facts.hpp"

#include "replay/recorded_scene.hpp"

#include <algorithm>
#include <cstddef>

namespace wholehand {
namespace {

using Json = nlohmann::json;

/// Bin width as a fraction of the period; up to three periods and one overflow bin.
constexpr double kStep = 0.01;
constexpr std::size_t kSteps = 301;

Json percentilesJson(const Percentiles& p) {
  return {{"p50_s", 1e-9 * p.p50_ns},
          {"p99_s", 1e-9 * p.p99_ns},
          {"p999_s", 1e-9 * p.p999_ns},
          {"max_s", 1e-9 * p.max_ns}};
}

/// Faults that occurred, with their most frequent axis.
Json faultsJson(const TickSummary& summary, const RecordingMeta& meta) {
  Json faults = Json::array();
  for (std::size_t bit = 0; bit < kFaultTable.size(); ++bit) {
    if (summary.faults[bit] == 0) continue;
    const auto& counts = summary.fault_axes[bit];
    const auto most = std::max_element(counts.begin(), counts.end());
    const std::size_t axis = most - counts.begin();
    const bool has_axis = *most > 0 && axis < meta.axis_names.size();
    faults.push_back({{"name", kFaultTable[bit].name},
                      {"ticks", summary.faults[bit]},
                      {"stops", kFaultTable[bit].reaction == FaultReaction::kStops},
                      {"axis", has_axis ? meta.axis_names[axis] : std::string()}});
  }
  return faults;
}

Json settingsJson(const RecordingMeta& meta) {
  return {{"scene", embeddedName(meta, "scene")},
          {"rendering", embeddedName(meta, "rendering")},
          {"engine", meta.engine},
          {"simulated_clock", meta.simulated_clock},
          {"paper", meta.paper},
          {"uncertified", meta.uncertified},
          {"passport", meta.passport},
          {"seed", std::to_string(meta.seed)}};  // as text: JavaScript numbers cannot hold 64 bits
}

}  // namespace

EngineeringFacts::EngineeringFacts(const RecordingMeta& meta)
    : meta_(meta), wall_(kSteps, 0), cpu_(kSteps, 0) {}

void EngineeringFacts::add(const TickRecord& record) {
  statistics_.add(record);
  const auto step = [this](std::int64_t ns) {
    const double steps = static_cast<double>(ns) * 1e-9 / meta_.period_s / kStep;
    return static_cast<std::size_t>(std::clamp(steps, 0.0, static_cast<double>(kSteps - 1)));
  };
  ++wall_[step(record.wall_ns)];
  ++cpu_[step(record.cpu_ns)];
  ++records_;
  if (std::any_of(record.phi.begin(), record.phi.end(), [](double v) { return v > 0.5; })) {
    ++damped_;
  }
}

Json EngineeringFacts::timesJson(const TickSummary& summary) const {
  const bool is_cpu = meta_.simulated_clock || summary.wall.max_ns <= 0.0;
  Json stages = Json::array();
  for (int i = 0; i < kStages; ++i) {
    Json stage = percentilesJson(summary.stage_cpu[i]);
    stage["name"] = stageName(static_cast<Stage>(i));
    stages.push_back(std::move(stage));
  }
  return {{"is_cpu", is_cpu},
          {"tick", percentilesJson(is_cpu ? summary.cpu : summary.wall)},
          {"tick_cpu", percentilesJson(summary.cpu)},
          {"stages", stages},
          {"step_s", kStep * meta_.period_s},
          {"counts", is_cpu ? cpu_ : wall_}};
}

Json EngineeringFacts::json() const {
  const TickSummary summary = statistics_.snapshot();
  const double records = std::max<double>(1.0, static_cast<double>(records_));
  return {
      {"records", summary.records},
      {"missed_deadlines", summary.missed_deadlines},
      {"stopping_faults", summary.stopping_faults},
      {"faults", faultsJson(summary, meta_)},
      {"largest_effort", std::vector<double>(summary.max_effort.begin(), summary.max_effort.end())},
      {"contacts_max", summary.contacts_max},
      {"coupling_error_rad", summary.max_coupling_error_rad},
      {"damped_share", static_cast<double>(damped_) / records},
      {"times", timesJson(summary)},
      {"settings", settingsJson(meta_)}};
}

}  // namespace wholehand
