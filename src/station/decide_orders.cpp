#include "loop/patient/steered_player.hpp"
#include "station/decider.hpp"
#include "station/press_permit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>
#include <variant>

namespace wholehand {
namespace {

OrderReply notCommissioned() {
  return refused(Refusal::kNotHere, "no device is commissioned here");
}

OrderReply nothingArmed() {
  return refused(Refusal::kNothingArmed, "nothing is armed");
}

bool lowersLimit(const StationState& state, const Order& order) {
  const auto* set = order.as<orders::SetParameter>();
  if (set == nullptr) return false;
  const auto limit = state.person.limits(state.scene->parameters).of(set->name);
  return limit && set->value <= *limit;
}

}  // namespace

OrderReply mayStillDo(const StationState& state, const WaitingOrder& task,
                      std::chrono::steady_clock::time_point now) {
  const Order& order = task.order;
  if (state.quit) return refused(Refusal::kEnding, "the program is ending");
  if (task.refused_before) {
    return refused(Refusal::kRefusedBefore,
                   "what this client asked for before was refused: look why, then ask again");
  }
  if (task.waited_s > kLongestWait) {
    return refused(Refusal::kWaitedTooLong,
                   fmt::format("it waited {:.1f} s behind other orders, at most {} s are allowed: "
                               "look, then ask again",
                               task.waited_s.count(), kLongestWait.count()));
  }
  if (OrderReply may = PressPermit::refuseAbsent(order, state.claim); !may.accepted) return may;
  if (!task.starts) return {true, ""};
  if (order.requester) {
    if (OrderReply may = PressPermit::refuseLate(now - task.asked_at); !may.accepted) return may;
  }
  if (state.stops.stoppedSince(task.asked) || state.interrupted) {
    return refused(Refusal::kStopCame, "a stop was ordered meanwhile; nothing was armed");
  }
  if (task.person != state.person.person()) {
    return refused(Refusal::kOther,
                   "another person or hand was loaded after this was asked: look who, then arm "
                   "again");
  }
  if (OrderReply may = state.stops.refuseUnacknowledged(task.acknowledged_stop); !may.accepted) {
    return may;
  }
  const auto* arm = order.as<orders::Arm>();
  if (arm == nullptr) return {true, ""};
  return state.basis.refuseOutdated(arm->basis_seen, order.client);
}

bool isArming(const StationState& state, std::chrono::steady_clock::time_point now) {
  const auto comes = [&](const WaitingOrder& task) {
    return task.starts && mayStillDo(state, task, now).accepted;
  };
  if (state.starting && comes(*state.starting)) return true;
  return !state.live && std::any_of(state.waiting.begin(), state.waiting.end(), comes);
}

OrderReply refuseSuperseded(StationState& state, const Order& order) {
  const bool obeyed = order.stops() || lowersLimit(state, order);
  if (!obeyed && order.claim != 0 && order.claim < state.claim) {
    return refused(Refusal::kNotHolder, "another client holds the controls by now");
  }
  state.claim = std::max(state.claim, order.claim);
  return {true, ""};
}

OrderReply acceptBodies(StationState& state, const Order& order) {
  ++state.orders;
  if (OrderReply late = refuseSuperseded(state, order); !late.accepted) return late;
  if (state.live && state.run_state != RunState::kRendering) {
    return refused(Refusal::kStillStopping,
                   "the loop stops: arm again, then prepare shapes and spawn again");
  }
  return {true, ""};
}

std::vector<double> parameterValues(const StationState& state) {
  std::vector<double> values;
  for (const PublishedParameter& parameter : state.scene->parameters) {
    values.push_back(state.person.valueOf(parameter));
  }
  return values;
}

void describe(const StationState& state, std::chrono::steady_clock::time_point now,
              LoopStatus& status) {
  status.session = state.session;
  // Before its first tick a session renders nothing.
  const bool begins = state.live && !state.began && state.run_state == RunState::kRendering;
  status.run_state = begins ? state.under_way->before.run_state : state.run_state;
  status.steering = state.steering;
  status.latched = state.latched;
  status.arming = begins || isArming(state, now);
  status.endings = state.stops.count();
  status.basis = state.basis.number();
  status.rested = state.stops.rested(state.run_state);
  status.rest_before_start = status.rested && state.stops.restBeforeStart();
  status.help = state.person.help();
  status.settings = status.parameters = parameterValues(state);
}

Effects decide(StationState& state, const events::Any& event,
               std::chrono::steady_clock::time_point now) {
  Decider decider(state, now);
  std::visit([&decider](const auto& what) { decider.on(what); }, event);
  return decider.effects();
}

void Decider::answer(std::uint64_t asked, OrderReply reply) {
  effects_.emplace_back(effects::Reply{asked, std::move(reply)});
}

void Decider::on(const events::Asked& event) {
  const Order& order = event.order;
  asked_ = ++s_.orders;
  OrderReply reply = refuseSuperseded(s_, order);
  bool waits = false, handed = false;
  if (reply.accepted && order.row().thread != orders::Thread::kMain) {
    const std::size_t before = effects_.size();
    reply = carryOut(order);
    handed = effects_.size() > before && std::holds_alternative<effects::Command>(effects_.back());
  } else if (reply.accepted) {
    reply = enqueue(order);
    waits = reply.accepted;
  }
  if (reply.accepted) countParticipant(order);
  if (!waits && !handed) answer(asked_, std::move(reply));
}

// Queues an order, unless the present state already requires a refusal.
OrderReply Decider::enqueue(const Order& order) {
  if (s_.over) return refused(Refusal::kEnding, "the program is ending");
  if (s_.waiting.size() >= kMostWaitingOrders) {
    return refused(Refusal::kTooMany, "too many orders wait already; try again");
  }
  WaitingOrder task;
  task.order = order;
  task.asked = asked_;
  task.asked_at = now_;
  const auto* arm = order.as<orders::Arm>();
  task.starts = arm != nullptr;
  task.acknowledged_stop = arm != nullptr ? arm->acknowledged_stop : s_.stops.count();
  if (order.is<orders::SaveProfile>()) task.profile = profileNow(s_);
  task.person = s_.person.person();
  OrderReply may = mayStillDo(s_, task, now_);
  if (!may.accepted) return may;
  if (task.starts) s_.stops.forgetPresses();
  s_.waiting.push_back(std::move(task));
  return may;
}

// Records that somebody takes part. Orders of the program itself do not count.
void Decider::countParticipant(const Order& order) {
  const auto* steer = order.as<orders::Steer>();
  const bool own = order.is<orders::HolderAlive>() || order.is<orders::Unattended>() ||
                   (steer != nullptr && steer->by != Steering::kPerson);
  if (own) return;
  s_.attended = true;
  s_.unattended = false;
}

void Decider::on(const events::PersonMoved&) {
  // While the next session is being prepared, movement belongs to the session that ends.
  (s_.starting && s_.renewing ? s_.keep_recording : s_.attended) = true;
}

// Answers every waiting order, so that no client waits for ever.
void Decider::on(const events::Over&) {
  s_.over = true;
  for (const WaitingOrder& task : s_.waiting) {
    answer(task.asked, refused(Refusal::kEnding, "the program is ending"));
  }
  s_.waiting.clear();
}

OrderReply Decider::carryOut(const Order& order) {
  return std::visit(
      Overloaded{[&](const orders::Stop&) { return stop(order); },
                 [&](const orders::Rest&) { return stop(order); },
                 [&](const orders::EmergencyStop&) { return stop(order); },
                 [&](const orders::SetParameter& set) { return setParameter(set, order.client); },
                 [&](const orders::SetHelp& set) { return setHelp(set); },
                 [&](const orders::Aim& aim) { return this->aim(aim); },
                 [&](const orders::Steer& steer) { return this->steer(steer.by); },
                 [&](const orders::Action& action) { return act(action, order.client); },
                 [&](const orders::HolderAlive& holder) { return tellHolderAlive(holder.alive); },
                 [&](const orders::Unattended&) { return markUnattended(order); },
                 [&](const orders::UnattendedEnds&) {
                   return OrderReply{true, ""};
                 },  // countParticipant() does the rest
                 [&](const orders::Answer&) { return notCommissioned(); },
                 [&](const orders::HoldToMove&) { return notCommissioned(); },
                 [&](const auto&) { return notHere(order); }},
      order.what);
}

void Decider::beginStop(bool at_once) {
  if (!s_.live) return;
  s_.run_state = RunState::kStopping;
  effects_.emplace_back(effects::StopLoop{at_once});
}

// A stop takes effect and is published even when nothing renders, because an order to arm may be
// under way.
OrderReply Decider::stop(const Order& order) {
  s_.stops.stop(order, asked_, now_, s_.run_state, isArming(s_, now_));
  if (!s_.live && s_.run_state == RunState::kDisarmed) s_.run_state = RunState::kStopped;
  beginStop(order.is<orders::EmergencyStop>());
  return {true, ""};
}

OrderReply Decider::push(const Command& command) {
  if (!s_.live) return nothingArmed();
  effects_.emplace_back(effects::Command{asked_, command});
  return {true, ""};
}

// Whatever but a pause lets efforts of the exercise rise.
OrderReply Decider::act(const orders::Action& action, std::uint32_t client) {
  if (action.act != Act::kPause) {
    OrderReply may = s_.basis.refuseOutdated(action.basis_seen, client);
    if (!may.accepted) return may;
  }
  Command command;
  command.type = CommandType::kAction;
  command.index = static_cast<std::int32_t>(action.act);
  if (action.chosen != Choice::kNone) {
    command.value = choiceValue(action.chosen, action.by_therapist);
  }
  return push(command);
}

OrderReply Decider::steer(Steering by) {
  if (!s_.live && !s_.renewing) return nothingArmed();
  if (s_.live && s_.rules->robot) {
    return refused(Refusal::kOther, "the person at the device moves the hand");
  }
  // Between two sessions it takes effect at the first tick of the next one.
  if (s_.live) effects_.emplace_back(effects::SteerLoop{by});
  s_.steering = by;
  return {true, ""};
}

OrderReply Decider::setParameter(const orders::SetParameter& order, std::uint32_t client) {
  const auto& parameters = s_.scene->parameters;
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
  // A sender that raises a limit may still see the values of another person.
  if (s_.person.limits(parameters).exceeds(order.name, order.value)) {
    if (OrderReply may = s_.basis.refuseOutdated(order.basis_seen, client); !may.accepted) {
      return may;
    }
    s_.basis.change(client, fmt::format("{} = {:.6g} {}", order.name, order.value, found->unit));
    effects_.emplace_back(effects::RaiseLimit{client});
  }
  if (s_.live) {
    effects_.emplace_back(
        effects::SetLoopParameter{static_cast<int>(found - parameters.begin()), order.value});
  }
  s_.person.set(order.name, order.value, asked_);
  return {true, ""};
}

OrderReply Decider::setHelp(const orders::SetHelp& order) {
  s_.person.setHelp(order.help, asked_);
  return {true, ""};
}

OrderReply Decider::aim(const orders::Aim& order) {
  const DeviceModel& device = s_.scene->device;
  if (order.q.size() != static_cast<int>(device.axes.size()) || !allFinite(order.q)) {
    return refused(Refusal::kNotAPosture,
                   fmt::format("an aim has {} finite values, one an axis", device.axes.size()));
  }
  if (const int far = firstFarAim(device, order.q); far >= 0) {
    return refused(Refusal::kNotAPosture,
                   "an aim of " + farAimText(device.axes[far], order.q[far]));
  }
  Command command;
  command.type = CommandType::kAim;
  command.aim = order.q;
  command.index = static_cast<std::int32_t>(order.by);
  return push(command);
}

OrderReply Decider::tellHolderAlive(bool alive) {
  s_.holder_alive = alive;
  if (!s_.live) return nothingArmed();
  effects_.emplace_back(effects::TellHolderAlive{alive});
  return {true, ""};
}

OrderReply Decider::markUnattended(const Order& order) {
  if (!s_.live || s_.run_state != RunState::kRendering) return {true, ""};
  if (!s_.armed_for_client) {
    s_.unattended = s_.attended;
    return {true, ""};
  }
  effects_.emplace_back(
      effects::Log{"nobody has held the controls or ordered anything for long: the session ends"});
  return stop(order);
}

}  // namespace wholehand
