#include "rig/run/run.hpp"

#include "files/text/text_file.hpp"
#include "loop/core/printable.hpp"
#include "loop/realtime/monotonic_clock.hpp"
#include "loop/realtime/thread_setup.hpp"
#include "loop/runtime/interrupt_scope.hpp"
#include "rig/arming.hpp"
#include "rig/models.hpp"
#include "rig/program_version.hpp"

#include <fmt/chrono.h>
#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <thread>
#include <utility>

namespace wholehand {

namespace {

constexpr std::chrono::milliseconds kStatusEvery{20};
constexpr std::uint64_t kStatusTicks = 256;  // status interval on the simulated clock

double rateOf(const TickSummary& summary, std::int64_t began_ns) {
  const double elapsed_s = static_cast<double>(monotonicNow_ns() - began_ns) * 1e-9;
  return elapsed_s > 0.0 ? static_cast<double>(summary.records) / elapsed_s : 0.0;
}

// Requests real-time priority on a temporary thread, before the device is enabled.
Diagnostics refuseWithoutRealTime() {
  SetupReport report;
  std::thread([&report] {
    report = {requestFifoPriority(ThreadSetupConfig{}.fifo_priority), requestLockedMemory()};
  }).join();
  Diagnostics refused;
  for (const SetupLine& line : report) {
    if (line.granted) continue;
    refused.push_back(keyFault("", line.what, "",
                               "a loop that moves a person needs it: " + line.sentence,
                               "run wholehand doctor"));
  }
  return refused;
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

Expected<std::unique_ptr<Run>> Run::prepare(std::shared_ptr<Rig> rig, RunPlan plan) {
  std::unique_ptr<Run> run(new Run(std::move(rig), std::move(plan)));
  if (auto ready = run->rig_->renderer->prepare(run->plan_.rehearsed); !ready) {
    run->finished_ = true;  // the run never began
    return ready.errors();
  }
  if (Expected<Done> kept = run->keepTrack(); !kept) {
    run->rig_->renderer->disarm();  // leaves no state for the next arm()
    run->finish();
    return kept.errors();
  }
  run->startSession();
  return Expected<std::unique_ptr<Run>>(std::move(run));
}

Expected<Done> Run::keepTrack() {
  if (plan_.record.empty() && plan_.black_box.empty()) return Done{};
  auto meta = describeRecording(*rig_, plan_.title, plan_.seed, plan_.simulated_clock);
  if (!meta) return meta.errors();
  meta->profile = printable(plan_.profile);
  meta->clinic_visit = plan_.visit;
  meta->clinic_item = plan_.visit_item;
  if (!plan_.black_box.empty()) {
    const std::uint64_t most_ticks =
        plan_.duration_ticks > 0 ? plan_.duration_ticks : std::numeric_limits<std::uint64_t>::max();
    auto armed = armBlackBox(*rig_, *meta, plan_.black_box, most_ticks);
    if (!armed) return armed.errors();
    black_box_ = std::move(*armed);
  }
  if (plan_.record.empty()) return Done{};
  const WaitingFor disk("the disk: recording " + plan_.record);
  auto created = RecordingWriter::create(plan_.record, *meta);
  if (!created) return created.errors();
  writer_ = std::move(*created);
  return Done{};
}

void Run::startSession() {
  SessionConfig config;
  config.listener = rig_->listener.get();
  config.black_box = black_box_.get();
  config.interrupts = plan_.interrupts;
  config.permit = plan_.permit.get();
  config.queue_bytes = plan_.queue_bytes;
  config.count_allocations = plan_.count_allocations;
  if (plan_.duration_ticks > 0) config.duration_ticks = plan_.duration_ticks;
  session_ = std::make_unique<Session>(*rig_->renderer, config);
  hub_ = std::make_unique<TelemetryHub>(
      [this](TickRecord& record) { return session_->tryPop(record); });
  if (writer_) hub_->record(*writer_);
  hub_->count(statistics_);
  for (const auto& sink : plan_.sinks) hub_->add(sink);
  if (black_box_) hub_->add([box = black_box_.get()](const TickRecord&) { box->provideMemory(); });
}

Expected<Done> Run::begin() {
  hub_->start();
  if (plan_.real_time_required) {
    if (Diagnostics refused = refuseWithoutRealTime(); !refused.empty()) return refused;
  }
  if (auto armed = rig_->renderer->arm(); !armed) return armed;
  PeriodicThreadConfig thread;
  thread.period_ns = std::llround(rig_->options.period_s * 1e9);
  Expected<SetupReport> setup = session_->start(thread);
  if (!setup) return setup.errors();
  setup_ = std::move(*setup);
  return Done{};
}

Expected<Done> Run::simulate() {
  if (auto armed = rig_->renderer->arm(); !armed) return armed;
  session_->runSimulated([this](const TickRecord& record) {
    statistics_.add(record);
    if (writer_) writer_->append(record);
    for (const auto& sink : plan_.sinks) sink(record);
  });
  return Done{};
}

Run::~Run() {
  if (session_ && session_->running()) session_->requestStop();
  finish();
}

void Run::finish() {
  if (std::exchange(finished_, true)) return;
  if (session_) session_->join();
  rig_->device->close();
  const WaitingFor disk("the disk: " +
                        (plan_.record.empty() ? "black box" : "recording " + plan_.record));
  if (black_box_) black_box_said_ = writeBlackBoxIfNeeded(*black_box_);
  if (hub_) {
    hub_->stop();
    failures_ = hub_->failures();
  }
  black_box_.reset();  // releases its memory and its crash handler
  if (writer_) closeRecording();
}

void Run::closeRecording() {
  writer_->close();
  std::error_code unknown;
  if (!session_ || session_->counters().ticks_run == 0) {
    std::filesystem::remove(plan_.record, unknown);
  } else if (!std::filesystem::exists(plan_.record, unknown)) {
    failures_.push_back("the recording was removed while it was written: " + plan_.record);
  }
}

RunOutcome Run::outcome() const {
  RunOutcome outcome;
  outcome.counters = session_->counters();
  outcome.summary = corrected(statistics_.snapshot(), outcome.counters, rig_->options.period_s);
  if (const Exercise* exercise = rig_->models.exercise.get()) {
    outcome.exercise = exercise->description().name;
    outcome.level = exercise->description().level;
    outcome.results = exerciseResults(rig_->models, outcome.summary);
  }
  outcome.dropped_records = session_->droppedRecords();
  outcome.dropped_writes = hub_->unrecorded() + (writer_ ? writer_->dropped() : 0);
  outcome.written = writer_ ? writer_->written() : 0;
  outcome.failures = failures_;
  outcome.setup = setup_;
  outcome.black_box = black_box_said_;
  outcome.engine = rig_->options.engine;
  outcome.uncertified = !rig_->refused.empty();
  outcome.interrupted = plan_.interrupts != nullptr && plan_.interrupts->asked.load() > 0;
  outcome.faulted = any(outcome.counters.latched);
  return outcome;
}

std::string lossNotice(double time_s, const std::string& record) {
  return fmt::format("the disk accepts no more data: from {:.1f} s on ticks are missing in {}",
                     time_s, record);
}

Expected<RunOutcome> runAndRecord(Rig& rig, RunPlan plan) {
  const WaitingFor end("the run to end");
  const bool simulated_clock = plan.simulated_clock;
  const auto status = plan.status;
  const auto notice = plan.notice;
  const std::string record = plan.record;
  const std::int64_t began_ns = monotonicNow_ns();
  Run* running = nullptr;
  bool loss_reported = false;
  // Reports progress and, once, lost ticks.
  const auto report = [&] {
    if (!status && !notice) return;
    const TickSummary now = running->summary();
    if (status) status(now, rateOf(now, began_ns));
    if (!notice || record.empty() || loss_reported || running->droppedRecords() == 0) return;
    loss_reported = true;
    notice(lossNotice(now.time_s, record));
  };
  if (simulated_clock) {
    plan.sinks.emplace_back([&](const TickRecord& tick) {
      if (tick.tick % kStatusTicks == 0) report();
    });
  }
  auto run = Run::prepare({std::shared_ptr<Rig>(), &rig}, std::move(plan));
  if (!run) return run.errors();
  running = run->get();
  if (simulated_clock) {
    if (auto ran = running->simulate(); !ran) return ran.errors();
  } else {
    if (auto begun = running->begin(); !begun) return begun.errors();
    while (running->running()) {
      std::this_thread::sleep_for(kStatusEvery);
      report();
    }
  }
  running->finish();
  return running->outcome();
}

std::vector<ResultValue> exerciseResults(const Models& models, const TickSummary& summary) {
  std::vector<ResultValue> out;
  if (!models.exercise) return out;
  const std::vector<std::string>& names = models.exercise->description().value_names;
  for (const PanelValue& reported : models.exercise_panel.values) {
    const auto at = std::find(names.begin(), names.end(), reported.name) - names.begin();
    if (!reported.result || at >= summary.value_count) continue;
    const double value = summary.values[at];
    if (!std::isfinite(value)) continue;  // not measured
    std::string shown =
        fmt::format("{} {:.{}f}", reported.label.en, value * reported.factor, reported.decimals);
    if (!reported.unit.empty()) shown += " " + reported.unit;
    out.push_back({reported.name, value, std::move(shown)});
  }
  return out;
}

namespace fs = std::filesystem;
namespace {

/// True when the files on disk still match the models that the rig renders.
bool printRendered(const ModelFiles& files, const Rig& rig) {
  const auto again = loadModels(files);
  if (!again) return false;
  const auto& now = again->prescription;
  const auto& then = rig.models.prescription;
  if (now.has_value() != then.has_value() || (now && !now->sameAs(*then))) return false;
  const auto certified = fingerprintOf(certificateInput(*again, rig.options.period_s));
  return rehearsalFingerprint(*again, rig.options, certified) == rig.renderer->config().rehearsal;
}

}  // namespace

void describeAxes(const DeviceModel& device, RecordingMeta& meta) {
  for (const DeviceAxis& axis : device.axes) {
    meta.axis_names.push_back(axis.name);
    meta.axis_units.push_back(axis.positionUnit());
    meta.effort_limits.push_back(axis.effort_limit);
    meta.lever_arms_m.push_back(axis.lever_arm_m);
    meta.encoder_step.push_back(axis.encoder_step);
  }
}

Expected<RecordingMeta> describeRecording(const Rig& rig, const std::string& title,
                                          std::uint64_t seed, bool simulated_clock) {
  auto files = readFileTexts(rig.models);
  if (!files) return files.errors();
  RecordingMeta meta;
  meta.created_utc =
      fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::chrono::system_clock::now()));
  meta.git_version = programVersion();
  meta.seed = seed;
  meta.period_s = rig.options.period_s;
  meta.engine = rig.options.engine;
  meta.simulated_clock = simulated_clock;
  meta.uncertified = !rig.refused.empty();
  meta.paper = rig.models.rendering.paper;
  meta.models_changed = !printRendered(rig.models.files, rig);
  meta.simulated_device = rig.device->simulated();
  meta.passport = rig.options.passport;
  meta.title = printable(title);
  describeAxes(rig.models.device, meta);
  for (double q : rig.renderer->armedPosition()) meta.armed_position.push_back(q);
  meta.joint_names = rig.models.hand.joint_names;
  meta.body_names = rig.models.scene.recordedBodies();
  for (const int body : rig.models.scene.recordedJoints()) {
    const SceneBody& on = rig.models.scene.bodies[body];
    meta.body_joint_names.push_back(on.name);
    meta.body_joint_units.emplace_back(on.joint->isHinge() ? "rad" : "m");
  }
  meta.game_slots = static_cast<std::uint64_t>(rig.models.scene.game.slots);
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
    for (const PanelValue& value : rig.models.exercise_panel.values) {
      if (!value.result) continue;
      meta.result_names.push_back(value.name);
      meta.result_labels.push_back(value.label.en);
      meta.result_units.push_back(value.unit);
      meta.result_factors.push_back(value.factor);
      meta.result_decimals.push_back(value.decimals);
    }
  }
  meta.files = std::move(*files);
  if (!rig.options.passport_text.empty()) {
    meta.files.emplace_back(kRecordedPassport, rig.options.passport_text);
  }
  if (!rig.options.measured.empty()) {
    meta.files.emplace_back(kRecordedDelay,
                            fmt::format("kind = \"arming-delay\"\nversion = 1\nperiods = {}\n",
                                        rig.options.measured[0].output_delay_ticks));
  }
  return meta;
}

std::string blackBoxPath(const std::string& recording) {
  if (fs::path(recording).extension() == ".wbb") return recording + ".wbb";
  if (!recording.empty()) return fs::path(recording).replace_extension(".wbb").string();
  std::string stem = fmt::format("out/blackbox/{:%Y%m%d-%H%M%S}",
                                 fmt::localtime(std::chrono::system_clock::now()));
  std::error_code nowhere;
  if (!checkFiles({stem + ".wbb"})) stem = fs::temp_directory_path(nowhere) / stem;
  // No file reserves the name, because a black box file is rarely written. Random digits prevent
  // collisions between programs.
  return stem + "-" + randomName().substr(0, 8) + ".wbb";
}

Expected<std::unique_ptr<BlackBox>> armBlackBox(const Rig& rig, const RecordingMeta& meta,
                                                const std::string& path, std::uint64_t most_ticks) {
  BlackBoxPlan plan;
  plan.path = path;
  plan.most_ticks = most_ticks;
  plan.stop = [](void* renderer) noexcept {
    static_cast<HapticRenderer*>(renderer)->requestEmergencyStop();
  };
  plan.stop_whom = rig.renderer.get();
  return BlackBox::arm(meta, plan);
}

std::string writeBlackBoxIfNeeded(BlackBox& box) {
  if (!box.wanted()) return {};
  if (auto written = box.write(); !written) return format(written.errors());
  return fmt::format("the last seconds and what led to them: wholehand replay {} --resimulate",
                     box.path());
}

}  // namespace wholehand
