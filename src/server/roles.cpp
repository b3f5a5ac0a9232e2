#include "server/roles.hpp"

#include <array>

namespace wholehand {

namespace {

constexpr std::array<const char*, 4> kNames = {"unsaid", "watcher", "player", "therapist"};

constexpr const char* kCommissioning = "leading a commissioning";

OrderReply needsControls(const Standing& now) {
  if (now.holds) return {true, ""};
  return refused(Refusal::kNotHolder, "this client does not hold the controls");
}

OrderReply therapistOnly(const char* what) {
  return refused(Refusal::kTherapistOnly, std::string(what) + " is for the therapist only");
}

// A player who is alone with a simulated device may begin: the demo, and practice at home.
OrderReply playerMayBegin(const Order& order, const Standing& now) {
  const bool arms = order.type == OrderType::kArm;
  if (arms && now.own_rest) return needsControls(now);
  if (now.led || now.moves_person) return therapistOnly(arms ? "starting" : "loading");
  if (arms && now.run_state != RunState::kDisarmed) {
    return therapistOnly("starting again after a stop");
  }
  return needsControls(now);
}

OrderReply playerMayAct(const Order& order, const Standing& now) {
  if (now.therapist_paused && now.led && order.action != ExerciseAction::kPause) {
    return refused(Refusal::kTherapistPaused, "the therapist has paused the exercise");
  }
  return needsControls(now);
}

// Of the game that holds the controls.
bool isGames(const Order& order) {
  return order.type == OrderType::kPrepareShapes || order.type == OrderType::kOrderBodies;
}

bool isCommissioning(const Order& order) {
  return order.type == OrderType::kAnswer || order.type == OrderType::kHoldToMove;
}

OrderReply playerMay(const Order& order, const Standing& now) {
  switch (order.type) {
    case OrderType::kArm:
    case OrderType::kLoadExercise:
      return playerMayBegin(order, now);
    case OrderType::kAction:
      return playerMayAct(order, now);
    case OrderType::kAim:
    case OrderType::kSteer:
    case OrderType::kPrepareShapes:
    case OrderType::kOrderBodies:
      return needsControls(now);
    case OrderType::kSaveProfile:
    case OrderType::kLoadProfile:
      return therapistOnly("a profile");
    case OrderType::kAnswer:
    case OrderType::kHoldToMove:
      return therapistOnly(kCommissioning);
    default:
      return therapistOnly("setting a value");
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
  if (order.type == OrderType::kEmergencyStop) return {true, ""};
  if (order.type == OrderType::kStop && role != Role::kWatcher) return {true, ""};
  switch (role) {
    case Role::kWatcher:
      return refused(Refusal::kOnlyWatches, "this client only watches");
    case Role::kPlayer:
      return playerMay(order, now);
    case Role::kTherapist: {
      const bool one_leads = order.type == OrderType::kAim || order.type == OrderType::kSteer ||
                             isGames(order) || isCommissioning(order);
      return one_leads ? needsControls(now) : OrderReply{true, ""};
    }
    case Role::kUnsaid:
      if (isCommissioning(order)) return therapistOnly(kCommissioning);
      break;
  }
  return needsControls(now);
}

}  // namespace wholehand
