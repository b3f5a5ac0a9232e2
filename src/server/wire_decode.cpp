#include "core/body_order.hpp"
#include "core/expected.hpp"
#include "server/wire.hpp"
#include "wholehand_generated.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

namespace wholehand::wire {

namespace fb = wholehand::protocol;

namespace {

/// Limits of nesting depth and number of tables of a client message: Message, Command, its order,
/// and the items of that.
constexpr flatbuffers::uoffset_t kDepth = 8, kTables = 8 + kMostBodyItems;
/// Smallest message: root offset and identifier.
constexpr std::size_t kSmallestMessage = 8;
struct alignas(16) AlignedBytes : std::array<std::uint8_t, kLargestClientMessage> {};
constexpr const char* kVersionKey = "schema_version";

Diagnostic refusal(std::string key, std::string value, std::string problem, std::string remedy) {
  return {"", 0, std::move(key), std::move(value), std::move(problem), std::move(remedy)};
}

Diagnostic notFinite(const char* key) {
  return refusal(key, "", "is not a finite number", "");
}

std::string text(const flatbuffers::String* s) {
  return s == nullptr ? std::string() : s->str();
}

Expected<ClientMessage> decodeAim(const fb::Aim& aim, ClientMessage m) {
  const auto* q = aim.q();
  const flatbuffers::uoffset_t n = q == nullptr ? 0 : q->size();
  if (n < 1 || n > kMaxAxes) {
    return refusal("aim", std::to_string(n) + " axes", "is not a posture",
                   "must have 1 to " + std::to_string(kMaxAxes) + " axes");
  }
  if (aim.by() > fb::Help::MAX) {
    return refusal("help", std::to_string(static_cast<int>(aim.by())), "is not known", "");
  }
  m.order.type = OrderType::kAim;
  m.order.help = static_cast<Help>(aim.by());
  m.order.aim = AxisPosition(static_cast<int>(n));
  for (flatbuffers::uoffset_t i = 0; i < n; ++i) {
    const double value = static_cast<double>(q->Get(i));
    if (!std::isfinite(value)) return notFinite("aim");
    m.order.aim[static_cast<int>(i)] = value;
  }
  return m;
}

Expected<ClientMessage> decodeSetParameter(const fb::SetParameter& p, ClientMessage m) {
  if (!std::isfinite(p.value())) return notFinite("parameter");
  m.order.type = OrderType::kSetParameter;
  m.order.name = text(p.name());
  m.order.value = p.value();
  return m;
}

Expected<ClientMessage> decodeSteer(const fb::Steer& s, ClientMessage m) {
  if (s.by() < fb::Steering::MIN || s.by() > fb::Steering::MAX) {
    return refusal("steer", std::to_string(static_cast<int>(s.by())), "is not known", "");
  }
  m.order.type = OrderType::kSteer;
  m.order.steering = static_cast<Steering>(s.by());
  return m;
}

Expected<ClientMessage> decodeAction(const fb::Action& a, ClientMessage m) {
  if (a.act() < fb::Act::MIN || a.act() > fb::Act::MAX) {
    return refusal("action", std::to_string(static_cast<int>(a.act())), "is not known", "");
  }
  m.order.type = OrderType::kAction;
  m.order.action = static_cast<ExerciseAction>(a.act());
  return m;
}

Expected<ClientMessage> decodeHelp(const fb::SetHelp& h, ClientMessage m) {
  if (h.help() > fb::Help::MAX) {
    return refusal("help", std::to_string(static_cast<int>(h.help())), "is not known", "");
  }
  m.order.type = OrderType::kSetHelp;
  m.order.help = static_cast<Help>(h.help());
  return m;
}

Expected<ClientMessage> decodeLoad(const fb::LoadExercise& l, ClientMessage m) {
  m.order.type = OrderType::kLoadExercise;
  m.order.name = text(l.exercise());
  m.order.hand = text(l.hand());
  m.order.level = l.level();
  return m;
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
    return refusal(key + ".in_body.position_m", "", "is not finite", "give metres");
  }
  if (!(std::abs(turn.norm() - 1.0) <= kMostNormFault)) {
    return refusal(key + ".in_body.orientation_xyzw", fmt::format("norm {:.6g}", turn.norm()),
                   "is no rotation", "must have a norm of 1, within 0.001");
  }
  out.in_body = {turn.normalized().toRotationMatrix(), pose.position_m.eigen()};
  return Done{};
}

Expected<Done> readMesh(const fb::Shape& in, const std::string& key, Shape& out) {
  const auto points = in.points_m() == nullptr ? 0U : in.points_m()->size();
  const auto corners = in.triangles() == nullptr ? 0U : in.triangles()->size();
  if (points < 4 || points > kMaxPieceVertices) {
    return refusal(key + ".points_m", std::to_string(points),
                   "is not a number of vertices that fits",
                   fmt::format("must be in [4, {}]", kMaxPieceVertices));
  }
  // A closed surface with n vertices has 2 n - 4 triangles.
  if (corners % 3 != 0 || corners > 3 * (2 * points - 4)) {
    return refusal(key + ".triangles", std::to_string(corners),
                   "is not a number of indices that fits",
                   fmt::format("must be three a triangle, at most {}", 3 * (2 * points - 4)));
  }
  for (const fb::Vec3* p : *in.points_m()) out.points_m.push_back(fromWire(*p));
  for (flatbuffers::uoffset_t i = 0; i + 2 < corners; i += 3) {
    Eigen::Vector3i triangle;
    for (flatbuffers::uoffset_t k = 0; k < 3; ++k) {
      const std::uint32_t corner = in.triangles()->Get(i + k);
      if (corner >= points) {
        return refusal(fmt::format("{}.triangles[{}]", key, i + k), std::to_string(corner),
                       "is not the index of a vertex",
                       fmt::format("must be in [0, {}]", points - 1));
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
    return refusal(key + ".type", std::to_string(static_cast<int>(in.type())), "is not known",
                   "must be Box, Sphere, Cylinder, Capsule or ConvexMesh");
  }
  out.type = static_cast<ShapeType>(in.type());
  if (out.type == ShapeType::kBox) {
    if (in.half_extents_m() == nullptr) {
      return refusal(key + ".half_extents_m", "", "is missing", "give metres");
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
    return refusal("pieces", std::to_string(pieces), "is out of range",
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
    return refusal("bodies", std::to_string(count), "is not a number of items that fits",
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

/// Reads an order to a game's bodies. Refuses counts that no scene allows, and what a picture or a
/// shape cannot be made of. Numbers of a body are read as they are: whoever obeys checks them.
/// @pre it is one of these orders, and the message is verified
Expected<ClientMessage> decodeBodies(const fb::Command& command, ClientMessage message) {
  auto bodies = std::make_shared<BodyOrders>();
  if (auto done = read(command, *bodies); !done) return done.errors();
  const bool shapes = command.order_type() == fb::Order::PrepareShapes;
  message.order.type = shapes ? OrderType::kPrepareShapes : OrderType::kOrderBodies;
  message.order.bodies = std::move(bodies);
  return message;
}

Expected<ClientMessage> decodeCommand(const fb::Command& c) {
  ClientMessage m;
  m.type = ClientMessageType::kOrder;
  m.id = c.id();
  m.order.number = c.id();
  switch (c.order_type()) {
    case fb::Order::Arm:
      m.order.type = OrderType::kArm;
      m.order.endings_seen = c.order_as_Arm()->endings_seen();
      return m;
    case fb::Order::Stop:
      m.order.type = OrderType::kStop;
      return m;
    case fb::Order::EmergencyStop:
      m.order.type = OrderType::kEmergencyStop;
      return m;
    case fb::Order::LoadExercise:
      return decodeLoad(*c.order_as_LoadExercise(), m);
    case fb::Order::SetParameter:
      return decodeSetParameter(*c.order_as_SetParameter(), m);
    case fb::Order::Aim:
      return decodeAim(*c.order_as_Aim(), m);
    case fb::Order::Steer:
      return decodeSteer(*c.order_as_Steer(), m);
    case fb::Order::Action:
      return decodeAction(*c.order_as_Action(), m);
    case fb::Order::TakeControls:
      m.type = ClientMessageType::kTakeControls;
      m.token = text(c.order_as_TakeControls()->token());
      return m;
    case fb::Order::ReleaseControls:
      m.type = ClientMessageType::kReleaseControls;
      return m;
    case fb::Order::Heartbeat:
      m.type = ClientMessageType::kHeartbeat;
      return m;
    case fb::Order::Rest:
      m.order.type = OrderType::kStop;
      m.order.rest = true;
      return m;
    case fb::Order::SaveProfile:
      m.order.type = OrderType::kSaveProfile;
      m.order.name = text(c.order_as_SaveProfile()->name());
      return m;
    case fb::Order::LoadProfile:
      m.order.type = OrderType::kLoadProfile;
      m.order.name = text(c.order_as_LoadProfile()->name());
      return m;
    case fb::Order::SetHelp:
      return decodeHelp(*c.order_as_SetHelp(), m);
    case fb::Order::Answer:
      m.order.type = OrderType::kAnswer;
      m.order.number = c.order_as_Answer()->question();
      m.order.name = text(c.order_as_Answer()->text());
      return m;
    case fb::Order::HoldToMove:
      m.order.type = OrderType::kHoldToMove;
      m.order.number = c.order_as_HoldToMove()->press();
      m.order.held = c.order_as_HoldToMove()->held();
      return m;
    case fb::Order::PrepareShapes:
    case fb::Order::Spawn:
    case fb::Order::Remove:
    case fb::Order::Teleport:
    case fb::Order::SetOwner:
    case fb::Order::BodyTargets:
      return decodeBodies(c, m);
    case fb::Order::NONE:
      break;
  }
  return refusal("order", std::to_string(static_cast<int>(c.order_type())), "is not known", "");
}

Expected<ClientMessage> decodePayload(const fb::Message& message) {
  if (message.schema_version() != kSchemaVersion) {
    return refusal(kVersionKey, std::to_string(message.schema_version()),
                   "is not the version of this program",
                   "must be " + std::to_string(kSchemaVersion) +
                       ": reload the page, or bring "
                       "client and program to the same version");
  }
  // Both null checks are needed: an absent union passes verification.
  if (const fb::Command* command = message.payload_as_Command()) {
    if (command->order_type() != fb::Order::NONE && command->order() == nullptr) {
      return refusal("order", "", "is missing", "");
    }
    return decodeCommand(*command);
  }
  return refusal("payload", std::to_string(static_cast<int>(message.payload_type())),
                 "is not a message that a client may send", "");
}

}  // namespace

Expected<ClientMessage> decode(std::span<const std::uint8_t> message) {
  if (message.size() > kLargestClientMessage) {
    return refusal("size", std::to_string(message.size()) + " bytes", "is too large",
                   "must be at most " + std::to_string(kLargestClientMessage) + " bytes");
  }
  // Numbers are read in place, and are aligned as in the format only in our own buffer.
  AlignedBytes bytes;
  if (!message.empty()) std::memcpy(bytes.data(), message.data(), message.size());
  if (message.size() < kSmallestMessage || !fb::MessageBufferHasIdentifier(bytes.data())) {
    return refusal("message", "", "is not one of Wholehand's", "");
  }
  flatbuffers::Verifier verifier(bytes.data(), message.size(), kDepth, kTables);
  if (!fb::VerifyMessageBuffer(verifier)) {
    return refusal("message", "", "is damaged or cut short", "");
  }
  return decodePayload(*fb::GetMessage(bytes.data()));
}

std::uint32_t commandIdOf(std::span<const std::uint8_t> message) {
  if (message.size() < kSmallestMessage || message.size() > kLargestClientMessage) return 0;
  AlignedBytes bytes;
  std::memcpy(bytes.data(), message.data(), message.size());
  flatbuffers::Verifier verifier(bytes.data(), message.size(), kDepth, kTables);
  if (!fb::MessageBufferHasIdentifier(bytes.data()) || !fb::VerifyMessageBuffer(verifier)) return 0;
  const fb::Command* command = fb::GetMessage(bytes.data())->payload_as_Command();
  return command == nullptr ? 0 : command->id();
}

Refusal refusalOf(const Diagnostics& errors) {
  return errors.front().key == kVersionKey ? Refusal::kOtherVersion : Refusal::kUnreadable;
}

}  // namespace wholehand::wire
