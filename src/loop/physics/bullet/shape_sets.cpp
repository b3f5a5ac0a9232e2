#include "loop/physics/bullet/shape_sets.hpp"

#include "loop/physics/bullet/bullet_shapes.hpp"
#include "loop/physics/bullet/bullet_types.hpp"

#include <algorithm>
#include <cmath>

namespace wholehand::bullet {

btCollisionShape* SlotShape::make(const SlotPiece& piece) noexcept {
  if (!piece.isMesh()) {
    return constructSum(piece, [&](auto type, const auto&... dimensions) -> btCollisionShape* {
      return &shape_.emplace<typename decltype(type)::type>(dimensions...);
    });
  }
  auto& cloud = shape_.emplace<btConvexPointCloudShape>();
  // Bullet's default margin would enlarge the mesh by 4 cm. It is set first, because the box
  // includes it.
  cloud.setMargin(0.0);
  cloud.setPoints(piece.vertices, piece.vertex_count);
  return &cloud;
}

namespace {

bool isUnit(const Eigen::Quaterniond& q) noexcept {
  return std::abs(q.squaredNorm() - 1.0) <= 2e-3;
}

/// True for a length that a piece may have: finite, positive and within the budget.
bool isLength(double value_m, double most_m) noexcept {
  return value_m > 0.0 && value_m <= most_m;
}

bool hasDimensions(const ShapePiece& p, double most_m) noexcept {
  if (!isShapeType(p.type)) return false;
  const ShapeKind& kind = p.kind();
  return (!kind.has_extents || (isLength(p.half_extents_m.minCoeff(), most_m) &&
                                isLength(p.half_extents_m.maxCoeff(), most_m))) &&
         (!(kind.has_disk || kind.has_ball) || isLength(p.radius_m, most_m)) &&
         (kind.length_key == nullptr || isLength(p.length_m, most_m));
}

}  // namespace

ShapeSets::ShapeSets(const GameBudget& budget)
    : most_pieces_(budget.pieces),
      most_vertices_(budget.vertices),
      most_m_(budget.most_m),
      sets_(budget.shape_sets),
      pieces_(sets_.size() * budget.pieces),
      vertices_(pieces_.size() * budget.vertices) {
  for (std::size_t i = 0; i < pieces_.size(); ++i) {
    pieces_[i].vertices = vertices_.data() + i * budget.vertices;
  }
}

BodyRefusal ShapeSets::take(const Command& command) noexcept {
  const int set = command.index;
  if (set < 0 || set >= static_cast<int>(sets_.size())) return BodyRefusal::kNoSuchShapes;
  if (sets_[set].users > 0) return BodyRefusal::kShapesBusy;
  BodyRefusal refusal = BodyRefusal::kBadShapes;
  if (command.type == CommandType::kShapeSet) refusal = begin(set, shapeSetHeadOf(command));
  if (command.type == CommandType::kShapePiece) refusal = addPiece(set, shapePieceOf(command));
  if (command.type == CommandType::kShapeVertices) {
    refusal = addVertices(set, shapeVerticesOf(command));
  }
  if (refusal != BodyRefusal::kNone) sets_[set] = Set{};
  return refusal;
}

ShapeSets::Set* ShapeSets::find(int set) noexcept {
  if (set < 0 || set >= static_cast<int>(sets_.size())) return nullptr;
  const Set& found = sets_[set];
  const bool whole =
      found.announced > 0 && found.pieces == found.announced && lastPieceIsWhole(set);
  return whole ? &sets_[set] : nullptr;
}

bool ShapeSets::lastPieceIsWhole(int set) const noexcept {
  const Set& s = sets_[set];
  return s.pieces == 0 || s.vertices == piecesOf(set)[s.pieces - 1].vertex_count;
}

BodyRefusal ShapeSets::begin(int set, const ShapeSetHead& head) noexcept {
  const Eigen::Vector3d& m = head.moments_per_kg;
  const bool possible = m.minCoeff() > 0.0 && m.maxCoeff() <= most_m_ * most_m_ &&
                        2.0 * m.maxCoeff() <= m.sum() * (1.0 + 1e-9);
  if (head.pieces < 1 || head.pieces > most_pieces_ || !possible || !isUnit(head.from_body)) {
    return BodyRefusal::kBadShapes;
  }
  sets_[set] = Set{};
  sets_[set].announced = head.pieces;
  sets_[set].moments_per_kg = toBt(m);
  sets_[set].from_body = head.from_body.normalized();
  return BodyRefusal::kNone;
}

BodyRefusal ShapeSets::addPiece(int set, const ShapePiece& in) noexcept {
  Set& s = sets_[set];
  if (!hasDimensions(in, most_m_)) return BodyRefusal::kBadShapes;
  const bool vertices =
      in.isMesh() ? in.vertices >= 4 && in.vertices <= most_vertices_ : in.vertices == 0;
  if (in.piece != s.pieces || s.pieces >= s.announced || !lastPieceIsWhole(set) || !vertices ||
      !isUnit(in.orientation) || !(in.position_m.norm() <= 2.0 * most_m_)) {
    return BodyRefusal::kBadShapes;
  }
  SlotPiece& out = piece(set, s.pieces++);
  s.vertices = 0;
  static_cast<ShapeForm&>(out) = in;
  const Eigen::Quaterniond turn = in.orientation.normalized();
  out.in_rigid =
      btTransform(btQuaternion(turn.x(), turn.y(), turn.z(), turn.w()), toBt(in.position_m));
  out.vertex_count = in.vertices;
  s.radius_m = std::max(s.radius_m, in.position_m.norm() + in.outerRadius());
  return BodyRefusal::kNone;
}

BodyRefusal ShapeSets::addVertices(int set, const ShapeVertices& in) noexcept {
  Set& s = sets_[set];
  if (s.pieces == 0 || in.piece != s.pieces - 1) return BodyRefusal::kBadShapes;
  SlotPiece& into = piece(set, in.piece);
  if (in.first != s.vertices || in.count < 1 || in.count > kVerticesPerCommand ||
      s.vertices + in.count > into.vertex_count) {
    return BodyRefusal::kBadShapes;
  }
  for (int i = 0; i < in.count; ++i) {
    if (!(in.points_m[i].cwiseAbs().maxCoeff() <= 2.0 * most_m_)) return BodyRefusal::kBadShapes;
    into.vertices[s.vertices++] = toBt(in.points_m[i]);
    s.radius_m = std::max(s.radius_m, toEigen(into.in_rigid * toBt(in.points_m[i])).norm());
  }
  return BodyRefusal::kNone;
}

}  // namespace wholehand::bullet
