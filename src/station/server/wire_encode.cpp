#include "loop/core/axis_array.hpp"
#include "loop/core/geometry.hpp"
#include "loop/model/scene_model.hpp"
#include "station/server/wire.hpp"
#include "wholehand_generated.h"

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace wholehand::wire {

namespace fb = wholehand::protocol;

namespace {

using Builder = flatbuffers::FlatBufferBuilder;
template <class T>
using Offset = flatbuffers::Offset<T>;
template <class T>
using VectorOffset = flatbuffers::Offset<flatbuffers::Vector<T>>;

fb::Vec3 toWire(const Vec3& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}
fb::Vec3 toWire(const Eigen::Vector3d& v) {
  return toWire(Vec3::from(v));
}
fb::QuatXyzw toWire(const QuatXyzw& q) {
  return {static_cast<float>(q.x), static_cast<float>(q.y), static_cast<float>(q.z),
          static_cast<float>(q.w)};
}
fb::Pose toWire(const Pose& pose) {
  return {toWire(pose.translation_m), toWire(QuatXyzw::from(Eigen::Quaterniond(pose.rotation)))};
}

/// Writes the doubles of a range with data() and size() as a vector of floats, directly into the
/// builder's memory.
template <class Range>
VectorOffset<float> floats(Builder& b, const Range& values) {
  float* out = nullptr;
  const std::size_t n = values.size();
  const auto offset = b.CreateUninitializedVector<float>(n, &out);
  const double* in = values.data();
  for (std::size_t i = 0; i < n; ++i) {
    flatbuffers::WriteScalar(out + i, static_cast<float>(in[i]));
  }
  return offset;
}

/// Finishes a message around a payload.
template <class T>
void finish(Builder& b, Offset<T> payload, std::uint16_t schema_version) {
  b.Finish(fb::CreateMessage(b, schema_version, fb::PayloadTraits<T>::enum_value, payload.Union()),
           fb::MessageIdentifier());
}

/// A shape of a body, placed relative to the body's centre of mass.
Offset<fb::Shape> shapeToWire(Builder& b, const Shape& shape, const Eigen::Vector3d& com_m) {
  VectorOffset<const fb::Vec3*> points;
  VectorOffset<std::uint32_t> triangles;
  if (shape.isMesh()) {
    std::vector<fb::Vec3> p;
    for (const Eigen::Vector3d& point : shape.points_m) p.push_back(toWire(point));
    points = b.CreateVectorOfStructs(p);
    std::vector<std::uint32_t> t;
    for (const Eigen::Vector3i& face : shape.triangles) {
      for (const int corner : face) t.push_back(static_cast<std::uint32_t>(corner));
    }
    triangles = b.CreateVector(t);
  }
  // Shapes are placed relative to the centre of mass, because a state gives its position.
  Pose about_com = shape.in_body;
  about_com.translation_m -= com_m;
  const fb::Vec3 half = toWire(shape.half_extents_m);
  const fb::Pose pose = toWire(about_com);
  return fb::CreateShape(b, static_cast<fb::ShapeType>(shape.type), &half,
                         static_cast<float>(shape.radius_m), static_cast<float>(shape.length_m),
                         points, triangles, &pose);
}

/// Largest number of axes at which a compact state carries everything. With more axes it omits what
/// a game can do without, so that it always fits into a datagram.
constexpr int kAxesThatFitDatagram = 9;

/// The arrays of a state, which FlatBuffers needs before the table that refers to them, and the
/// person's times.
struct Arrays {
  VectorOffset<float> q_m, q_s, qd_s, theta, intention, coupling, exercise_effort, damping, sent,
      phi;
  VectorOffset<float> parameters;
  VectorOffset<double> values, settings;
  VectorOffset<const fb::Pose*> links, bodies;
  VectorOffset<const fb::ContactPoint*> contacts;
  Offset<fb::DeviceState> device;
  VectorOffset<std::uint32_t> fault_ticks;
  double active_s = 0.0, helped_s = 0.0, led_s = 0.0;
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

/// Number of bodies in a state, without the empty slots after the last used one.
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
  return fb::CreateDeviceState(
      b, s.enabled, s.homed, s.silenced, warm, warm ? static_cast<float>(s.temperature_c) : 0.0F,
      static_cast<float>(s.sample_age_s), s.hosted, static_cast<float>(s.host_age_s),
      static_cast<fb::ReleaseReason>(s.let_go));
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
    a.settings = b.CreateVector(status.settings);
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
  out.add_settings(a.settings);
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
  // Large fields come first, so that there is no padding between them.
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
  out.add_palm_target_distance_m(static_cast<float>(r.palm_target_distance_m));
  out.add_fault_value(static_cast<float>(status.fault_value));
  out.add_fault_limit(static_cast<float>(status.fault_limit));
  out.add_endings(status.endings);
  if (detail == Detail::kFull) out.add_basis(status.basis);  // datagrams may overtake the scene
  out.add_rehearsed_ticks(status.rehearsed_ticks);
  out.add_loop_age_s(static_cast<float>(status.loop_age_s));
  out.add_active_s(static_cast<float>(arrays.active_s));
  out.add_helped_s(static_cast<float>(arrays.helped_s));
  out.add_led_s(static_cast<float>(arrays.led_s));
  if (detail == Detail::kFull) out.add_work_j(static_cast<float>(status.work_j));
  addArrays(out, arrays);
  out.add_fault_axis(static_cast<std::int16_t>(status.fault_axis));
  out.add_palm_body(static_cast<std::int16_t>(r.palm_body));
  out.add_run_state(static_cast<fb::RunState>(status.run_state));
  out.add_steering(static_cast<fb::Steering>(status.steering));
  out.add_safety_state(static_cast<fb::SafetyState>(r.safety_state));
  out.add_rested(status.rested);
  out.add_arming(status.arming);
  out.add_silent(status.silent);
  out.add_stop_pending(status.stop_pending);
  out.add_stop_unconfirmed(status.stop_unconfirmed);
  out.add_help(static_cast<fb::Help>(status.help));
  return out.Finish();
}

Bytes take(const Builder& b) {
  return {b.GetBufferPointer(), b.GetBufferPointer() + b.GetSize()};
}

Offset<fb::Body> bodyToWire(Builder& b, const SceneBody& body) {
  std::vector<Offset<fb::Shape>> shapes;
  for (const Shape& shape : body.shapes) shapes.push_back(shapeToWire(b, shape, body.com_m));
  return fb::CreateBody(b, b.CreateString(body.name), body.fixed, b.CreateString(body.color),
                        b.CreateVector(shapes));
}

Offset<fb::Capsule> capsuleToWire(Builder& b, const Capsule& capsule) {
  const fb::Vec3 begin = toWire(capsule.a_m);
  const fb::Vec3 end = toWire(capsule.b_m);
  return fb::CreateCapsule(b, b.CreateString(capsule.name), static_cast<fb::HandPart>(capsule.part),
                           static_cast<std::int16_t>(capsule.link), &begin, &end,
                           static_cast<float>(capsule.radius_m));
}

Offset<fb::Link> linkToWire(Builder& b, const HandLink& link) {
  const fb::Vec3 axis = toWire(link.axis);
  const fb::Pose at_zero = toWire(link.parent_to_link);
  return fb::CreateLink(b, b.CreateString(link.name), static_cast<std::int16_t>(link.parent),
                        static_cast<std::int16_t>(link.joint),
                        static_cast<fb::JointType>(link.type), &axis, &at_zero);
}

Offset<fb::Axis> axisToWire(Builder& b, const DeviceAxis& axis) {
  return fb::CreateAxis(b, b.CreateString(axis.name), b.CreateString(axis.positionUnit()),
                        static_cast<float>(axis.lower), static_cast<float>(axis.upper),
                        static_cast<float>(axis.effort_limit), static_cast<float>(axis.lever_arm_m),
                        static_cast<float>(axis.speed_limit));
}

Offset<fb::Parameter> parameterToWire(Builder& b, const PublishedParameter& p) {
  const fb::ParameterRange exact(p.lower, p.upper, p.initial);
  return fb::CreateParameter(b, b.CreateString(p.name), static_cast<fb::ParameterGroup>(p.group),
                             b.CreateString(p.unit), static_cast<float>(p.lower),
                             static_cast<float>(p.upper), static_cast<float>(p.initial),
                             static_cast<float>(p.rate_per_s), &exact, p.bounds_effort);
}

Offset<fb::Words> wordsToWire(Builder& b, const Words& words) {
  return fb::CreateWords(b, b.CreateString(words.en), b.CreateString(words.fr),
                         b.CreateString(words.de));
}

Offset<fb::PanelValue> panelValueToWire(Builder& b, const PanelValue& v) {
  return fb::CreatePanelValue(b, b.CreateString(v.name), wordsToWire(b, v.label),
                              b.CreateString(v.unit), v.factor,
                              static_cast<std::uint8_t>(v.decimals), v.lower, v.upper,
                              b.CreateString(v.goal_lower), b.CreateString(v.goal_upper), v.result);
}

/// Makes a vector of tables; `make(b, item)` makes each.
template <class Item, class Make>
auto tables(Builder& b, const std::vector<Item>& items, Make make) {
  std::vector<decltype(make(b, items.front()))> out;
  out.reserve(items.size());
  for (const Item& item : items) out.push_back(make(b, item));
  return b.CreateVector(out);
}

/// Encodes the panel; null when the exercise file has none.
Offset<fb::Panel> panelToWire(Builder& b, const SceneFacts& s) {
  if (s.panel.title.en.empty()) return {};
  const auto title = wordsToWire(b, s.panel.title);
  const auto lead = wordsToWire(b, s.panel.lead);
  const auto instructions = tables(b, s.panel.instructions, wordsToWire);
  const auto values = tables(b, s.panel.values, panelValueToWire);
  const auto events = tables(b, s.panel.events, [&s](Builder& to, const PanelEvent& event) {
    const auto at = std::find(s.event_names.begin(), s.event_names.end(), event.name);
    const auto words = wordsToWire(to, event.words);
    return fb::CreatePanelEvent(to, static_cast<std::uint16_t>(at - s.event_names.begin()), words);
  });
  return fb::CreatePanel(b, title, lead, instructions, values, events);
}

std::vector<std::string> linkNames(const HandModel& hand) {
  std::vector<std::string> names;
  for (const HandLink& link : hand.links) names.push_back(link.name);
  return names;
}

std::vector<std::string> faultNames() {
  std::vector<std::string> names;
  for (int bit = 0; bit < kFaultBits; ++bit) names.emplace_back(faultName(bit));
  return names;
}

/// Encodes the budget; null when a game cannot bring bodies.
Offset<fb::BodyBudget> budgetToWire(Builder& b, const GameBudget& game) {
  if (game.slots == 0) return {};
  const auto count = [](int n) { return static_cast<std::uint16_t>(n); };
  return fb::CreateBodyBudget(
      b, count(game.slots), count(game.awake), count(game.shape_sets), count(game.pieces),
      count(game.vertices), static_cast<float>(game.least_kg), static_cast<float>(game.most_kg),
      static_cast<float>(game.least_m), static_cast<float>(game.most_m), count(kMostRegistered));
}

fb::RegisteredBody registeredToWire(const RegisteredBody& body) {
  const Whereabouts where = body.shapes ? body.whereabouts : Whereabouts::kGone;
  return {static_cast<std::uint32_t>(body.number),
          static_cast<std::uint32_t>(body.generation),
          body.shapes ? body.shapes->id : 0,
          body.slot,
          static_cast<fb::Whereabouts>(where),
          {toWire(body.pose.position_m), toWire(body.pose.orientation_xyzw)}};
}

using Facts = CommissioningFacts;

Offset<fb::Finding> findingToWire(Builder& b, const Facts::Finding& f) {
  return fb::CreateFindingDirect(b, f.axis.c_str(), f.quantity.c_str(), f.unit.c_str(), f.lower,
                                 f.upper);
}

Offset<fb::CommissioningStep> stepToWire(Builder& b, const Facts::Step& step) {
  std::vector<Offset<fb::Finding>> findings;
  for (const Facts::Finding& f : step.findings) findings.push_back(findingToWire(b, f));
  return fb::CreateCommissioningStepDirect(b, step.name.c_str(),
                                           static_cast<fb::StepState>(step.state), &findings,
                                           step.problem.c_str(), step.remedy.c_str());
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
                                                   std::int64_t sent_monotonic_ns,
                                                   const ActivePeriods& active) {
  Builder& b = buffer_->builder;
  b.Clear();
  Arrays arrays = makeArrays(b, scene_->scene, record, status, detail);
  // A record from before a scene change may have other joints; its links are omitted then.
  const HandModel& hand = scene_->hand;
  if (detail != Detail::kCompact && hand.joint_count > 0 &&
      record.theta.size() == hand.joint_count) {
    kinematics_.updateKinematics(record.theta);
    arrays.links = links(b, hand, kinematics_);
  }
  arrays.active_s = static_cast<double>(active.active) * scene_->period_s;
  arrays.helped_s = static_cast<double>(active.helped) * scene_->period_s;
  arrays.led_s = static_cast<double>(active.led) * scene_->period_s;
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

Bytes controlsMessage(const ControlsFacts& f) {
  Builder b;
  finish(b,
         fb::CreateControls(b, f.held_by_you, f.held, static_cast<fb::Role>(f.your_role),
                            static_cast<fb::Role>(f.holder_role), f.led),
         kSchemaVersion);
  return take(b);
}

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

Bytes sceneMessage(const SceneFacts& s) {
  Builder b;
  const auto text = [&b](const std::string& words) { return b.CreateString(words); };
  const auto texts = [&b](const std::vector<std::string>& all) {
    return b.CreateVectorOfStrings(all);
  };
  const auto scene = fb::CreateScene(
      b, s.session, text(s.program_version), text(s.scene.name), text(s.hand.name),
      s.hand.side == Side::kRight, text(s.device.name), text(s.patient_name), text(s.exercise_name),
      text(s.exercise_json), s.period_s, tables(b, s.device.axes, axisToWire),
      texts(s.hand.joint_names), texts(linkNames(s.hand)),
      tables(b, s.hand.capsules, capsuleToWire), tables(b, s.scene.bodies, bodyToWire),
      texts(s.value_names), texts(s.event_names), texts(faultNames()),
      tables(b, s.parameters, parameterToWire), texts(s.exercises), texts(s.hands),
      static_cast<std::uint16_t>(s.levels), static_cast<std::uint16_t>(s.level), text(s.recording),
      panelToWire(b, s), texts(s.profiles), text(s.profile), tables(b, s.hand.links, linkToWire),
      budgetToWire(b, s.scene.game), s.visit.number, s.visit.item);
  finish(b, scene, kSchemaVersion);
  return take(b);
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
  for (const RegisteredBody& body : registered) numbers.push_back(registeredToWire(body));
  const auto number_list = numbers.empty() ? 0 : b.CreateVectorOfStructs(numbers);
  finish(b, fb::CreateGameBodies(b, session, body_list, shape_list, number_list), kSchemaVersion);
  return take(b);
}

Bytes commissioningMessage(const CommissioningFacts& f) {
  Builder b;
  std::vector<Offset<fb::CommissioningStep>> steps;
  for (const Facts::Step& step : f.steps) steps.push_back(stepToWire(b, step));
  const auto message = fb::CreateCommissioningDirect(
      b, f.device.c_str(), f.driver.c_str(), f.serial.c_str(), f.firmware.c_str(),
      f.operator_name.c_str(), &steps, f.question, static_cast<fb::QuestionKind>(f.asked),
      f.axis.c_str(), f.unit.c_str(), f.lower, f.upper, f.next.c_str(), f.note.c_str(),
      static_cast<fb::MotionKind>(f.motion), static_cast<fb::MotionState>(f.motion_state),
      static_cast<float>(f.motion_s), f.passport.c_str(), f.recording.c_str(), f.daily);
  finish(b, message, kSchemaVersion);
  return take(b);
}

}  // namespace wholehand::wire
