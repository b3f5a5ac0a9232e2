#include "server/wire.hpp"
#include "server/wire_common.hpp"

#include <algorithm>

namespace wholehand::wire {

Offset<fb::Shape> shapeToWire(Builder& b, const Shape& shape, const Eigen::Vector3d& com_m) {
  VectorOffset<const fb::Vec3*> points;
  VectorOffset<std::uint32_t> triangles;
  if (shape.type == ShapeType::kConvexMesh) {
    std::vector<fb::Vec3> p;
    for (const Eigen::Vector3d& point : shape.points_m) p.push_back(toWire(point));
    points = b.CreateVectorOfStructs(p);
    std::vector<std::uint32_t> t;
    for (const Eigen::Vector3i& face : shape.triangles) {
      for (const int corner : face) t.push_back(static_cast<std::uint32_t>(corner));
    }
    triangles = b.CreateVector(t);
  }
  // A state gives the position of the centre of mass, so shapes are placed relative to it.
  Pose about_com = shape.in_body;
  about_com.translation_m -= com_m;
  const fb::Vec3 half = toWire(shape.half_extents_m);
  const fb::Pose pose = toWire(about_com);
  return fb::CreateShape(b, static_cast<fb::ShapeType>(shape.type), &half,
                         static_cast<float>(shape.radius_m), static_cast<float>(shape.length_m),
                         points, triangles, &pose);
}

namespace {

using Strings = VectorOffset<flatbuffers::Offset<flatbuffers::String>>;

Strings strings(Builder& b, const std::vector<std::string>& texts) {
  return b.CreateVectorOfStrings(texts);
}

Offset<fb::Body> bodyToWire(Builder& b, const SceneBody& body) {
  std::vector<Offset<fb::Shape>> shapes;
  for (const Shape& shape : body.shapes) shapes.push_back(shapeToWire(b, shape, body.com_m));
  const auto name = b.CreateString(body.name);
  const auto color = b.CreateString(body.color);
  return fb::CreateBody(b, name, body.fixed, color, b.CreateVector(shapes));
}

Offset<fb::Capsule> capsuleToWire(Builder& b, const Capsule& capsule) {
  const fb::Vec3 begin = toWire(capsule.a_m);
  const fb::Vec3 end = toWire(capsule.b_m);
  return fb::CreateCapsule(b, b.CreateString(capsule.name), static_cast<fb::HandPart>(capsule.part),
                           static_cast<std::int16_t>(capsule.link), &begin, &end,
                           static_cast<float>(capsule.radius_m));
}

Offset<fb::Link> linkToWire(Builder& b, const HandLink& link) {
  const auto name = b.CreateString(link.name);
  const fb::Vec3 axis = toWire(link.axis);
  const fb::Pose at_zero = toWire(link.parent_to_link);
  return fb::CreateLink(b, name, static_cast<std::int16_t>(link.parent),
                        static_cast<std::int16_t>(link.joint),
                        static_cast<fb::JointType>(link.type), &axis, &at_zero);
}

Offset<fb::Axis> axisToWire(Builder& b, const DeviceAxis& axis) {
  const auto name = b.CreateString(axis.name);
  const auto unit = b.CreateString(axis.positionUnit());
  return fb::CreateAxis(b, name, unit, static_cast<float>(axis.lower),
                        static_cast<float>(axis.upper), static_cast<float>(axis.effort_limit),
                        static_cast<float>(axis.lever_arm_m), static_cast<float>(axis.speed_limit));
}

Offset<fb::Parameter> parameterToWire(Builder& b, const PublishedParameter& p) {
  const auto name = b.CreateString(p.name);
  const auto unit = b.CreateString(p.unit);
  return fb::CreateParameter(b, name, static_cast<fb::ParameterGroup>(p.group), unit,
                             static_cast<float>(p.lower), static_cast<float>(p.upper),
                             static_cast<float>(p.initial), static_cast<float>(p.rate_per_s));
}

Offset<fb::Words> wordsToWire(Builder& b, const Words& words) {
  const auto en = b.CreateString(words.en);
  const auto fr = b.CreateString(words.fr);
  const auto de = b.CreateString(words.de);
  return fb::CreateWords(b, en, fr, de);
}

Offset<fb::PanelValue> panelValueToWire(Builder& b, const PanelValue& v) {
  const auto name = b.CreateString(v.name);
  const auto label = wordsToWire(b, v.label);
  const auto unit = b.CreateString(v.unit);
  const auto goal_lower = b.CreateString(v.goal_lower);
  const auto goal_upper = b.CreateString(v.goal_upper);
  return fb::CreatePanelValue(b, name, label, unit, v.factor, static_cast<std::uint8_t>(v.decimals),
                              v.lower, v.upper, goal_lower, goal_upper, v.result);
}

/// A vector of tables, each made by `make(b, item)`.
template <class Item, class Make>
auto tables(Builder& b, const std::vector<Item>& items, Make make) {
  std::vector<decltype(make(b, items.front()))> out;
  out.reserve(items.size());
  for (const Item& item : items) out.push_back(make(b, item));
  return b.CreateVector(out);
}

/// Null where the exercise file has no panel.
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

/// Null where a game can bring no bodies.
Offset<fb::BodyBudget> budgetToWire(Builder& b, const GameBudget& game) {
  if (game.slots == 0) return {};
  const auto count = [](int n) { return static_cast<std::uint16_t>(n); };
  return fb::CreateBodyBudget(
      b, count(game.slots), count(game.awake), count(game.shape_sets), count(game.pieces),
      count(game.vertices), static_cast<float>(game.least_kg), static_cast<float>(game.most_kg),
      static_cast<float>(game.least_m), static_cast<float>(game.most_m), count(kMostRegistered));
}

/// Offsets of a Scene's parts; FlatBuffers needs them before its table is begun.
struct SceneParts {
  Offset<flatbuffers::String> program_version, scene_name, hand_name, device_name, patient_name;
  Offset<flatbuffers::String> exercise_name, exercise_json, recording;
  VectorOffset<Offset<fb::Axis>> axes;
  VectorOffset<Offset<fb::Capsule>> capsules;
  VectorOffset<Offset<fb::Link>> links;
  VectorOffset<Offset<fb::Body>> bodies;
  VectorOffset<Offset<fb::Parameter>> parameters;
  Offset<fb::Panel> panel;
  Offset<fb::BodyBudget> budget;
  Offset<flatbuffers::String> profile;
  Strings profiles;
  Strings joint_names, link_names, value_names, event_names, fault_names, exercises, hands;
};

SceneParts makeParts(Builder& b, const SceneFacts& s) {
  SceneParts p;
  p.program_version = b.CreateString(s.program_version);
  p.scene_name = b.CreateString(s.scene.name);
  p.hand_name = b.CreateString(s.hand.name);
  p.device_name = b.CreateString(s.device.name);
  p.patient_name = b.CreateString(s.patient_name);
  p.exercise_name = b.CreateString(s.exercise_name);
  p.exercise_json = b.CreateString(s.exercise_json);
  p.recording = b.CreateString(s.recording);
  p.panel = panelToWire(b, s);
  p.budget = budgetToWire(b, s.scene.game);
  p.axes = tables(b, s.device.axes, axisToWire);
  p.capsules = tables(b, s.hand.capsules, capsuleToWire);
  p.links = tables(b, s.hand.links, linkToWire);
  p.bodies = tables(b, s.scene.bodies, bodyToWire);
  p.parameters = tables(b, s.parameters, parameterToWire);
  p.joint_names = strings(b, s.hand.joint_names);
  p.link_names = strings(b, linkNames(s.hand));
  p.value_names = strings(b, s.value_names);
  p.event_names = strings(b, s.event_names);
  p.fault_names = strings(b, faultNames());
  p.exercises = strings(b, s.exercises);
  p.hands = strings(b, s.hands);
  p.profiles = strings(b, s.profiles);
  p.profile = b.CreateString(s.profile);
  return p;
}

}  // namespace

Bytes sceneMessage(const SceneFacts& s) {
  Builder b;
  const SceneParts p = makeParts(b, s);
  fb::SceneBuilder out(b);
  out.add_session(s.session);
  out.add_program_version(p.program_version);
  out.add_scene_name(p.scene_name);
  out.add_hand_name(p.hand_name);
  out.add_right_hand(s.hand.side == Side::kRight);
  out.add_device_name(p.device_name);
  out.add_patient_name(p.patient_name);
  out.add_exercise_name(p.exercise_name);
  out.add_exercise_json(p.exercise_json);
  out.add_period_s(s.period_s);
  out.add_axes(p.axes);
  out.add_joint_names(p.joint_names);
  out.add_link_names(p.link_names);
  out.add_capsules(p.capsules);
  out.add_bodies(p.bodies);
  out.add_value_names(p.value_names);
  out.add_event_names(p.event_names);
  out.add_fault_names(p.fault_names);
  out.add_parameters(p.parameters);
  out.add_exercises(p.exercises);
  out.add_hands(p.hands);
  out.add_levels(static_cast<std::uint16_t>(s.levels));
  out.add_level(static_cast<std::uint16_t>(s.level));
  out.add_recording(p.recording);
  if (!p.panel.IsNull()) out.add_panel(p.panel);
  out.add_profiles(p.profiles);
  out.add_profile(p.profile);
  out.add_links(p.links);
  if (!p.budget.IsNull()) out.add_budget(p.budget);
  finish(b, out.Finish(), kSchemaVersion);
  return {b.GetBufferPointer(), b.GetBufferPointer() + b.GetSize()};
}

}  // namespace wholehand::wire
