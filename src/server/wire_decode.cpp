#include "server/wire.hpp"
#include "server/wire_bodies.hpp"
#include "server/wire_common.hpp"

#include <array>
#include <cmath>
#include <cstring>

namespace wholehand::wire {

namespace {

/// Limits of nesting depth and number of tables of a client message: Message, Command, its order,
/// and the items of that.
constexpr flatbuffers::uoffset_t kDepth = 8, kTables = 8 + kMostBodyItems;
/// Smallest message: root offset and identifier.
constexpr std::size_t kSmallestMessage = 8;
struct alignas(16) AlignedBytes : std::array<std::uint8_t, kLargestClientMessage> {};
constexpr const char* kVersionKey = "schema_version";

Diagnostic refusal(const char* key, std::string value, std::string problem, std::string remedy) {
  return {"", 0, key, std::move(value), std::move(problem), std::move(remedy)};
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
