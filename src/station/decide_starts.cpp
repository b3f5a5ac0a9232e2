#include "station/decider.hpp"
#include "station/press_permit.hpp"

#include <utility>
#include <variant>

namespace wholehand {

OrderReply mayStillStart(const StationState& state, std::chrono::steady_clock::time_point now) {
  if (!state.under_way) return refused(Refusal::kStopCame, "nothing is being started");
  return mayStillDo(state, state.under_way->start, now);
}

void Decider::on(const events::FirstStart&) {
  UnderWay& first = s_.under_way.emplace();
  first.kind = UnderWay::Kind::kFirstStart;
  first.start.acknowledged_stop = 1;
  first.start.asked = kFirstStart;
  first.start.starts = true;
  s_.starting = first.start;
  start(false);
}

// Ends a session that the program armed, when nobody has joined it for long or everybody has left;
// the program then arms the next one.
void Decider::on(const events::RenewalDue&) {
  const bool alone = !s_.attended && now_ - s_.began_at >= s_.rules->renew_after;
  if (s_.under_way || !s_.live || s_.armed_for_client || s_.rules->record_named ||
      !(alone || s_.unattended) || s_.run_state != RunState::kRendering) {
    return;
  }
  UnderWay& renewal = s_.under_way.emplace();
  renewal.kind = UnderWay::Kind::kRenewal;
  renewal.start.acknowledged_stop = s_.stops.count();
  renewal.start.person = s_.person.person();
  renewal.start.asked = s_.orders;
  renewal.start.starts = true;
  s_.starting = renewal.start;
  s_.renewing = true;
  s_.keep_recording = std::exchange(s_.attended, false);
  beginStop(false);
  s_.work = work::EndSession{true};
}

void Decider::on(const events::EndDue& event) {
  if (s_.under_way || !s_.live) return;
  s_.under_way.emplace().kind = UnderWay::Kind::kEnd;
  if (!event.by_itself) beginStop(false);
  s_.work = work::EndSession{false};
}

// A recording is discarded that the program started by itself and that nobody took part in. A
// recording that ended by a fault is kept.
void Decider::on(const events::LoopFinished& event) {
  const bool joined = std::exchange(s_.keep_recording, false) || s_.attended;
  // A client that joins while the session ends also takes part in the next one.
  s_.attended = s_.attended && s_.renewing;
  const bool asked_for = s_.armed_for_client || s_.rules->record_named;
  if (joined || asked_for || event.faulted || !event.recorded) return;
  effects_.emplace_back(effects::DiscardRecording{});
}

void Decider::on(const events::SessionEnded& event) {
  const bool goes_on = std::get<work::EndSession>(s_.work).goes_on;
  effects_.emplace_back(effects::RetireRun{});
  s_.live = false;
  s_.run_state = event.faulted ? RunState::kFaulted : RunState::kStopped;
  s_.latched = event.latched;
  s_.stops.endSession(event.faulted, goes_on);
  UnderWay& under_way = *s_.under_way;
  if (under_way.loads) {
    OrderReply may = mayStillDo(s_, under_way.task, now_);
    if (may.accepted) return useModels();
    s_.stops.keepRestPending();
    return finish(std::move(may));
  }
  if (under_way.kind != UnderWay::Kind::kRenewal) return finish({true, ""});
  if (any(s_.latched)) return finish(refused(Refusal::kStopCame, "it ended by a fault"));
  if (OrderReply may = mayStillDo(s_, under_way.start, now_); !may.accepted) return finish(may);
  start(false);
}

void Decider::start(bool for_client) {
  s_.under_way->for_client = for_client;
  s_.under_way->recorded = s_.rules->records;
  if (s_.live) {
    const bool ends = s_.run_state != RunState::kRendering || s_.loop_ends;
    return finishStart(ends ? refused(Refusal::kStillStopping,
                                      "it is still going to neutral; arm again when it is there")
                            : refused(Refusal::kArmedAlready, "it is armed already"));
  }
  if (!s_.rules->rehearse || s_.rehearsed) return prepare();
  s_.work = work::Rehearse{false};
}

void Decider::prepare() {
  UnderWay& start = *s_.under_way;
  if (OrderReply may = mayStillDo(s_, start.start, now_); !may.accepted) return finishStart(may);
  const bool rested = s_.stops.rested(s_.run_state);
  start.before = {s_.run_state, s_.steering, s_.latched, s_.session, s_.stops.count(), rested};
  start.preparing = true;
  ++s_.session;
  s_.armed_for_client = start.for_client;
  s_.work = work::Prepare{start.recorded, rested};
}

void Decider::on(const events::Prepared& event) {
  const WaitingOrder& task = s_.under_way->start;
  OrderReply may = event.reply;
  if (may.accepted) may = mayStillDo(s_, task, now_);
  if (may.accepted) may = PressPermit::refuse(task.order, task.asked_at, now_, s_.claim);
  if (!may.accepted) return restore(std::move(may));
  adopt();
}

// From here on a stop reaches the run, even before its device is enabled.
void Decider::adopt() {
  s_.live = true;
  s_.began = false;
  s_.latched = Fault::kNone;
  // Nobody plays in a person's visit but that person.
  const bool steered = s_.visit.number != 0 || (s_.renewing && s_.steering == Steering::kPerson);
  s_.steering = Steering::kVirtualPatient;
  s_.unattended = false;
  s_.began_at = now_;
  s_.run_state = RunState::kRendering;
  s_.starting.reset();
  s_.stops.beginSession();
  effects_.emplace_back(effects::AdoptRun{});
  if (steered) (void)steer(Steering::kPerson);
  s_.work = work::Begin{};
}

void Decider::on(const events::Begun& event) {
  const WaitingOrder& task = s_.under_way->start;
  if (!event.reply.accepted) {
    OrderReply may = mayStillDo(s_, task, now_);  // a stop came while the device was enabled
    return restore(may.accepted ? event.reply : may);
  }
  if (task.order.requester) {
    s_.work = work::AwaitFirstTick{};
    return;
  }
  on(events::FirstTick{{true, ""}});
}

// A session whose permit no longer holds stays at neutral and ends as after a stop.
void Decider::on(const events::FirstTick& event) {
  s_.began = event.reply.accepted;
  if (!event.reply.accepted) beginStop(false);
  s_.under_way->preparing = false;
  effects_.emplace_back(effects::SessionRuns{});
  finishStart(event.reply);
}

// Restores the state before a start that failed.
void Decider::restore(OrderReply reply) {
  UnderWay& start = *s_.under_way;
  const UnderWay::Before& before = start.before;
  start.preparing = false;
  s_.live = false;
  s_.stops.restoreRest(before.rested, before.endings);
  const bool stopped = s_.stops.stoppedSince(start.start.asked);
  const bool first_stop = stopped && before.run_state == RunState::kDisarmed;
  s_.run_state = first_stop ? RunState::kStopped : before.run_state;
  s_.steering = before.steering;
  s_.latched = before.latched;
  s_.session = before.session;
  effects_.emplace_back(effects::DropRun{});
  start.reply = std::move(reply);
  s_.work = work::CloseUnused{};
}

// If the disk fails, a session that no client asked for runs unrecorded: there is nobody to whom a
// refusal could be reported.
void Decider::on(const events::UnusedClosed&) {
  UnderWay& start = *s_.under_way;
  const bool disk = start.reply.refusal == Refusal::kCannotStart;
  if (start.for_client || !start.recorded || !disk) {
    return finishStart(start.reply);
  }
  start.recorded = false;
  prepare();
}

void Decider::finishStart(OrderReply reply) {
  const UnderWay& start = *s_.under_way;
  if (reply.accepted && !start.reply.accepted && !start.reply.reason.empty()) {
    effects_.emplace_back(effects::Log{"what follows is not recorded: " + start.reply.reason});
  }
  if (start.loads && !reply.accepted) s_.stops.keepRestPending();
  finish(std::move(reply));
}

}  // namespace wholehand
