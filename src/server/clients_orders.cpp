// Permission of orders, and steering.
#include "server/clients.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace wholehand {

bool Clients::led() const {
  return std::any_of(clients_.begin(), clients_.end(),
                     [](const auto& c) { return c.second.role == Role::kTherapist; });
}

Role Clients::roleOf(std::uint32_t client) const {
  const auto found = clients_.find(client);
  return found == clients_.end() ? Role::kUnsaid : found->second.role;
}

Standing Clients::standingOf(std::uint32_t client, const Order& order,
                             const LoopStatus& status) const {
  Standing now;
  now.holds = desk_.holds(client);
  now.led = led();
  now.moves_person = status.device.has_value();
  now.own_rest = status.rested && resting_ == client && order.endings_seen == status.endings;
  now.therapist_paused = paused_in_ == status.session;
  now.run_state = status.run_state;
  return now;
}

void Clients::obeyOrder(Entry entry, const wire::ClientMessage& m, std::int64_t now_ns) {
  const std::uint32_t client = entry->first;
  // Aims of a cursor or stick are frequent; all they need for judging is at hand.
  const bool aim = m.order.type == OrderType::kAim;
  const LoopStatus status = aim ? LoopStatus{} : backend_.status();
  const OrderReply may =
      mayOrder(entry->second.role, m.order,
               aim ? Standing{desk_.holds(client)} : standingOf(client, m.order, status));
  if (!may.accepted) {
    const char* counter = may.refusal == Refusal::kNotHolder ? "not_holder" : "role";
    return refuse(entry, m.id, counter, may, now_ns);
  }
  Order order = m.order;
  // Without the controls a rest is a plain stop, but for one that is repeated.
  order.rest = order.rest && (desk_.holds(client) || status.rested);
  noteOrder(entry, order, status, now_ns);
  forward(entry, m.id, std::move(order));
  if (m.order.type == OrderType::kEmergencyStop) {
    log_.write(fmt::format("client {}: emergency stop", client), now_ns);
  }
}

void Clients::noteOrder(Entry entry, const Order& order, const LoopStatus& status,
                        std::int64_t now_ns) {
  desk_.attend(now_ns);
  const bool therapist = entry->second.role == Role::kTherapist;
  if (order.type == OrderType::kAction) {
    paused_in_.reset();
    if (therapist && order.action == ExerciseAction::kPause) paused_in_ = status.session;
  }
  // The right to go on stays with whoever rested first.
  if (order.type == OrderType::kStop && order.rest && !status.rested) {
    resting_ = entry->first;
    log_.write(fmt::format("client {} rests", entry->first), now_ns);
  }
  // The one who starts it declares it alive: the effort that faded with a lost holder returns.
  if (order.type != OrderType::kArm || !therapist || desk_.held()) return;
  if (desk_.take(entry->first, now_ns).empty()) (void)desk_.release(entry->first);
  followControls(now_ns);
}

std::string Clients::takeControls(Entry entry, std::int64_t now_ns) {
  if (entry->second.role != Role::kTherapist) return desk_.take(entry->first, now_ns);
  desk_.takeOver(entry->first, now_ns);
  return {};
}

void Clients::changeHands(Entry entry, const wire::ClientMessage& m, std::int64_t now_ns) {
  const std::uint32_t client = entry->first;
  const bool take = m.type == wire::ClientMessageType::kTakeControls;
  if (entry->second.role == Role::kWatcher) {
    return refuse(entry, m.id, "role", refused(Refusal::kOnlyWatches, "this client only watches"),
                  now_ns);
  }
  // A connected client has shown its token already; a wrong one here is an error to report.
  if (take && !m.token.empty() && !access_.tokenMatches(m.token)) {
    refuse(entry, m.id, "token", refused(Refusal::kWrongToken, "the token is wrong"), now_ns);
    return;
  }
  const std::string why = take ? takeControls(entry, now_ns) : desk_.release(client);
  if (!why.empty()) {
    refuse(entry, m.id, take ? "controls_held" : "not_holder",
           refused(take ? Refusal::kControlsHeld : Refusal::kNotHolder, why), now_ns);
    return;
  }
  log_.write(fmt::format("client {} ({}) {} the controls", client, nameOf(entry->second.role),
                         take ? "takes" : "gives back"),
             now_ns);
  entry->second.line->deliver(
      std::make_shared<const wire::Bytes>(wire::replyMessage(m.id, {true, ""})));
}

// A player steers only while the loop renders: at a stop it loses the controls, and takes them
// again by a press.
void Clients::followEndings(const LoopStatus& status, std::int64_t now_ns) {
  const bool ended = endings_ != 0 && status.endings != endings_;
  endings_ = status.endings;
  if (!ended || roleOf(desk_.holder()) != Role::kPlayer) return;
  log_.write(fmt::format("client {} gives back the controls: it was stopped", desk_.holder()),
             now_ns);
  (void)desk_.release(desk_.holder());
  followControls(now_ns);
}

}  // namespace wholehand
