#include "experiments/grasp_script.hpp"

#include "loop/core/geometry.hpp"
#include "loop/dynamics/articulated_body.hpp"
#include "loop/dynamics/synergy.hpp"

#include <fmt/format.h>

namespace wholehand {
namespace {

constexpr double kApproach_m = 0.08;  // approach distance along the palm's normal
constexpr double kPedestal_m = 0.02;  // half of the pedestal's height
// Edge length of the pedestal's top. On a wider top the little finger would touch it during a
// pinch.
constexpr double kPedestalWidth_m = 0.02;
constexpr double kApproachCircumduction_rad = 0.09;

struct ShapeText {
  std::string keys;
  double half_height_m = 0.0;  // half of its height in its orientation in the world
};

std::string ball(double radius_m) {
  return fmt::format("shape = \"sphere\"\nradius_m = {}\n", radius_m);
}

std::string upright(const char* shape, double radius_m, double height_m) {
  return fmt::format("shape = \"{}\"\nradius_m = {}\nheight_m = {}\n", shape, radius_m, height_m);
}

// Keys of a shape. Cylinder and disk stand upright: with the hand in handshake orientation their
// axis lies along the palm's radial direction, which is the world's z.
ShapeText shapeText(const std::string& shape, double size) {
  if (shape == "cube") {
    return {fmt::format("shape = \"box\"\nsize_m = [{0}, {0}, {0}]\n", 0.05 * size), 0.025 * size};
  }
  if (shape == "sphere") return {ball(0.03 * size), 0.03 * size};
  if (shape == "cylinder") return {upright("cylinder", 0.025 * size, 0.12 * size), 0.06 * size};
  return {upright("disk", 0.04 * size, 0.02 * size), 0.01 * size};
}

std::string vectorText(const Eigen::Vector3d& v) {
  return fmt::format("[{:.17g}, {:.17g}, {:.17g}]", v.x(), v.y(), v.z());
}

Eigen::Matrix3d palmRotation(const Models& models) {
  ArticulatedBody body(models.hand);
  JointPosition theta;
  Synergy(models.hand).expand(AxisPosition(models.hand.axis_count), theta);
  body.updateKinematics(theta);
  return body.linkPose(models.hand.palm_link).rotation;
}

Eigen::Matrix3d turnOf(const GraspTrial& trial) {
  const Eigen::Vector3d& rpy = trial.turn_rpy_rad;
  return rotationFromRpy(rpy.x(), rpy.y(), rpy.z());
}

/// Position of the hand's base when the hand closes: low and forward, so that the lift fits the
/// workspace.
Eigen::Vector3d graspBase(const GraspTrial& trial) {
  return turnOf(trial) * Eigen::Vector3d(0.0, kApproach_m / 2.0, -kLift_m / 2.0);
}

/// Start of the approach relative to graspBase(), along the palm's normal.
Eigen::Vector3d graspApproach(const Models& models) {
  return kApproach_m * (palmRotation(models) * Eigen::Vector3d::UnitZ());
}

}  // namespace

Intention graspIntention(const GraspTrial& trial, const Models& models) {
  namespace at = grasp_times;
  const DeviceModel& device = models.device;
  const Eigen::Vector3d base = graspBase(trial);
  const auto pose = [&](const Eigen::Vector3d& p, double fingers, double circumduction,
                        double thumb) {
    AxisPosition q(device.axisCount());
    const auto set = [&](const char* axis, double value) {
      if (const int a = device.axisIndex(axis); a >= 0) q[a] = value;
    };
    set("x", p.x());
    set("y", p.y());
    set("z", p.z());
    set("finger_flexion", fingers);
    set("thumb_circumduction", circumduction);
    set("thumb_flexion", thumb);
    return q;
  };
  const double open = trial.fingers_open_rad;
  const double closed = trial.fingers_closed_rad;
  const double opposed = trial.circumduction_rad;
  const Eigen::Vector3d lifted = base + kLift_m * turnOf(trial).col(2);
  return Intention::throughWaypoints(
      {{0.0, pose(base + graspApproach(models), open, kApproachCircumduction_rad, 0.0)},
       {at::kApproached, pose(base, open, kApproachCircumduction_rad, 0.0)},
       {at::kOpposed, pose(base, open, opposed, 0.0)},
       {at::kClosed, pose(base, closed, opposed, trial.thumb_closed_rad)},
       {at::kLiftBegins, pose(base, closed, opposed, trial.thumb_closed_rad)},
       {at::kLifted, pose(lifted, closed, opposed, trial.thumb_closed_rad)}});
}

std::string graspScene(const GraspTrial& trial, const Models& models) {
  const Eigen::Vector3d center = graspBase(trial) + palmRotation(models) * trial.center_m;
  const Eigen::Vector3d up = turnOf(trial).col(2);
  const Eigen::Vector3d gravity = (trial.gravity ? -9.81 : 0.0) * up;
  const ShapeText shape = shapeText(trial.shape, trial.size);
  const std::string turn = "orientation_rpy_rad = " + vectorText(trial.turn_rpy_rad);
  std::string text = fmt::format(
      "# Written by `wholehand experiment grasping`: {}.\n"
      "kind = \"scene\"\nversion = 1\nname = \"{}\"\n"
      "gravity_m_s2 = {}\nhand_friction = {}\n\n"
      "[[bodies]]\nname = \"{}\"\n{}mass_kg = 0.1\nposition_m = {}\n{}\n"
      "friction = {}\nlinear_damping_per_s = {}\ncolor = \"#3B6FD1\"\n",
      trial.name(), trial.name(), vectorText(gravity), trial.friction, trial.shape, shape.keys,
      vectorText(center), turn, trial.friction, trial.gravity ? "0.0" : "0.7");
  if (trial.gravity) {
    text += fmt::format(
        "\n[[bodies]]\nname = \"pedestal\"\nshape = \"box\"\nsize_m = [{0}, {0}, {1}]\nfixed = "
        "true\nposition_m = {2}\n{3}\nfriction = 0.8\ncolor = \"#765443\"\n",
        kPedestalWidth_m, 2.0 * kPedestal_m,
        vectorText(center - (shape.half_height_m + kPedestal_m) * up), turn);
  }
  return text;
}

}  // namespace wholehand
