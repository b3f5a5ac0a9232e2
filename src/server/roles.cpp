#include "server/roles.hpp"

#include <array>

namespace wholehand {

namespace {

using orders::Giver;

constexpr std::array<const char*, 4> kNames = {"unsaid", "watcher", "player", "therapist"};

OrderReply needsControls(const Standing& now) {
  if (now.holds) return {true, ""};
  return refused(Refusal::kNotHolder, "this client does not hold the controls");
}

OrderReply therapistOnly(const std::string& what) {
  return refused(Refusal::kTherapistOnly, what + " is for the therapist only");
}

// A player who is alone with a simulated device may begin: the demo, and practice at home.
OrderReply playerMayBegin(const Order& order, const Standing& now) {
  const bool arms = order.is<orders::Arm>();
  if (arms && now.own_rest) return needsControls(now);
  if (now.led || now.moves_person) return therapistOnly(order.row().doing);
  if (arms && now.run_state != RunState::kDisarmed && !now.rest_before_start) {
    return therapistOnly("starting again after a stop");
  }
  return needsControls(now);
}

OrderReply playerMay(const Order& order, const Standing& now) {
  switch (order.row().giver) {
    case Giver::kHolder:
      return needsControls(now);
    case Giver::kBeginner:
      return playerMayBegin(order, now);
    case Giver::kHolderOrLeader: {
      const auto* action = order.as<orders::Action>();
      const bool pauses = action != nullptr && action->act == ExerciseAction::kPause;
      if (!now.therapist_paused || !now.led || pauses) return needsControls(now);
      return refused(Refusal::kTherapistPaused, "the therapist has paused the exercise");
    }
    default:
      return therapistOnly(order.row().doing);
  }
}

}  // namespace

std::optional<Role> roleNamed(std::string_view name) {
  for (const Role role : {Role::kWatcher, Role::kPlayer, Role::kTherapist}) {
    if (name == nameOf(role)) return role;
  }
  return std::nullopt;
}

const char* nameOf(Role role) noexcept {
  const auto i = static_cast<std::size_t>(role);
  return i < kNames.size() ? kNames[i] : "unknown";
}

Role grantedRole(Role claimed, Role by_token) noexcept {
  if (claimed == Role::kUnsaid) return by_token;
  return claimed <= by_token ? claimed : Role::kWatcher;
}

OrderReply mayOrder(Role role, const Order& order, const Standing& now) {
  const orders::Row& row = order.row();
  const Giver giver = row.giver;
  if (giver == Giver::kProgram) {
    return refused(Refusal::kUnreadable, std::string(row.name) + " is not a client's order");
  }
  if (giver == Giver::kAnyone) return {true, ""};
  if (role == Role::kWatcher) return refused(Refusal::kOnlyWatches, "this client only watches");
  if (giver == Giver::kNotWatchers) return {true, ""};
  if (role == Role::kPlayer) return playerMay(order, now);
  const bool therapist = role == Role::kTherapist;
  if (giver == Giver::kHoldingTherapist && !therapist) return therapistOnly(row.doing);
  const bool holds = giver == Giver::kHolder || giver == Giver::kHoldingTherapist;
  return therapist && !holds ? OrderReply{true, ""} : needsControls(now);
}

}  // namespace wholehand
