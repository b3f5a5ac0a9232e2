#include "station/body_orders.hpp"

#include "files/mesh/convex_mesh.hpp"
#include "loop/core/body_order.hpp"
#include "loop/model/game_shapes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <set>
#include <string>
#include <utility>

namespace wholehand {
namespace {

struct Problem {
  BodyRefusal refusal = BodyRefusal::kNone;
  std::string reason;
};

std::optional<Problem> poseProblem(const BodyPose& pose) {
  if (isBodyPose(pose)) return std::nullopt;
  const double far_m = pose.position_m.eigen().norm();
  if (!(far_m <= kFarthest_m)) {
    return Problem{
        BodyRefusal::kBadPose,
        fmt::format("position ({:.4g}, {:.4g}, {:.4g}) m: must be finite, and within {:.4g} m "
                    "of the origin",
                    pose.position_m.x, pose.position_m.y, pose.position_m.z, kFarthest_m)};
  }
  return Problem{BodyRefusal::kBadPose,
                 fmt::format("orientation_xyzw has norm {:.6g}: must be 1, within {:.4g}",
                             pose.orientation_xyzw.eigen().norm(), kMostNormFault)};
}

std::optional<Problem> shapeSetProblem(int set, const GameBudget& budget) {
  if (set >= 0 && set < budget.shape_sets) return std::nullopt;
  return Problem{BodyRefusal::kNoSuchShapes,
                 fmt::format("shape set {}: must be in [0, {}] (budget.shape_sets)", set,
                             budget.shape_sets - 1)};
}

std::optional<Problem> ownerProblem(BodyOwner owner) {
  if (isBodyOwner(owner)) return std::nullopt;
  return Problem{BodyRefusal::kBadPose,
                 fmt::format("owner {}: must be Loop, Game or Fixed", static_cast<int>(owner))};
}

std::optional<Problem> massProblem(const SpawnOrder& spawn, const GameBudget& budget) {
  if (!(spawn.mass_kg >= budget.least_kg && spawn.mass_kg <= budget.most_kg)) {
    return Problem{BodyRefusal::kBadMass,
                   fmt::format("mass_kg = {:.6g}: must be in [{:.4g}, {:.4g}] kg (budget.mass_kg)",
                               spawn.mass_kg, budget.least_kg, budget.most_kg)};
  }
  if (!(spawn.friction >= 0.0 && spawn.friction <= kMostBodyFriction)) {
    return Problem{BodyRefusal::kBadMass, fmt::format("friction = {:.6g}: must be in [0, {:.4g}]",
                                                      spawn.friction, kMostBodyFriction)};
  }
  return std::nullopt;
}

std::optional<Problem> spawnProblem(const SpawnOrder& spawn, const GameBudget& budget) {
  if (auto problem = shapeSetProblem(spawn.shape_set, budget)) return problem;
  if (auto problem = poseProblem(spawn.pose)) return problem;
  if (auto problem = ownerProblem(spawn.owner)) return problem;
  const double speed_m_s = spawn.velocity_m_s.eigen().norm();
  if (!(speed_m_s <= kMostSpawnSpeed_m_s)) {
    return Problem{BodyRefusal::kBadPose,
                   fmt::format("velocity_m_s has norm {:.4g}: at most {:.4g} m/s", speed_m_s,
                               kMostSpawnSpeed_m_s)};
  }
  return massProblem(spawn, budget);
}

std::optional<Problem> problemOf(const Command& command, const GameBudget& budget) {
  const bool in_pool = command.index >= 0 && command.index < budget.slots;
  if (!in_pool && !isRegistered(command.index)) {
    return Problem{BodyRefusal::kNoSuchSlot,
                   fmt::format("slot {}: must be in [0, {}] (budget.slots), or in [{}, {}] for a "
                               "body of the registry",
                               command.index, budget.slots - 1, kFirstNumber, kLastNumber)};
  }
  if (!(command.value >= 1.0 && command.value <= kMostGeneration)) {
    return Problem{BodyRefusal::kWrongGeneration,
                   fmt::format("slot {}, generation {:.0f}: must be in [1, {}]", command.index,
                               command.value, kMostGeneration)};
  }
  switch (command.type) {
    case CommandType::kSpawn:
      return spawnProblem(spawnOrderOf(command), budget);
    case CommandType::kTeleport:
    case CommandType::kBodyTarget:
      return poseProblem(poseOf(command));
    case CommandType::kSetOwner:
      return ownerProblem(spawnOrderOf(command).owner);
    default:
      return std::nullopt;
  }
}

/// Index of the piece in a key such as "pieces[3]"; 0 when the key names all pieces.
int pieceOf(const std::string& key) {
  int index = 0;
  const std::size_t at = key.find('[');
  if (at != std::string::npos) {
    std::from_chars(key.data() + at + 1, key.data() + key.size(), index);
  }
  return index;
}

void refuseShapes(const Diagnostics& faults, std::vector<RefusedItem>& refused) {
  for (const Diagnostic& fault : faults) {
    const int piece = pieceOf(fault.key);
    refused.push_back({piece, -1, BodyRefusal::kBadShapes, format(fault)});
  }
}

/// Faults that the loop would report for prepared pieces: a piece lies too far from the centre of
/// mass, or the inertia per mass is too large.
std::vector<RefusedItem> spreadFaults(const PreparedShapes& shapes, const GameBudget& budget) {
  std::vector<RefusedItem> faults;
  const double most_m = 2.0 * budget.most_m, most_m2 = budget.most_m * budget.most_m;
  for (std::size_t i = 0; i < shapes.pieces.size(); ++i) {
    const Shape& piece = shapes.pieces[i];
    double far_m = piece.in_body.translation_m.norm();
    for (const Eigen::Vector3d& p : piece.points_m) far_m = std::max(far_m, p.norm());
    if (far_m <= most_m) continue;
    faults.push_back({static_cast<int>(i), -1, BodyRefusal::kBadShapes,
                      fmt::format("pieces[{}]: is {:.4g} m off: must be within {:.4g} m of the "
                                  "centre of mass, and its vertices of its own frame (twice "
                                  "budget.size_m)",
                                  i, far_m, most_m)});
  }
  const double widest_m2 = shapes.moments_per_kg.maxCoeff();
  if (faults.empty() && widest_m2 > most_m2) {
    faults.push_back({0, -1, BodyRefusal::kBadShapes,
                      fmt::format("pieces: are spread too far, with {:.4g} m² of inertia for each "
                                  "kg: at most {:.4g} m² (the square of budget.size_m)",
                                  widest_m2, most_m2)});
  }
  return faults;
}

/// Copies of the pieces whose meshes are verified and have outward normals.
std::vector<Shape> verified(const std::vector<Shape>& pieces, std::vector<RefusedItem>& refused) {
  std::vector<Shape> out;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    Shape shape = pieces[i];
    if (shape.isMesh()) {
      auto mesh = convexMesh(shape.points_m, shape.triangles);
      if (!mesh) {
        Diagnostics faults = mesh.errors();
        for (Diagnostic& fault : faults) fault.key = fmt::format("pieces[{}]", i);
        refuseShapes(faults, refused);
        continue;
      }
      mesh->in_body = shape.in_body;
      shape = std::move(*mesh);
    }
    out.push_back(std::move(shape));
  }
  return out;
}

CheckedOrders checkShapes(const BodyOrders& orders, const GameBudget& budget,
                          std::uint32_t shapes_id) {
  CheckedOrders out;
  out.refused = orders.faults;
  if (auto problem = shapeSetProblem(orders.shape_set, budget)) {
    out.refused.push_back({0, -1, problem->refusal, std::move(problem->reason)});
  }
  if (!out.refused.empty()) return out;
  const std::vector<Shape> pieces = verified(orders.pieces, out.refused);
  if (!out.refused.empty()) return out;
  auto prepared = prepareShapes(pieces, budget);
  if (!prepared) {
    refuseShapes(prepared.errors(), out.refused);
    return out;
  }
  out.refused = spreadFaults(*prepared, budget);
  if (!out.refused.empty()) return out;
  out.commands = shapeCommands(orders.shape_set, *prepared);
  out.shape_set = orders.shape_set;
  out.shapes = std::make_shared<const GameShapes>(
      GameShapes{shapes_id, prepared->com_m, pieces, outerRadius(*prepared)});
  return out;
}

}  // namespace

CheckedOrders checkOrders(const BodyOrders& orders, const GameBudget& budget,
                          std::uint32_t shapes_id) {
  if (orders.shape_set >= 0) return checkShapes(orders, budget, shapes_id);
  CheckedOrders out;
  std::set<int> named;
  for (std::size_t i = 0; i < orders.commands.size(); ++i) {
    const Command& command = orders.commands[i];
    auto problem = problemOf(command, budget);
    const bool slot_exists = !problem || problem->refusal != BodyRefusal::kNoSuchSlot;
    if (slot_exists && !named.insert(command.index).second) {
      problem = Problem{
          BodyRefusal::kSlotTaken,
          fmt::format("slot {} stands in this message before: name it once", command.index)};
    }
    if (problem) {
      out.refused.push_back(
          {static_cast<int>(i), command.index, problem->refusal, std::move(problem->reason)});
      continue;
    }
    out.item_of_slot[command.index] = static_cast<int>(i);
    out.commands.push_back(command);
  }
  return out;
}

OrderReply replyFor(std::vector<RefusedItem> refused) {
  if (refused.empty()) return {true, ""};
  std::string reason = fmt::format("{} ({}): {}", nameOf(refused.front().refusal),
                                   refused.front().item, refused.front().reason);
  if (refused.size() > 1) reason += fmt::format("; and {} more", refused.size() - 1);
  return {false, std::move(reason), Refusal::kBodiesRefused, std::move(refused)};
}

}  // namespace wholehand
