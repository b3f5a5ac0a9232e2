#include "apps/wholehand/run/run_summary.hpp"

#include "apps/wholehand/run/status_line.hpp"
#include "apps/wholehand/shared/exit_code.hpp"
#include "loop/core/printable.hpp"
#include "loop/runtime/statistics.hpp"
#include "record/recording.hpp"
#include "rig/prescribed_guides.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <filesystem>

namespace wholehand {
namespace {

// Text of the transitions: "armed at 0.000 s, rendering at 0.500 s, disarmed at 9.780 s (stop
// requested)".
std::string pathOf(const std::vector<SafetyTransition>& transitions) {
  std::string text;
  for (const SafetyTransition& t : transitions) {
    if (!text.empty()) text += ", ";
    text += fmt::format("{} at {:.3f} s", nameOf(t.to), t.time_s);
    const bool ended = t.to == SafetyState::kDisarmed || t.to == SafetyState::kFaulted;
    if (ended) text += " (" + t.cause + ")";
  }
  return text.empty() ? "nothing was armed" : text;
}

nlohmann::ordered_json transitionJson(const DeviceModel& device, const SafetyTransition& t) {
  nlohmann::ordered_json json = {{"tick", t.tick},
                                 {"time_s", t.time_s},
                                 {"from", nameOf(t.from)},
                                 {"to", nameOf(t.to)},
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

/// What holds a person back in this run: a device may bear less than the prescription asks.
void printPrescription(const Models& models) {
  const Prescription& prescription = *models.prescription;
  const PersonGuidesConfig guides = guidesOf(models, models.files.period_s);
  std::vector<std::string> parts;
  for (const Prescription::Limit& limit : prescription.limits) {
    const DeviceAxis& axis = models.device.axes[limit.axis];
    const bool turns = axis.kind == AxisKind::kRotation;
    const double scale = turns ? 1.0 / kDeg : 1e3;
    const double stiffness = guides.walls.stiffness[limit.axis];
    const std::string wall = stiffness > 0.0
                                 ? fmt::format("{:.3g} {}", stiffness, turns ? "N·m/rad" : "N/m")
                                 : "no wall: the device bears none";
    parts.push_back(fmt::format("{} {:.0f} to {:.0f}{} ({})", axis.name, scale * limit.lower,
                                scale * limit.upper, turns ? "°" : " mm", wall));
  }
  if (prescription.corridor) {
    const double asked = prescription.corridor->stiffness_n_m;
    const double is = guides.corridor ? guides.corridor->stiffness_n_m : 0.0;
    const bool whole = is >= asked * (1.0 - 1e-9);
    parts.push_back(
        fmt::format("corridor {:.3g} N/m{}", is,
                    whole ? "" : fmt::format(" of {:.3g}: the device bears no more", asked)));
  }
  std::printf("  allowed  %s: %s\n", printable(prescription.name).c_str(),
              fmt::format("{}", fmt::join(parts, "; ")).c_str());
  const Eigen::Vector3d mm = (1e3 * models.exercise_moved_m).array().round() + 0.0;
  if (mm.isZero()) return;
  std::printf("  placed   within them: the scene is moved by x %.0f, y %.0f, z %.0f mm\n", mm.x(),
              mm.y(), mm.z());
}

}  // namespace

std::string titleOf(const Models& models) {
  if (models.exercise) {
    const ExerciseDescription& exercise = models.exercise->description();
    return fmt::format("{}, level {} of {}", exercise.name, exercise.level, exercise.levels);
  }
  if (models.files.motion.empty()) return models.scene.name;
  return models.scene.name + ", " + std::filesystem::path(models.files.motion).stem().string();
}

void printOpening(const Models& models, bool real_device) {
  std::printf("Wholehand: %s\n", printable(titleOf(models)).c_str());
  const std::string mover =
      real_device ? std::string("a person moves it") : "simulated; patient " + models.patient.name;
  std::printf("  device   %s, %d %s, %s\n", models.device.name.c_str(), models.device.axisCount(),
              models.device.axisCount() == 1 ? "axis" : "axes", mover.c_str());
  std::printf("  hand     %s, %d joints, %zu capsules; scene %s, %zu %s\n",
              models.hand.name.c_str(), models.hand.joint_count, models.hand.capsules.size(),
              models.scene.name.c_str(), models.scene.bodies.size(),
              models.scene.bodies.size() == 1 ? "body" : "bodies");
  constexpr int kBelowTheScene = 11;
  printNotices(models.scene.notices, kBelowTheScene);
  if (models.prescription) printPrescription(models);
  if (!models.prescription && !models.files.prescription.empty()) {
    std::printf("  allowed  own movement is measured without the limits of %s\n",
                printable(models.files.prescription).c_str());
  }
}

void printSummary(const RunOptions& options, const Models& models, const RunOutcome& outcome,
                  const RunSafety& safety) {
  const TickSummary& s = outcome.summary;
  std::printf("\n%s after %.2f s: %llu ticks, %llu deadline%s missed\n",
              outcome.faulted       ? "Stopped by a fault"
              : outcome.interrupted ? "Interrupted"
                                    : "Done",
              s.time_s, static_cast<unsigned long long>(s.ticks),
              static_cast<unsigned long long>(s.missed_deadlines), plural(s.missed_deadlines));
  std::printf("  tick     %.0f µs CPU at the median, %.0f p99, %.0f p99.9, %.0f at most\n",
              s.cpu.p50_ns / 1e3, s.cpu.p99_ns / 1e3, s.cpu.p999_ns / 1e3, s.cpu.max_ns / 1e3);
  std::printf("  force    largest %s; at most %d contact%s at once\n",
              largestEffort(models.device, s.max_effort).c_str(), s.contacts_max,
              plural(s.contacts_max));
  std::printf("  work     %.3g J of the device\n", s.work_j);
  std::string results;
  for (const ResultValue& r : outcome.results) {
    if (!r.shown.empty()) results += (results.empty() ? "" : "; ") + r.shown;
  }
  if (!results.empty()) std::printf("  result   %s\n", printable(results, 1000).c_str());
  const std::vector<DeviceAxis>& axes = models.device.axes;
  std::printf("  faults   %s\n", faultText(s, axes).c_str());
  std::printf("  safety   %s\n", pathOf(safety.transitions).c_str());
  if (noticeText(s) != "none") std::printf("  noticed  %s\n", noticeText(s, axes).c_str());
  if (outcome.dropped_records + outcome.dropped_writes > 0) {
    std::printf("  dropped  %llu record%s: %s\n",
                static_cast<unsigned long long>(outcome.dropped_records + outcome.dropped_writes),
                plural(outcome.dropped_records + outcome.dropped_writes),
                !outcome.failures.empty()    ? "see what failed"
                : outcome.dropped_writes > 0 ? "the disk was full, refused them or was too slow"
                                             : "the queue was full");
  }
  for (const std::string& failure : outcome.failures) {
    std::printf("  FAILED   %s; it was switched off, the loop ran on\n",
                printable(failure, 1000).c_str());
  }
  if (!outcome.black_box.empty()) {
    std::printf("  black box  %s\n", printable(outcome.black_box, 1000).c_str());
  }
  if (!options.record.empty()) {
    std::printf("  recorded %s\n", printable(options.record).c_str());
    for (const std::string& part : recordingParts(options.record)) {
      std::printf("           %s, after an error of the disk\n", printable(part).c_str());
    }
  }
  if (!options.report.empty())
    std::printf("  report   %s/index.html\n", printable(options.report).c_str());
}

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
  json["work_j"] = s.work_j;
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
