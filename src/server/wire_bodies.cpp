// Bodies of a game: what clients order, and what they are told.
#include "server/wire_bodies.hpp"

#include "core/body_order.hpp"
#include "server/wire_common.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace wholehand::wire {
namespace {

Diagnostic fault(std::string key, std::string value, std::string problem, std::string remedy) {
  return {"", 0, std::move(key), std::move(value), std::move(problem), std::move(remedy)};
}

Eigen::Vector3d fromWire(const fb::Vec3& v) {
  return {static_cast<double>(v.x()), static_cast<double>(v.y()), static_cast<double>(v.z())};
}

BodyPose fromWire(const fb::Pose& pose) {
  const fb::QuatXyzw& q = pose.orientation_xyzw();
  return {Vec3::from(fromWire(pose.position_m())),
          {static_cast<double>(q.x()), static_cast<double>(q.y()), static_cast<double>(q.z()),
           static_cast<double>(q.w())}};
}

/// A number that is not larger than a command's; what is larger is no slot and no generation.
int fromWire(std::uint32_t number) {
  return static_cast<int>(
      std::min<std::uint32_t>(number, std::numeric_limits<std::int32_t>::max()));
}

Expected<Done> readPlace(const fb::Shape& in, const std::string& key, Shape& out) {
  const fb::Pose* place = in.in_body();
  if (place == nullptr) return Done{};  // the frame of the body
  const BodyPose pose = fromWire(*place);
  const Eigen::Quaterniond turn = pose.orientation_xyzw.eigen();
  if (!pose.position_m.eigen().allFinite()) {
    return fault(key + ".in_body.position_m", "", "is not finite", "give metres");
  }
  if (!(std::abs(turn.norm() - 1.0) <= kMostNormFault)) {
    return fault(key + ".in_body.orientation_xyzw", fmt::format("norm {:.6g}", turn.norm()),
                 "is no rotation", "must have a norm of 1, within 0.001");
  }
  out.in_body = {turn.normalized().toRotationMatrix(), pose.position_m.eigen()};
  return Done{};
}

Expected<Done> readMesh(const fb::Shape& in, const std::string& key, Shape& out) {
  const auto points = in.points_m() == nullptr ? 0U : in.points_m()->size();
  const auto corners = in.triangles() == nullptr ? 0U : in.triangles()->size();
  if (points < 4 || points > kMaxPieceVertices) {
    return fault(key + ".points_m", std::to_string(points), "is not a number of vertices that fits",
                 fmt::format("must be in [4, {}]", kMaxPieceVertices));
  }
  // A closed surface with n vertices has 2 n - 4 triangles.
  if (corners % 3 != 0 || corners > 3 * (2 * points - 4)) {
    return fault(key + ".triangles", std::to_string(corners),
                 "is not a number of indices that fits",
                 fmt::format("must be three a triangle, at most {}", 3 * (2 * points - 4)));
  }
  for (const fb::Vec3* p : *in.points_m()) out.points_m.push_back(fromWire(*p));
  for (flatbuffers::uoffset_t i = 0; i + 2 < corners; i += 3) {
    Eigen::Vector3i triangle;
    for (flatbuffers::uoffset_t k = 0; k < 3; ++k) {
      const std::uint32_t corner = in.triangles()->Get(i + k);
      if (corner >= points) {
        return fault(fmt::format("{}.triangles[{}]", key, i + k), std::to_string(corner),
                     "is not the index of a vertex", fmt::format("must be in [0, {}]", points - 1));
      }
      triangle[static_cast<Eigen::Index>(k)] = static_cast<int>(corner);
    }
    out.triangles.push_back(triangle);
  }
  return Done{};
}

/// Of the numbers only those that the type uses: the others stay 0.
Expected<Done> readShape(const fb::Shape& in, const std::string& key, Shape& out) {
  if (in.type() < fb::ShapeType::MIN || in.type() > fb::ShapeType::MAX) {
    return fault(key + ".type", std::to_string(static_cast<int>(in.type())), "is not known",
                 "must be Box, Sphere, Cylinder, Capsule or ConvexMesh");
  }
  out.type = static_cast<ShapeType>(in.type());
  if (out.type == ShapeType::kBox) {
    if (in.half_extents_m() == nullptr) {
      return fault(key + ".half_extents_m", "", "is missing", "give metres");
    }
    out.half_extents_m = fromWire(*in.half_extents_m());
  } else if (out.type == ShapeType::kConvexMesh) {
    if (auto mesh = readMesh(in, key, out); !mesh) return mesh.errors();
  } else {
    out.radius_m = static_cast<double>(in.radius_m());
    if (out.type != ShapeType::kSphere) out.length_m = static_cast<double>(in.length_m());
  }
  return readPlace(in, key, out);
}

Expected<Done> readPieces(const fb::PrepareShapes& in, BodyOrders& out) {
  const auto pieces = in.pieces() == nullptr ? 0U : in.pieces()->size();
  if (pieces < 1 || pieces > kMaxSlotPieces) {
    return fault("pieces", std::to_string(pieces), "is out of range",
                 fmt::format("must be in [1, {}]", kMaxSlotPieces));
  }
  out.shape_set = in.set();
  for (flatbuffers::uoffset_t i = 0; i < pieces; ++i) {
    auto read =
        readShape(*in.pieces()->Get(i), fmt::format("pieces[{}]", i), out.pieces.emplace_back());
    if (read) continue;
    out.faults.push_back(
        {static_cast<int>(i), -1, OrderRefusal::kBadShapes, format(read.errors())});
  }
  return Done{};
}

Command commandOf(const fb::SpawnBody& in) {
  SpawnOrder out;
  out.slot = in.slot();
  out.generation = fromWire(in.generation());
  out.shape_set = in.shape_set();
  out.owner = static_cast<BodyOwner>(in.owner());
  out.mass_kg = static_cast<double>(in.mass_kg());
  out.friction = static_cast<double>(in.friction());
  if (in.pose() != nullptr) {
    out.pose = fromWire(*in.pose());
  } else {
    out.pose.orientation_xyzw.w = 0.0;  // no rotation: refused as a bad pose
  }
  if (in.velocity_m_s() != nullptr) out.velocity_m_s = Vec3::from(fromWire(*in.velocity_m_s()));
  out.refuse_overlap = in.refuse_overlap();
  return spawnCommand(out);
}

template <class Item>
int slotOf(const Item& item) {
  return fromWire(item.slot());
}
template <class Item>
int generationOf(const Item& item) {
  return fromWire(item.generation());
}

/// One command for each item of a vector, which `make` turns into a command.
template <class Items, class Make>
Expected<Done> readItems(const Items* items, Make make, BodyOrders& out) {
  const auto count = items == nullptr ? 0U : items->size();
  if (count < 1 || count > kMostBodyItems) {
    return fault("bodies", std::to_string(count), "is not a number of items that fits",
                 fmt::format("must be in [1, {}]", kMostBodyItems));
  }
  for (const auto* item : *items) out.commands.push_back(make(*item));
  return Done{};
}

Expected<Done> read(const fb::Command& c, BodyOrders& out) {
  switch (c.order_type()) {
    case fb::Order::PrepareShapes:
      return readPieces(*c.order_as_PrepareShapes(), out);
    case fb::Order::Spawn:
      return readItems(
          c.order_as_Spawn()->bodies(), [](const fb::SpawnBody& b) { return commandOf(b); }, out);
    case fb::Order::Remove:
      return readItems(
          c.order_as_Remove()->bodies(),
          [](const fb::BodyName& b) { return removeCommand(slotOf(b), generationOf(b)); }, out);
    case fb::Order::Teleport:
      return readItems(
          c.order_as_Teleport()->bodies(),
          [](const fb::BodyPlace& b) {
            return teleportCommand(slotOf(b), generationOf(b), fromWire(b.pose()));
          },
          out);
    case fb::Order::SetOwner:
      return readItems(
          c.order_as_SetOwner()->bodies(),
          [](const fb::BodyHandover& b) {
            return setOwnerCommand(slotOf(b), generationOf(b), static_cast<BodyOwner>(b.owner()));
          },
          out);
    default:
      return readItems(
          c.order_as_BodyTargets()->bodies(),
          [](const fb::BodyPlace& b) {
            return bodyTargetCommand(slotOf(b), generationOf(b), fromWire(b.pose()));
          },
          out);
  }
}

fb::RegisteredBody registeredToWire(const ShownBody& shown) {
  const RegisteredBody& body = shown.body;
  const auto where =
      shown.shapes ? static_cast<fb::Whereabouts>(body.whereabouts) : fb::Whereabouts::Gone;
  return {static_cast<std::uint32_t>(body.number),
          static_cast<std::uint32_t>(body.generation),
          shown.shapes ? shown.shapes->id : 0,
          body.slot,
          where,
          {toWire(body.pose.position_m), toWire(body.pose.orientation_xyzw)}};
}

}  // namespace

bool ordersBodies(fb::Order type) noexcept {
  return type >= fb::Order::PrepareShapes && type <= fb::Order::BodyTargets;
}

Expected<ClientMessage> decodeBodies(const fb::Command& command, ClientMessage message) {
  auto bodies = std::make_shared<BodyOrders>();
  if (auto done = read(command, *bodies); !done) return done.errors();
  const bool shapes = command.order_type() == fb::Order::PrepareShapes;
  message.order.type = shapes ? OrderType::kPrepareShapes : OrderType::kOrderBodies;
  message.order.bodies = std::move(bodies);
  return message;
}

Bytes gameBodiesMessage(std::uint32_t session, const GameBodies& bodies,
                        const std::vector<std::shared_ptr<const GameShapes>>& new_shapes,
                        const RegisteredBodies& registered) {
  Builder b;
  std::vector<fb::GameBody> places;
  for (const GameBody& body : bodies) {
    places.emplace_back(static_cast<std::uint32_t>(body.slot),
                        static_cast<std::uint32_t>(body.generation), body.shapes->id,
                        static_cast<fb::SlotState>(body.state));
  }
  std::vector<Offset<fb::GameShapes>> shapes;
  for (const auto& set : new_shapes) {
    std::vector<Offset<fb::Shape>> pieces;
    for (const Shape& piece : set->pieces) pieces.push_back(shapeToWire(b, piece, set->com_m));
    const auto list = b.CreateVector(pieces);
    const fb::Vec3 com = toWire(set->com_m);
    shapes.push_back(fb::CreateGameShapes(b, set->id, &com, list));
  }
  const auto body_list = b.CreateVectorOfStructs(places);
  const auto shape_list = b.CreateVector(shapes);
  std::vector<fb::RegisteredBody> numbers;
  for (const ShownBody& shown : registered) numbers.push_back(registeredToWire(shown));
  const auto number_list = numbers.empty() ? 0 : b.CreateVectorOfStructs(numbers);
  finish(b, fb::CreateGameBodies(b, session, body_list, shape_list, number_list), kSchemaVersion);
  return {b.GetBufferPointer(), b.GetBufferPointer() + b.GetSize()};
}

}  // namespace wholehand::wire
