// Random orders near a moving hand: no allocation, no stop, and both recording and black box file
// replay.
#include "game_bodies/expect_same_rerun.hpp"
#include "game_bodies/game_tools.hpp"
#include "loop/device/simulated/simulated_device.hpp"
#include "loop/patient/motion.hpp"
#include "loop/realtime/allocation_counter.hpp"
#include "rig/run/run.hpp"
#include "support/fault_injector.hpp"
#include "support/folder.hpp"
#include "support/seed.hpp"

namespace wholehand::test {
namespace {

constexpr int kSlots = 20;

/// A game that sends random orders near the hand, including orders that are refused.
class WildGame {
 public:
  WildGame(std::mt19937_64& random, const Models& models) : random_(random), models_(models) {
    std::vector<std::vector<Shape>> sets = {
        {boxShape({0.04, 0.05, 0.06})}, {ballShape(0.025)}, {boxMesh({0.05, 0.03, 0.04})}};
    Shape arm = ballShape(0.02);
    arm.in_body.translation_m = {0.0, 0.0, 0.05};
    sets.push_back({ballShape(0.03), arm});
    for (int set = 0; set < static_cast<int>(sets.size()); ++set) {
      const auto shapes = orThrow(prepareShapes(sets[set], models.scene.game));
      for (const Command& c : shapeCommands(set, shapes)) waiting_.push_back(c);
    }
  }
  std::vector<Command> next(const TickRecord& record) {
    if (!waiting_.empty()) return std::exchange(waiting_, {});
    std::vector<Command> orders;
    if (record.tick % 16 == 0) {
      for (int slot = 0; slot < 6; ++slot) {
        orders.push_back(bodyTargetCommand(slot, generation_[slot], somewhere(record)));
      }
    }
    if (random_() % 4 != 0) return orders;
    const int slot = static_cast<int>(random_() % kSlots);
    switch (random_() % 4) {
      case 0: {
        SpawnOrder order;
        order.slot = slot;
        order.generation = generation_[slot] + 1;
        order.shape_set = static_cast<int>(random_() % 4);
        order.owner = slot < 6 ? BodyOwner::kGame : static_cast<BodyOwner>(random_() % 3);
        order.mass_kg = 0.02 + 0.98 * share();
        order.pose = somewhere(record);
        order.refuse_overlap = random_() % 8 == 0;
        generation_[slot] = order.generation;
        orders.push_back(removeCommand(slot, order.generation - 1));
        orders.push_back(spawnCommand(order));
        break;
      }
      case 1:
        orders.push_back(removeCommand(slot, generation_[slot]));
        break;
      case 2:
        orders.push_back(teleportCommand(slot, generation_[slot], somewhere(record)));
        break;
      default:
        orders.push_back(
            setOwnerCommand(slot, generation_[slot], static_cast<BodyOwner>(random_() % 3)));
    }
    return orders;
  }

 private:
  double share() { return std::uniform_real_distribution<double>(0.0, 1.0)(random_); }
  BodyPose somewhere(const TickRecord& record) {
    const HandModel& hand = models_.hand;
    const Capsule& near = hand.capsules[random_() % hand.capsules.size()];
    const auto offset = [&] { return 0.2 * (share() - 0.5); };
    const Eigen::Vector3d at = handAt(hand, record.q_s).linkPose(near.link) * near.a_m +
                               Eigen::Vector3d(offset(), offset(), offset());
    const Eigen::Quaterniond turn(share() + 0.1, share() - 0.5, share() - 0.5, share() - 0.5);
    return poseAt(at, turn.normalized());
  }

  std::mt19937_64& random_;
  const Models& models_;
  std::vector<Command> waiting_;
  std::array<int, kSlots> generation_{};
};

/// Describes what stopped a run, for debugging.
std::string storyOf(const TickRecord& before, const TickRecord& now) {
  std::string story = "tick " + std::to_string(now.tick) + ", faults " +
                      std::to_string(static_cast<std::uint32_t>(now.faults)) + ", axis " +
                      std::to_string(now.fault_axis) + "; fastest axis " +
                      std::to_string(now.qd_s.vec().cwiseAbs().maxCoeff());
  for (int i = 0; i < now.body_count; ++i) {
    const Eigen::Vector3d change =
        now.bodies[i].velocity_m_s.eigen() - before.bodies[i].velocity_m_s.eigen();
    const Eigen::Vector3d spin = now.bodies[i].angular_velocity_rad_s.eigen() -
                                 before.bodies[i].angular_velocity_rad_s.eigen();
    if (change.norm() < 2.0 && spin.norm() < 100.0) continue;
    story += "; slot " + std::to_string(i) + " by " + std::to_string(change.norm()) + " m/s, " +
             std::to_string(spin.norm()) + " rad/s";
  }
  return story;
}

struct Wild {
  std::string stopped;  ///< what stopped the run; empty if nothing did
  RunOutcome outcome;
  std::uint64_t orders = 0, spawned = 0, ghosts = 0, solid = 0, refused = 0, touching = 0;
};

Wild runWild(std::mt19937_64& random, const std::string& device_name, int ticks,
             const Folder& folder, const std::vector<InjectedFault>& faults) {
  Models models = gameModels(device_name);
  const Models copy = models;
  auto inner = std::make_unique<SimulatedDevice>(
      models.device, models.patient,
      std::make_unique<ScriptedPlayer>(wander(random, models.device, 1e-3 * ticks, 0.25)), 1e-3);
  SimulatedDevice& device = *inner;
  auto rig = build(std::move(models), std::make_unique<FaultInjector>(device, faults, true));
  Wild out;
  WildGame game(random, copy);
  TickRecord before;
  std::unique_ptr<Run> run;
  RunPlan plan;
  plan.duration_ticks = static_cast<std::uint64_t>(ticks);
  plan.record = folder.file("run.h5");
  plan.black_box = blackBoxPath(plan.record);
  plan.simulated_clock = true;
  plan.count_allocations = threadAllocations;
  plan.sinks.push_back([&](const TickRecord& record) {
    if (record.contact_count > 0) ++out.touching;
    if (any(record.faults & kStoppingFaults) && out.stopped.empty())
      out.stopped = storyOf(before, record);
    before = record;
    for (int i = 0; i < record.exercise.event_count; ++i) {
      const int type = record.exercise.events[i].type;
      if (type == 0) ++out.ghosts;
      if (type == 1) ++out.solid;
      if (type == 5) ++out.refused;
    }
    for (const Command& order : game.next(record)) {
      out.orders += run->tryCommand(order) ? 1 : 0;
      if (order.type == CommandType::kSpawn) ++out.spawned;
    }
  });
  run = orThrow(Run::prepare(std::shared_ptr<Rig>(std::move(rig)), std::move(plan)));
  orThrow(run->simulate());
  run->finish();
  out.outcome = run->outcome();
  return out;
}

TEST(GameOrders, RandomOrdersNearAMovingHand_AllocateNothingStopNothingAndReplay) {
  auto random = seededRandom(4303);
  Wild all;
  for (const std::string device : {"lambda-pride", "desktop-3axis", "wrist-9axis"}) {
    SCOPED_TRACE(device);
    const Folder folder;
    const int ticks = cases(4000);
    const Wild wild = runWild(random, device, ticks, folder, {});
    EXPECT_EQ(wild.stopped, "");
    EXPECT_FALSE(wild.outcome.faulted);
    EXPECT_EQ(wild.outcome.counters.stopping_faults, 0U);
    if (allocationCountingAvailable()) {
      EXPECT_EQ(wild.outcome.counters.allocations, 0U);
    }
    expectSameRerun(folder.file("run.h5"), ticks);
    all.orders += wild.orders, all.spawned += wild.spawned, all.solid += wild.solid;
    all.refused += wild.refused, all.touching += wild.touching, all.ghosts += wild.ghosts;
  }
  figure("orders", static_cast<double>(all.orders), "1");
  figure("spawns", static_cast<double>(all.spawned), "1");
  figure("became solid", static_cast<double>(all.solid), "1");
  figure("refused", static_cast<double>(all.refused), "1");
  figure("ticks with contact", static_cast<double>(all.touching), "1");
  if (kStatisticsMeaningful) {
    EXPECT_GT(all.solid, 100U);
    EXPECT_GT(all.refused, 10U);
    EXPECT_GT(all.touching, 100U);
  }
}

TEST(GameOrders, BlackBoxAfterAFault_Replays) {
  auto random = seededRandom(4304);
  const Folder folder;
  const Models models = gameModels();
  const InjectedFault fault =
      faultAtRandom(models.device, 1e-3, InjectedKind::kReadFails, 2500, 2600, 2000, random());
  const Wild wild = runWild(random, "lambda-pride", 4000, folder, {fault});
  ASSERT_TRUE(wild.outcome.faulted);
  expectSameRerun(folder.file("run.wbb"), 1000);
  expectSameRerun(folder.file("run.h5"), 1000);
}

}  // namespace
}  // namespace wholehand::test
