#include "loop/core/body_order.hpp"
#include "loop/core/expected.hpp"
#include "station/server/wire.hpp"
#include "wholehand_generated.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <type_traits>
#include <utility>

namespace wholehand::wire {

namespace fb = wholehand::protocol;

namespace {

/// Limits of nesting depth and number of tables in a client message: Message, Command, its order,
/// and the items of the order.
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

template <class Enum>
bool isKnown(Enum value) {
  return value >= Enum::MIN && value <= Enum::MAX;
}

template <class Enum>
Diagnostic unknown(const char* key, Enum value) {
  return refusal(key, std::to_string(static_cast<int>(value)), "is not known", "");
}

std::string text(const flatbuffers::String* s) {
  return s == nullptr ? std::string() : s->str();
}

// Readers of the orders of the schema.

orders::Arm read(const fb::Arm& in) {
  return {in.endings_seen(), in.basis_seen()};
}
orders::Stop read(const fb::Stop&) {
  return {};
}
orders::EmergencyStop read(const fb::EmergencyStop&) {
  return {};
}
orders::LoadExercise read(const fb::LoadExercise& in) {
  return {text(in.exercise()), text(in.hand()), in.level()};
}
Expected<orders::SetParameter> read(const fb::SetParameter& in) {
  if (!std::isfinite(in.value())) return notFinite("parameter");
  return orders::SetParameter{text(in.name()), in.value(), in.basis_seen()};
}

Expected<orders::Aim> read(const fb::Aim& in) {
  const auto* q = in.q();
  const flatbuffers::uoffset_t n = q == nullptr ? 0 : q->size();
  if (n < 1 || n > kMaxAxes) {
    return refusal("aim", std::to_string(n) + " axes", "is not a posture",
                   "must have 1 to " + std::to_string(kMaxAxes) + " axes");
  }
  if (!isKnown(in.by())) return unknown("help", in.by());
  orders::Aim aim{AxisPosition(static_cast<int>(n)), static_cast<Help>(in.by())};
  for (flatbuffers::uoffset_t i = 0; i < n; ++i) {
    const double value = static_cast<double>(q->Get(i));
    if (!std::isfinite(value)) return notFinite("aim");
    aim.q[static_cast<int>(i)] = value;
  }
  return aim;
}

Expected<orders::Steer> read(const fb::Steer& in) {
  if (!isKnown(in.by())) return unknown("steer", in.by());
  return orders::Steer{static_cast<Steering>(in.by())};
}
Expected<orders::Action> read(const fb::Action& in) {
  if (!isKnown(in.act())) return unknown("action", in.act());
  if (in.chosen() >= kChoices) {
    return refusal("chosen", std::to_string(in.chosen()), "is not known", "");
  }
  return orders::Action{static_cast<Act>(in.act()), in.basis_seen(),
                        static_cast<Choice>(in.chosen())};
}
orders::TakeControls read(const fb::TakeControls& in) {
  return {text(in.token())};
}
orders::ReleaseControls read(const fb::ReleaseControls&) {
  return {};
}
orders::Heartbeat read(const fb::Heartbeat& in) {
  return {in.busy()};
}
orders::Rest read(const fb::Rest&) {
  return {};
}
orders::SaveProfile read(const fb::SaveProfile& in) {
  return {text(in.name())};
}
orders::LoadProfile read(const fb::LoadProfile& in) {
  return {text(in.name())};
}
Expected<orders::SetHelp> read(const fb::SetHelp& in) {
  if (!isKnown(in.help())) return unknown("help", in.help());
  return orders::SetHelp{static_cast<Help>(in.help())};
}
orders::Answer read(const fb::Answer& in) {
  return {in.question(), text(in.text())};
}
orders::HoldToMove read(const fb::HoldToMove& in) {
  return {in.press(), in.held()};
}

Expected<orders::OpenVisit> read(const fb::OpenVisit& in) {
  if (!isKnown(in.help())) return unknown("help", in.help());
  orders::OpenVisit visit{in.visit(),
                          in.item(),
                          text(in.exercise()),
                          text(in.hand()),
                          text(in.hand_file()),
                          in.level(),
                          static_cast<Help>(in.help()),
                          {},
                          text(in.prescription_file())};
  if (in.parameters() == nullptr) return visit;
  if (in.parameters()->size() > kMaxLiveParameters) {
    return refusal("parameters", std::to_string(in.parameters()->size()), "are too many",
                   "at most " + std::to_string(kMaxLiveParameters));
  }
  for (const fb::VisitParameter* parameter : *in.parameters()) {
    const std::string name = text(parameter->name());
    if (!std::isfinite(parameter->value())) {
      return refusal(name, std::to_string(parameter->value()), "is not finite", "");
    }
    if (!visit.parameters.emplace(name, parameter->value()).second) {
      return refusal(name, "", "is named twice", "");
    }
  }
  return visit;
}
orders::CloseVisit read(const fb::CloseVisit& in) {
  return {in.visit()};
}

// Orders to a game's bodies. Counts beyond the limit of every scene are refused, and so is data
// from which no picture and no shape can be made. Numbers of a body are not checked here, but where
// they are used.

Eigen::Vector3d fromWire(const fb::Vec3& v) {
  return {static_cast<double>(v.x()), static_cast<double>(v.y()), static_cast<double>(v.z())};
}

BodyPose fromWire(const fb::Pose& pose) {
  const fb::QuatXyzw& q = pose.orientation_xyzw();
  return {Vec3::from(fromWire(pose.position_m())),
          {static_cast<double>(q.x()), static_cast<double>(q.y()), static_cast<double>(q.z()),
           static_cast<double>(q.w())}};
}

/// Converts a number. Larger values than an int become its maximum, which is no valid slot or
/// generation.
int fromWire(std::uint32_t number) {
  return static_cast<int>(
      std::min<std::uint32_t>(number, std::numeric_limits<std::int32_t>::max()));
}

Expected<Done> readPlace(const fb::Shape& in, const std::string& key, Shape& out) {
  const fb::Pose* place = in.in_body();
  if (place == nullptr) return Done{};  // no pose: the frame of the body
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

/// Reads only the numbers that the shape's type uses; the others stay 0.
Expected<Done> readShape(const fb::Shape& in, const std::string& key, Shape& out) {
  if (!isKnown(in.type())) {
    return refusal(key + ".type", std::to_string(static_cast<int>(in.type())), "is not known",
                   "must be Box, Sphere, Cylinder, Capsule or ConvexMesh");
  }
  out.type = static_cast<ShapeType>(in.type());
  const ShapeKind& kind = out.kind();
  if (kind.has_extents) {
    if (in.half_extents_m() == nullptr) {
      return refusal(key + ".half_extents_m", "", "is missing", "give metres");
    }
    out.half_extents_m = fromWire(*in.half_extents_m());
  } else if (kind.has_vertices) {
    if (auto mesh = readMesh(in, key, out); !mesh) return mesh.errors();
  } else {
    out.radius_m = static_cast<double>(in.radius_m());
    if (kind.length_key != nullptr) out.length_m = static_cast<double>(in.length_m());
  }
  return readPlace(in, key, out);
}

Expected<orders::PrepareShapes> read(const fb::PrepareShapes& in) {
  const auto pieces = in.pieces() == nullptr ? 0U : in.pieces()->size();
  if (pieces < 1 || pieces > kMaxSlotPieces) {
    return refusal("pieces", std::to_string(pieces), "is out of range",
                   fmt::format("must be in [1, {}]", kMaxSlotPieces));
  }
  auto out = std::make_shared<BodyOrders>();
  out->shape_set = in.set();
  for (flatbuffers::uoffset_t i = 0; i < pieces; ++i) {
    auto read =
        readShape(*in.pieces()->Get(i), fmt::format("pieces[{}]", i), out->pieces.emplace_back());
    if (read) continue;
    out->faults.push_back(
        {static_cast<int>(i), -1, BodyRefusal::kBadShapes, format(read.errors())});
  }
  return orders::PrepareShapes{{std::move(out)}};
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
    out.pose.orientation_xyzw.w = 0.0;  // no rotation given: later refused as a bad pose
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

/// Makes one command per item of a vector with `make`.
template <class Kind, class Items, class Make>
Expected<Kind> readItems(const Items* items, Make make) {
  const auto count = items == nullptr ? 0U : items->size();
  if (count < 1 || count > kMostBodyItems) {
    return refusal("bodies", std::to_string(count), "is not a number of items that fits",
                   fmt::format("must be in [1, {}]", kMostBodyItems));
  }
  auto out = std::make_shared<BodyOrders>();
  for (const auto* item : *items) out->commands.push_back(make(*item));
  return Kind{{std::move(out)}};
}

Expected<orders::Spawn> read(const fb::Spawn& in) {
  return readItems<orders::Spawn>(in.bodies(), commandOf);
}
Expected<orders::Remove> read(const fb::Remove& in) {
  return readItems<orders::Remove>(
      in.bodies(), [](const fb::BodyName& b) { return removeCommand(slotOf(b), generationOf(b)); });
}
Expected<orders::Teleport> read(const fb::Teleport& in) {
  return readItems<orders::Teleport>(in.bodies(), [](const fb::BodyPlace& b) {
    return teleportCommand(slotOf(b), generationOf(b), fromWire(b.pose()));
  });
}
Expected<orders::SetOwner> read(const fb::SetOwner& in) {
  return readItems<orders::SetOwner>(in.bodies(), [](const fb::BodyHandover& b) {
    return setOwnerCommand(slotOf(b), generationOf(b), static_cast<BodyOwner>(b.owner()));
  });
}
Expected<orders::BodyTargets> read(const fb::BodyTargets& in) {
  return readItems<orders::BodyTargets>(in.bodies(), [](const fb::BodyPlace& b) {
    return bodyTargetCommand(slotOf(b), generationOf(b), fromWire(b.pose()));
  });
}

/// True when the table row of an order kind has the number of the schema.
template <class Kind>
constexpr bool isRowOf(fb::Order wire) {
  return orders::kTable[orders::kIndexOf<Kind>].wire == static_cast<std::uint8_t>(wire);
}

using Reader = Expected<orders::Any> (*)(const void* table);

template <class Table>
Expected<orders::Any> readAs(const void* table) {
  constexpr auto kWire = fb::OrderTraits<Table>::enum_value;
  auto order = read(*static_cast<const Table*>(table));
  if constexpr (requires { order.errors(); }) {
    static_assert(isRowOf<std::remove_reference_t<decltype(*order)>>(kWire));
    if (!order) return order.errors();
    return orders::Any(std::move(*order));
  } else {
    static_assert(isRowOf<decltype(order)>(kWire));
    return orders::Any(std::move(order));
  }
}

/// Readers by number in the schema.
template <class... Tables>
constexpr auto readersOf() {
  std::array<Reader, static_cast<std::size_t>(fb::Order::MAX) + 1> readers{};
  ((readers[static_cast<std::size_t>(fb::OrderTraits<Tables>::enum_value)] = &readAs<Tables>), ...);
  return readers;
}
constexpr auto kReaders =
    readersOf<fb::Arm, fb::Stop, fb::EmergencyStop, fb::LoadExercise, fb::SetParameter, fb::Aim,
              fb::Steer, fb::Action, fb::TakeControls, fb::ReleaseControls, fb::Heartbeat, fb::Rest,
              fb::SaveProfile, fb::LoadProfile, fb::SetHelp, fb::Answer, fb::HoldToMove,
              fb::PrepareShapes, fb::Spawn, fb::Remove, fb::Teleport, fb::SetOwner, fb::BodyTargets,
              fb::OpenVisit, fb::CloseVisit>();
static_assert(std::count(kReaders.begin(), kReaders.end(), nullptr) == 1,
              "every type but NONE has a reader");

Expected<Order> decodeCommand(const fb::Command& c) {
  const auto type = static_cast<std::size_t>(c.order_type());
  if (type >= kReaders.size() || kReaders[type] == nullptr) return unknown("order", c.order_type());
  auto what = kReaders[type](c.order());
  if (!what) return what.errors();
  return Order{std::move(*what), c.id()};
}

Expected<Order> decodePayload(const fb::Message& message) {
  if (message.schema_version() != kSchemaVersion) {
    return refusal(kVersionKey, std::to_string(message.schema_version()),
                   "is not the version of this program",
                   "must be " + std::to_string(kSchemaVersion) +
                       ": reload the page, or bring "
                       "client and program to the same version");
  }
  // Both null checks are needed, because a message without the union passes verification.
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

Expected<Order> decode(std::span<const std::uint8_t> message) {
  if (message.size() > kLargestClientMessage) {
    return refusal("size", std::to_string(message.size()) + " bytes", "is too large",
                   "must be at most " + std::to_string(kLargestClientMessage) + " bytes");
  }
  // The bytes are copied into an aligned buffer, because FlatBuffers reads numbers in place.
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
