#include "loop/safety/body_energy.hpp"

#include "loop/model/scene_model.hpp"

#include <algorithm>
#include <cmath>

namespace wholehand {
namespace {

bool isZero(const Vec3& v) noexcept {
  return v.x == 0.0 && v.y == 0.0 && v.z == 0.0;
}

}  // namespace

BodyEnergy::BodyEnergy(const SceneModel& scene, double period_s)
    : gravity_m_s2_(scene.gravity_m_s2), period_s_(period_s) {
  const std::size_t count = std::min<std::size_t>(scene.bodies.size(), kMaxBodies);
  bodies_.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    const SceneBody& body = scene.bodies[i];
    if (body.fixed) continue;
    bodies_[i].mass_kg = body.mass_kg;
    bodies_[i].inertia_kg_m2 = body.inertia_kg_m2;
    free_.push_back(static_cast<int>(i));
    const std::optional<SceneJoint>& joint = body.joint;
    if (!joint || (joint->spring_stiffness == 0.0 && joint->latch_energy_j == 0.0)) continue;
    bodies_[i].store = static_cast<int>(stores_.size());
    stores_.push_back({*joint, body.pose, body.com_m, 0.0, storedEnergy(*joint, 0.0)});
  }
}

void BodyEnergy::Store::put(const Pose& pose) noexcept {
  q = positionOn(joint, start, pose);
  stored_j = storedEnergy(joint, q);
}

void BodyEnergy::Store::follow(const Pose& pose) noexcept {
  q = positionOn(joint, start, pose, q);
  stored_j = storedEnergy(joint, q);
}

Pose BodyEnergy::Store::poseAt(const Vec3& position_m, const QuatXyzw& turned) const noexcept {
  const Eigen::Matrix3d rotation = turned.eigen().toRotationMatrix();
  return {rotation, position_m.eigen() - rotation * com_m};
}

double BodyEnergy::kinetic(const Body& body, const BodyState& state) noexcept {
  double twice_j = body.mass_kg * state.velocity_m_s.eigen().squaredNorm();
  if (!isZero(state.angular_velocity_rad_s)) {
    const Eigen::Vector3d spin =
        state.orientation_xyzw.eigen().conjugate() * state.angular_velocity_rad_s.eigen();
    twice_j += spin.dot(body.inertia_kg_m2 * spin);
  }
  return 0.5 * twice_j;
}

// Work of the hand on the moving bodies of the scene and of a game. Call while the bodies still
// have the velocities of the last step.
double BodyEnergy::workOfHand(const TickRecord& observed, const Contact* contacts,
                              int contact_count) noexcept {
  double work_j = 0.0;
  for (int i = 0; i < contact_count; ++i) {
    const Contact& contact = contacts[i];
    if (contact.body < 0 || contact.body >= observed.body_count) continue;
    const BodyState& now = observed.bodies[contact.body];
    Eigen::Vector3d velocity = now.velocity_m_s.eigen(), spin = now.angular_velocity_rad_s.eigen();
    const auto body = static_cast<std::size_t>(contact.body);
    const bool of_scene = body < bodies_.size();
    if (of_scene && bodies_[body].mass_kg == 0.0) {
      energy_.received_j += period_s_ * contact.force_n.eigen().dot(velocity);
      continue;
    }
    if (of_scene) {
      velocity = 0.5 * (velocity + bodies_[body].velocity_m_s.eigen());
      spin = 0.5 * (spin + bodies_[body].spin_rad_s.eigen());
    }
    const Eigen::Vector3d arm_m = contact.point_m.eigen() - now.position_m.eigen();
    work_j -= period_s_ * (contact.force_n.eigen().dot(velocity + spin.cross(arm_m)) +
                           contact.torque_nm.eigen().dot(spin));
  }
  return work_j;
}

void BodyEnergy::advance(const TickRecord& observed, const Contact* contacts, int contact_count,
                         const PoolEnergy& pool) noexcept {
  energy_ = {pool.held_j, known_ ? pool.received_j + placed_j_ : 0.0};
  double gained_j = known_ ? pool.held_j - pool_held_j_ - pool.received_j -
                                 workOfHand(observed, contacts, contact_count)
                           : 0.0;
  pool_held_j_ = pool.held_j;
  for (const int i : free_) {
    if (i >= observed.body_count) break;
    Body& body = bodies_[static_cast<std::size_t>(i)];
    const BodyState& now = observed.bodies[i];
    // Energy in spring and latch of the joint.
    if (body.store >= 0) {
      Store& store = stores_[static_cast<std::size_t>(body.store)];
      const double before_j = store.stored_j;
      store.follow(store.poseAt(now.position_m, now.orientation_xyzw));
      energy_.held_j += store.stored_j;
      if (known_) gained_j += store.stored_j - before_j;
    }
    if (isZero(now.velocity_m_s) && isZero(now.angular_velocity_rad_s) && body.kinetic_j == 0.0) {
      continue;
    }
    // Kinetic energy and the work of gravity.
    const double kinetic_j = kinetic(body, now);
    energy_.held_j += kinetic_j;
    if (known_) {
      const double work_j = 0.5 * period_s_ * body.mass_kg *
                            gravity_m_s2_.dot(now.velocity_m_s.eigen() + body.velocity_m_s.eigen());
      energy_.received_j += work_j;
      gained_j += kinetic_j - body.kinetic_j - work_j;
    }
    body.velocity_m_s = now.velocity_m_s;
    body.spin_rad_s = now.angular_velocity_rad_s;
    body.kinetic_j = kinetic_j;
  }
  // A moving fixed body may push other bodies: their gain counts as received.
  if (pushes_ && gained_j > 0.0) {
    energy_.received_j += gained_j;
    gained_j = 0.0;
  }
  gained_j_ = gained_j;
  placed_j_ = 0.0;
  pushes_ = false;
  known_ = true;
}

void BodyEnergy::notePlaced(const BodyPlacements& placements, const TickRecord& observed) noexcept {
  for (int i = 0; i < placements.count; ++i) {
    const BodyPlacement& placed = placements.items[i];
    if (placed.body < 0 || placed.body >= static_cast<int>(bodies_.size())) continue;
    Body& body = bodies_[static_cast<std::size_t>(placed.body)];
    const Eigen::Vector3d way_m =
        placed.position_m.eigen() - observed.bodies[placed.body].position_m.eigen();
    if (body.mass_kg == 0.0) {
      pushes_ = pushes_ || !isZero(placed.velocity_m_s) || !way_m.isZero(0.0);
      continue;
    }
    body.velocity_m_s = placed.velocity_m_s;
    body.spin_rad_s = Vec3{};
    const double before_j = body.kinetic_j;
    body.kinetic_j = 0.5 * body.mass_kg * placed.velocity_m_s.eigen().squaredNorm();
    placed_j_ += std::max(0.0, body.kinetic_j - before_j);
    if (body.store < 0) continue;
    Store& store = stores_[static_cast<std::size_t>(body.store)];
    const double stored_j = store.stored_j;
    store.put(store.poseAt(placed.position_m, placed.orientation_xyzw));
    placed_j_ += std::max(0.0, store.stored_j - stored_j);
  }
}

}  // namespace wholehand
