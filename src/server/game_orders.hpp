#pragma once

#include "core/body_order.hpp"
#include "core/command.hpp"
#include "model/scene/scene_model.hpp"
#include "server/refusal.hpp"

#include <cstdint>
#include <memory>
#include <vector>

// Bodies of a game, as clients order them and as clients are told of them
// (docs/adr/0043-bodies-of-a-game.md). SI units; positions are those of the centre of mass.
namespace wholehand {

/// Most items of one message: one for each slot.
inline constexpr int kMostBodyItems = kMaxSlots;
/// Largest generation: the value of an event, a float, holds it exactly.
inline constexpr int kMostGeneration = (1 << 24) - 1;

/// What one message orders. Its counts are verified; no number is.
struct BodyOrders {
  int shape_set = -1;               ///< of `pieces`; -1: a message without shapes
  std::vector<Shape> pieces;        ///< as the game gave them
  std::vector<Command> commands;    ///< one an item, in the order of the message
  std::vector<RefusedItem> faults;  ///< found while the message was read
};

/// Shapes of a game's bodies, for pictures.
struct GameShapes {
  std::uint32_t id = 0;                             ///< unique while the program runs; > 0
  Eigen::Vector3d com_m = Eigen::Vector3d::Zero();  ///< in the frame of `pieces`
  std::vector<Shape> pieces;                        ///< as the game gave them
  double radius_m = 0.0;                            ///< of a ball about com_m that holds them
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

/// A body beyond the slots of the loop, or one of those that has a slot.
struct ShownBody {
  RegisteredBody body;
  std::shared_ptr<const GameShapes> shapes;
};
/// All registered bodies, by number.
using RegisteredBodies = std::vector<ShownBody>;

}  // namespace wholehand
