// The budget of a game scene: what a file may say, which engines and devices take it, and shapes.
#include "assembly/engines.hpp"
#include "game/game_tools.hpp"
#include "model/temp_folder.hpp"
#include "physics/body_pool.hpp"

#include <fstream>
#include <sstream>
#include <time.h>

namespace wholehand::test {
namespace {

/// The shipped file with one text replaced; its scene is found by its full path.
std::string changedFile(const TempFolder& folder, const std::string& from, const std::string& to) {
  const std::string config = std::string(WHOLEHAND_SOURCE_DIR) + "/config/";
  std::ifstream in(config + "exercises/game-scene.toml");
  std::stringstream text;
  text << in.rdbuf();
  std::string all = text.str();
  const std::string scene = "../scenes/game-scene.toml";
  all.replace(all.find(scene), scene.size(), config + "scenes/game-scene.toml");
  if (all.find(from) == std::string::npos) throw std::runtime_error("the file has no " + from);
  all.replace(all.find(from), from.size(), to);
  const std::string path = folder.path("game.toml");
  std::ofstream(path) << all;
  return path;
}

std::string refusalOf(const std::string& from, const std::string& to) {
  const TempFolder folder;
  ModelFiles files = shippedFiles();
  files.exercise = changedFile(folder, from, to);
  const auto models = loadModels(files);
  return models ? "" : format(models.errors());
}

TEST(GameBudget, BadValues_AreNamed) {
  EXPECT_EQ(refusalOf("slots = 64", "slots = 32"), "");
  EXPECT_NE(refusalOf("slots = 64", "slots = 65").find("budget.slots = 65"), std::string::npos);
  EXPECT_NE(refusalOf("slots = 64", "slots = 8").find("more than there are slots"),
            std::string::npos);
  EXPECT_NE(refusalOf("pieces = 4", "pieces = 17").find("budget.pieces"), std::string::npos);
  EXPECT_NE(refusalOf("vertices = 32", "vertices = 3").find("budget.vertices"), std::string::npos);
  EXPECT_NE(refusalOf("[0.02, 2.0]", "[2.0, 0.02]").find("budget.mass_kg"), std::string::npos);
}

TEST(GameBudget, OtherEngines_RefuseWithTheRemedy) {
  for (const std::string& engine : engineNames()) {
    RigOptions options;
    options.engine = engine;
    options.uncertified = true;
    const auto rig = buildRig(gameModels(), atRest(), options);
    if (engine == defaultEngine()) {
      EXPECT_TRUE(rig);
      continue;
    }
    ASSERT_FALSE(rig) << engine;
    const std::string text = format(rig.errors());
    EXPECT_TRUE(text.find("use --engine bullet") != std::string::npos ||
                text.find("is not built into") != std::string::npos)
        << text;
  }
}

TEST(GameBudget, DeviceThatMovesAPerson_IsNotArmedWithoutARehearsal) {
  class Real final : public HapticDevice {
   public:
    [[nodiscard]] Expected<Done> open() override { return Done{}; }
    [[nodiscard]] Expected<Done> ready() override { return Done{}; }
    [[nodiscard]] bool simulated() const noexcept override { return false; }
    [[nodiscard]] Fault read(DeviceReading&, int) noexcept override { return Fault::kNone; }
    [[nodiscard]] Fault write(const AxisEffort&) noexcept override { return Fault::kNone; }
    void close() noexcept override {}
  };
  const auto rig = buildRig(gameModels(), std::make_unique<Real>(), RigOptions{});
  ASSERT_TRUE(rig) << format(rig.errors());
  const auto armed = (*rig)->renderer->arm();
  ASSERT_FALSE(armed);
  EXPECT_NE(format(armed.errors()).find("nothing was rehearsed"), std::string::npos);
}

TEST(GameShapes, BeyondTheBudget_AreNamed) {
  const GameBudget budget = gameModels().scene.game;
  const auto refused = [&](const std::vector<Shape>& pieces) {
    const auto shapes = prepareShapes(pieces, budget);
    return shapes ? std::string() : format(shapes.errors());
  };
  EXPECT_EQ(refused({boxShape({0.05, 0.05, 0.05})}), "");
  EXPECT_NE(refused({}).find("pieces = 0"), std::string::npos);
  EXPECT_NE(refused(std::vector<Shape>(5, ballShape(0.02))).find("[1, 4]"), std::string::npos);
  EXPECT_NE(refused({ballShape(0.02), boxShape({0.05, 0.05, 0.005})}).find("pieces[1]"),
            std::string::npos);
  EXPECT_NE(refused({boxShape({0.05, 0.05, 0.5})}).find("size_m"), std::string::npos);
  EXPECT_NE(refused({ballShape(std::numeric_limits<double>::quiet_NaN())}).find("finite"),
            std::string::npos);
  GameBudget few = budget;
  few.vertices = 6;
  const auto mesh = prepareShapes({boxMesh({0.05, 0.05, 0.05})}, few);
  ASSERT_FALSE(mesh);
  EXPECT_NE(format(mesh.errors()).find("8 vertices"), std::string::npos);
}

/// The same piece many times multiplies the contacts. Shares by closed form.
TEST(GameShapes, PiecesThatLieInOthers_AreNamed) {
  const GameBudget budget = gameModels().scene.game;
  const auto refused = [&](std::vector<Shape> pieces) {
    const auto shapes = prepareShapes(pieces, budget);
    return shapes ? std::string() : format(shapes.errors());
  };
  const auto at = [](Shape shape, const Eigen::Vector3d& place_m) {
    shape.in_body.translation_m = place_m;
    return shape;
  };
  const Shape cube = boxShape({0.04, 0.04, 0.04});
  const std::string twice = refused({cube, boxMesh({0.04, 0.04, 0.04})});
  EXPECT_NE(twice.find("pieces[0]: lies with 100 % of its volume"), std::string::npos) << twice;
  EXPECT_NE(twice.find("pieces[1]: lies with 100 %"), std::string::npos) << twice;
  EXPECT_NE(twice.find("at most 65 %"), std::string::npos) << twice;
  // Two cubes share 71 % of each, and 29 %.
  EXPECT_NE(refused({cube, at(cube, {0.0116, 0.0, 0.0})}).find("71 %"), std::string::npos);
  EXPECT_EQ(refused({cube, at(cube, {0.0284, 0.0, 0.0})}), "");
  // A small one in a large one is named alone.
  const std::string inside = refused({boxShape({0.1, 0.1, 0.1}), ballShape(0.02)});
  EXPECT_EQ(inside.find("pieces[0]"), std::string::npos) << inside;
  EXPECT_NE(inside.find("pieces[1]"), std::string::npos) << inside;
  // A bar through two balls is a dumbbell: nothing is wrong with it.
  EXPECT_EQ(refused({boxShape({0.015, 0.015, 0.2}), at(ballShape(0.03), {0.0, 0.0, 0.08}),
                     at(ballShape(0.03), {0.0, 0.0, -0.08})}),
            "");
}

TEST(GameShapes, TwoBalls_HaveTheMomentsOfADumbbell) {
  Shape left = ballShape(0.02), right = ballShape(0.02);
  left.in_body.translation_m = {0.0, -0.05, 0.0};
  right.in_body.translation_m = {0.0, 0.05, 0.0};
  const PreparedShapes shapes = orThrow(prepareShapes({left, right}, gameModels().scene.game));
  // Two spheres of half a kilogram: 0.4 r² about the axis, 0.4 r² + d² across it.
  const double along = 0.4 * 0.02 * 0.02, across = along + 0.05 * 0.05;
  EXPECT_NEAR(shapes.moments_per_kg.x(), across, tolerance(1e-12));
  EXPECT_NEAR(shapes.moments_per_kg.y(), along, tolerance(1e-12));
  EXPECT_NEAR(shapes.moments_per_kg.z(), across, tolerance(1e-12));
}

double cpuNow_s() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// CPU time of one tick, taken in turn: a busy machine slows both.
TEST(GameBudget, ParkedSlots_CostAlmostNothing) {
  Models without = gameModels();
  without.scene.game = {};
  Game slots(gameModels(), atRest()), none(std::move(without), atRest());
  std::vector<double> difference_us;
  for (int k = 0; k < 4000; ++k) {
    const double a = cpuNow_s();
    slots.tick();
    const double b = cpuNow_s();
    none.tick();
    difference_us.push_back(1e6 * ((b - a) - (cpuNow_s() - b)));
  }
  std::nth_element(difference_us.begin(), difference_us.begin() + 2000, difference_us.end());
  figure("64 parked slots, p50 of a tick", difference_us[2000], "us");
  if (WHOLEHAND_SANITIZED == 0) {
    EXPECT_LE(difference_us[2000], tolerance(3.0));
  }
}

// CPU time of an order among twenty bodies over the hand.
TEST(GameBudget, AnOrder_TakesMicroseconds) {
  const Models models = gameModels();
  const auto world = orThrow(buildWorld(defaultEngine(), models.hand, models.scene));
  auto* pool = dynamic_cast<BodyPool*>(world.get());
  ASSERT_NE(pool, nullptr);
  ASSERT_TRUE(world->placeHand(AxisPosition(6)));
  for (const Command& c : shapeCommands(
           0, orThrow(prepareShapes({boxShape({0.04, 0.04, 0.04})}, models.scene.game)))) {
    pool->obey(c);
  }
  const AxisMatrix inverse = AxisMatrix::Identity(6, 6);
  HandDrive drive;
  drive.effort = AxisEffort(6);
  drive.reduced_inertia_inverse = &inverse;
  std::vector<double> times_us;
  const auto obey = [&](const Command& command) {
    const double before = cpuNow_s();
    pool->obey(command);
    times_us.push_back(1e6 * (cpuNow_s() - before));
  };
  for (int k = 0; k < 2000; ++k) {
    const int slot = k % 20, generation = 1 + k / 20;
    const BodyPose at = poseAt({0.02 * (slot % 5), 0.03 * (slot / 5) - 0.05, 0.0});
    obey(removeCommand(slot, generation - 1));
    SpawnOrder spawn = spawnOf(slot, 0, BodyOwner::kFixed, at);
    spawn.generation = generation;
    obey(spawnCommand(spawn));
    obey(teleportCommand(slot, generation, at));
    ASSERT_EQ(world->step(drive, 1e-3), Fault::kNone);
  }
  std::sort(times_us.begin(), times_us.end());
  figure("an order, p50", times_us[times_us.size() / 2], "us");
  figure("an order, p99.9", times_us[times_us.size() * 999 / 1000], "us");
  if (WHOLEHAND_SANITIZED == 0) {
    EXPECT_LE(times_us[times_us.size() / 2], tolerance(5.0));
  }
}

}  // namespace
}  // namespace wholehand::test
