#include "station/server/access.hpp"

#include <gtest/gtest.h>

#include <vector>

// Who may order what: the table of docs/adr/0028-roles.md, row by row.
namespace wholehand {
namespace {

const std::vector<std::string> kAll = {"Arm",          "Stop", "EmergencyStop", "LoadExercise",
                                       "SetParameter", "Aim",  "Steer",         "Action"};

std::vector<std::string> allowed(Role role, const Standing& now) {
  std::vector<std::string> may;
  for (const orders::Any& what :
       {orders::Any(orders::Arm{}), orders::Any(orders::Stop{}),
        orders::Any(orders::EmergencyStop{}), orders::Any(orders::LoadExercise{}),
        orders::Any(orders::SetParameter{}), orders::Any(orders::Aim{}),
        orders::Any(orders::Steer{}), orders::Any(orders::Action{})}) {
    const Order order{what};
    if (mayOrder(role, order, now).accepted) may.emplace_back(order.row().name);
  }
  return may;
}

Standing playing() {
  Standing now;
  now.holds = now.led = true;
  now.run_state = RunState::kRendering;
  return now;
}

TEST(Roles, EmergencyStop_IsAllowedToEveryRoleAtAnyTime) {
  for (const Role role : {Role::kUnspecified, Role::kWatcher, Role::kPlayer, Role::kTherapist}) {
    EXPECT_TRUE(mayOrder(role, Order{orders::EmergencyStop{}}, {}).accepted) << nameOf(role);
  }
}

TEST(Roles, TherapistWhileAPlayerHolds_MayDoAllButSteer) {
  Standing now = playing();
  now.holds = false;
  EXPECT_EQ(allowed(Role::kTherapist, now),
            (std::vector<std::string>{"Arm", "Stop", "EmergencyStop", "LoadExercise",
                                      "SetParameter", "Action"}));
  EXPECT_EQ(mayOrder(Role::kTherapist, Order{orders::Aim{}}, now).refusal, Refusal::kNotHolder);
}

TEST(Roles, PlayerUnderATherapist_MayOnlySteerRestAndStop) {
  EXPECT_EQ(allowed(Role::kPlayer, playing()),
            (std::vector<std::string>{"Stop", "EmergencyStop", "Aim", "Steer", "Action"}));
  EXPECT_EQ(mayOrder(Role::kPlayer, Order{orders::SetHelp{}}, playing()).refusal,
            Refusal::kTherapistOnly);
  EXPECT_EQ(mayOrder(Role::kPlayer, Order{orders::SetParameter{}}, playing()).refusal,
            Refusal::kTherapistOnly);
}

TEST(Roles, Watcher_MayOnlyStop) {
  EXPECT_EQ(allowed(Role::kWatcher, playing()), (std::vector<std::string>{"EmergencyStop"}));
  EXPECT_EQ(mayOrder(Role::kWatcher, Order{orders::Action{}}, playing()).refusal,
            Refusal::kOnlyWatches);
}

TEST(Roles, PlayerAloneOnASimulatedDevice_MayStartButNotAfterAStop) {
  Standing now;
  now.holds = true;
  EXPECT_TRUE(mayOrder(Role::kPlayer, Order{orders::Arm{}}, now).accepted);
  EXPECT_TRUE(mayOrder(Role::kPlayer, Order{orders::LoadExercise{}}, now).accepted);
  for (const RunState ended : {RunState::kStopped, RunState::kFaulted, RunState::kStopping}) {
    now.run_state = ended;
    EXPECT_EQ(mayOrder(Role::kPlayer, Order{orders::Arm{}}, now).refusal, Refusal::kTherapistOnly);
  }
  now.run_state = RunState::kDisarmed;
  now.moves_person = true;
  EXPECT_EQ(mayOrder(Role::kPlayer, Order{orders::Arm{}}, now).refusal, Refusal::kTherapistOnly);
  EXPECT_EQ(mayOrder(Role::kPlayer, Order{orders::LoadExercise{}}, now).refusal,
            Refusal::kTherapistOnly);
}

TEST(Roles, PlayerAfterItsOwnRest_MayArmUnderATherapist) {
  Standing now = playing();
  now.moves_person = true;
  now.run_state = RunState::kStopped;
  EXPECT_FALSE(mayOrder(Role::kPlayer, Order{orders::Arm{}}, now).accepted);
  now.own_rest = true;
  EXPECT_TRUE(mayOrder(Role::kPlayer, Order{orders::Arm{}}, now).accepted);
  now.holds = false;  // it must take the controls first
  EXPECT_EQ(mayOrder(Role::kPlayer, Order{orders::Arm{}}, now).refusal, Refusal::kNotHolder);
}

TEST(Roles, PauseOfAPresentTherapist_CannotBeEndedByThePlayer) {
  Standing now = playing();
  now.therapist_paused = true;
  for (const Act action : {Act::kResume, Act::kNext, Act::kRestart}) {
    const Order order{orders::Action{action}};
    EXPECT_EQ(mayOrder(Role::kPlayer, order, now).refusal, Refusal::kTherapistPaused);
    EXPECT_TRUE(mayOrder(Role::kTherapist, order, now).accepted);
  }
  now.led = false;  // no therapist is left to end it
  const Order resume{orders::Action{Act::kResume}};
  EXPECT_TRUE(mayOrder(Role::kPlayer, resume, now).accepted);
}

TEST(Roles, ClientWithoutARole_MayDoAllWithTheControlsAndElseOnlyStop) {
  EXPECT_EQ(allowed(Role::kUnspecified, playing()), kAll);
  Standing now = playing();
  now.holds = false;
  EXPECT_EQ(allowed(Role::kUnspecified, now), (std::vector<std::string>{"Stop", "EmergencyStop"}));
}

TEST(Roles, OrdersOfTheProgramItself_AreRefusedFromClients) {
  for (const Order& order : {Order{orders::HolderAlive{true}}, Order{orders::Unattended{}},
                             Order{orders::UnattendedEnds{}}}) {
    for (const Role role : {Role::kUnspecified, Role::kPlayer, Role::kTherapist}) {
      const OrderReply may = mayOrder(role, order, playing());
      EXPECT_FALSE(may.accepted) << order.row().name;
      EXPECT_TRUE(may.reason.starts_with(order.row().name)) << may.reason;
    }
  }
}

TEST(Roles, RoleBeyondTheToken_BecomesWatcher) {
  EXPECT_EQ(grantedRole(Role::kTherapist, Role::kPlayer), Role::kWatcher);
  EXPECT_EQ(grantedRole(Role::kTherapist, Role::kWatcher), Role::kWatcher);
  EXPECT_EQ(grantedRole(Role::kPlayer, Role::kTherapist), Role::kPlayer);
  EXPECT_EQ(grantedRole(Role::kUnspecified, Role::kPlayer), Role::kPlayer);
}

TEST(Roles, RoleNames_AreReadBackAndOthersRefused) {
  for (const Role role : {Role::kWatcher, Role::kPlayer, Role::kTherapist}) {
    EXPECT_EQ(roleNamed(nameOf(role)), role);
  }
  for (const char* none : {"", "unspecified", "Therapist", "admin", "therapist "}) {
    EXPECT_FALSE(roleNamed(none)) << none;
  }
}

}  // namespace
}  // namespace wholehand
