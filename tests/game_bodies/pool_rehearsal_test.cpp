// The rehearsal fills the slots of a game with the worst bodies of the budget before any effort is
// rendered.
#include "files/mesh/convex_hull.hpp"
#include "files/scene/separation.hpp"
#include "game_bodies/game_tools.hpp"
#include "loop/runtime/session.hpp"
#include "rig/admission.hpp"
#include "rig/rehearsal.hpp"
#include "support/contains.hpp"

#include <cmath>
#include <numbers>
#include <set>

namespace wholehand::test {
namespace {

constexpr int kAxes = 6;

/// Options that accept any CPU time of this machine; a test adds time.
RehearsalOptions anyTime() {
  RehearsalOptions options;
  options.allowed_period_share = 1e4;  // 10 s per tick
  options.attempts = 1;
  return options;
}

/// Options for which ticks with more than `most` moving bodies are too slow.
RehearsalOptions slowAbove(int most) {
  RehearsalOptions options = anyTime();
  options.extra_ns = [most](const TickRecord& record) -> std::int64_t {
    return record.exercise.values[2] > most ? 20'000'000'000 : 0;  // "moving" of the game scene
  };
  return options;
}

Models smallGame(int slots, int awake) {
  Models models = gameModels();
  models.scene.game.slots = slots;
  models.scene.game.awake = awake;
  return models;
}

std::unique_ptr<HapticDevice> restingDevice() {
  return std::make_unique<RestingDevice>(AxisPosition(kAxes));
}

/// Counts the bodies that fill the shipped budget in their own world.
TEST(WorstCaseBodies, WorstCaseBodies_HaveTheCountsOfTheBudget) {
  const Models models = gameModels();
  const GameBudget& budget = models.scene.game;
  Game game(models, atRest());
  WorstCaseBodies filling(game.rig->models, budget, AxisPosition(kAxes));
  const auto& owners = filling.owners();
  ASSERT_EQ(static_cast<int>(owners.size()), budget.slots);
  EXPECT_EQ(std::count(owners.begin(), owners.end(), BodyOwner::kFixed),
            budget.slots - budget.awake);
  EXPECT_EQ(std::count(owners.begin(), owners.end(), BodyOwner::kLoop), budget.awake / 2);
  ASSERT_EQ(static_cast<int>(filling.pieces().size()), budget.pieces);
  for (const Shape& piece : filling.pieces()) {
    EXPECT_EQ(piece.type, ShapeType::kConvexMesh);
    EXPECT_EQ(static_cast<int>(piece.points_m.size()), budget.vertices);
  }
  EXPECT_TRUE(prepareShapes(filling.pieces(), budget)) << "a game could order it";

  int solid = 0, moving = 0, refused = 0, contacts = 0;
  for (int k = 0; k < 500; ++k) {
    filling.order(game.record);
    game.rig->renderer->tick(1, game.record);
    const ExerciseRecord& said = game.record.exercise;
    for (int i = 0; i < said.event_count; ++i) refused += said.events[i].type == 5 ? 1 : 0;
    solid = std::max(solid, static_cast<int>(said.values[0] - said.values[1]));
    moving = std::max(moving, static_cast<int>(said.values[2]));
    contacts = std::max(contacts, game.record.contact_count);
  }
  EXPECT_EQ(refused, 0);
  EXPECT_EQ(solid, budget.slots);
  EXPECT_EQ(moving, budget.awake);
  EXPECT_GE(contacts, 3) << "of the open hand";

  // Moving bodies touch others.
  const auto poseOf = [&](int slot) {
    const BodyState& state = game.body(slot);
    Pose body;
    body.rotation = state.orientation_xyzw.eigen().toRotationMatrix();
    body.translation_m = state.position_m.eigen();
    return body;
  };
  std::set<std::pair<int, int>> touching;
  for (int a = 0; a < budget.slots; ++a) {
    for (int b = a + 1; b < budget.slots; ++b) {
      if (owners[a] == BodyOwner::kFixed && owners[b] == BodyOwner::kFixed) continue;
      if ((poseOf(a).translation_m - poseOf(b).translation_m).norm() > 0.05) continue;
      for (const Shape& of_a : filling.pieces()) {
        for (const Shape& of_b : filling.pieces()) {
          if (separation(of_a, poseOf(a), of_b, poseOf(b)) < 5e-4) touching.insert({a, b});
        }
      }
    }
  }
  figure("pool_filling_touching_pairs", static_cast<double>(touching.size()), "pairs of bodies");
  EXPECT_GE(3 * static_cast<int>(touching.size()), budget.awake);
}

Shape meshOf(const std::vector<Eigen::Vector3d>& points) {
  const auto hull = orThrow(convexHull(points));
  return orThrow(convexMesh(hull.points, hull.triangles));
}

/// A convex mesh of points on an ellipsoid.
Shape roundMesh(int vertices, const Eigen::Vector3d& size_m) {
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < vertices; ++i) {
    const double z = 1.0 - 2.0 * (i + 0.5) / vertices, r = std::sqrt(1.0 - z * z);
    const Eigen::Vector3d unit(r * std::cos(2.4 * i), r * std::sin(2.4 * i), z);
    points.emplace_back(0.5 * unit.cwiseProduct(size_m));
  }
  return meshOf(points);
}

Shape prismMesh(int vertices, const Eigen::Vector3d& size_m) {
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < vertices; ++i) {
    const double turn = 4.0 * std::numbers::pi * (i / 2) / vertices;
    const Eigen::Vector3d corner(std::cos(turn), std::sin(turn), i % 2 == 0 ? 1.0 : -1.0);
    points.emplace_back(0.5 * corner.cwiseProduct(size_m));
  }
  return meshOf(points);
}

/// Copies of a piece; `spacing` is the distance in extents along each axis.
std::vector<Shape> row(const Shape& piece, int pieces, const Eigen::Vector3d& spacing) {
  std::vector<Shape> out;
  const Eigen::Vector3d extent_m = ownBox(piece).sizes();
  for (int i = 0; i < pieces; ++i) {
    const Eigen::Vector3d at(spacing.y() > 0.0 ? i % 2 : i, i / 2, i);
    Shape& placed = out.emplace_back(piece);
    placed.in_body.translation_m = at.cwiseProduct(spacing).cwiseProduct(extent_m);
  }
  return out;
}

/// CPU time per tick of a world filled with bodies of these pieces; empty: the worst-case bodies.
TickSummary fillAndTick(const Models& models, const std::vector<Shape>& pieces) {
  Game game(models, atRest());
  WorstCaseBodies filling(game.rig->models, models.scene.game, AxisPosition(kAxes), pieces);
  TickTimer timer;
  TickStatistics statistics;
  for (int k = 0; k < 700; ++k) {
    filling.order(game.record);
    timer.start();
    game.rig->renderer->tick(1, game.record, &timer);
    timer.finish(game.record);
    if (k >= 100) statistics.add(game.record);
  }
  return statistics.snapshot();
}

/// The rehearsal must cover every body that a game may order: bodies of any other form that
/// prepareShapes() accepts cost less. A margin of a quarter is allowed for the noise of the
/// machine.
TEST(WorstCaseBodies, CostsMoreThanOtherBodiesOfTheBudget_slow) {
  const Models models = smallGame(32, 8);
  const int p = models.scene.game.pieces, v = models.scene.game.vertices;
  const Eigen::Vector3d line(0.75, 0.0, 0.0), stack(0.0, 0.0, 0.8), bundle(0.75, 0.75, 0.0);
  const std::vector<std::pair<const char*, std::vector<Shape>>> others{
      {"balls in a row", row(roundMesh(v, {0.03, 0.03, 0.03}), p, line)},
      {"balls in a bundle", row(roundMesh(v, {0.03, 0.03, 0.03}), p, bundle)},
      {"small balls in a bundle", row(roundMesh(v, {0.012, 0.012, 0.012}), p, bundle)},
      {"plates", row(prismMesh(v, {0.06, 0.06, 0.011}), p, stack)},
      {"needles", row(roundMesh(v, {0.011, 0.011, 0.06}), p, bundle)},
      {"rods", row(prismMesh(v, {0.011, 0.011, 0.06}), p, bundle)},
      {"large prisms", row(prismMesh(v, {0.1, 0.1, 0.1}), p, bundle)},
      {"boxes", row(boxShape({0.03, 0.03, 0.03}), p, bundle)},
      {"balls", row(ballShape(0.015), p, bundle)}};
  const auto ticks_us = [&](const std::vector<Shape>& pieces) {
    return 1e-3 * fillAndTick(models, pieces).cpu.p50_ns;
  };
  double costliest_us = ticks_us({});
  std::printf("costliest: %.0f us at the median\n", costliest_us);
  for (const auto& [name, pieces] : others) {
    const auto prepared = prepareShapes(pieces, models.scene.game);
    ASSERT_TRUE(prepared) << name << ": " << format(prepared.errors());
    double us = ticks_us(pieces);
    // Other programs on this machine disturb either measurement, so both are repeated.
    for (int again = 0; again < 4 && us > 1.25 * costliest_us; ++again) {
      costliest_us = ticks_us({});
      us = std::min(us, ticks_us(pieces));
    }
    std::printf("%s: %.0f us\n", name, us);
    EXPECT_LE(us, 1.25 * costliest_us) << name;
  }
}

/// The rehearsal covers the budget only, so a game may not make more bodies move than the budget
/// allows.
TEST(GameBudget, FixedBodyFreedBeyondTheBudget_IsRefused) {
  Game game(smallGame(4, 1), atRest());
  game.prepare(0, {ballShape(0.02)});
  game.order(spawnCommand(spawnOf(0, 0, BodyOwner::kGame, poseAt({0.5, 0.3, 0.2}))));
  game.order(spawnCommand(spawnOf(1, 0, BodyOwner::kFixed, poseAt({0.5, -0.3, 0.2}))));
  game.run(3);
  game.order(setOwnerCommand(1, 1, BodyOwner::kLoop));
  EXPECT_TRUE(game.until(1, "refused", 5));
  EXPECT_EQ(game.record.exercise.values[2], 1.0);
  game.order(removeCommand(0, 1));
  game.run(2);
  game.order(setOwnerCommand(1, 1, BodyOwner::kLoop));
  EXPECT_FALSE(game.until(1, "refused", 5));
  EXPECT_LT(game.body(1).position_m.z, 0.2) << "it falls";
}

TEST(WorstCaseBodies, UnusualBudgets_AreFilled) {
  for (const auto& [pieces, vertices, size_m] :
       {std::tuple{1, 4, std::pair{0.01, 0.3}}, std::tuple{16, 64, std::pair{0.01, 0.3}},
        std::tuple{2, 5, std::pair{0.05, 0.05}}}) {
    Models models = smallGame(8, 4);
    GameBudget& budget = models.scene.game;
    budget.pieces = pieces;
    budget.vertices = vertices;
    std::tie(budget.least_m, budget.most_m) = size_m;
    const auto pool = rehearsePool(models, AxisPosition(kAxes), {}, anyTime());
    ASSERT_TRUE(pool) << format(pool.errors());
    EXPECT_EQ(pool->measured.bodies_max, 8) << pieces;
    EXPECT_EQ(pool->measured.moving_max, 4) << pieces;
  }
}

TEST(PoolRehearsal, BudgetBeyondTheLimit_IsRefusedAndTheSuggestedOnePasses) {
  const Models models = smallGame(8, 6);
  std::vector<std::string> said;
  RehearsalOptions options = slowAbove(3);
  options.status = [&](const std::string& what) { said.push_back(what); };
  const auto refused = rehearse(models, AxisPosition(kAxes), {}, options);
  ASSERT_FALSE(refused);
  const Diagnostic& why = refused.errors().front();
  EXPECT_EQ(why.file, models.files.exercise);
  EXPECT_EQ(why.key, "budget.awake");
  EXPECT_EQ(why.value, "6");
  EXPECT_TRUE(contains(why.remedy, "state awake = 3,"));
  EXPECT_GE(said.size(), 3U);

  const auto named = rehearse(smallGame(8, 3), AxisPosition(kAxes), {}, slowAbove(3));
  ASSERT_TRUE(named) << format(named.errors());
  ASSERT_TRUE(named->pool);
  EXPECT_EQ(named->pool->moving_max, 3);
  EXPECT_FALSE(rehearse(smallGame(8, 4), AxisPosition(kAxes), {}, slowAbove(3)));
}

TEST(PoolRehearsal, NoBudgetThatPasses_IsReportedWithARemedy) {
  const auto refused = rehearse(smallGame(6, 3), AxisPosition(kAxes), {}, slowAbove(0));
  ASSERT_FALSE(refused);
  EXPECT_TRUE(contains(refused.errors().front().remedy, "slower rate"));
}

/// Bodies wider than the gap between floor and ceiling cannot be placed.
TEST(PoolRehearsal, BudgetThatCannotBeFilled_IsRefused) {
  Models models = gameModels();
  models.scene.game.least_m = models.scene.game.most_m = 0.5;
  models.scene.game.pieces = 16;
  models.scene.bodies = {fixedBox({0.0, 0.0, -5.5}, {30.0, 30.0, 10.0}),
                         fixedBox({0.0, 0.0, 5.5}, {30.0, 30.0, 10.0})};
  const auto refused = rehearsePool(models, AxisPosition(kAxes), {}, anyTime());
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.errors().front().key, "budget.slots") << format(refused.errors());
}

TEST(PoolRehearsal, CancelledRehearsal_IsReported) {
  RehearsalOptions options = anyTime();
  int asked = 0;
  options.cancelled = [&asked] { return ++asked > 100; };
  const auto refused = rehearsePool(smallGame(8, 4), AxisPosition(kAxes), {}, options);
  EXPECT_TRUE(refusedWith(refused, "stopped"));
  EXPECT_EQ(asked, 101);
}

TEST(PoolRehearsal, NegativeExtraTime_IsIgnored) {
  RehearsalOptions options = anyTime();
  options.extra_ns = [](const TickRecord&) -> std::int64_t { return -1'000'000'000; };
  const auto pool = rehearsePool(smallGame(4, 2), AxisPosition(kAxes), {}, options);
  ASSERT_TRUE(pool);
  EXPECT_GT(pool->measured.summary.cpu.p50_ns, 1000.0);
}

TEST(PoolRehearsal, DeviceThatMovesAPerson_IsArmedOnlyAfterAWholeRehearsal) {
  const Models models = smallGame(4, 1);
  const auto rig = orThrow(buildRig(models, restingDevice(), RigOptions{}));
  EXPECT_FALSE(rig->renderer->arm());
  RehearsalOptions without;
  without.fill_pool = false;
  const auto informs = rehearse(models, AxisPosition(kAxes), {}, without);
  ASSERT_TRUE(informs);
  EXPECT_FALSE(informs->passed);
  const auto whole = rehearse(models, AxisPosition(kAxes), {});
  ASSERT_TRUE(whole) << format(whole.errors());
  EXPECT_EQ(whole->pool->moving_max, 1);
  Models larger = smallGame(5, 1);
  const auto other = orThrow(buildRig(larger, restingDevice(), RigOptions{}));
  EXPECT_FALSE(other->renderer->arm(whole->passed)) << "another budget was rehearsed";
  EXPECT_TRUE(rig->renderer->arm(whole->passed));
}

/// Depending on the machine, the shipped budget arms a device or is refused with a budget that
/// passes.
TEST(PoolRehearsal, ShippedScene_ArmsOrNamesABudgetThatPasses) {
  const Models models = gameModels();
  const auto began = std::chrono::steady_clock::now();
  const auto rehearsed = rehearse(models, AxisPosition(kAxes), {});
  figure("pool_rehearsal_wall",
         std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count(), "s");
  if (rehearsed) {
    std::printf("%s\n", describe(*rehearsed).c_str());
    const auto rig = orThrow(buildRig(models, restingDevice(), RigOptions{}));
    EXPECT_TRUE(rig->renderer->arm(rehearsed->passed));
    return;
  }
  std::printf("%s\n", format(rehearsed.errors()).c_str());
  EXPECT_EQ(rehearsed.errors().front().key, "budget.awake");
}

TEST(Admission, AdmissionOfAGameScene_FillsItsSlots) {
  const auto refused = orThrow(admit(smallGame(8, 4), {}, slowAbove(2)));
  EXPECT_FALSE(refused.admitted);
  ASSERT_TRUE(refused.pool);
  EXPECT_EQ(refused.pool->awake, 2);
  const auto admitted = orThrow(admit(smallGame(8, 4), {}, anyTime()));
  EXPECT_TRUE(admitted.admitted);
  ASSERT_TRUE(admitted.pool);
  EXPECT_EQ(admitted.pool->measured.moving_max, 4);
}

/// A session with bodies is bit-identical with and without a rehearsal before it.
TEST(PoolRehearsal, Rehearsal_DoesNotChangeTheSession) {
  const auto play = [](bool rehearsed) {
    const Models models = smallGame(8, 4);
    if (rehearsed) orThrow(rehearsePool(models, AxisPosition(kAxes), {}, anyTime()));
    Game game(models, Intention::throughWaypoints({{0.0, AxisPosition(kAxes)}}));
    WorstCaseBodies filling(game.rig->models, models.scene.game, AxisPosition(kAxes));
    std::vector<BodyState> states;
    std::vector<AxisEffort> sent;
    for (int k = 0; k < 400; ++k) {
      filling.order(game.record);
      game.rig->renderer->tick(1, game.record);
      sent.push_back(game.record.sent);
      for (int slot = 0; slot < 8; ++slot) states.push_back(game.body(slot));
    }
    return std::pair(states, sent);
  };
  const auto without = play(false), with = play(true);
  ASSERT_EQ(without.first.size(), with.first.size());
  EXPECT_EQ(0, std::memcmp(without.first.data(), with.first.data(),
                           with.first.size() * sizeof(BodyState)));
  EXPECT_EQ(0, std::memcmp(without.second.data(), with.second.data(),
                           with.second.size() * sizeof(AxisEffort)));
}

}  // namespace
}  // namespace wholehand::test
