#pragma once

#include "loop/physics/bullet/bullet_world.hpp"
#include "loop/physics/engine_bench.hpp"
#include "support/seed.hpp"

/// Bodies far from a resting hand, in a scene that is rotated as a whole: no law may depend on the
/// world's axes.
namespace wholehand::test {

/// Uniform on the logarithm.
inline double logUniform(std::mt19937_64& random, double low, double high) {
  return low * std::pow(high / low, uniform(random, 0.0, 1.0));
}

/// A random rotation, uniform over all rotations.
inline Eigen::Matrix3d anyTurn(std::mt19937_64& random) {
  const double u = uniform(random, 0.0, 1.0), v = uniform(random, 0.0, 2.0 * kPi),
               w = uniform(random, 0.0, 2.0 * kPi);
  return Eigen::Quaterniond(std::sqrt(u) * std::cos(w), std::sqrt(1.0 - u) * std::sin(v),
                            std::sqrt(1.0 - u) * std::cos(v), std::sqrt(u) * std::sin(w))
      .toRotationMatrix();
}

inline Shape boxShape(const Eigen::Vector3d& size_m) {
  Shape shape;
  shape.half_extents_m = 0.5 * size_m;
  return shape;
}
inline Shape roundShape(ShapeType type, double radius_m, double length_m) {
  Shape shape;
  shape.type = type;
  shape.radius_m = radius_m;
  shape.length_m = length_m;
  return shape;
}
/// The convex mesh of a box.
inline Shape meshShape(const Eigen::Vector3d& size_m) {
  Shape shape;
  shape.type = ShapeType::kConvexMesh;
  for (int i = 0; i < 8; ++i) {
    const Eigen::Vector3d corner(i & 1 ? 0.5 : -0.5, i & 2 ? 0.5 : -0.5, i & 4 ? 0.5 : -0.5);
    shape.points_m.emplace_back(corner.cwiseProduct(size_m));
  }
  shape.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                     {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return shape;
}

/// A body of uniform density, fixed if it has no mass. @param turn orientation of its axes in the
/// yard's frame
inline SceneBody bodyOf(const Shape& shape, const Eigen::Vector3d& center_m, double mass_kg,
                        double friction,
                        const Eigen::Matrix3d& turn = Eigen::Matrix3d::Identity()) {
  SceneBody body;
  body.name = "body";
  body.fixed = mass_kg == 0.0;
  body.mass_kg = mass_kg;
  body.friction = friction;
  const ShapeMoments about = moments(shape);
  body.inertia_kg_m2 = mass_kg / about.volume_m3 * about.inertia_m5;
  body.pose = {turn, center_m};
  body.shapes.push_back(shape);
  return body;
}

/// A fixed box whose upper face is z = 0.
inline SceneBody ground(double friction, double size_m = 8.0) {
  return bodyOf(boxShape({size_m, size_m, 0.04}), {0.0, 0.0, -0.02}, 0.0, friction);
}

class Yard {
 public:
  /// @param bodies,gravity_m_s2 in the yard's frame @param lets_rest false: the default engine,
  /// whatever the name, computes bodies that stand still, too
  Yard(const std::string& engine, const std::vector<SceneBody>& bodies,
       const Eigen::Vector3d& gravity_m_s2, double rate_hz, const Eigen::Matrix3d& turn,
       bool lets_rest = true)
      : models_(load(shippedFiles("lambda-pride", "empty"))),
        frame_{turn, turn * Eigen::Vector3d(12.0, 0.0, 0.0)},
        period_s_(1.0 / rate_hz) {
    scene_.gravity_m_s2 = turn * gravity_m_s2;
    scene_.bodies = bodies;
    for (SceneBody& body : scene_.bodies) body.pose = frame_ * body.pose;
    if (lets_rest) {
      world_ = orThrow(buildWorld(engine, models_.hand, scene_));
    } else {
      BulletSettings settings;
      settings.lets_rest = false;
      world_ = std::make_unique<BulletWorld>(models_.hand, scene_, settings);
    }
    EXPECT_TRUE(world_->placeHand(models_.hand.reference));
    const PhysicsState state = look(*world_);
    ArticulatedBody body(models_.hand);
    EXPECT_TRUE(body.update(state.theta, state.theta_dot, scene_.gravity_m_s2));
    inverse_ = body.reducedInertiaInverse();
    drive_.effort = AxisEffort(models_.hand.axis_count);
    body.distribute(drive_.effort, drive_.torque);
    drive_.reduced_inertia_inverse = &inverse_;
  }
  Yard(const Yard&) = delete;
  Yard& operator=(const Yard&) = delete;

  /// Gives a body a velocity without rotation at its present pose.
  void throwBody(int body, const Eigen::Vector3d& velocity_m_s) {
    const BodyState now = look(*world_).bodies[body];
    BodyPlacements placements;
    placements.count = 1;
    placements.items[0] = {body, 0, now.position_m, now.orientation_xyzw,
                           Vec3::from(Eigen::Vector3d(frame_.rotation * velocity_m_s))};
    world_->placeBodies(placements);
    looked_ = false;
  }
  /// Position and rate of the i-th body on a joint, as a recording has them.
  [[nodiscard]] std::pair<double, double> joint(int i) {
    const PhysicsState now = look(*world_);
    EXPECT_LT(i, now.body_joint_count);
    return {now.body_q[i], now.body_qd[i]};
  }
  void run(double seconds) {
    for (int k = 0; k < static_cast<int>(std::lround(seconds / period_s_)); ++k) step();
  }
  void step() {
    const Fault fault = world_->step(drive_, period_s_);
    looked_ = false;
    ASSERT_EQ(fault & kStoppingFaults, Fault::kNone);
    unsettled_ += any(fault & Fault::kContactsUnsettled) ? 1 : 0;
  }
  /// Number of steps whose contact forces did not settle.
  [[nodiscard]] int unsettled() const { return unsettled_; }

  /// Position of the centre of mass; the next functions give velocity, angular velocity and axes,
  /// all in the yard's frame.
  [[nodiscard]] Eigen::Vector3d at(int body) const {
    return frame_.rotation.transpose() * (state(body).position_m.eigen() - frame_.translation_m);
  }
  [[nodiscard]] Eigen::Vector3d velocity(int body) const {
    return frame_.rotation.transpose() * state(body).velocity_m_s.eigen();
  }
  [[nodiscard]] Eigen::Vector3d spin(int body) const {
    return frame_.rotation.transpose() * state(body).angular_velocity_rad_s.eigen();
  }
  [[nodiscard]] Eigen::Matrix3d axes(int body) const {
    return frame_.rotation.transpose() *
           state(body).orientation_xyzw.eigen().normalized().toRotationMatrix();
  }
  /// I ω about the centre of mass, in the yard's frame [N·m·s].
  [[nodiscard]] Eigen::Vector3d angularMomentum(int body) const {
    return axes(body) * scene_.bodies[body].inertia_kg_m2 * axes(body).transpose() * spin(body);
  }
  /// Kinetic energy plus potential energy in the scene's gravity [J].
  [[nodiscard]] double energy(int body) const {
    const double m = scene_.bodies[body].mass_kg;
    return 0.5 * m * velocity(body).squaredNorm() + 0.5 * spin(body).dot(angularMomentum(body)) -
           m * scene_.gravity_m_s2.dot(state(body).position_m.eigen());
  }
  /// The state of the world, in its own frame.
  [[nodiscard]] const PhysicsState& seen() const {
    if (!looked_) seen_ = look(*world_);
    looked_ = true;
    return seen_;
  }
  [[nodiscard]] PhysicsWorld& world() {
    looked_ = false;
    return *world_;
  }

 private:
  [[nodiscard]] const BodyState& state(int body) const { return seen().bodies[body]; }

  Models models_;
  Pose frame_;
  double period_s_;
  SceneModel scene_;
  std::unique_ptr<PhysicsWorld> world_;
  AxisMatrix inverse_;
  HandDrive drive_;
  int unsettled_ = 0;
  mutable PhysicsState seen_;    ///< valid if looked_
  mutable bool looked_ = false;  ///< since the last step
};

}  // namespace wholehand::test
