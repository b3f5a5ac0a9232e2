// Which of the registered bodies have slots.
#include "core/body_limits.hpp"
#include "registry/body_registry.hpp"

#include <algorithm>
#include <limits>
#include <optional>

namespace wholehand {
namespace {

constexpr double kDriven_m_s = 0.5;  ///< of a body that the game moves
// A body that has a slot keeps it until it is that far out of reach, or another one is that much
// nearer, and for a while.
constexpr double kLateOut_m = 0.1, kNearer_m = 0.05, kStays_s = 0.3, kTouchStays_s = 0.2;

}  // namespace

bool BodyRegistry::mustStay(const Held& held) const {
  return !held.seen || time_s_ - held.since_s < kStays_s ||
         (held.touched_s >= 0.0 && time_s_ - held.touched_s < kTouchStays_s);
}

/// Distance from the hand, less what a body in a slot is ahead by; none: out of reach.
std::optional<double> BodyRegistry::rankOf(const Body& body) const {
  const bool in_slot = body.slot >= 0;
  double speed_m_s = 0.0;
  if (body.spawn.owner == BodyOwner::kLoop) speed_m_s = body.spawn.velocity_m_s.eigen().norm();
  if (body.spawn.owner == BodyOwner::kGame) speed_m_s = kDriven_m_s;
  const double margin_m = kReachWithin_s * speed_m_s + (in_slot ? kLateOut_m : 0.0);
  const HandReach::Distance at =
      reach_->to(body.spawn.pose.position_m.eigen(), body.radius_m, margin_m);
  if (at.missed_m > margin_m) return std::nullopt;
  return at.now_m - (in_slot ? kNearer_m : 0.0);
}

std::vector<BodyRegistry::Candidate> BodyRegistry::candidates() {
  std::vector<Candidate> out;
  for (auto& [number, body] : bodies_) {
    if (body.slot >= 0 && held_[body.slot].leaving) continue;
    if (body.slot >= 0 && mustStay(held_[body.slot])) {
      out.push_back({-std::numeric_limits<double>::infinity(), number});
      continue;
    }
    const std::optional<double> rank_m = rankOf(body);
    if (body.slot < 0) {
      setWhereabouts(body, rank_m ? Whereabouts::kLeftOut : Whereabouts::kOutOfReach);
      if (time_s_ < body.not_before_s) continue;
    }
    if (rank_m) out.push_back({*rank_m, number});
  }
  std::sort(out.begin(), out.end(), [](const Candidate& a, const Candidate& b) {
    return a.rank_m != b.rank_m ? a.rank_m < b.rank_m : a.number < b.number;
  });
  return out;
}

// Bodies at rest count as moving: the hand may wake them all at once.
int BodyRegistry::movingNow(const TickRecord& record) const {
  int moving = 0;
  for (int slot = 0; slot < budget_.slots; ++slot) {
    if (held_[slot].number != 0) {
      moving += held_[slot].moves ? 1 : 0;
    } else if (!parked(slot, record) && !fixed_[slot]) {
      ++moving;
    }
  }
  return moving;
}

// From the first one up: a state has the poses up to the last slot in use.
int BodyRegistry::freeOne(const TickRecord& record) const {
  for (int slot = 0; slot < budget_.slots; ++slot) {
    const bool others = time_s_ < others_until_s_[slot];
    if (held_[slot].number == 0 && !others && parked(slot, record)) return slot;
  }
  return -1;
}

void BodyRegistry::choose(const TickRecord& record) {
  reach_->look(record.q_s, record.theta);
  int slots = budget_.slots, moving = budget_.awake;
  for (int slot = 0; slot < budget_.slots; ++slot) {  // those of others
    if (held_[slot].number != 0 || parked(slot, record)) continue;
    --slots;
    if (!fixed_[slot]) --moving;
  }
  std::vector<int> wanted;
  for (const Candidate& candidate : candidates()) {
    const bool moves = bodies_.at(candidate.number).spawn.owner != BodyOwner::kFixed;
    if (slots <= 0 || (moves && moving <= 0)) continue;
    --slots;
    if (moves) --moving;
    wanted.push_back(candidate.number);
  }
  giveSlots(wanted, record);
}

void BodyRegistry::giveSlots(const std::vector<int>& wanted, const TickRecord& record) {
  std::array<bool, kMaxSlots> stays{};
  for (const int number : wanted) {
    const int slot = bodies_.at(number).slot;
    if (slot >= 0) stays[slot] = true;
  }
  for (int slot = 0; slot < budget_.slots; ++slot) {
    const Held& held = held_[slot];
    if (held.number > 0 && !held.leaving && !stays[slot] && !mustStay(held)) leave(slot);
  }
  for (const int number : wanted) {
    Body& body = bodies_.at(number);
    if (body.slot >= 0) continue;
    const bool moves = body.spawn.owner != BodyOwner::kFixed;
    if (moves && movingNow(record) >= budget_.awake) continue;
    const int slot = freeOne(record);
    if (slot < 0) return;
    enter(body, slot);
  }
}

void BodyRegistry::enter(Body& body, int slot) {
  last_generation_ = last_generation_ < kLastGeneration ? last_generation_ + 1 : kFirstGeneration;
  SpawnOrder order = body.spawn;
  order.slot = slot;
  order.generation = last_generation_;
  const double speed_m_s = order.velocity_m_s.eigen().norm();
  if (speed_m_s > kMostSpawnSpeed_m_s) {
    const double share = 0.999 * kMostSpawnSpeed_m_s / speed_m_s;
    order.velocity_m_s = Vec3::from(share * order.velocity_m_s.eigen());
  }
  body.slot = slot;
  held_[slot] = Held{};
  held_[slot].number = body.spawn.slot;
  held_[slot].generation = last_generation_;
  held_[slot].moves = order.owner != BodyOwner::kFixed;
  held_[slot].since_s = time_s_;
  for_loop_.push_back(spawnCommand(order));
  setWhereabouts(body, Whereabouts::kInSlot);
}

void BodyRegistry::leave(int slot) {
  Held& held = held_[slot];
  held.leaving = true;
  held.since_s = time_s_;
  for_loop_.push_back(removeCommand(slot, held.generation));
}

}  // namespace wholehand
