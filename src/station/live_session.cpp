#include "station/live_session.hpp"

#include "assembly/kept_black_box.hpp"

#include <cmath>

namespace wholehand {

void LiveSession::Watcher::beforeTick(const TickRecord& record) noexcept {
  for (int i = 0; i < record.command_count; ++i) {
    player_.command(record.commands[static_cast<std::size_t>(i)]);
  }
}

void LiveSession::Watcher::afterTick(const TickRecord& record) noexcept {
  player_.see(record);
}

Expected<std::unique_ptr<LiveSession>> LiveSession::arm(const Models& models,
                                                        std::unique_ptr<Player> player,
                                                        const RigOptions& options,
                                                        const LiveSessionPlan& plan) {
  std::unique_ptr<LiveSession> live(new LiveSession);
  auto steered = std::make_unique<SteeredPlayer>(std::move(player), models.device);
  live->watcher_ = std::make_unique<Watcher>(*steered);
  auto rig = buildRig(models, std::move(steered), options);
  if (!rig) return rig.errors();
  live->rig_ = std::move(*rig);
  live->rig_->renderer->startParametersAt(plan.parameters);
  if (auto armed = live->rig_->renderer->arm(); !armed) return armed.errors();
  auto meta = describeRecording(*live->rig_, plan.title, plan.seed, false);
  if (!meta) return meta.errors();
  auto box = armBlackBox(*live->rig_, *meta, blackBoxPath(plan.record),
                         plan.duration_ticks > 0 ? plan.duration_ticks : UINT64_MAX);
  if (!box) return box.errors();
  live->black_box_ = std::move(*box);
  if (!plan.record.empty()) {
    const WaitingFor disk("the disk: recording " + plan.record);
    auto created = RecordingWriter::create(plan.record, *meta);
    if (!created) return created.errors();
    live->writer_ = std::move(*created);
    live->record_ = plan.record;
  }
  SessionConfig config;
  config.listener = live->watcher_.get();
  config.black_box = live->black_box_.get();
  config.interrupts = &InterruptScope::shared();
  const Exercise* exercise = models.exercise.get();
  if (exercise != nullptr) config.fade_out_s = exercise->description().fade_out_s;
  if (plan.duration_ticks > 0) config.duration_ticks = plan.duration_ticks;
  live->session_ = std::make_unique<Session>(*live->rig_->renderer, config);
  live->hub_ = std::make_unique<TelemetryHub>(
      [session = live->session_.get()](TickRecord& record) { return session->tryPop(record); });
  if (live->writer_) live->hub_->record(*live->writer_);
  live->hub_->count(live->statistics_);
  for (const auto& sink : plan.sinks) live->hub_->add(sink);
  return Expected<std::unique_ptr<LiveSession>>(std::move(live));
}

Expected<Done> LiveSession::begin() {
  hub_->start();
  PeriodicThreadConfig thread;
  thread.period_ns = std::llround(rig_->options.period_s * 1e9);
  Expected<SetupReport> setup = session_->start(thread);
  if (!setup) return setup.errors();
  setup_ = *setup;
  return Done{};
}

Expected<std::unique_ptr<LiveSession>> LiveSession::start(const Models& models,
                                                          std::unique_ptr<Player> player,
                                                          const RigOptions& options,
                                                          const LiveSessionPlan& plan) {
  auto live = arm(models, std::move(player), options, plan);
  if (!live) return live;
  if (auto begun = (*live)->begin(); !begun) return begun.errors();
  return live;
}

LiveSession::~LiveSession() {
  if (session_ && session_->running()) session_->requestStop();
  finish();
}

void LiveSession::finish() {
  if (finished_) return;
  finished_ = true;
  if (session_) session_->join();
  if (rig_) rig_->device->close();  // before the disk takes its time
  const WaitingFor disk("the disk: " + (record_.empty() ? "black box" : "recording " + record_));
  if (hub_) hub_->stop();
  if (writer_) writer_->close();
  if (black_box_) black_box_said_ = keepBlackBox(*black_box_);
  black_box_.reset();  // its memory, and its watch for crashes
}

RunOutcome LiveSession::outcome() const {
  RunOutcome outcome;
  outcome.counters = session_->counters();
  outcome.summary = corrected(statistics_.snapshot(), outcome.counters, rig_->options.period_s);
  outcome.dropped_records = session_->droppedRecords();
  outcome.dropped_writes = hub_->unrecorded() + (writer_ ? writer_->dropped() : 0);
  outcome.written = writer_ ? writer_->written() : 0;
  outcome.failures = hub_->failures();
  outcome.setup = setup_;
  outcome.black_box = black_box_said_;
  outcome.uncertified = !rig_->refused.empty();
  outcome.faulted = any(outcome.counters.latched);
  return outcome;
}

}  // namespace wholehand
