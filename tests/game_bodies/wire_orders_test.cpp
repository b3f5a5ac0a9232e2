// Orders of a game as bytes of the protocol, carried out on the simulated clock.
#include "game_bodies/expect_same_rerun.hpp"
#include "game_bodies/game_tools.hpp"
#include "replay/replayed_recording.hpp"
#include "rig/registry/body_table.hpp"
#include "rig/run/run.hpp"
#include "station/body_orders.hpp"
#include "station/server/client_words.hpp"
#include "support/contains.hpp"
#include "support/folder.hpp"
#include "support/seed.hpp"

#include <chrono>
#include <cmath>

namespace wholehand::test {
namespace {

using namespace words;  // NOLINT(google-build-using-namespace): the client's vocabulary

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// The station's check of a message, in a scene with the shipped budget.
CheckedOrders checkedOf(const wire::Bytes& message, const GameBudget& budget) {
  const auto decoded = wire::decode(message);
  if (!decoded) throw std::runtime_error(format(decoded.errors()));
  if (bodiesOf(*decoded) == nullptr) throw std::runtime_error("no order to bodies");
  return checkOrders(*bodiesOf(*decoded), budget, 1);
}

/// The table's answers to the message's orders, except kNone.
std::vector<BodyRefusal> refusalsOf(BodyTable& table, const CheckedOrders& checked) {
  std::vector<BodyRefusal> out;
  if (checked.shapes) out.push_back(table.prepare(checked.shape_set, checked.shapes));
  for (const Command& command : checked.commands) {
    if (!checked.shapes) out.push_back(table.order(command));
  }
  std::erase(out, BodyRefusal::kNone);
  return out;
}

/// A game that sends its orders as messages.
struct WireGame : Game {
  WireGame() : Game(gameModels(), atRest()) {
    table.follow(rig->models.exercise->description().event_names);
  }
  /// Passes the message on; none of its items may be refused.
  void send(const wire::Bytes& message) {
    const CheckedOrders checked = checkedOf(message, rig->models.scene.game);
    for (const RefusedItem& item : checked.refused) ADD_FAILURE() << item.reason;
    EXPECT_TRUE(refusalsOf(table, checked).empty());
    for (const Command& command : checked.commands) order(command);
  }
  bool becomes(int slot, const char* event, int most) {
    for (int k = 0; k < most; ++k) {
      table.onRecord(tick());
      if (this->event(slot) == event) return true;
    }
    return false;
  }
  [[nodiscard]] GameBodies bodies() const {
    return table.inSlots() ? *table.inSlots() : GameBodies{};
  }

  BodyTable table;
};

fb::Pose placedAt(const Eigen::Vector3d& at) {
  return words::placed(static_cast<float>(at.x()), static_cast<float>(at.y()),
                       static_cast<float>(at.z()));
}

TEST(GameOnTheWire, DrivenBall_IsSolidPressesTheHandAndReleasesIt) {
  WireGame game;
  game.tick();
  std::uint32_t id = 0;
  const Eigen::Vector3d palm = game.palm();
  const Eigen::Vector3d beside = palm + Eigen::Vector3d(0.0, 0.25, 0.0);
  game.send(prepareBall(++id, 3, 0.03F));
  SpawnWords ball;
  ball.slot = 7, ball.generation = 5, ball.shape_set = 3, ball.owner = fb::BodyOwner::Game;
  ball.pose = placedAt(beside);
  game.send(spawn(++id, {ball}));
  ASSERT_TRUE(game.becomes(7, "solid", 20));
  ASSERT_EQ(game.bodies().size(), 1U);
  EXPECT_EQ(game.bodies()[0].slot, 7);
  EXPECT_EQ(game.bodies()[0].generation, 5);
  EXPECT_EQ(game.bodies()[0].state, SlotState::kSolid);
  EXPECT_EQ(game.bodies()[0].shapes->pieces[0].radius_m, static_cast<double>(0.03F));
  double most_n = 0.0;
  for (int k = 0; k < 2000; ++k) {
    if (k % 16 == 0) game.send(bodyTargets(++id, {{7, 5, placedAt(palm)}}));
    game.table.onRecord(game.tick());
    if (k > 1500) most_n = std::max(most_n, game.forceOf(7).norm());
  }
  figure("a driven ball presses the palm", most_n, "N");
  EXPECT_GT(most_n, 0.5);
  EXPECT_LT(most_n, 1.1 * 5.0);  // F_max of ADR 43
  game.send(words::remove(++id, {{7, 5}}));
  EXPECT_TRUE(game.becomes(7, "letting_go", 20));
  EXPECT_EQ(game.bodies()[0].state, SlotState::kLettingGo);
  EXPECT_TRUE(game.becomes(7, "left", 2000));
  EXPECT_TRUE(game.bodies().empty());
  EXPECT_FALSE(any(game.record.faults & kStoppingFaults));
}

TEST(GameOnTheWire, TeleportAndSetOwner_ActOnTheBody) {
  WireGame game;
  std::uint32_t id = 0;
  game.send(prepareBox(++id, 0, {0.02F, 0.025F, 0.03F}));
  SpawnWords box;
  box.owner = fb::BodyOwner::Fixed;
  game.send(spawn(++id, {box}));
  ASSERT_TRUE(game.becomes(0, "solid", 20));
  game.send(teleport(++id, {{0, 1, words::placed(0.5F, -0.25F, 0.5F)}}));
  game.run(2);
  EXPECT_EQ(game.body(0).position_m.y, -0.25);
  game.send(setOwner(++id, {{0, 1, fb::BodyOwner::Loop}}));
  game.run(102);
  EXPECT_LT(game.body(0).velocity_m_s.z, -0.9);  // it falls: g 0.1 s
}

TEST(GameOnTheWire, ShapesInUse_AreRefusedUntilTheirBodyLeft) {
  WireGame game;
  const GameBudget& budget = game.rig->models.scene.game;
  game.send(prepareBall(1, 0, 0.03F));
  game.send(spawn(2, {{}}));
  const auto again = [&](int set) {
    return refusalsOf(game.table,
                      checkedOf(prepareBall(3, static_cast<std::uint16_t>(set), 0.04F), budget));
  };
  const std::vector busy{BodyRefusal::kShapesBusy};
  EXPECT_EQ(again(0), busy) << "spawn under way";
  EXPECT_TRUE(again(1).empty());
  ASSERT_TRUE(game.becomes(0, "solid", 20));
  EXPECT_EQ(again(0), busy);
  game.send(words::remove(4, {{0, 1}}));
  ASSERT_TRUE(game.becomes(0, "left", 20));
  EXPECT_TRUE(again(0).empty());
}

TEST(GameOnTheWire, SpawnIntoAPendingSlotOrWithoutShapes_IsRefused) {
  WireGame game;
  const GameBudget& budget = game.rig->models.scene.game;
  const auto again = [&] { return refusalsOf(game.table, checkedOf(spawn(9, {{}}), budget)); };
  EXPECT_EQ(again(), std::vector{BodyRefusal::kNoSuchShapes});
  game.send(prepareBall(1, 0, 0.03F));
  game.send(spawn(2, {{}}));
  EXPECT_EQ(again(), std::vector{BodyRefusal::kSlotTaken});
}

struct BadItem {
  const char* what;
  wire::Bytes message;
  BodyRefusal refusal;
  const char* expected;  ///< part of the expected reason
};

std::vector<BadItem> badBodies() {
  const auto changed = [](auto change) {
    SpawnWords words;
    change(words);
    return spawn(1, {words});
  };
  const fb::Pose off = words::placed(0.5F, 0.3F, 0.2F, {0, 0, 0, 1.01F});
  const fb::Pose nan = words::placed(kNan, 0.3F, 0.2F);
  return {
      {"slot", changed([](auto& w) { w.slot = 64; }), BodyRefusal::kNoSuchSlot, "[0, 63]"},
      {"large slot", words::remove(1, {{0xFFFFFFFFU, 1}}), BodyRefusal::kNoSuchSlot, "[0, 63]"},
      {"generation 0", changed([](auto& w) { w.generation = 0; }), BodyRefusal::kWrongGeneration,
       "[1, 16777215]"},
      {"generation", words::remove(1, {{0, 16777216}}), BodyRefusal::kWrongGeneration, "16777215"},
      {"set", changed([](auto& w) { w.shape_set = 32; }), BodyRefusal::kNoSuchShapes, "[0, 31]"},
      {"NaN", changed([&](auto& w) { w.pose = nan; }), BodyRefusal::kBadPose, "must be finite"},
      {"quaternion", changed([&](auto& w) { w.pose = off; }), BodyRefusal::kBadPose, "1.01"},
      {"world", teleport(1, {{0, 1, words::placed(5.1F, 0, 0)}}), BodyRefusal::kBadPose, "5 m"},
      {"target", bodyTargets(1, {{0, 1, nan}}), BodyRefusal::kBadPose, "must be finite"},
      {"velocity", changed([](auto& w) {
         w.velocity_m_s = {0, 2.1F, 0};
       }),
       BodyRefusal::kBadPose, "2.1"},
      {"NaN velocity", changed([](auto& w) {
         w.velocity_m_s = {kNan, 0, 0};
       }),
       BodyRefusal::kBadPose, "nan"},
      {"owner", changed([](auto& w) { w.owner = static_cast<fb::BodyOwner>(3); }),
       BodyRefusal::kBadPose, "Loop, Game or Fixed"},
      {"owner again", setOwner(1, {{0, 1, static_cast<fb::BodyOwner>(255)}}), BodyRefusal::kBadPose,
       "Loop, Game or Fixed"},
      {"mass", changed([](auto& w) { w.mass_kg = 2.1F; }), BodyRefusal::kBadMass, "[0.02, 2] kg"},
      {"NaN mass", changed([](auto& w) { w.mass_kg = kNan; }), BodyRefusal::kBadMass, "nan"},
      {"friction", changed([](auto& w) { w.friction = -0.1F; }), BodyRefusal::kBadMass, "[0, 2]"},
  };
}

std::vector<BadItem> badShapes() {
  const std::vector<fb::Vec3> corners = {{0, 0, 0}, {0.05F, 0, 0}, {0, 0.05F, 0}, {0, 0, 0.05F}};
  const std::vector<std::uint32_t> faces = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
  std::vector<fb::Vec3> dented = corners;  // with a corner inside the tetrahedron's largest face
  dented.emplace_back(0.01F, 0.01F, 0.01F);
  const std::vector<std::uint32_t> dent = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 4, 2, 3, 4, 3, 1, 4};
  const std::vector<fb::Vec3> flat = {{0, 0, 0}, {0.05F, 0, 0}, {0, 0.05F, 0}, {0.05F, 0.05F, 0}};
  const std::vector<std::uint32_t> open(faces.begin() + 3, faces.end());
  std::vector<std::uint32_t> wild = faces;
  wild[4] = 4;
  const fb::Pose turned = words::placed(0, 0, 0, {0, 0, 0, 0.9F});
  const fb::Pose lost = words::placed(kNan, 0, 0);
  const auto bad = BodyRefusal::kBadShapes;
  return {
      {"small", prepareBall(1, 0, 0.004F), bad, "budget.size_m"},
      {"large", prepareBall(1, 0, 0.16F), bad, "budget.size_m"},
      {"negative", prepareBall(1, 0, -0.03F), bad, "budget.size_m"},
      {"NaN", prepareBall(1, 0, kNan), bad, "not finite"},
      {"flat box", prepareBox(1, 0, {0.02F, 0.02F, 0.0F}), bad, "budget.size_m"},
      {"turned", prepareBox(1, 0, {0.02F, 0.02F, 0.02F}, &turned), bad, "norm 0.9"},
      {"lost", prepareBox(1, 0, {0.02F, 0.02F, 0.02F}, &lost), bad, "not finite"},
      {"set", prepareBall(1, 32, 0.03F), BodyRefusal::kNoSuchShapes, "[0, 31]"},
      {"not convex", prepareMesh(1, 0, dented, dent), bad, "not convex"},
      {"flat", prepareMesh(1, 0, flat, faces), bad, "no volume"},
      {"open", prepareMesh(1, 0, corners, open), bad, "watertight"},
      {"NaN corner", prepareMesh(1, 0, {{0, 0, 0}, {kNan, 0, 0}, {0, 1, 0}, {0, 0, 1}}, faces), bad,
       "not finite"},
      {"no such corner", prepareMesh(1, 0, corners, wild), bad, "index of a vertex"},
      {"too many corners", prepareMesh(1, 0, std::vector<fb::Vec3>(65), faces), bad, "[4, 64]"},
      {"far apart",
       prepareShapes(1, 0,
                     [](Builder& b) {
                       const fb::Pose at = words::placed(2, 0, 0);
                       return std::vector{fb::CreateShape(b, fb::ShapeType::Sphere, nullptr, 0.03F),
                                          fb::CreateShape(b, fb::ShapeType::Sphere, nullptr, 0.03F,
                                                          0.0F, 0, 0, &at)};
                     }),
       bad, "of the centre of mass"},
      {"pieces",
       prepareShapes(1, 0,
                     [](Builder& b) {
                       std::vector<flatbuffers::Offset<fb::Shape>> out;
                       for (int i = 0; i < 5; ++i) {
                         out.push_back(fb::CreateShape(b, fb::ShapeType::Sphere, nullptr, 0.03F));
                       }
                       return out;
                     }),
       bad, "budget.pieces"},
  };
}

TEST(GameOnTheWire, BadItems_AreRefusedByNameAndNotPassedToTheLoop) {
  const GameBudget budget = gameModels().scene.game;
  std::vector<BadItem> all = badBodies();
  for (BadItem& bad : badShapes()) all.push_back(std::move(bad));
  for (const BadItem& bad : all) {
    SCOPED_TRACE(bad.what);
    const CheckedOrders checked = checkedOf(bad.message, budget);
    EXPECT_TRUE(checked.commands.empty());
    ASSERT_FALSE(checked.refused.empty());
    EXPECT_STREQ(nameOf(checked.refused[0].refusal), nameOf(bad.refusal));
    EXPECT_TRUE(contains(checked.refused[0].reason, bad.expected));
    const OrderReply reply = replyFor(checked.refused);
    EXPECT_EQ(reply.refusal, Refusal::kBodiesRefused);
    EXPECT_TRUE(contains(reply.reason, bad.expected));
  }
}

TEST(GameOnTheWire, GoodItemsBesideBadOnes_ArePassedToTheLoop) {
  const GameBudget budget = gameModels().scene.game;
  const CheckedOrders checked =
      checkedOf(words::remove(1, {{2, 1}, {64, 1}, {3, 1}, {2, 1}}), budget);
  ASSERT_EQ(checked.commands.size(), 2U);
  EXPECT_EQ(checked.commands[0].index, 2);
  EXPECT_EQ(checked.commands[1].index, 3);
  ASSERT_EQ(checked.refused.size(), 2U);
  EXPECT_EQ(checked.refused[0].item, 1);
  EXPECT_EQ(checked.refused[0].refusal, BodyRefusal::kNoSuchSlot);
  EXPECT_EQ(checked.refused[1].item, 3);
  EXPECT_EQ(checked.refused[1].slot, 2);
  EXPECT_EQ(checked.refused[1].refusal, BodyRefusal::kSlotTaken) << "named twice";
}

/// A double pyramid over a regular polygon: 64 vertices, 124 triangles.
wire::Bytes largestShapes(std::uint32_t id) {
  constexpr int kRing = kMaxPieceVertices - 2;
  std::vector<fb::Vec3> points;
  std::vector<std::uint32_t> triangles;
  for (int i = 0; i < kRing; ++i) {
    const double angle = 2.0 * M_PI * i / kRing;
    points.emplace_back(static_cast<float>(0.05 * std::cos(angle)),
                        static_cast<float>(0.05 * std::sin(angle)), 0.0F);
    const auto next = static_cast<std::uint32_t>((i + 1) % kRing);
    for (const std::uint32_t apex : {std::uint32_t{kRing}, std::uint32_t{kRing + 1}}) {
      triangles.insert(triangles.end(), {static_cast<std::uint32_t>(i), next, apex});
    }
  }
  points.emplace_back(0.0F, 0.0F, 0.04F);
  points.emplace_back(0.0F, 0.0F, -0.04F);
  return prepareShapes(id, 0, [&](Builder& b) {
    std::vector<flatbuffers::Offset<fb::Shape>> out;
    for (int i = 0; i < kMaxSlotPieces; ++i) {
      const fb::Pose above({0.0F, 0.0F, 0.04F * static_cast<float>(i)}, {0.0F, 0.0F, 0.0F, 1.0F});
      out.push_back(fb::CreateShapeDirect(b, fb::ShapeType::ConvexMesh, nullptr, 0.0F, 0.0F,
                                          &points, &triangles, &above));
    }
    return out;
  });
}

TEST(GameOnTheWire, LargestShapes_AreCheckedInTimeAndFitTheQueue) {
  GameBudget budget = gameModels().scene.game;
  budget.pieces = kMaxSlotPieces;
  budget.vertices = kMaxPieceVertices;
  const wire::Bytes message = largestShapes(1);
  const auto begun = std::chrono::steady_clock::now();
  const CheckedOrders checked = checkedOf(message, budget);
  const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - begun;
  for (const RefusedItem& item : checked.refused) ADD_FAILURE() << item.reason;
  figure("largest shapes", static_cast<double>(message.size()), "bytes");
  figure("largest shapes checked and prepared", took.count(), "ms");
  // One command for the head and one for each piece, and one for every four vertices.
  EXPECT_EQ(checked.commands.size(), 1U + kMaxSlotPieces * (1U + kMaxPieceVertices / 4U));
  EXPECT_LE(checked.commands.size(), 288U) << "what may wait for the loop";
}

/// A tetrahedron.
const std::vector<fb::Vec3> kCorners = {{0, 0, 0}, {0.05F, 0, 0}, {0, 0.05F, 0}, {0, 0, 0.05F}};
const std::vector<std::uint32_t> kFaces = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};

TEST(GameOnTheWire, InsideOutMesh_IsTurnedOutward) {
  const GameBudget budget = gameModels().scene.game;
  const std::vector<fb::Vec3>& corners = kCorners;
  const std::vector<std::uint32_t>& outward = kFaces;
  const std::vector<std::uint32_t> inward = {0, 1, 2, 0, 3, 1, 0, 2, 3, 1, 3, 2};
  const CheckedOrders good = checkedOf(prepareMesh(1, 0, corners, outward), budget);
  const CheckedOrders turned = checkedOf(prepareMesh(1, 0, corners, inward), budget);
  ASSERT_TRUE(turned.refused.empty());
  ASSERT_EQ(turned.commands.size(), good.commands.size());
  for (std::size_t k = 0; k < 3; ++k) {  // moments of inertia
    EXPECT_GT(good.commands[0].numbers[k], 0.0);
    EXPECT_NEAR(turned.commands[0].numbers[k], good.commands[0].numbers[k], tolerance(1e-12));
  }
  EXPECT_LT((turned.shapes->com_m - good.shapes->com_m).norm(), tolerance(1e-12));
  // The centroid of a tetrahedron is the mean of its corners.
  EXPECT_NEAR(good.shapes->com_m.x(), 0.0125, tolerance(1e-8));
}

TEST(GameOnTheWire, MutatedMessages_NeverGiveAnUncheckedCommand) {
  auto random = seededRandom(4305);
  const GameBudget budget = gameModels().scene.game;
  std::uint64_t passed = 0, refused = 0, unreadable = 0;
  for (int n = cases(20'000); n > 0; --n) {
    const auto all = oneOfEach();
    wire::Bytes bytes = all[all.size() - 6 + random() % 6];
    for (std::uint64_t flips = 1 + random() % 3; flips > 0; --flips) {
      bytes[random() % bytes.size()] ^= static_cast<std::uint8_t>(1U << random() % 8);
    }
    const auto decoded = wire::decode(bytes);
    if (!decoded || bodiesOf(*decoded) == nullptr) {
      ++unreadable;
      continue;
    }
    const CheckedOrders checked = checkOrders(*bodiesOf(*decoded), budget, 1);
    refused += checked.refused.empty() ? 0 : 1;
    for (const Command& c : checked.commands) {
      ++passed;
      EXPECT_TRUE((c.index >= 0 && c.index < kMaxSlots) || isRegistered(c.index));
      for (const double number : c.numbers) EXPECT_TRUE(std::isfinite(number));
    }
  }
  figure("mutated messages refused while read", static_cast<double>(unreadable), "1");
  figure("mutated messages with refused items", static_cast<double>(refused), "1");
  EXPECT_GT(passed, 0U);
  EXPECT_GT(refused, 0U);
}

/// Bodies reported to live clients, with the tick of the report.
using Reported = std::vector<std::pair<std::uint64_t, std::shared_ptr<const GameBodies>>>;

/// Records a session whose orders are sent as messages.
/// @return how often a body became solid; -1: the session faulted
int recordSession(const std::string& path, int ticks, Reported& reported) {
  auto rig = orThrow(buildRig(gameModels(), atRest(), {}));
  const GameBudget budget = rig->models.scene.game;
  BodyTable table;
  table.follow(rig->models.exercise->description().event_names);
  std::uint32_t id = 0;
  std::unique_ptr<Run> run;
  int solid = 0;
  RunPlan plan;
  plan.duration_ticks = static_cast<std::uint64_t>(ticks);
  plan.record = path;
  plan.simulated_clock = true;
  const auto send = [&](const wire::Bytes& message) {
    const CheckedOrders checked = checkedOf(message, budget);
    EXPECT_TRUE(refusalsOf(table, checked).empty());
    for (const Command& c : checked.commands) {
      if (!run->tryCommand(c)) throw std::runtime_error("no room for a command");
    }
  };
  SpawnWords ball;
  ball.owner = fb::BodyOwner::Game;
  ball.pose = words::placed(0.05F, 0.25F, 0.0F);
  SpawnWords box;
  box.slot = 1, box.shape_set = 1, box.pose = words::placed(0.05F, 0.0F, 0.25F);
  SpawnWords stone;
  stone.slot = 5, stone.shape_set = 2, stone.owner = fb::BodyOwner::Fixed;
  SpawnWords block = stone;
  block.slot = 6, block.shape_set = 3, block.pose = words::placed(-0.5F, 0.3F, 0.2F);
  const fb::Pose aside({0.01F, 0.0F, 0.02F}, {0.0F, 0.0F, 0.70710678F, 0.70710678F});
  plan.sinks.push_back([&](const TickRecord& record) {
    for (int i = 0; i < record.exercise.event_count; ++i) {
      solid += record.exercise.events[i].type == 1 ? 1 : 0;
    }
    table.onRecord(record);
    const auto now = table.inSlots();
    if (now && (reported.empty() || reported.back().second != now))
      reported.emplace_back(record.tick, now);
    const auto tick = static_cast<int>(record.tick);
    if (tick == 10) send(prepareBall(++id, 0, 0.03F));
    if (tick == 10) send(prepareBox(++id, 1, {0.02F, 0.03F, 0.04F}));
    if (tick == 10) send(prepareMesh(++id, 2, kCorners, kFaces));
    if (tick == 12) send(prepareBox(++id, 3, {0.02F, 0.03F, 0.04F}, &aside));
    if (tick == 20) send(spawn(++id, {ball, box, stone}));  // the box falls on the hand
    if (tick == 30) send(spawn(++id, {block}));
    if (tick > 30 && tick < 2000 && tick % 16 == 0) {
      send(bodyTargets(++id, {{0, 1, words::placed(0.05F, 0.0F, 0.0F)}}));
    }
    if (tick == 2000) send(words::remove(++id, {{0, 1}}));
  });
  run = orThrow(Run::prepare(std::shared_ptr<Rig>(std::move(rig)), std::move(plan)));
  orThrow(run->simulate());
  run->finish();
  return run->outcome().faulted ? -1 : solid;
}

TEST(GameOnTheWire, RecordedSession_ReplaysBitIdentically) {
  const Folder folder;
  Reported reported;
  EXPECT_EQ(recordSession(folder.file("run.h5"), 3000, reported), 4);
  expectSameRerun(folder.file("run.h5"), 3000);
}

/// One change in the answer of a replay.
struct Replayed {
  std::uint32_t row = 0;
  const fb::GameBodies* bodies = nullptr;
};

std::vector<Replayed> changesIn(const std::string& answer) {
  std::vector<Replayed> out;
  for (std::size_t at = 0; at + 8 <= answer.size();) {
    std::uint32_t head[2];
    std::memcpy(head, answer.data() + at, sizeof head);
    const auto* message = reinterpret_cast<const std::uint8_t*>(answer.data() + at + 8);
    flatbuffers::Verifier verifier(message, head[1]);
    if (!fb::VerifyMessageBuffer(verifier)) throw std::runtime_error("not a message");
    out.push_back({head[0], fb::GetMessage(message)->payload_as_GameBodies()});
    at += 8 + head[1];
  }
  return out;
}

TEST(GameOnTheWire, RecordedSession_ShowsTheBodiesReportedToLiveClients) {
  const Folder folder;
  Reported reported;
  EXPECT_EQ(recordSession(folder.file("run.h5"), 2300, reported), 4);
  ReplayedRecording recording(folder.file("run.h5"));
  const auto answer = recording.answer(orThrow(parseReplayQuestion("bodies")));
  ASSERT_EQ(answer.status, 200);
  const std::vector<Replayed> changes = changesIn(answer.body);
  ASSERT_GE(changes.size(), 4U);
  ASSERT_EQ(changes.size(), reported.size());
  std::map<std::uint32_t, const fb::GameShapes*> shapes;
  for (std::size_t i = 0; i < changes.size(); ++i) {
    SCOPED_TRACE(i);
    EXPECT_EQ(changes[i].row, reported[i].first);
    for (const auto* set : *changes[i].bodies->new_shapes()) shapes[set->id()] = set;
    const GameBodies& live = *reported[i].second;
    ASSERT_EQ(changes[i].bodies->bodies()->size(), live.size());
    for (std::size_t k = 0; k < live.size(); ++k) {
      const auto* body = changes[i].bodies->bodies()->Get(static_cast<unsigned>(k));
      EXPECT_EQ(body->slot(), static_cast<std::uint32_t>(live[k].slot));
      EXPECT_EQ(body->generation(), static_cast<std::uint32_t>(live[k].generation));
      EXPECT_EQ(static_cast<int>(body->state()), static_cast<int>(live[k].state));
      ASSERT_TRUE(shapes.count(body->shapes()));
      const auto* piece = shapes[body->shapes()]->pieces()->Get(0);
      const Shape& given = live[k].shapes->pieces[0];
      EXPECT_EQ(static_cast<int>(piece->type()), static_cast<int>(given.type));
      const Eigen::Vector3d from_com_m = given.in_body.translation_m - live[k].shapes->com_m;
      EXPECT_NEAR(piece->in_body()->position_m().z(), from_com_m.z(), tolerance(1e-6));
      if (given.type != ShapeType::kConvexMesh) continue;
      EXPECT_EQ(piece->points_m()->size(), 4U);
      EXPECT_EQ(piece->triangles()->size(), 12U) << "faces of its hull";
    }
  }
}

}  // namespace
}  // namespace wholehand::test
