// A thousand bodies of a game around a moving hand: cost of a tick, and replay.
#include "game_bodies/expect_same_rerun.hpp"
#include "game_bodies/game_tools.hpp"
#include "loop/realtime/allocation_counter.hpp"
#include "loop/realtime/monotonic_clock.hpp"
#include "rig/registry/body_table.hpp"
#include "rig/run/run.hpp"
#include "support/folder.hpp"
#include "support/seed.hpp"

namespace wholehand::test {
namespace {

constexpr int kTiles = 49;    // fixed tiles of a floor
constexpr int kDriven = 300;  // weightless bodies that follow targets of the game
constexpr int kThousandTicks = 10'000;

/// Boxes, balls and meshes on a floor and in the air, 1.6 m wide and deep.
class Crowd {
 public:
  Crowd(std::mt19937_64& random, const Models& models) : random_(random) {
    std::deque<Command> shape_commands;
    const std::vector<std::vector<Shape>> sets = {{boxShape({0.23, 0.23, 0.04})},
                                                  {boxShape({0.04, 0.05, 0.06})},
                                                  {ballShape(0.025)},
                                                  {boxMesh({0.05, 0.03, 0.04})}};
    table.begin(models.hand, models.device, models.scene.game,
                static_cast<int>(models.scene.bodies.size()),
                models.exercise->description().event_names);
    for (int set = 0; set < 4; ++set) {
      const auto shapes = orThrow(prepareShapes(sets[set], models.scene.game));
      table.noteShapes(set, std::make_shared<const GameShapes>(
                                GameShapes{1, shapes.com_m, sets[set], outerRadius(shapes)}));
      for (const Command& c : shapeCommands(set, shapes)) shape_commands.push_back(c);
    }
    table.forLoop() = std::move(shape_commands);
    for (int i = 0; i < kMostRegistered; ++i) {
      SpawnOrder order = spawnOf(kFirstNumber + i, 0, BodyOwner::kFixed, poseAt({0, 0, 0}));
      if (i < kTiles) {
        order.pose = poseAt({0.24 * (i % 7 - 3), 0.24 * (i / 7 - 3), -0.32});
      } else {
        order.shape_set = 1 + i % 3;
        order.owner = i < kTiles + kDriven ? BodyOwner::kGame : BodyOwner::kLoop;
        order.mass_kg = 0.05 + 0.3 * share();
        order.pose = poseAt({1.6 * (share() - 0.5), 1.6 * (share() - 0.5),
                             order.owner == BodyOwner::kGame ? 0.8 * (share() - 0.3) : -0.25});
      }
      poses_.push_back(order.pose);
      if (table.order(spawnCommand(order)) != BodyRefusal::kNone) {
        throw std::runtime_error("not registered");
      }
    }
  }
  /// A game at 60 Hz: in each frame a third of the driven bodies gets a target.
  void play(const TickRecord& record) {
    if (record.tick % 16 != 0) return;
    for (int i = kTiles + static_cast<int>(record.tick / 16 % 3); i < kTiles + kDriven; i += 3) {
      BodyPose target = poses_[static_cast<std::size_t>(i)];
      target.position_m.x += 0.05 * std::sin(2.0 * record.time_s + i);
      (void)table.order(bodyTargetCommand(kFirstNumber + i, 1, target));
    }
  }
  BodyTable table;

 private:
  double share() { return std::uniform_real_distribution<double>(0.0, 1.0)(random_); }
  std::mt19937_64& random_;
  std::vector<BodyPose> poses_;
};

struct RoundOutcome {
  RunOutcome outcome;
  std::uint64_t most_awake = 0, awake_ticks = 0, touching = 0, handovers = 0, refused = 0;
  std::size_t registered = 0, most_left_out = 0;
  double table_ns = 0.0;
  bool stopped = false;

  void look(const TickRecord& record) {
    stopped = stopped || any(record.faults & kStoppingFaults);
    const auto awake = static_cast<std::uint64_t>(record.exercise.values[2]);
    most_awake = std::max(most_awake, awake);
    awake_ticks += awake;
    touching += record.contact_count > 0 ? 1 : 0;
    for (int i = 0; i < record.command_count; ++i) {
      handovers += record.commands[i].type == CommandType::kSpawn ? 1 : 0;
    }
    for (int i = 0; i < record.exercise.event_count; ++i) {
      refused += record.exercise.events[i].type == 5 ? 1 : 0;
    }
  }
  void lookAt(const BodyTable& table) {
    const auto bodies = table.registered();
    const auto left_out = std::count_if(bodies.begin(), bodies.end(), [](const auto& body) {
      return body.whereabouts == Whereabouts::kLeftOut;
    });
    registered = bodies.size();
    most_left_out = std::max(most_left_out, static_cast<std::size_t>(left_out));
  }
};

RoundOutcome playRound(std::mt19937_64& random, const std::string& path) {
  Models models = gameModels();
  const Intention way = wander(random, models.device, 1e-3 * kThousandTicks, 0.3);
  auto rig = orThrow(buildRig(std::move(models), way, {}));
  Crowd crowd(random, rig->models);
  RoundOutcome seen;
  std::unique_ptr<Run> run;
  RunPlan plan;
  plan.duration_ticks = kThousandTicks;
  plan.record = path;
  plan.simulated_clock = true;
  plan.count_allocations = threadAllocations;
  plan.sinks.push_back([&](const TickRecord& record) {
    seen.look(record);
    crowd.play(record);
    const std::int64_t begun_ns = threadCpuNow_ns();
    crowd.table.onRecord(record);
    seen.table_ns += static_cast<double>(threadCpuNow_ns() - begun_ns);
    auto& waiting = crowd.table.forLoop();
    while (!waiting.empty() && run->tryCommand(waiting.front())) waiting.pop_front();
    if (record.tick % 100 == 0) seen.lookAt(crowd.table);
  });
  run = orThrow(Run::prepare(std::shared_ptr<Rig>(std::move(rig)), std::move(plan)));
  orThrow(run->simulate());
  run->finish();
  seen.outcome = run->outcome();
  return seen;
}

TEST(ThousandBodies, ThousandBodiesAroundAMovingHand_CostLittleAllocateNothingAndReplay_slow) {
  auto random = seededRandom(5403);
  const Folder folder;
  const RoundOutcome seen = playRound(random, folder.file("run.h5"));
  const Percentiles& cpu = seen.outcome.summary.cpu;
  figure("registered bodies", static_cast<double>(seen.registered), "bodies");
  figure("awake at once, most", static_cast<double>(seen.most_awake), "bodies");
  figure("awake at once, mean", static_cast<double>(seen.awake_ticks) / kThousandTicks, "bodies");
  figure("left out at once, most", static_cast<double>(seen.most_left_out), "bodies");
  figure("handed to a slot", static_cast<double>(seen.handovers), "times");
  figure("ticks with contact", static_cast<double>(seen.touching), "1");
  figure("tick p50", cpu.p50_ns * 1e-3, "us of CPU");
  figure("tick p99.9", cpu.p999_ns * 1e-3, "us of CPU");
  figure("table of bodies outside of the loop", 1e-3 * seen.table_ns / kThousandTicks,
         "us of CPU a record");
  EXPECT_FALSE(seen.stopped);
  EXPECT_FALSE(seen.outcome.faulted);
  if (allocationCountingAvailable()) {
    EXPECT_EQ(seen.outcome.counters.allocations, 0U);
  }
  EXPECT_EQ(seen.refused, 0U);
  EXPECT_GE(seen.most_awake, 20U);
  EXPECT_LE(seen.most_awake, 24U) << "budget.awake";
  if (kStatisticsMeaningful && fullCounts()) {
    EXPECT_LE(cpu.p999_ns, 500e3);
  }
  expectSameRerun(folder.file("run.h5"), kThousandTicks);
}

}  // namespace
}  // namespace wholehand::test
