#include "run_text.hpp"

#include "core/printable.hpp"
#include "status_line.hpp"
#include "telemetry/fault_text.hpp"
#include "telemetry/recording.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <filesystem>

namespace wholehand {

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
  for (const Diagnostic& notice : models.scene.notices) {
    std::printf("           %s\n", format(notice).c_str());
  }
}

namespace {

// "armed at 0.000 s, rendering at 0.500 s, disarmed at 9.780 s (stop requested)"
std::string pathOf(const std::vector<SafetyTransition>& transitions) {
  std::string text;
  for (const SafetyTransition& t : transitions) {
    if (!text.empty()) text += ", ";
    text += fmt::format("{} at {:.3f} s", safetyStateName(t.to), t.time_s);
    const bool ended = t.to == SafetyState::kDisarmed || t.to == SafetyState::kFaulted;
    if (ended) text += " (" + t.cause + ")";
  }
  return text.empty() ? "nothing was armed" : text;
}

}  // namespace

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
  std::string results;
  for (const ResultValue& r : outcome.results) results += (results.empty() ? "" : "; ") + r.shown;
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

}  // namespace wholehand
