#pragma once

#include "loop/core/body_order.hpp"
#include "loop/core/expected.hpp"
#include "loop/model/scene_model.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace wholehand {

/// Shapes of a game's body, ready for the loop: checked, given in the principal frame of inertia at
/// the centre of mass, with their moments. Many bodies may use one set.
struct PreparedShapes {
  std::vector<Shape> pieces;       ///< in the principal frame
  Eigen::Vector3d moments_per_kg;  ///< principal moments of inertia per mass [m²]
  Eigen::Matrix3d from_body;       ///< axes of the principal frame in the frame of the input
  Eigen::Vector3d com_m;           ///< centre of mass in the frame of the input
};

/// Shapes of a game's bodies as the game gave them, for clients that draw them.
struct GameShapes {
  std::uint32_t id = 0;                             ///< unique while the program runs; > 0
  Eigen::Vector3d com_m = Eigen::Vector3d::Zero();  ///< centre of mass in the frame of `pieces`
  std::vector<Shape> pieces;
  double radius_m = 0.0;  ///< radius of a sphere about com_m that contains the pieces
};

/// A body of a game that is in the world.
struct GameBody {
  int slot = 0;
  int generation = 0;
  SlotState state = SlotState::kGhost;
  std::shared_ptr<const GameShapes> shapes;
};
/// All bodies of a game that are in the world, in the order of their slots.
using GameBodies = std::vector<GameBody>;

/// A registered body, with or without a slot in the loop, as clients see it.
struct RegisteredBody {
  int number = 0;
  int generation = 0;
  int slot = -1;  ///< its slot while whereabouts is kInSlot
  Whereabouts whereabouts = Whereabouts::kOutOfReach;
  BodyPose pose;  ///< newest known pose
  std::shared_ptr<const GameShapes> shapes;
};
/// All registered bodies, by number.
using RegisteredBodies = std::vector<RegisteredBody>;

/// Checks the pieces against the budget and prepares them. Reports all faults at once, with the
/// piece as the key ("pieces[1]"). Convex meshes come from convexMesh(), which checks that they are
/// closed and convex. At most 65 % of a piece's volume may lie in other pieces. Not real-time safe.
[[nodiscard]] Expected<PreparedShapes> prepareShapes(const std::vector<Shape>& pieces,
                                                     const GameBudget& budget);

/// Radius of a sphere about the centre of mass that contains the shapes [m].
[[nodiscard]] double outerRadius(const PreparedShapes& shapes);

/// Commands that transfer the shapes to the loop as shape set `set`; send them in this order.
[[nodiscard]] std::vector<Command> shapeCommands(int set, const PreparedShapes& shapes);

// Readers of the commands that shapeCommands() writes, for the loop. Real-time safe.

/// Number of vertices that one command carries.
inline constexpr int kVerticesPerCommand = 4;

struct ShapeSetHead {
  int pieces = 0;
  Eigen::Vector3d moments_per_kg;
  Eigen::Quaterniond from_body;
};
[[nodiscard]] ShapeSetHead shapeSetHeadOf(const Command& command) noexcept;

/// A piece without its vertices.
struct ShapePiece : ShapeForm {
  int piece = 0;
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();
  int vertices = 0;
};
[[nodiscard]] ShapePiece shapePieceOf(const Command& command) noexcept;

struct ShapeVertices {
  int piece = 0, first = 0, count = 0;
  std::array<Eigen::Vector3d, kVerticesPerCommand> points_m;
};
[[nodiscard]] ShapeVertices shapeVerticesOf(const Command& command) noexcept;

}  // namespace wholehand
