// The key of a state: what its future depends on, and nothing else.
#include "station/decide_world.hpp"
#include "station/press_permit.hpp"

#include <algorithm>
#include <cstdint>
#include <string>
#include <variant>

namespace wholehand::test::decisions {
namespace {

template <class Value>
void add(Value value, Key& key) {
  key.add(static_cast<std::uint64_t>(static_cast<int>(value)) + 2);
}

char side(const std::string& hand) {
  return hand.empty() ? '-' : hand[0];
}

/// 0: none, 1: of another client by now, 2: the newest.
int rankOf(std::uint32_t claim, const StationState& state) {
  return claim == 0 ? 0 : claim == state.claim ? 2 : 1;
}

/// What was once shown as shown now.
bool basisHolds(const StationState& state, std::uint32_t seen, int client) {
  return state.basis.refuseOutdated(seen, static_cast<std::uint32_t>(client) + 1).accepted;
}

int clientOf(const WaitingOrder& task) {
  return static_cast<int>(task.order.client) - 1;
}

}  // namespace

bool World::isRefusedForGood(const WaitingOrder& task, bool waits) const {
  if (waits && now() - task.asked_at > kLongestWait) return true;
  const OrderReply may = mayStillDo(state_, task, now());
  if (may.accepted) return false;
  // Another person may become the order's own (finish()), if nothing else refuses it.
  if (may.refusal != Refusal::kOther) return true;
  const auto* arm = task.order.as<orders::Arm>();
  return !state_.stops.refuseUnacknowledged(task.acknowledged_stop).accepted ||
         (arm != nullptr && !basisHolds(state_, arm->basis_seen, clientOf(task)));
}

// What laws compare with the state of later. An order of the client's own makes up for the rest.
void World::addShown(const Shown& shown, Key& key) const {
  add(shown.own_visit, key);
  if (shown.own_visit) return;
  add(shown.visit, key);
  add(shown.own_hand, key);
  if (shown.own_hand) return;
  add(side(shown.hand), key);
  add(shown.own_limit, key);
  if (!shown.own_limit) add(shown.limit_n, key);
}

void World::addClient(int client, Key& key) const {
  const Client& c = clients_[client];
  add(c.connected, key);
  if (!c.connected) return;
  add(rankOf(c.claim, state_), key);
  add(rankOf(c.named_claim, state_), key);
  if (rules_.repeats) add(stop_ids_[client] != 0, key);
  const bool saw_ending = c.shown.endings == state_.stops.count();
  add(saw_ending, key);
  if (saw_ending) add(c.shown.ended == ended_, key);
  const bool holds = basisHolds(state_, c.shown.basis, client);
  add(holds, key);
  if (holds) addShown(c.shown, key);
  // Whatever the client does next is heard; only its orders until now may find it silent.
  const bool waits =
      std::any_of(state_.waiting.begin(), state_.waiting.end(), [&](const WaitingOrder& task) {
        return clientOf(task) == client && !isRefusedForGood(task, true);
      });
  if (waits || (state_.under_way && clientOf(state_.under_way->task) == client)) {
    add(now_ms_ - c.heard_ms <= 200, key);
  }
}

void World::addTask(const WaitingOrder& task, bool waits, const Ranks& ranks, Key& key) const {
  const int client = clientOf(task);
  const bool stopped = state_.stops.stoppedSince(task.asked);
  const bool refused = isRefusedForGood(task, waits);
  add(client < 0 ? -1 : ranks[client], key);
  add(task.starts, key);
  add(refused, key);
  if (!waits) {
    add(task.order.what.index(), key);
    add(PressPermit::refuseAbsent(task.order, state_.claim).accepted, key);
    add(now() - task.asked_at > PressPermit::kLongest, key);
  }
  if (refused) return add(task.starts && stopped, key);
  add(task.order.what.index(), key);
  add(doomed_.count(task.asked), key);
  add(rankOf(task.order.claim, state_), key);
  const bool saw_ending = task.acknowledged_stop == state_.stops.count();
  if (task.starts) {
    add(task.person == state_.person.person(), key);
    if (state_.under_way) add(task.person == state_.under_way->person_before, key);
    if (const auto pressed = pressed_.find(task.asked); pressed != pressed_.end()) {
      add(pressed->second.ended == ended_, key);
      addShown(pressed->second, key);
    }
  } else {
    add(stopped, key);
    if (!stopped) add(saw_ending, key);
    add(limit_set_ > task.asked, key);
  }
  if (const auto* load = task.order.as<orders::LoadExercise>()) {
    add(side(load->hand), key);
    add(load->level == 0 || load->level == state_.scene->level, key);
  }
  if (const auto* close = task.order.as<orders::CloseVisit>()) add(close->visit, key);
}

void World::addUnderWay(const Ranks& ranks, Key& key) const {
  const UnderWay& u = *state_.under_way;
  add(u.kind, key);
  addTask(u.task, false, ranks, key);
  addTask(u.start, false, ranks, key);
  for (const bool flag :
       {u.loads, u.rendered, u.other_hand, u.rehearsed, u.preparing, u.had_session,
        u.profile.has_value(), u.person_before == state_.person.person()}) {
    add(flag, key);
  }
  add(u.visit ? static_cast<int>(u.visit->number) : -1, key);
  if (u.facts) {
    add(side(u.facts->hand.name), key);
    add(u.facts->level == state_.scene->level, key);
  }
  if (!u.preparing) return;
  add(u.before.run_state, key);
  add(u.before.rested, key);
  add(any(u.before.latched), key);
  add(u.before.endings == state_.stops.count(), key);
}

void World::addStation(Key& key) const {
  const StationState& s = state_;
  add(s.live, key);
  if (s.live) {
    add(fault_, key);
    add(stopping_, key);
    // From the first tick on nobody asks whether a limit was raised.
    if (!s.began) add(raised_, key);
  }
  add(s.began && s.live, key);
  add(s.run_state, key);
  add(any(s.latched), key);
  add(s.rehearsed, key);
  add(s.starting.has_value(), key);
  add(s.visit.number, key);
  add(side(s.scene->hand.name), key);
  add(!s.profile.empty(), key);
  add(limit_n_, key);
  add(s.person.valueOf(s.scene->parameters[0]), key);
  const bool rested = s.stops.rested(RunState::kStopped);
  add(rested, key);
  if (rested || (s.under_way && s.under_way->before.rested)) add(s.stops.restBeforeStart(), key);
  add(s.work.index(), key);
  if (const auto* end = std::get_if<work::EndSession>(&s.work)) add(end->goes_on, key);
  if (const auto* rehearse = std::get_if<work::Rehearse>(&s.work)) add(rehearse->next, key);
}

std::uint64_t World::keyBy(const Ranks& ranks) const {
  Key key;
  addStation(key);
  for (int rank = 0; rank < kClients; ++rank) {
    addClient(static_cast<int>(std::find(ranks.begin(), ranks.end(), rank) - ranks.begin()), key);
  }
  for (const WaitingOrder& task : state_.waiting) {
    add(-2, key);
    addTask(task, true, ranks, key);
  }
  if (state_.under_way) {
    add(-2, key);
    add(-2, key);
    addUnderWay(ranks, key);
  }
  return key.value();
}

std::uint64_t World::key() const {
  const std::uint64_t key = keyBy({0, 1, 2});
  return rules_.alike ? std::min(key, keyBy({1, 0, 2})) : key;
}

}  // namespace wholehand::test::decisions
