#include "server/wire.hpp"

#include "server/wire_common.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace wholehand::wire {

namespace {

/// With more axes than this, a compact state omits what a game can do without, so that it always
/// fits into a datagram.
constexpr int kAxesThatFitDatagram = 9;

/// The arrays of a state; FlatBuffers needs them before the table that refers to them.
struct Arrays {
  VectorOffset<float> q_m, q_s, qd_s, theta, intention, coupling, exercise_effort, damping, sent,
      phi;
  VectorOffset<float> parameters;
  VectorOffset<double> values;
  VectorOffset<const fb::Pose*> links, bodies;
  VectorOffset<const fb::ContactPoint*> contacts;
  Offset<fb::DeviceState> device;
  VectorOffset<std::uint32_t> fault_ticks;
};

VectorOffset<const fb::Pose*> links(Builder& b, const HandModel& hand,
                                    const ArticulatedBody& kinematics) {
  std::array<fb::Pose, kMaxLinks> poses;
  const std::size_t n = std::min(hand.links.size(), poses.size());
  for (std::size_t i = 0; i < n; ++i) {
    poses[i] = toWire(kinematics.linkPose(static_cast<int>(i)));
  }
  return b.CreateVectorOfStructs(poses.data(), n);
}

/// Bodies of a state: without the empty slots that follow the last one in use.
int bodyCount(const SceneModel& scene, const TickRecord& r, const LoopStatus& status,
              Detail detail) {
  const int all = std::clamp(r.body_count, 0, kMaxBodies);
  if (detail == Detail::kRecorded || scene.game.slots == 0) return all;
  const bool in_use = status.bodies && !status.bodies->empty();
  const int slots = in_use ? status.bodies->back().slot + 1 : 0;
  return std::min(all, static_cast<int>(scene.bodies.size()) + slots);
}

VectorOffset<const fb::Pose*> bodies(Builder& b, const TickRecord& r, int count) {
  std::array<fb::Pose, kMaxBodies> poses;
  for (int i = 0; i < count; ++i) {
    poses[i] = {toWire(r.bodies[i].position_m), toWire(r.bodies[i].orientation_xyzw)};
  }
  return b.CreateVectorOfStructs(poses.data(), count);
}

VectorOffset<const fb::ContactPoint*> contacts(Builder& b, const TickRecord& r) {
  std::array<fb::ContactPoint, kMaxContacts> points;
  const int n = std::clamp(r.contact_count, 0, kMaxContacts);
  for (int i = 0; i < n; ++i) {
    const Contact& c = r.contacts[i];
    points[i] = {static_cast<std::int16_t>(c.capsule), static_cast<std::int16_t>(c.body),
                 toWire(c.point_m), toWire(c.force_n)};
  }
  return b.CreateVectorOfStructs(points.data(), n);
}

Offset<fb::DeviceState> deviceToWire(Builder& b, const DeviceStatus& s) {
  const bool warm = std::isfinite(s.temperature_c);
  return fb::CreateDeviceState(b, s.enabled, s.homed, s.silenced, warm,
                               warm ? static_cast<float>(s.temperature_c) : 0.0F,
                               static_cast<float>(s.sample_age_s), s.hosted,
                               static_cast<float>(s.host_age_s), static_cast<fb::LetGo>(s.let_go));
}

Arrays makeArrays(Builder& b, const SceneModel& scene, const TickRecord& r,
                  const LoopStatus& status, Detail detail) {
  Arrays a;
  a.q_m = floats(b, r.q_m);
  a.q_s = floats(b, r.q_s);
  a.theta = floats(b, r.theta);
  a.exercise_effort = floats(b, r.exercise.effort);
  a.sent = floats(b, r.sent);
  a.phi = floats(b, r.phi);
  a.values = b.CreateVector(
      r.exercise.values.data(),
      static_cast<std::size_t>(std::clamp(r.exercise.value_count, 0, kMaxExerciseValues)));
  if (detail != Detail::kCompact || r.q_m.size() <= kAxesThatFitDatagram) {
    a.intention = floats(b, r.intention);
    a.coupling = floats(b, r.coupling);
    a.damping = floats(b, r.damping);
  }
  if (detail == Detail::kFull) {
    std::array<std::uint32_t, kFaultBits> ticks;
    std::transform(status.fault_ticks.begin(), status.fault_ticks.end(), ticks.begin(),
                   [](std::uint64_t n) { return static_cast<std::uint32_t>(n); });
    a.fault_ticks = b.CreateVector(ticks.data(), ticks.size());
    if (status.device) a.device = deviceToWire(b, *status.device);
  }
  if (detail != Detail::kCompact) {
    a.qd_s = floats(b, r.qd_s);
    a.parameters = floats(b, status.parameters);
    a.bodies = bodies(b, r, bodyCount(scene, r, status, detail));
    a.contacts = contacts(b, r);
  }
  return a;
}

void addArrays(fb::WorldStateBuilder& out, const Arrays& a) {
  out.add_q_m(a.q_m);
  out.add_q_s(a.q_s);
  out.add_qd_s(a.qd_s);
  out.add_theta(a.theta);
  out.add_intention(a.intention);  // add_* ignores an array that was not made
  out.add_coupling(a.coupling);
  out.add_exercise_effort(a.exercise_effort);
  out.add_damping(a.damping);
  out.add_sent(a.sent);
  out.add_phi(a.phi);
  out.add_links(a.links);
  out.add_bodies(a.bodies);
  out.add_contacts(a.contacts);
  out.add_values(a.values);
  out.add_parameters(a.parameters);
  out.add_device(a.device);
  out.add_fault_ticks(a.fault_ticks);
}

fb::Statistics statisticsToWire(const LoopStatus& s) {
  return {s.ticks,
          s.missed_deadlines,
          s.dropped_records,
          static_cast<float>(s.cpu_p50_us),
          static_cast<float>(s.cpu_p99_us),
          static_cast<float>(s.cpu_p999_us),
          static_cast<float>(s.cpu_max_us)};
}

Offset<fb::WorldState> makeState(Builder& b, const TickRecord& r, const LoopStatus& status,
                                 const Arrays& arrays, Detail detail,
                                 std::int64_t sent_monotonic_ns) {
  const fb::Statistics statistics = statisticsToWire(status);
  fb::WorldStateBuilder out(b);
  // Large fields first: no padding between them.
  out.add_tick(r.tick);
  out.add_time_s(r.time_s);
  out.add_sent_monotonic_ns(sent_monotonic_ns);
  out.add_recording_bytes(status.recording_bytes);
  if (detail != Detail::kRecorded) out.add_statistics(&statistics);
  out.add_session(status.session);
  out.add_faults(static_cast<std::uint32_t>(r.faults));
  out.add_latched_faults(static_cast<std::uint32_t>(status.latched));
  out.add_authority(static_cast<float>(r.authority));
  out.add_alpha(static_cast<float>(r.exercise.alpha));
  out.add_palm_distance_m(static_cast<float>(r.palm_target_distance_m));
  out.add_fault_value(static_cast<float>(status.fault_value));
  out.add_fault_limit(static_cast<float>(status.fault_limit));
  out.add_endings(status.endings);
  out.add_rehearsed_ticks(status.rehearsed_ticks);
  addArrays(out, arrays);
  out.add_fault_axis(static_cast<std::int16_t>(status.fault_axis));
  out.add_palm_body(static_cast<std::int16_t>(r.palm_body));
  out.add_run_state(static_cast<fb::RunState>(status.run_state));
  out.add_steering(static_cast<fb::Steering>(status.steering));
  out.add_safety_state(static_cast<fb::SafetyState>(r.safety_state));
  out.add_rested(status.rested);
  out.add_help(static_cast<fb::Help>(status.help));
  return out.Finish();
}

Bytes take(const Builder& b) {
  return {b.GetBufferPointer(), b.GetBufferPointer() + b.GetSize()};
}

}  // namespace

struct StateEncoder::Buffer {
  Builder builder{16 * 1024};
};

StateEncoder::StateEncoder(std::shared_ptr<const SceneFacts> scene)
    : scene_(std::move(scene)), kinematics_(scene_->hand), buffer_(std::make_unique<Buffer>()) {}

StateEncoder::~StateEncoder() = default;

std::span<const std::uint8_t> StateEncoder::encode(const TickRecord& record,
                                                   const LoopStatus& status, Detail detail,
                                                   std::int64_t sent_monotonic_ns) {
  Builder& b = buffer_->builder;
  b.Clear();
  Arrays arrays = makeArrays(b, scene_->scene, record, status, detail);
  // A record from before a scene change may have other joints: then without links.
  const HandModel& hand = scene_->hand;
  if (detail != Detail::kCompact && hand.joint_count > 0 &&
      record.theta.size() == hand.joint_count) {
    kinematics_.updateKinematics(record.theta);
    arrays.links = links(b, hand, kinematics_);
  }
  finish(b, makeState(b, record, status, arrays, detail, sent_monotonic_ns), kSchemaVersion);
  return {b.GetBufferPointer(), b.GetSize()};
}

Bytes eventsMessage(std::span<const NumberedEvent> events) {
  Builder b;
  std::vector<fb::Event> out;
  out.reserve(events.size());
  for (const NumberedEvent& e : events) {
    out.emplace_back(e.tick, static_cast<std::uint16_t>(e.event.type),
                     static_cast<std::int16_t>(e.event.index), static_cast<float>(e.event.value));
  }
  finish(b, fb::CreateEvents(b, b.CreateVectorOfStructs(out)), kSchemaVersion);
  return take(b);
}

Bytes welcomeMessage(std::uint32_t client, bool controls, const std::string& program_version,
                     const UdpAccess& access) {
  Builder b;
  const auto version = b.CreateString(program_version);
  finish(b,
         fb::CreateWelcome(b, kSchemaVersion, client, controls, version, access.port, access.key),
         kSchemaVersion);
  return take(b);
}

static_assert(static_cast<int>(Role::kTherapist) == static_cast<int>(fb::Role::MAX));

Bytes controlsMessage(const ControlsFacts& f) {
  Builder b;
  finish(b,
         fb::CreateControls(b, f.held_by_you, f.held, static_cast<fb::Role>(f.your_role),
                            static_cast<fb::Role>(f.holder_role), f.led),
         kSchemaVersion);
  return take(b);
}

static_assert(static_cast<int>(Refusal::kRefusedBefore) == static_cast<int>(fb::Refusal::MAX));
static_assert(kOrderRefusals - 1 == static_cast<int>(fb::BodyRefusal::MAX));

Bytes replyMessage(std::uint32_t command, const OrderReply& reply) {
  Builder b;
  const auto reason = b.CreateString(reply.reason);
  const auto refusal = reply.accepted ? fb::Refusal::None : static_cast<fb::Refusal>(reply.refusal);
  std::vector<Offset<fb::RefusedItem>> items;
  for (const RefusedItem& item : reply.items) {
    items.push_back(fb::CreateRefusedItemDirect(b, static_cast<std::uint16_t>(item.item), item.slot,
                                                static_cast<fb::BodyRefusal>(item.refusal),
                                                item.reason.c_str()));
  }
  VectorOffset<Offset<fb::RefusedItem>> list;
  if (!items.empty()) list = b.CreateVector(items);
  finish(b, fb::CreateReply(b, command, reply.accepted, reason, refusal, list), kSchemaVersion);
  return take(b);
}

namespace {

const char* nameOfBodyOrder(const ClientMessage& message) noexcept {
  switch (message.order.bodies->commands.front().type) {
    case CommandType::kSpawn:
      return "Spawn";
    case CommandType::kRemove:
      return "Remove";
    case CommandType::kTeleport:
      return "Teleport";
    case CommandType::kSetOwner:
      return "SetOwner";
    default:
      return "BodyTargets";
  }
}

}  // namespace

const char* nameOf(const ClientMessage& message) noexcept {
  switch (message.type) {
    case ClientMessageType::kTakeControls:
      return "TakeControls";
    case ClientMessageType::kReleaseControls:
      return "ReleaseControls";
    case ClientMessageType::kHeartbeat:
      return "Heartbeat";
    case ClientMessageType::kOrder:
      break;
  }
  if (message.order.rest) return "Rest";
  constexpr std::array<const char*, 8> kNames = {
      "Arm", "Stop", "EmergencyStop", "LoadExercise", "SetParameter", "Aim", "Steer", "Action"};
  if (message.order.type == OrderType::kPrepareShapes) return "PrepareShapes";
  if (message.order.type == OrderType::kOrderBodies) return nameOfBodyOrder(message);
  if (message.order.type == OrderType::kSaveProfile) return "SaveProfile";
  if (message.order.type == OrderType::kLoadProfile) return "LoadProfile";
  if (message.order.type == OrderType::kSetHelp) return "SetHelp";
  if (message.order.type == OrderType::kAnswer) return "Answer";
  if (message.order.type == OrderType::kHoldToMove) return "HoldToMove";
  const auto i = static_cast<std::size_t>(message.order.type);
  return i < kNames.size() ? kNames[i] : "command";
}

}  // namespace wholehand::wire
