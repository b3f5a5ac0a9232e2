// What MuJoCo's solver left, as the record wants it.
#include "physics/mujoco/mujoco_engine.hpp"

#include <algorithm>
#include <array>

namespace wholehand::mujoco {
namespace {

using Eigen::Vector3d;

/// A contact's force on geom 2, in the world.
struct Wrench {
  Vector3d normal, force_n, torque_nm;
};

Wrench wrenchOf(const mjModel& model, const mjData& data, int contact) {
  std::array<mjtNum, 6> local{};
  mj_contactForce(&model, &data, contact, local.data());
  const Eigen::Map<const Eigen::Matrix3d> frame(data.contact[contact].frame);  // columns: its axes
  return {frame.col(0), frame * Vector3d(local[0], local[1], local[2]),
          frame * Vector3d(local[3], local[4], local[5])};
}

bool acts(const mjData& data, int contact) {
  const int row = data.contact[contact].efc_address;
  return row >= 0 && data.efc_force[row] > 0.0;
}

}  // namespace

void MujocoEngine::contacts(ContactList& contacts) const noexcept {
  contacts.count = 0;
  contacts.dropped = overflows_;
  for (int i = 0; i < data_->ncon; ++i) {
    const mjContact& found = data_->contact[i];
    const Owner &a = owner(found.geom1), &b = owner(found.geom2);
    if ((a.capsule < 0) == (b.capsule < 0) || !acts(*data_, i)) continue;
    if (contacts.count == kMaxContacts) {
      ++contacts.dropped;
      continue;
    }
    const Wrench wrench = wrenchOf(*model_, *data_, i);
    const double sign = b.capsule >= 0 ? 1.0 : -1.0;
    const Vector3d normal = sign * wrench.normal;
    const Vector3d middle_m(found.pos[0], found.pos[1], found.pos[2]);
    Contact& out = contacts.points[contacts.count++];
    out = Contact{};
    out.capsule = std::max(a.capsule, b.capsule);
    out.link = map_.hand().capsules[out.capsule].link;
    out.body = std::max(a.body, b.body);
    out.point_m = Vec3::from(middle_m + 0.5 * found.dist * normal);
    out.normal = Vec3::from(normal);
    out.force_n = Vec3::from(sign * wrench.force_n);
    out.torque_nm = Vec3::from(sign * wrench.torque_nm);
    out.distance_m = found.dist;
  }
}

void MujocoEngine::selfForces(SelfForces& forces) const noexcept {
  forces.count = 0;
  const std::size_t count = map_.hand().capsules.size();
  for (int i = 0; i < data_->ncon && forces.count < kMaxSelfForces; ++i) {
    const mjContact& found = data_->contact[i];
    const Owner &a = owner(found.geom1), &b = owner(found.geom2);
    if (a.capsule < 0 || b.capsule < 0 || !acts(*data_, i)) continue;
    const int index = self_pair_[a.capsule * count + b.capsule];
    const SelfPair& pair = map_.hand().self_contacts[index];
    const Wrench wrench = wrenchOf(*model_, *data_, i);
    const double sign = b.capsule == pair.capsule_a ? 1.0 : -1.0;
    SelfForce& out = forces.touches[forces.count++];
    out.capsule_a = pair.capsule_a;
    out.capsule_b = pair.capsule_b;
    out.point_m = Vec3{found.pos[0], found.pos[1], found.pos[2]};
    out.normal = Vec3::from(sign * wrench.normal);
    out.force_n = Vec3::from(sign * wrench.force_n);
    out.distance_m = found.dist;
  }
  forces.joint_ends = constraints_.endEffort(*data_);
}

}  // namespace wholehand::mujoco
