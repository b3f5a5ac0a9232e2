#include "loop/model/game_shapes.hpp"

#include "loop/model/principal_axes.hpp"
#include "loop/model/scene_model.hpp"

#include <Eigen/LU>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace wholehand {
namespace {

/// Largest share of a piece's volume inside other pieces of the body.
constexpr double kMostShared = 0.65;

Diagnostic fault(std::size_t piece, std::string problem, std::string remedy) {
  return {"", 0, fmt::format("pieces[{}]", piece), "", std::move(problem), std::move(remedy)};
}

void checkPiece(const Shape& shape, std::size_t index, const GameBudget& budget,
                Diagnostics& faults) {
  const Eigen::Vector3d extent = ownBox(shape).sizes();
  if (!extent.allFinite() || !shape.in_body.translation_m.allFinite() ||
      !shape.in_body.rotation.allFinite()) {
    faults.push_back(fault(index, "is not finite", "give finite numbers in metres"));
    return;
  }
  if (!(extent.minCoeff() >= budget.least_m) || !(extent.maxCoeff() <= budget.most_m)) {
    faults.push_back(fault(
        index, fmt::format("measures {:.4g} to {:.4g} m", extent.minCoeff(), extent.maxCoeff()),
        fmt::format("every extent must be in [{:.4g}, {:.4g}] m (budget.size_m)", budget.least_m,
                    budget.most_m)));
  }
  if (shape.isMesh() && std::cmp_greater(shape.points_m.size(), budget.vertices)) {
    faults.push_back(fault(index, fmt::format("has {} vertices", shape.points_m.size()),
                           fmt::format("at most {} (budget.vertices)", budget.vertices)));
  }
}

/// Share of a piece's volume that lies in other pieces, estimated on a grid over its box.
double shareInOthers(const std::vector<Shape>& pieces, std::size_t piece) {
  constexpr int kSteps = 7;  // grid points along each side
  const Shape& own = pieces[piece];
  const Eigen::AlignedBox3d box = ownBox(own);
  int inside = 0, shared = 0;
  for (int k = 0; k < kSteps * kSteps * kSteps; ++k) {
    const int across = k % kSteps, along = k / kSteps % kSteps, up = k / kSteps / kSteps;
    const Eigen::Vector3d step(across, along, up);
    const Eigen::Vector3d in_shape_m =
        box.min() + (step.array() + 0.5).matrix().cwiseProduct(box.sizes()) / kSteps;
    const Eigen::Vector3d point_m = own.in_body * in_shape_m;
    if (signedDistance(own, point_m) > 0.0) continue;
    ++inside;
    for (std::size_t j = 0; j < pieces.size(); ++j) {
      if (j == piece || signedDistance(pieces[j], point_m) > 0.0) continue;
      ++shared;
      break;
    }
  }
  return inside > 0 ? static_cast<double>(shared) / inside : 0.0;
}

/// Refuses pieces that overlap too much. Overlapping pieces multiply the contacts of two bodies, so
/// a body made of the same piece many times would cost far more time in a tick than any other body.
void checkOverlaps(const std::vector<Shape>& pieces, Diagnostics& faults) {
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const double share = shareInOthers(pieces, i);
    if (share <= kMostShared) continue;
    faults.push_back(fault(
        i, fmt::format("lies with {:.0f} % of its volume inside other pieces", 100.0 * share),
        fmt::format("at most {:.0f} %: leave it out, or make it smaller", 100.0 * kMostShared)));
  }
}

int whole(double value) noexcept {
  return value >= 0.0 && value < 1e6 && value == std::floor(value) ? static_cast<int>(value) : -1;
}

// A diagonal inertia keeps its axes, so that a box is not rotated by 90 degrees.
void principalAxes(const Eigen::Matrix3d& inertia, PreparedShapes& out) {
  const Eigen::Matrix3d diagonal = inertia.diagonal().asDiagonal();
  if ((inertia - diagonal).cwiseAbs().maxCoeff() <= 1e-9 * inertia.trace()) {
    out.from_body.setIdentity();
    out.moments_per_kg = inertia.diagonal();
    return;
  }
  const PrincipalAxes principal = principalAxesOf(inertia);
  out.from_body = principal.axes;
  if (out.from_body.determinant() < 0.0) out.from_body.col(2) = -out.from_body.col(2);
  out.moments_per_kg = principal.moments;
}

Command command(CommandType type, int index, double value) {
  Command out;
  out.type = type;
  out.index = index;
  out.value = value;
  return out;
}

Command pieceCommand(int set, int index, const Shape& shape) {
  Command out = command(CommandType::kShapePiece, set, index);
  const Eigen::Quaterniond turn(shape.in_body.rotation);
  const Eigen::Vector3d& at = shape.in_body.translation_m;
  const Eigen::Vector3d& half = shape.half_extents_m;
  const bool mesh = shape.isMesh();
  out.numbers = {static_cast<double>(shape.type),
                 half.x(),
                 half.y(),
                 half.z(),
                 shape.radius_m,
                 shape.length_m,
                 at.x(),
                 at.y(),
                 at.z(),
                 turn.x(),
                 turn.y(),
                 turn.z(),
                 turn.w(),
                 mesh ? static_cast<double>(shape.points_m.size()) : 0.0};
  return out;
}

void addVertices(int set, int index, const Shape& shape, std::vector<Command>& commands) {
  if (!shape.isMesh()) return;
  for (std::size_t first = 0; first < shape.points_m.size(); first += kVerticesPerCommand) {
    Command& out = commands.emplace_back(command(CommandType::kShapeVertices, set, index));
    const std::size_t count =
        std::min<std::size_t>(kVerticesPerCommand, shape.points_m.size() - first);
    out.numbers[0] = static_cast<double>(first);
    out.numbers[1] = static_cast<double>(count);
    for (std::size_t i = 0; i < count; ++i) {
      for (int k = 0; k < 3; ++k) {
        out.numbers[2 + 3 * i + k] = shape.points_m[first + i][k];
      }
    }
  }
}

}  // namespace

Expected<PreparedShapes> prepareShapes(const std::vector<Shape>& pieces, const GameBudget& budget) {
  Diagnostics faults;
  if (pieces.empty() || std::cmp_greater(pieces.size(), budget.pieces)) {
    faults.push_back(keyFault("", "pieces", std::to_string(pieces.size()), "is out of range",
                              fmt::format("must be in [1, {}] (budget.pieces)", budget.pieces)));
  }
  for (std::size_t i = 0; i < pieces.size(); ++i) checkPiece(pieces[i], i, budget, faults);
  if (faults.empty()) checkOverlaps(pieces, faults);
  if (!faults.empty()) return faults;

  const MassProperties mass = uniformDensity(pieces, 1.0);
  const std::string impossible = inertiaFault(mass.inertia_kg_m2);
  if (!impossible.empty()) {
    return keyFault("", "pieces", "", "have an impossible inertia: " + impossible,
                    "give pieces that have volume");
  }
  PreparedShapes out;
  out.com_m = mass.com_m;
  principalAxes(mass.inertia_kg_m2, out);
  const Pose principal{out.from_body, out.com_m};
  for (const Shape& piece : pieces) {
    Shape& moved = out.pieces.emplace_back(piece);
    moved.in_body = principal.inverse() * piece.in_body;
  }
  return out;
}

double outerRadius(const PreparedShapes& shapes) {
  double radius_m = 0.0;
  for (const Shape& piece : shapes.pieces) {
    radius_m = std::max(radius_m, piece.in_body.translation_m.norm() + outerRadius(piece));
  }
  return radius_m;
}

std::vector<Command> shapeCommands(int set, const PreparedShapes& shapes) {
  std::vector<Command> commands;
  Command& head = commands.emplace_back(
      command(CommandType::kShapeSet, set, static_cast<double>(shapes.pieces.size())));
  const Eigen::Quaterniond turn(shapes.from_body);
  const Eigen::Vector3d& moments = shapes.moments_per_kg;
  head.numbers = {moments.x(), moments.y(), moments.z(), turn.x(), turn.y(), turn.z(), turn.w()};
  for (std::size_t i = 0; i < shapes.pieces.size(); ++i) {
    const int index = static_cast<int>(i);
    commands.push_back(pieceCommand(set, index, shapes.pieces[i]));
    addVertices(set, index, shapes.pieces[i], commands);
  }
  return commands;
}

ShapeSetHead shapeSetHeadOf(const Command& c) noexcept {
  const auto& n = c.numbers;
  return {whole(c.value), {n[0], n[1], n[2]}, Eigen::Quaterniond(n[6], n[3], n[4], n[5])};
}

ShapePiece shapePieceOf(const Command& c) noexcept {
  const auto& n = c.numbers;
  ShapePiece out;
  out.piece = whole(c.value);
  out.type = static_cast<ShapeType>(whole(n[0]));
  out.half_extents_m = {n[1], n[2], n[3]};
  out.radius_m = n[4];
  out.length_m = n[5];
  out.position_m = {n[6], n[7], n[8]};
  out.orientation = Eigen::Quaterniond(n[12], n[9], n[10], n[11]);
  out.vertices = whole(n[13]);
  return out;
}

ShapeVertices shapeVerticesOf(const Command& c) noexcept {
  const auto& n = c.numbers;
  ShapeVertices out;
  out.piece = whole(c.value);
  out.first = whole(n[0]);
  out.count = whole(n[1]);
  for (int i = 0; i < kVerticesPerCommand; ++i) {
    out.points_m[i] = {n[2 + 3 * i], n[3 + 3 * i], n[4 + 3 * i]};
  }
  return out;
}

}  // namespace wholehand
