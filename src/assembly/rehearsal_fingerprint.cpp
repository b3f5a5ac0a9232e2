#include "assembly/rehearsal_fingerprint.hpp"

#include <fmt/format.h>

#include <initializer_list>

namespace wholehand {
namespace {

void add(std::string& text, std::initializer_list<double> values) {
  for (const double value : values) text += fmt::format("{:.17g};", value);
}

void add(std::string& text, const Eigen::Ref<const Eigen::MatrixXd>& m) {
  for (Eigen::Index j = 0; j < m.cols(); ++j) {
    for (Eigen::Index i = 0; i < m.rows(); ++i) add(text, {m(i, j)});
  }
}

void add(std::string& text, const Pose& pose) {
  add(text, pose.rotation);
  add(text, pose.translation_m);
}

// Adds device properties that the certificate's fingerprint lacks.
void addDevice(std::string& text, const DeviceModel& device) {
  add(text, {device.mount_roll_rad, device.mount_pitch_rad, device.mount_yaw_rad});
  for (const DeviceAxis& axis : device.axes) {
    text += axis.name + ";";
    add(text, {axis.lower, axis.upper, axis.effort_limit, axis.neutral_effort});
  }
}

void addHand(std::string& text, const HandModel& hand) {
  for (const HandLink& link : hand.links) {
    add(text, link.parent_to_link);
    add(text, link.axis);
    add(text, {static_cast<double>(link.parent), static_cast<double>(link.joint), link.mass_kg});
  }
  for (const Capsule& capsule : hand.capsules) {
    add(text, capsule.a_m);
    add(text, capsule.b_m);
    add(text, {static_cast<double>(capsule.link), capsule.radius_m});
  }
  add(text, hand.synergy);
}

void addShape(std::string& text, const Shape& shape) {
  add(text, {static_cast<double>(shape.type), shape.radius_m, shape.length_m});
  add(text, shape.half_extents_m);
  add(text, shape.in_body);
  for (const Eigen::Vector3d& point : shape.points_m) add(text, point);
}

void addScene(std::string& text, const SceneModel& scene) {
  add(text, scene.gravity_m_s2);
  add(text, {scene.hand_friction});
  for (const SceneBody& body : scene.bodies) {
    add(text, {body.fixed ? 1.0 : 0.0, body.mass_kg, body.friction, body.linear_damping_per_s,
               body.soft_m});
    add(text, body.com_m);
    add(text, body.inertia_kg_m2);
    add(text, body.pose);
    for (const Shape& shape : body.shapes) addShape(text, shape);
    text += "|";
  }
  const GameBudget& game = scene.game;
  if (game.slots == 0) return;
  for (const int count : {game.slots, game.awake, game.shape_sets, game.pieces, game.vertices}) {
    add(text, {static_cast<double>(count)});
  }
  add(text, {game.least_kg, game.most_kg, game.least_m, game.most_m});
}

}  // namespace

std::string rehearsalFingerprint(const Models& models, const RigOptions& options,
                                 const CertificateFingerprint& certified) {
  std::string text = options.engine + ";";
  add(text, {options.period_s});
  for (const FingerprintPart& part : certified.parts) text += part.name + ":" + part.hash + ";";
  addDevice(text, models.device);
  addHand(text, models.hand);
  addScene(text, models.scene);
  return hashOf(text);
}

}  // namespace wholehand
