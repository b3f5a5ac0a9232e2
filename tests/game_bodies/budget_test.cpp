// The body budget of a game scene: valid values, the engines and devices that accept it, and
// shapes.
#include "game_bodies/game_tools.hpp"
#include "rig/engines.hpp"
#include "support/constants.hpp"
#include "support/contains.hpp"
#include "support/file_bytes.hpp"
#include "support/folder.hpp"

#include <sstream>

namespace wholehand::test {
namespace {

/// The shipped file with one text replaced; the path of its scene is made absolute.
std::string changedFile(const Folder& folder, const std::string& from, const std::string& to) {
  const std::string text =
      replaced(bytesOfFile(kConfig + "exercises/game-scene.toml"), "../scenes/game-scene.toml",
               kConfig + "scenes/game-scene.toml");
  return folder.write("game.toml", replaced(text, from, to));
}

std::string refusalOf(const std::string& from, const std::string& to) {
  const Folder folder;
  ModelFiles files = shippedFiles();
  files.exercise = changedFile(folder, from, to);
  const auto models = loadModels(files);
  return models ? "" : format(models.errors());
}

TEST(GameBudget, BadValues_AreRefusedByName) {
  EXPECT_EQ(refusalOf("slots = 64", "slots = 32"), "");
  EXPECT_TRUE(contains(refusalOf("slots = 64", "slots = 65"), "budget.slots = 65"));
  EXPECT_TRUE(contains(refusalOf("slots = 64", "slots = 8"), "more than budget.slots"));
  EXPECT_TRUE(contains(refusalOf("pieces = 4", "pieces = 17"), "budget.pieces"));
  EXPECT_TRUE(contains(refusalOf("vertices = 32", "vertices = 3"), "budget.vertices"));
  EXPECT_TRUE(contains(refusalOf("[0.02, 2.0]", "[2.0, 0.02]"), "budget.mass_kg"));
}

TEST(GameBudget, OtherEngines_RefuseTheBudgetWithARemedy) {
  for (const Engine& engine : engines()) {
    RigOptions options;
    options.engine = engine.name;
    options.uncertified = true;
    const auto rig = buildRig(gameModels(), atRest(), options);
    if (engine.takes_game_bodies) {
      EXPECT_TRUE(rig) << engine.name;
      continue;
    }
    ASSERT_FALSE(rig) << engine.name;
    const std::string text = format(rig.errors());
    EXPECT_TRUE(text.find("use --engine bullet") != std::string::npos ||
                text.find("is not built into") != std::string::npos)
        << text;
  }
}

TEST(GameBudget, DeviceThatMovesAPerson_IsNotArmedWithoutARehearsal) {
  const auto rig = buildRig(gameModels(), std::make_unique<RestingDevice>(), RigOptions{});
  ASSERT_TRUE(rig) << format(rig.errors());
  const auto armed = (*rig)->renderer->arm();
  EXPECT_TRUE(refusedWith(armed, "nothing was rehearsed"));
}

TEST(GameShapes, ShapesBeyondTheBudget_AreRefusedByName) {
  const GameBudget budget = gameModels().scene.game;
  const auto refused = [&](const std::vector<Shape>& pieces) {
    const auto shapes = prepareShapes(pieces, budget);
    return shapes ? std::string() : format(shapes.errors());
  };
  EXPECT_EQ(refused({boxShape({0.05, 0.05, 0.05})}), "");
  EXPECT_TRUE(contains(refused({}), "pieces = 0"));
  EXPECT_TRUE(contains(refused(std::vector<Shape>(5, ballShape(0.02))), "[1, 4]"));
  EXPECT_TRUE(contains(refused({ballShape(0.02), boxShape({0.05, 0.05, 0.005})}), "pieces[1]"));
  EXPECT_TRUE(contains(refused({boxShape({0.05, 0.05, 0.5})}), "size_m"));
  EXPECT_TRUE(contains(refused({ballShape(std::numeric_limits<double>::quiet_NaN())}), "finite"));
  GameBudget few = budget;
  few.vertices = 6;
  const auto mesh = prepareShapes({boxMesh({0.05, 0.05, 0.05})}, few);
  EXPECT_TRUE(refusedWith(mesh, "8 vertices"));
}

/// A piece repeated many times multiplies the contacts. The shared volumes are in closed form.
TEST(GameShapes, PiecesInsideOtherPieces_AreRefusedByName) {
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
  EXPECT_TRUE(contains(twice, "pieces[0]: lies with 100 % of its volume"));
  EXPECT_TRUE(contains(twice, "pieces[1]: lies with 100 %"));
  EXPECT_TRUE(contains(twice, "at most 65 %"));
  // The two cubes share 71 % of their volume, then 29 %.
  EXPECT_TRUE(contains(refused({cube, at(cube, {0.0116, 0.0, 0.0})}), "71 %"));
  EXPECT_EQ(refused({cube, at(cube, {0.0284, 0.0, 0.0})}), "");
  // A small piece in a large one is the only one reported.
  const std::string inside = refused({boxShape({0.1, 0.1, 0.1}), ballShape(0.02)});
  EXPECT_EQ(inside.find("pieces[0]"), std::string::npos) << inside;
  EXPECT_TRUE(contains(inside, "pieces[1]"));
  // A bar through two balls is a dumbbell, which is valid.
  EXPECT_EQ(refused({boxShape({0.015, 0.015, 0.2}), at(ballShape(0.03), {0.0, 0.0, 0.08}),
                     at(ballShape(0.03), {0.0, 0.0, -0.08})}),
            "");
}

TEST(GameShapes, TwoBalls_HaveTheMomentsOfADumbbell) {
  Shape left = ballShape(0.02), right = ballShape(0.02);
  left.in_body.translation_m = {0.0, -0.05, 0.0};
  right.in_body.translation_m = {0.0, 0.05, 0.0};
  const PreparedShapes shapes = orThrow(prepareShapes({left, right}, gameModels().scene.game));
  // Two spheres of 0.5 kg: 0.4 r² about the axis, 0.4 r² + d² across it.
  const double along = 0.4 * 0.02 * 0.02, across = along + 0.05 * 0.05;
  EXPECT_NEAR(shapes.moments_per_kg.x(), across, tolerance(1e-12));
  EXPECT_NEAR(shapes.moments_per_kg.y(), along, tolerance(1e-12));
  EXPECT_NEAR(shapes.moments_per_kg.z(), across, tolerance(1e-12));
}

}  // namespace
}  // namespace wholehand::test
