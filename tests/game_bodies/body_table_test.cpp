// The table of a game's bodies with records that the test writes: which registered bodies get a
// slot, and when.
#include "rig/registry/body_table.hpp"

#include "game_bodies/game_tools.hpp"
#include "loop/dynamics/synergy.hpp"
#include "support/seed.hpp"

#include <set>

namespace wholehand::test {
namespace {

constexpr int kRefusedType = 5;  // type of the event "refused" in a game scene
const Vec3 kParked{0.0, 0.0, -10.0};

/// The hand's capsules in the world.
struct HandSurface {
  HandSurface(const HandModel& model, const AxisPosition& q_s) {
    const ArticulatedBody hand = handAt(model, q_s);
    for (const Capsule& c : model.capsules) {
      const Eigen::Vector3d a = hand.linkPose(c.link) * c.a_m, b = hand.linkPose(c.link) * c.b_m;
      segments.push_back({a, b - a, c.radius_m});
    }
  }
  /// Distance from a ball of 3 cm: of each segment from its centre, less both radii.
  [[nodiscard]] double distanceOf(const Eigen::Vector3d& at) const {
    double nearest_m = 1e9;
    for (const Segment& s : segments) {
      const Eigen::Vector3d from = at - s.begin_m;
      const double share = std::clamp(from.dot(s.along_m) / s.along_m.squaredNorm(), 0.0, 1.0);
      nearest_m = std::min(nearest_m, (from - share * s.along_m).norm() - s.radius_m - 0.03);
    }
    return nearest_m;
  }

  struct Segment {
    Eigen::Vector3d begin_m, along_m;
    double radius_m;
  };
  std::vector<Segment> segments;
};

/// A loop that obeys at once and moves no body by itself.
struct Loop {
  explicit Loop(int awake = 0) : models(gameModels()) {
    budget = models.scene.game;
    if (awake > 0) budget.awake = awake;
    table.begin(models.hand, models.device, budget, 0, models.exercise->description().event_names);
    GameShapes ball;
    ball.radius_m = 0.03;
    table.noteShapes(0, std::make_shared<const GameShapes>(ball));
    record.q_s = AxisPosition(models.hand.axis_count);
    record.body_count = budget.slots;
    for (int slot = 0; slot < budget.slots; ++slot) record.bodies[slot].position_m = kParked;
    moveHandTo(record.q_s);
  }
  void moveHandTo(const AxisPosition& q_s) {
    record.q_s = q_s;
    Synergy(models.hand).expand(q_s, record.theta);
  }
  void tick(int count = 1) {
    for (int k = 0; k < count; ++k) {
      record.command_count = 0;
      record.exercise.event_count = 0;
      auto& waiting = table.forLoop();
      while (record.command_count < kMaxCommands && !waiting.empty()) {
        apply(waiting.front());
        record.commands[record.command_count++] = waiting.front();
        waiting.pop_front();
      }
      ++record.tick;
      record.time_s = 1e-3 * static_cast<double>(record.tick);
      table.onRecord(record);
    }
  }
  void apply(const Command& command) {
    BodyState& body = record.bodies[command.index];
    if (command.type == CommandType::kRemove) {
      ++removals;
      body = BodyState{};
      body.position_m = kParked;
      return;
    }
    if (command.type == CommandType::kSpawn) {
      ++spawns;
      last_spawn = spawnOrderOf(command);
    }
    body.position_m = poseOf(command).position_m;
    body.orientation_xyzw = poseOf(command).orientation_xyzw;
  }
  BodyRefusal add(int number, const Eigen::Vector3d& at, BodyOwner owner = BodyOwner::kFixed) {
    return table.order(spawnCommand(spawnOf(number, 0, owner, poseAt(at))));
  }
  [[nodiscard]] RegisteredBody body(int number) const {
    for (const RegisteredBody& b : table.registered()) {
      if (b.number == number) return b;
    }
    return {};
  }

  Models models;
  GameBudget budget;
  BodyTable table;
  TickRecord record;
  SpawnOrder last_spawn;
  int spawns = 0, removals = 0;
};

Eigen::Vector3d somewhere(std::mt19937_64& random, double within_m) {
  std::uniform_real_distribution<double> unit(-within_m, within_m);
  const double x = unit(random), y = unit(random), z = unit(random);
  return {x, y, z};
}

TEST(BodyTable, ThousandBodies_GiveTheSlotsToTheNearest) {
  auto random = seededRandom(5401);
  Loop loop;
  std::vector<Eigen::Vector3d> at;
  for (int i = 0; i < kMostRegistered; ++i) {
    at.push_back(somewhere(random, 0.7));
    ASSERT_EQ(loop.add(kFirstNumber + i, at.back()), BodyRefusal::kNone);
  }
  loop.tick(200);
  double farthest_in_m = 0.0, nearest_out_m = 1e9;
  const HandSurface hand(loop.models.hand, loop.record.q_s);
  int in_slots = 0, left_out = 0, beyond = 0;
  std::set<int> slots;
  for (const RegisteredBody& body : loop.table.registered()) {
    const double away_m = hand.distanceOf(at[static_cast<std::size_t>(body.number - kFirstNumber)]);
    if (body.whereabouts == Whereabouts::kInSlot) {
      ++in_slots;
      slots.insert(body.slot);
      farthest_in_m = std::max(farthest_in_m, away_m);
    }
    if (body.whereabouts == Whereabouts::kLeftOut) {
      nearest_out_m = std::min(nearest_out_m, away_m);
    }
    left_out += body.whereabouts == Whereabouts::kLeftOut ? 1 : 0;
    beyond += body.whereabouts == Whereabouts::kOutOfReach ? 1 : 0;
  }
  EXPECT_EQ(in_slots, kMaxSlots);
  EXPECT_EQ(slots.size(), static_cast<std::size_t>(kMaxSlots)) << "a slot each";
  EXPECT_GE(nearest_out_m, farthest_in_m - 1e-9) << "the test's own distances";
  EXPECT_GT(left_out, 0);
  EXPECT_GT(beyond, 0);
  EXPECT_EQ(loop.spawns, kMaxSlots);
}

/// A random position that the axes can reach in 0.25 s, each at its speed limit and within its
/// range.
AxisPosition movedFrom(const AxisPosition& q_s, const DeviceModel& device,
                       std::mt19937_64& random) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  AxisPosition q = q_s;
  for (int a = 0; a < q.size(); ++a) {
    const DeviceAxis& axis = device.axes[a];
    const double step = (random() % 2 == 0 ? 1.0 : unit(random)) * (random() % 2 == 0 ? 1 : -1);
    q[a] = std::clamp(q[a] + 0.25 * axis.speed_limit * step, axis.lower, axis.upper);
  }
  return q;
}

TEST(BodyTable, BodyOutOfReach_IsNotMetByTheHandWithinAQuarterSecond) {
  auto random = seededRandom(5404);
  double closest_m = 1e9;
  std::size_t met = 0;
  for (int n = cases(10); n > 0; --n) {
    Loop loop;
    loop.moveHandTo(movedFrom(loop.record.q_s, loop.models.device, random));
    std::vector<Eigen::Vector3d> beyond;
    for (int i = 0; i < kMostRegistered; ++i) {
      (void)loop.add(kFirstNumber + i, somewhere(random, 0.7));
    }
    loop.tick(25);
    for (const RegisteredBody& body : loop.table.registered()) {
      if (body.whereabouts == Whereabouts::kOutOfReach) {
        beyond.push_back(body.pose.position_m.eigen());
      } else {
        ++met;
      }
    }
    for (int k = 0; k < (WHOLEHAND_SANITIZED ? 10 : 100); ++k) {
      const HandSurface hand(loop.models.hand,
                             movedFrom(loop.record.q_s, loop.models.device, random));
      for (const Eigen::Vector3d& p : beyond) closest_m = std::min(closest_m, hand.distanceOf(p));
    }
  }
  figure("closest that the hand comes to what is out of reach", closest_m, "m");
  figure("bodies in reach", static_cast<double>(met), "1");
  EXPECT_GT(closest_m, 0.0);
  EXPECT_GT(met, 0U);
}

TEST(BodyTable, MovingBodiesBeyondTheBudget_AreLeftOut) {
  Loop loop(3);
  for (int i = 0; i < 10; ++i) {
    (void)loop.add(kFirstNumber + i, {0.1, 0.01 * i, 0.2}, BodyOwner::kLoop);
    (void)loop.add(kFirstNumber + 100 + i, {0.1, 0.01 * i, 0.3}, BodyOwner::kFixed);
  }
  loop.tick(100);
  int moving = 0, standing = 0, left_out = 0;
  for (const RegisteredBody& body : loop.table.registered()) {
    const bool in_slot = body.whereabouts == Whereabouts::kInSlot;
    moving += in_slot && body.number < kFirstNumber + 100 ? 1 : 0;
    standing += in_slot && body.number >= kFirstNumber + 100 ? 1 : 0;
    left_out += body.whereabouts == Whereabouts::kLeftOut ? 1 : 0;
  }
  EXPECT_EQ(moving, 3);
  EXPECT_EQ(standing, 10);
  EXPECT_EQ(left_out, 7);
}

TEST(BodyTable, ForeignBodiesInSlots_CountAndKeepTheirSlot) {
  Loop loop(3);
  loop.record.bodies[0].position_m = {0.2, 0.2, 0.2};  // not stated to be fixed
  for (int i = 0; i < 10; ++i) {
    (void)loop.add(kFirstNumber + i, {0.1, 0.01 * i, 0.2}, BodyOwner::kLoop);
  }
  ASSERT_EQ(loop.table.order(spawnCommand(spawnOf(1, 0, BodyOwner::kFixed, poseAt({0, 0, 4})))),
            BodyRefusal::kNone);
  loop.tick(100);
  EXPECT_EQ(loop.spawns, 2);
  EXPECT_FALSE(loop.table.holds(0));
  EXPECT_FALSE(loop.table.holds(1));
  EXPECT_TRUE(loop.table.holds(2));
}

TEST(BodyTable, BodyHandedOverAndBack_KeepsItsPoseAndVelocity) {
  Loop loop;
  SpawnOrder order = spawnOf(kFirstNumber, 0, BodyOwner::kLoop, poseAt({0.1, 0.3, 0.1}));
  order.generation = 7;
  ASSERT_EQ(loop.table.order(spawnCommand(order)), BodyRefusal::kNone);
  loop.tick(50);
  ASSERT_EQ(loop.body(kFirstNumber).whereabouts, Whereabouts::kInSlot);
  // The loop moves it to a place that the hand cannot reach.
  const int slot = loop.body(kFirstNumber).slot;
  BodyState& state = loop.record.bodies[slot];
  state.position_m = {3.1, 0.25, -0.125};
  state.orientation_xyzw = {0.5, -0.5, 0.5, 0.5};
  state.velocity_m_s = {1.5, -0.25, 0.5};
  state.angular_velocity_rad_s = {-30.0, 1.0 / 3.0, 100.0};
  loop.tick(500);
  const RegisteredBody away = loop.body(kFirstNumber);
  ASSERT_EQ(away.whereabouts, Whereabouts::kOutOfReach);
  EXPECT_EQ(away.generation, 7);
  EXPECT_EQ(away.pose.position_m.x, 3.1);
  EXPECT_EQ(away.pose.orientation_xyzw.y, -0.5);
  loop.tick(500);
  EXPECT_EQ(loop.spawns, 1);
  // With a larger range of the device, the hand can follow it.
  for (DeviceAxis& axis : loop.models.device.axes) axis.lower = -5.0, axis.upper = 5.0;
  AxisPosition there(6);
  there[0] = 3.0;
  loop.moveHandTo(there);
  loop.tick(50);
  ASSERT_EQ(loop.spawns, 2);
  EXPECT_EQ(loop.last_spawn.pose.position_m.x, 3.1);
  EXPECT_EQ(loop.last_spawn.pose.orientation_xyzw.w, 0.5);
  EXPECT_EQ(loop.last_spawn.velocity_m_s.x, 1.5);
  EXPECT_EQ(loop.last_spawn.velocity_m_s.y, -0.25);
  EXPECT_EQ(loop.last_spawn.spin_rad_s.x, -30.0);
  EXPECT_EQ(loop.last_spawn.spin_rad_s.y, 1.0 / 3.0);
  EXPECT_EQ(loop.last_spawn.spin_rad_s.z, 100.0);
}

TEST(BodyTable, HandThatTremblesAtTheEdge_CausesFewSlotChanges) {
  auto random = seededRandom(5402);
  Loop loop;
  for (int i = 0; i < kMostRegistered; ++i) {
    (void)loop.add(kFirstNumber + i, somewhere(random, 0.7));
  }
  loop.tick(500);
  const int before = loop.spawns;
  for (int k = 0; k < 200; ++k) {  // the hand moves 2 cm to and fro
    AxisPosition q(6);
    q[1] = k % 2 == 0 ? 0.01 : -0.01;
    loop.moveHandTo(q);
    loop.tick(50);
  }
  EXPECT_LE(loop.spawns - before, 3);
  EXPECT_EQ(loop.removals, loop.spawns - before);
}

TEST(BodyTable, TouchedBody_KeepsItsSlot) {
  Loop loop(1);
  (void)loop.add(kFirstNumber, {0.1, 0.25, 0.1}, BodyOwner::kLoop);
  loop.tick(50);
  const int slot = loop.body(kFirstNumber).slot;
  ASSERT_GE(slot, 0);
  loop.record.contact_count = 1;
  loop.record.contacts[0].body = slot;
  (void)loop.add(kFirstNumber + 1, {0.1, 0.1, 0.1}, BodyOwner::kLoop);  // nearer
  loop.tick(2000);
  EXPECT_EQ(loop.body(kFirstNumber).slot, slot);
  EXPECT_EQ(loop.body(kFirstNumber + 1).whereabouts, Whereabouts::kLeftOut);
  loop.record.contact_count = 0;
  loop.tick(500);
  EXPECT_EQ(loop.body(kFirstNumber).whereabouts, Whereabouts::kLeftOut);
  EXPECT_EQ(loop.body(kFirstNumber + 1).whereabouts, Whereabouts::kInSlot);
}

TEST(BodyTable, BadOrders_AreRefusedByName) {
  Loop loop;
  for (int i = 0; i < kMostRegistered; ++i) (void)loop.add(kFirstNumber + i, {0.0, 0.0, 4.0});
  EXPECT_EQ(loop.add(kFirstNumber + kMostRegistered, {0, 0, 4}), BodyRefusal::kBudget);
  EXPECT_EQ(loop.add(kFirstNumber, {0, 0, 4}), BodyRefusal::kSlotTaken);
  EXPECT_EQ(loop.add(kFirstNumber - 1, {0, 0, 4}), BodyRefusal::kNoSuchSlot);
  EXPECT_EQ(loop.add(kLastNumber + 1, {0, 0, 4}), BodyRefusal::kNoSuchSlot);
  BodyTable& table = loop.table;
  const BodyPose there = poseAt({0, 1, 4});
  EXPECT_EQ(table.order(removeCommand(9000, 1)), BodyRefusal::kWrongGeneration);
  EXPECT_EQ(table.order(removeCommand(kFirstNumber, 2)), BodyRefusal::kWrongGeneration);
  EXPECT_EQ(table.order(bodyTargetCommand(kFirstNumber, 1, there)), BodyRefusal::kNotTheGames);
  EXPECT_EQ(table.order(teleportCommand(kFirstNumber, 1, there)), BodyRefusal::kNone);
  EXPECT_EQ(loop.body(kFirstNumber).pose.position_m.y, 1.0);
  EXPECT_EQ(table.order(removeCommand(kFirstNumber, 1)), BodyRefusal::kNone);
  EXPECT_EQ(loop.add(kFirstNumber + kMostRegistered, {0, 0, 4}), BodyRefusal::kNone);
  EXPECT_EQ(table.registered().size(), static_cast<std::size_t>(kMostRegistered));
}

TEST(BodyTable, BodyRefusedByTheLoop_IsRetriedAndRemovedOneDropped) {
  Loop loop;
  (void)loop.add(kFirstNumber, {0.1, 0.25, 0.1}, BodyOwner::kLoop);
  loop.tick(25);
  ASSERT_EQ(loop.table.forLoop().size() + static_cast<std::size_t>(loop.spawns), 1U);
  loop.tick(2);
  const int slot = loop.body(kFirstNumber).slot;
  // The loop removes it because it is too fast.
  loop.record.bodies[slot].position_m = kParked;
  loop.tick(2);
  EXPECT_EQ(loop.table.registered().size(), 0U);
  EXPECT_FALSE(loop.table.holds(slot));

  (void)loop.add(kFirstNumber, {0.1, 0.25, 0.1}, BodyOwner::kLoop);
  while (loop.table.forLoop().empty()) loop.tick();
  const Command spawn = loop.table.forLoop().front();
  loop.table.forLoop().clear();  // the loop refuses it: the budget of moving bodies is used up
  loop.record.exercise.event_count = 1;
  loop.record.exercise.events[0] = {kRefusedType, spawn.index,
                                    static_cast<double>(BodyRefusal::kBudget)};
  loop.table.onRecord(loop.record);
  EXPECT_FALSE(loop.table.holds(spawn.index));
  loop.tick(400);
  EXPECT_EQ(loop.body(kFirstNumber).whereabouts, Whereabouts::kInSlot);
}

TEST(BodyTable, BodiesOfASilentGame_LeaveAfterFiveSeconds) {
  Loop loop;
  (void)loop.add(kFirstNumber, {0.0, 0.0, 4.0});
  loop.record.faults = Fault::kHolderSilent;
  loop.tick(4900);
  EXPECT_EQ(loop.table.registered().size(), 1U);
  EXPECT_EQ(loop.add(kFirstNumber + 1, {0, 0, 4}), BodyRefusal::kSilent);
  loop.tick(200);
  EXPECT_EQ(loop.table.registered().size(), 0U);
}

TEST(BodyTable, OrdersToABodyInASlot_ReachTheLoop) {
  Loop loop;
  (void)loop.add(kFirstNumber, {0.1, 0.25, 0.1}, BodyOwner::kGame);
  loop.tick(50);
  const int slot = loop.body(kFirstNumber).slot;
  ASSERT_GE(slot, 0);
  ASSERT_EQ(loop.table.order(bodyTargetCommand(kFirstNumber, 1, poseAt({0.1, 0.3, 0.1}))),
            BodyRefusal::kNone);
  ASSERT_EQ(loop.table.forLoop().size(), 1U);
  const Command order = loop.table.forLoop().front();
  EXPECT_EQ(order.type, CommandType::kBodyTarget);
  EXPECT_EQ(order.index, slot);
  EXPECT_EQ(order.value, loop.last_spawn.generation);
  EXPECT_EQ(poseOf(order).position_m.y, 0.3);
  ASSERT_EQ(loop.table.order(removeCommand(kFirstNumber, 1)), BodyRefusal::kNone);
  EXPECT_EQ(loop.table.registered().size(), 0U);
  EXPECT_TRUE(loop.table.holds(slot)) << "until the loop has let it go";
  loop.tick(3);
  EXPECT_FALSE(loop.table.holds(slot));
  EXPECT_EQ(loop.removals, 1);
}

/// A loop that answers orders as the pool does, after random times and with random faults of its
/// own.
struct RandomLoop {
  struct Body {
    int generation = 0;  ///< 0: parked
    SlotState state = SlotState::kParked;
    bool moves = false, of_table = false;
    int left_ticks = 0;  ///< until the state changes
  };
  RandomLoop(std::mt19937_64& numbers, const Models& models, int slots, int awake)
      : random(numbers), most_awake(awake), bodies(static_cast<std::size_t>(slots)) {
    GameBudget budget = models.scene.game;
    budget.slots = slots;
    budget.awake = awake;
    names = models.exercise->description().event_names;
    table.begin(models.hand, models.device, budget, 0, names);
    record.q_s = AxisPosition(models.hand.axis_count);
    Synergy(models.hand).expand(record.q_s, record.theta);
    record.body_count = slots;
  }
  void report(const char* event, int slot, int value) {
    const auto type = std::find(names.begin(), names.end(), event) - names.begin();
    record.exercise.events[record.exercise.event_count++] = {static_cast<std::int32_t>(type), slot,
                                                             static_cast<double>(value)};
  }
  void refuse(int slot, BodyRefusal why) { report("refused", slot, static_cast<int>(why)); }
  void leave(int slot) {
    report("left", slot, bodies[slot].generation);
    bodies[slot] = Body{};
  }
  [[nodiscard]] int moving() const {
    return static_cast<int>(std::count_if(
        bodies.begin(), bodies.end(), [](const Body& b) { return b.generation != 0 && b.moves; }));
  }
  void spawn(const SpawnOrder& order, bool of_table) {
    Body& body = bodies[order.slot];
    if (body.generation != 0) return refuse(order.slot, BodyRefusal::kSlotTaken);
    if (random() % 10 == 0) return refuse(order.slot, BodyRefusal::kBadMass);
    const bool moves = order.owner != BodyOwner::kFixed;
    EXPECT_TRUE(!of_table || !moves || moving() < most_awake) << "more move than may";
    body = {order.generation, SlotState::kGhost, moves, of_table, static_cast<int>(random() % 20)};
    record.bodies[order.slot].position_m = order.pose.position_m;
    report("appeared", order.slot, order.generation);
  }
  void apply(const Command& command, bool of_table) {
    if (command.type == CommandType::kSpawn) return spawn(spawnOrderOf(command), of_table);
    Body& body = bodies[command.index];
    if (body.generation == 0 || body.generation != static_cast<int>(command.value)) {
      return refuse(command.index, BodyRefusal::kWrongGeneration);
    }
    if (command.type == CommandType::kSetOwner && body.state != SlotState::kLettingGo) {
      body.moves = spawnOrderOf(command).owner != BodyOwner::kFixed;
    }
    if (command.type != CommandType::kRemove || body.state == SlotState::kLettingGo) return;
    if (random() % 2 == 0) return leave(command.index);
    body.state = SlotState::kLettingGo;
    body.left_ticks = static_cast<int>(random() % 60);
    report("letting_go", command.index, body.generation);
  }
  /// @return the slot whose body the loop removed because it was too fast; -1: none
  int tick(std::deque<Command>& own) {
    record.command_count = 0;
    record.exercise.event_count = 0;
    int lost = -1;
    for (std::deque<Command>* from : {&own, &table.forLoop()}) {
      for (; !from->empty() && record.command_count < kMaxCommands; from->pop_front()) {
        apply(from->front(), from != &own);
        record.commands[record.command_count++] = from->front();
      }
    }
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      Body& body = bodies[i];
      const int slot = static_cast<int>(i);
      const bool over = body.left_ticks-- <= 0;
      if (body.state == SlotState::kGhost && over) {
        body.state = SlotState::kSolid;
        report("solid", slot, body.generation);
      } else if (body.state == SlotState::kLettingGo && over) {
        leave(slot);
      } else if (lost < 0 && body.state == SlotState::kSolid && random() % 3000 == 0) {
        lost = body.of_table ? slot : -1;
        leave(slot);
      }
      if (body.generation == 0) record.bodies[i].position_m = kParked;
    }
    ++record.tick;
    record.time_s = 1e-3 * static_cast<double>(record.tick);
    record.contact_count = random() % 30 == 0 ? 1 : 0;
    record.contacts[0].body = static_cast<int>(random() % bodies.size());
    table.onRecord(record);
    return lost;
  }

  std::mt19937_64& random;
  int most_awake;
  std::vector<Body> bodies;
  std::vector<std::string> names;
  BodyTable table;
  TickRecord record;
};

/// Random orders of a game that names slots itself, for fixed bodies, and registers others.
class RandomGame {
 public:
  RandomGame(std::mt19937_64& random, const Models& models)
      : random_(random),
        loop_(random, models, 4 + static_cast<int>(random() % 5),
              1 + static_cast<int>(random() % 3)) {
    prepare(0);
    prepare(1);
  }
  void tick() {
    if (random_() % 10 == 0) order();
    if (random_() % 200 == 0) prepare(static_cast<int>(random_() % 2));
    const RegisteredBodies before = loop_.table.registered();
    const int lost = loop_.tick(own_);
    for (const RegisteredBody& body : before) {
      // A body that the loop removes is not registered any more, unless it was leaving its slot.
      if (lost >= 0 && body.slot == lost) lost_.insert(body.number);
    }
    check();
  }

 private:
  void prepare(int set) {
    GameShapes ball;
    ball.id = ++last_id_;
    ball.radius_m = 0.03;
    const bool used = std::any_of(registered_.begin(), registered_.end(),
                                  [&](const auto& at) { return at.second.shape_set == set; });
    const BodyRefusal is = loop_.table.prepare(set, std::make_shared<const GameShapes>(ball));
    if (used) EXPECT_EQ(is, BodyRefusal::kShapesBusy) << "a registered body has the set";
  }
  void order() {
    const bool own = random_() % 3 == 0;
    const int index =
        own ? static_cast<int>(random_() % 3) : kFirstNumber + static_cast<int>(random_() % 12);
    const auto kind = random_() % 5;
    SpawnOrder spawn = spawnOf(index, static_cast<int>(random_() % 2),
                               own ? BodyOwner::kFixed : static_cast<BodyOwner>(random_() % 3),
                               poseAt(somewhere(random_, random_() % 2 == 0 ? 0.3 : 2.0)));
    spawn.generation = generations_[index] + (kind < 2 ? 1 : 0);
    Command command = spawnCommand(spawn);
    if (kind == 2) command = removeCommand(index, spawn.generation);
    if (kind == 3) command = teleportCommand(index, spawn.generation, spawn.pose);
    if (kind == 4)
      command = setOwnerCommand(index, spawn.generation, own ? BodyOwner::kFixed : spawn.owner);
    const bool taken = own && kind < 2 &&
                       (loop_.table.holds(index) ||
                        std::any_of(own_.begin(), own_.end(), [&](const Command& waiting) {
                          return waiting.type == CommandType::kSpawn && waiting.index == index;
                        }));
    const BodyRefusal refusal = loop_.table.order(command);
    if (taken) EXPECT_EQ(refusal, BodyRefusal::kSlotTaken) << "slot " << index;
    if (refusal != BodyRefusal::kNone) return;
    generations_[index] = spawn.generation;
    if (own) return own_.push_back(command);
    if (kind < 2) registered_[index] = spawn;
    if (kind == 2) registered_.erase(index);
  }
  void check() {
    // Registered is what was ordered, except what the loop removed.
    std::set<int> slots;
    std::map<int, SpawnOrder> missing = registered_;
    for (const RegisteredBody& body : loop_.table.registered()) {
      ASSERT_EQ(missing.erase(body.number), 1U) << "nobody registered " << body.number;
      ASSERT_EQ(body.slot >= 0, body.whereabouts == Whereabouts::kInSlot);
      if (body.slot < 0) continue;
      ASSERT_TRUE(loop_.table.holds(body.slot));
      ASSERT_TRUE(slots.insert(body.slot).second) << "two bodies have slot " << body.slot;
    }
    for (const auto& [number, spawn] : missing) {
      ASSERT_TRUE(lost_.count(number)) << number << " is no longer registered";
      registered_.erase(number);
    }
    lost_.clear();
    // Clients see what the loop has.
    std::vector<std::array<int, 3>> is, shown;
    for (std::size_t i = 0; i < loop_.bodies.size(); ++i) {
      const RandomLoop::Body& body = loop_.bodies[i];
      if (body.generation == 0) continue;
      is.push_back({static_cast<int>(i), body.generation, static_cast<int>(body.state)});
    }
    for (const GameBody& body : loop_.table.inSlots() ? *loop_.table.inSlots() : GameBodies{}) {
      shown.push_back({body.slot, body.generation, static_cast<int>(body.state)});
      ASSERT_NE(body.shapes, nullptr);
    }
    ASSERT_EQ(shown, is);
  }

  std::mt19937_64& random_;
  RandomLoop loop_;
  std::deque<Command> own_;
  std::map<int, SpawnOrder> registered_;
  std::map<int, int> generations_;
  std::set<int> lost_;
  std::uint32_t last_id_ = 0;
};

// Laws: nobody has two slots; clients see what the loop has; registered is what was ordered; at
// most budget.awake bodies move; a set of shapes that a body has is kept.
TEST(BodyTable, RandomOrdersAndAnswers_KeepTheLaws) {
  auto random = seededRandom(6301);
  const Models models = gameModels();
  for (int n = cases(400); n > 0; --n) {
    RandomGame game(random, models);
    for (int k = 0; k < 1000; ++k) game.tick();
    if (HasFatalFailure()) return;
  }
}

}  // namespace
}  // namespace wholehand::test
