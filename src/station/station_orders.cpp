// Orders and queries of clients: any thread.
#include "runtime/interrupt_scope.hpp"
#include "station/report_mark.hpp"
#include "station/station_core.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace wholehand {
namespace {

using Clock = StationClock;

/// Orders that are queued for the main thread.
bool takesTime(OrderType type) {
  return type == OrderType::kArm || type == OrderType::kLoadExercise ||
         type == OrderType::kSaveProfile || type == OrderType::kLoadProfile;
}

}  // namespace

void Station::Core::quit() {
  const std::lock_guard lock(mutex_);
  quit_ = true;
  wake_.notify_all();
}

void Station::Core::beginStop(bool at_once) {
  if (!live_) return;
  status_.run_state = RunState::kRampingDown;
  if (at_once) {
    live_->requestEmergencyStop();
  } else {
    live_->requestGentleStop();
  }
}

OrderReply Station::Core::push(const Command& command) {
  if (!live_) return refused(Refusal::kNothingArmed, "nothing is armed");
  if (!live_->tryCommand(command)) {
    return refused(Refusal::kTooMany, "too many commands at once; try again");
  }
  return {true, ""};
}

// A level that is begun again is not done any more.
OrderReply Station::Core::act(const Command& command) {
  OrderReply pushed = push(command);
  const auto action = static_cast<ExerciseAction>(command.index);
  if (pushed.accepted && (action == ExerciseAction::kRestart || action == ExerciseAction::kNext)) {
    const std::lock_guard lock(latest_mutex_);
    level_done_at_.reset();
  }
  return pushed;
}

// Steering must reach the loop even when its queue is full of aims: the latest request is retried
// with every record.
OrderReply Station::Core::steer(Steering by) {
  if (!live_ && renewing_) {  // from the first tick of the next session
    status_.steering = by;
    return {true, ""};
  }
  if (!live_) return refused(Refusal::kNothingArmed, "nothing is armed");
  if (config_.make_device)
    return refused(Refusal::kOther, "the person at the device moves the hand");
  Command command;
  command.type = CommandType::kSteer;
  command.index = static_cast<std::int32_t>(by);
  unsent_steer_ = command;
  sendUnsent();
  status_.steering = by;
  return {true, ""};
}

void Station::Core::sendUnsent() {
  if (live_ && unsent_steer_ && live_->tryCommand(*unsent_steer_)) unsent_steer_.reset();
}

OrderReply Station::Core::setParameter(const Order& order) {
  const auto& parameters = scene_->parameters;
  const auto found = std::find_if(parameters.begin(), parameters.end(),
                                  [&](const auto& p) { return p.name == order.name; });
  if (found == parameters.end()) {
    return refused(Refusal::kUnknownParameter, "there is no parameter \"" + order.name + "\"");
  }
  if (!(order.value >= found->lower && order.value <= found->upper)) {
    return refused(Refusal::kOutOfRange,
                   fmt::format("{} = {:.6g} is out of range: {:.6g} to {:.6g} {}", order.name,
                               order.value, found->lower, found->upper, found->unit));
  }
  if (live_) {
    Command command;
    command.type = CommandType::kParameter;
    command.index = static_cast<std::int32_t>(found - parameters.begin());
    command.value = order.value;
    if (OrderReply pushed = push(command); !pushed.accepted) return pushed;
  }
  return {true, ""};
}

// The default unless a person set a value, in the range that holds now.
double Station::Core::valueOf(const PublishedParameter& parameter) const {
  const auto asked = asked_parameters_.find(parameter.name);
  if (asked == asked_parameters_.end()) return parameter.initial;
  const double value = asked->second.value;
  return value >= parameter.lower && value <= parameter.upper ? value : parameter.initial;
}

// An earlier holder's order must not take effect after one of the current holder.
bool Station::Core::superseded(const Order& order) {
  const bool stops = order.type == OrderType::kStop || order.type == OrderType::kEmergencyStop;
  if (!stops && order.claim != 0 && order.claim < claim_) return true;
  claim_ = std::max(claim_, order.claim);
  return false;
}

// Whether the last ending is a rest, and which one.
bool Station::Core::rested() const {
  const RunState now = status_.run_state;
  return status_.endings == rest_ending_ &&
         (now == RunState::kRampingDown || now == RunState::kStopped);
}

// Takes effect and is published even when nothing renders: an order to arm may be under way.
void Station::Core::takeStop(const Order& order, std::uint64_t asked) {
  stop_asked_ = asked;
  // A rest applies to a rendering loop, or continues a rest; it does not replace another stop.
  const bool rests = order.rest && (rested() || status_.run_state == RunState::kRendering);
  // Repetitions count once: else nobody could name the last ending while a client repeats its stop.
  const auto [last, first] =
      stops_.try_emplace({order.client, order.type, order.rest}, order.number);
  if (first || last->second != order.number) ++status_.endings;
  last->second = order.number;
  rest_ending_ = rests ? status_.endings : 0;
  if (!live_ && status_.run_state == RunState::kDisarmed) status_.run_state = RunState::kStopped;
  beginStop(order.type == OrderType::kEmergencyStop);
}

void Station::Core::order(const Order& order, const std::function<void(OrderReply)>& done) {
  if (order.bodies) return done(orderBodies(order));
  OrderReply reply{true, ""};
  {
    const std::lock_guard lock(mutex_);
    const std::uint64_t asked = ++orders_;
    const bool takes_time = takesTime(order.type);
    if (superseded(order)) {
      reply = refused(Refusal::kNotHolder, "another client holds the controls by now");
    } else if (!takes_time) {
      reply = carryOut(order, asked);
    } else if (over_) {
      reply = refused(Refusal::kEnding, "the program is ending");
    } else if (tasks_.size() >= kMostTasks) {
      reply = refused(Refusal::kTooMany, "too many orders wait already; try again");
    } else {
      reply = enqueue(order, asked, done);
      if (reply.accepted) {
        noteJoined(order);
        return;
      }
    }
    if (reply.accepted) noteJoined(order);
  }
  done(reply);
}

// What the program orders by itself is nobody's part.
void Station::Core::noteJoined(const Order& order) {
  const bool own = order.type == OrderType::kOwnerAlive || order.type == OrderType::kUnattended ||
                   (order.type == OrderType::kSteer && order.steering != Steering::kPerson);
  if (own) return;
  joined_ = true;
  left_alone_ = false;
}

OrderReply Station::Core::carryOut(const Order& order, std::uint64_t asked) {
  Command command;
  switch (order.type) {
    case OrderType::kStop:
    case OrderType::kEmergencyStop:
      takeStop(order, asked);
      break;
    case OrderType::kSetParameter: {
      OrderReply set = setParameter(order);
      if (set.accepted) asked_parameters_[order.name] = {order.value, asked};
      return set;
    }
    case OrderType::kSetHelp:
      help_ = order.help;
      help_asked_ = asked;
      break;
    case OrderType::kAim:
      if (order.aim.size() != static_cast<int>(scene_->device.axes.size()) ||
          !allFinite(order.aim)) {
        return refused(
            Refusal::kNotAPosture,
            fmt::format("an aim has {} finite values, one an axis", scene_->device.axes.size()));
      }
      command.type = CommandType::kAim;
      command.aim = order.aim;
      command.index = static_cast<std::int32_t>(order.help);
      return push(command);
    case OrderType::kSteer:
      return steer(order.steering);
    case OrderType::kAction:
      command.type = CommandType::kAction;
      command.index = static_cast<std::int32_t>(order.action);
      return act(command);
    case OrderType::kOwnerAlive:
      owner_alive_ = order.value != 0.0;
      if (!live_) return refused(Refusal::kNothingArmed, "nothing is armed");
      live_->setOwnerAlive(owner_alive_);
      break;
    case OrderType::kUnattended:
      if (!live_ || status_.run_state != RunState::kRendering) break;
      if (!armed_for_client_) {
        left_alone_ = joined_;
        break;
      }
      say("nobody has held the controls or ordered anything for long: the session ends");
      takeStop(order, asked);
      break;
    case OrderType::kAttended:  // noteJoined()
      break;
    case OrderType::kAnswer:
    case OrderType::kHoldToMove:
      return refused(Refusal::kNotHere, "no device is commissioned here");
    case OrderType::kArm:
    case OrderType::kLoadExercise:
    case OrderType::kSaveProfile:
    case OrderType::kLoadProfile:    // a queued task, as those above
    case OrderType::kPrepareShapes:  // orderBodies()
    case OrderType::kOrderBodies:
      break;
  }
  return {true, ""};
}

LoopStatus Station::Core::status() const {
  LoopStatus status;
  bool live = false;
  {
    const std::lock_guard lock(mutex_);
    live = live_ != nullptr;
    status = status_;
    status.rested = rested();
    status.help = help_;
    status.registered = registered_;
    for (const auto& parameter : scene_->parameters) {
      status.parameters.push_back(valueOf(parameter));
    }
  }
  nameSafety(status);
  status.rehearsed_ticks = rehearsed_ticks_;
  status.bodies = tracker_.bodies();
  if (config_.device_status) status.device = config_.device_status();
  const std::lock_guard lock(latest_mutex_);
  // While nothing runs, the published values are those of the next session.
  if (has_latest_ && live) {
    const auto count = std::min<std::size_t>(latest_.parameter_count, status.parameters.size());
    std::copy_n(latest_.parameters.begin(), count, status.parameters.begin());
  }
  return status;
}

// The supervisor's state is ahead of the thread that waits for a session's end.
void Station::Core::nameSafety(LoopStatus& status) const {
  if (!safety_) return;
  status.safety_state = safety_->state();
  // Likewise the loop, which stops by itself after a signal.
  if (InterruptScope::interrupted() && status.run_state == RunState::kRendering) {
    status.run_state = RunState::kRampingDown;
  }
  {
    // Before the session's first record, the newest one is of the session before.
    const std::lock_guard lock(latest_mutex_);
    if (!has_latest_ && status.run_state == RunState::kRendering) return;
  }
  const SafetyTransition fault = safety_->fault();
  if (fault.to != SafetyState::kFaulted) return;
  status.latched = status.latched | fault.faults;
  status.fault_axis = fault.axis;
  status.fault_value = fault.value;
  status.fault_limit = fault.limit;
  if (status.run_state == RunState::kRendering) status.run_state = RunState::kRampingDown;
}

// Telemetry thread.
void Station::Core::keepLatest(const TickRecord& record) {
  safety_->add(record);
  tracker_.see(record);
  {
    const std::lock_guard lock(mutex_);
    sendUnsent();
    followRegistry(record);
    joined_ = joined_ || record.moved_by == Mover::kPerson;
  }
  const std::lock_guard lock(latest_mutex_);
  latest_ = record;
  has_latest_ = true;
  for (int i = 0; i < record.exercise.event_count; ++i) {
    const ExerciseEvent& event = record.exercise.events[i];
    if (event.type == level_done_) level_done_at_ = Clock::now();
  }
}

bool Station::Core::latest(TickRecord& record) const {
  const std::lock_guard lock(latest_mutex_);
  if (has_latest_) record = latest_;
  return has_latest_;
}

std::string Station::Core::reportFolder(const std::string& name, std::string& why) {
  const std::lock_guard lock(report_mutex_);  // two concurrent requests share one result
  const std::string recording = recordingPath(name);
  if (recording.empty()) {
    why = "there is no recording of that name";
    return {};
  }
  if (name == scene()->recording) {
    why = "it is still being recorded";
    return {};
  }
  std::string folder = recording.substr(0, recording.size() - 3) + "-report";
  const std::string identity = identityOf(recording);
  if (isReportOf(folder, identity)) return folder;
  if (!config_.make_report) {
    why = "this program makes no reports";
    return {};
  }
  unmarkReport(folder);
  if (auto made = config_.make_report(recording, folder); !made) {
    why = format(made.errors());
    return {};
  }
  // Replaced meanwhile: the next one who asks has the report made again.
  if (identityOf(recording) == identity) markReport(folder, identity);
  return folder;
}

}  // namespace wholehand
