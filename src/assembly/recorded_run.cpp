#include "assembly/recorded_run.hpp"

#include "assembly/kept_black_box.hpp"
#include "git_version.hpp"
#include "realtime/monotonic_clock.hpp"
#include "telemetry/hub.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <thread>

namespace wholehand {
namespace {

// However the run ends, the device does not stay open.
class DeviceGuard {
 public:
  explicit DeviceGuard(HapticDevice& device) : device_(device) {}
  ~DeviceGuard() { device_.close(); }
  DeviceGuard(const DeviceGuard&) = delete;
  DeviceGuard& operator=(const DeviceGuard&) = delete;

 private:
  HapticDevice& device_;
};

double rateOf(const TickSummary& summary, std::int64_t began_ns) {
  const double elapsed_s = static_cast<double>(monotonicNow_ns() - began_ns) * 1e-9;
  return elapsed_s > 0.0 ? static_cast<double>(summary.records) / elapsed_s : 0.0;
}

// What is to be kept of a run: in a recording, and in the black box.
Expected<Done> keepTrack(const Rig& rig, const RunPlan& plan, const RecordingMeta& meta,
                         std::unique_ptr<RecordingWriter>& writer,
                         std::unique_ptr<BlackBox>& black_box) {
  if (!plan.black_box.empty()) {
    auto armed = armBlackBox(rig, meta, plan.black_box, plan.duration_ticks);
    if (!armed) return armed.errors();
    black_box = std::move(*armed);
  }
  if (plan.record.empty()) return Done{};
  auto created = RecordingWriter::create(plan.record, meta);
  if (!created) return created.errors();
  writer = std::move(*created);
  return Done{};
}

// What was armed for a run that never was: the next arming finds nothing of it.
Diagnostics notRun(Rig& rig, const Diagnostics& why) {
  rig.renderer->disarm();
  return why;
}

// A recording of no tick, of a run that never was.
void discard(RecordingWriter& writer, const std::string& path) {
  writer.close();
  std::error_code ignored;
  std::filesystem::remove(path, ignored);
}

Expected<SetupReport> runInRealTime(Session& session, TelemetryHub& hub,
                                    const TickStatistics& statistics, double period_s,
                                    const std::function<void(const TickSummary&, double)>& status) {
  PeriodicThreadConfig thread;
  thread.period_ns = std::llround(period_s * 1e9);
  hub.start();
  const std::int64_t began_ns = monotonicNow_ns();
  Expected<SetupReport> setup = session.start(thread);
  if (!setup) return setup;
  while (session.running()) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    if (status) {
      const TickSummary now = statistics.snapshot();
      status(now, rateOf(now, began_ns));
    }
  }
  session.join();
  return setup;
}

// " (x 10, finger_flexion 2)": on which axes, where that is known.
std::string axesText(const TickSummary& summary, std::size_t bit,
                     const std::vector<DeviceAxis>& axes) {
  std::string text;
  for (std::size_t a = 0; a < axes.size(); ++a) {
    const std::uint64_t count = summary.fault_axes[bit][a];
    if (count == 0) continue;
    text += fmt::format("{}{}", text.empty() ? " (" : ", ", axes[a].name);
    if (count != summary.faults[bit]) text += fmt::format(" {}", count);
  }
  return text.empty() ? text : text + ")";
}

// "late tick in 2 ticks, effort limited in 1 tick (x)", of these bits; "none".
std::string countText(const TickSummary& summary, Fault bits, const std::vector<DeviceAxis>& axes) {
  std::string text;
  for (int bit = 0; bit < kFaultBits; ++bit) {
    const auto at = static_cast<std::size_t>(bit);
    const auto count = summary.faults[at];
    if (count == 0 || !any(bits & static_cast<Fault>(1U << static_cast<unsigned>(bit)))) continue;
    if (!text.empty()) text += ", ";
    text += fmt::format("{} in {} tick{}{}", faultName(bit), count, count == 1 ? "" : "s",
                        axesText(summary, at, axes));
  }
  return text.empty() ? "none" : text;
}

}  // namespace

TickSummary corrected(TickSummary summary, const SessionCounters& counted, double period_s) {
  summary.ticks = counted.ticks_run + counted.skipped_periods;
  summary.missed_deadlines = counted.skipped_periods;
  summary.faults = counted.faults;
  summary.stopping_faults = counted.stopping_faults;
  if (summary.ticks > 0) summary.time_s = static_cast<double>(summary.ticks - 1) * period_s;
  return summary;
}

Expected<RecordingMeta> describeRecording(const Rig& rig, const std::string& title,
                                          std::uint64_t seed, bool simulated_clock) {
  auto files = readFileTexts(rig.models);
  if (!files) return files.errors();
  RecordingMeta meta;
  meta.created_utc =
      fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::chrono::system_clock::now()));
  meta.git_version = WHOLEHAND_VERSION;
  meta.seed = seed;
  meta.period_s = rig.options.period_s;
  meta.engine = rig.options.engine;
  meta.simulated_clock = simulated_clock;
  meta.uncertified = !rig.refused.empty();
  meta.paper = rig.models.rendering.paper;
  meta.simulated_device = rig.device->simulated();
  meta.title = title;
  for (const DeviceAxis& axis : rig.models.device.axes) {
    meta.axis_names.push_back(axis.name);
    meta.axis_units.push_back(axis.positionUnit());
    meta.effort_limits.push_back(axis.effort_limit);
    meta.lever_arms_m.push_back(axis.lever_arm_m);
  }
  for (double q : rig.renderer->armedPosition()) meta.armed_position.push_back(q);
  meta.joint_names = rig.models.hand.joint_names;
  for (const SceneBody& body : rig.models.scene.bodies) meta.body_names.push_back(body.name);
  for (const Capsule& capsule : rig.models.hand.capsules)
    meta.capsule_names.push_back(capsule.name);
  for (const LiveParameter& parameter : rig.renderer->liveParameters()) {
    meta.parameter_names.push_back(parameter.name);
  }
  meta.parameter_values = rig.renderer->parametersAtStart();
  if (const Exercise* exercise = rig.models.exercise.get()) {
    meta.exercise = exercise->description().name;
    meta.level = exercise->description().level;
    meta.value_names = exercise->description().value_names;
    meta.event_names = exercise->description().event_names;
  }
  meta.files = std::move(*files);
  return meta;
}

std::string faultText(const TickSummary& summary, const std::vector<DeviceAxis>& axes) {
  return countText(summary, kStopping, axes);
}

std::string noticeText(const TickSummary& summary, const std::vector<DeviceAxis>& axes) {
  constexpr Fault kNoticed = Fault::kEffortLimit | Fault::kPowerLimit | Fault::kEffortSlew |
                             Fault::kTankEmpty | Fault::kLateTick | Fault::kContactsDropped;
  return countText(summary, kNoticed, axes);
}

Expected<RunOutcome> runAndRecord(Rig& rig, const RunPlan& plan) {
  const DeviceGuard device(*rig.device);  // first: closed after the session has ramped
  std::unique_ptr<RecordingWriter> writer;
  std::unique_ptr<BlackBox> black_box;
  if (!plan.record.empty() || !plan.black_box.empty()) {
    auto meta = describeRecording(rig, plan.title, plan.seed, plan.simulated_clock);
    if (!meta) return notRun(rig, meta.errors());
    if (auto begun = keepTrack(rig, plan, *meta, writer, black_box); !begun) {
      return notRun(rig, begun.errors());
    }
  }
  SessionConfig config;
  config.black_box = black_box.get();
  config.duration_ticks = plan.duration_ticks;
  config.count_allocations = plan.count_allocations;
  config.queue_ticks = plan.queue_ticks;
  config.listener = plan.listener;
  config.interrupts = &InterruptScope::shared();
  const Exercise* exercise = rig.models.exercise.get();
  if (exercise != nullptr) config.fade_out_s = exercise->description().fade_out_s;
  const InterruptScope interrupts;
  Session session(*rig.renderer, config);
  const WaitingFor disk(plan.record.empty() ? "the run to end"
                                            : "the disk: recording " + plan.record);
  TickStatistics statistics;
  RunOutcome outcome;
  if (plan.simulated_clock) {
    const std::int64_t began_ns = monotonicNow_ns();
    session.runSimulated([&](const TickRecord& record) {
      statistics.add(record);
      if (writer) writer->append(record);
      if (plan.sink) plan.sink(record);
      if (plan.status && record.tick % 256 == 0) {
        const TickSummary now = statistics.snapshot();
        plan.status(now, rateOf(now, began_ns));
      }
    });
  } else {
    TelemetryHub hub([&](TickRecord& record) { return session.tryPop(record); });
    if (writer) hub.record(*writer);
    hub.count(statistics);
    if (plan.sink) hub.add(plan.sink);
    auto setup = runInRealTime(session, hub, statistics, rig.options.period_s, plan.status);
    if (!setup) {
      hub.stop();
      if (writer) discard(*writer, plan.record);
      return setup.errors();
    }
    rig.device->close();
    hub.stop();
    outcome.setup = *setup;
    outcome.failures = hub.failures();
    outcome.dropped_writes = hub.unrecorded();
  }
  rig.device->close();  // before the disk takes its time
  if (black_box) outcome.black_box = keepBlackBox(*black_box);
  if (writer) {
    writer->close();
    outcome.written = writer->written();
    outcome.dropped_writes += writer->dropped();
    if (std::error_code unknown; !std::filesystem::exists(plan.record, unknown)) {
      outcome.failures.push_back("the recording was removed while it was written: " + plan.record);
    }
  }
  outcome.summary = statistics.snapshot();
  outcome.counters = session.counters();
  outcome.summary = corrected(outcome.summary, outcome.counters, rig.options.period_s);
  outcome.dropped_records = session.droppedRecords();
  outcome.uncertified = !rig.refused.empty();
  outcome.interrupted = InterruptScope::interrupted();
  outcome.faulted = any(outcome.counters.latched);
  return outcome;
}

}  // namespace wholehand
