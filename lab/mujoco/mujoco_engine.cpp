#include "lab/mujoco/mujoco_engine.hpp"

#include "lab/mujoco/collisions.hpp"
#include "lab/mujoco/engine_errors.hpp"
#include "lab/mujoco/model_text.hpp"
#include "loop/physics/free_rotation.hpp"
#include "loop/physics/hand_overlaps.hpp"
#include "loop/physics/physics_world.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <utility>

namespace wholehand::mujoco {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;
using Vector3dMap = Eigen::Map<Vector3d>;
using ConstVector3dMap = Eigen::Map<const Vector3d>;

// Maximum number of bodies. MuJoCo sorts two entries of 8 bytes per body in every step, and the C
// library's sort allocates memory from 1024 bytes on.
constexpr int kMostBodies = 63;

int overflows(const mjData& data) {
  return data.warning[mjWARN_CONTACTFULL].number + data.warning[mjWARN_CNSTRFULL].number;
}

using Eigen::Vector3d;

/// Force of a contact on geom 2, in world coordinates.
struct Wrench {
  Vector3d normal, force_n, torque_nm;
};

Wrench wrenchOf(const mjModel& model, const mjData& data, int contact) {
  std::array<mjtNum, 6> local{};
  mj_contactForce(&model, &data, contact, local.data());
  // The columns are the contact's axes.
  const Eigen::Map<const Eigen::Matrix3d> frame(data.contact[contact].frame);
  return {frame.col(0), frame * Vector3d(local[0], local[1], local[2]),
          frame * Vector3d(local[3], local[4], local[5])};
}

bool acts(const mjData& data, int contact) {
  const int row = data.contact[contact].efc_address;
  return row >= 0 && data.efc_force[row] > 0.0;
}

}  // namespace

Expected<std::unique_ptr<MujocoEngine>> MujocoEngine::build(const HandModel& hand,
                                                            const SceneModel& scene,
                                                            const SolverSettings& settings) {
  takeErrors();
  refineCollisions();
  const std::string text = modelText(hand, scene, settings);
  const auto files = std::make_unique<mjVFS>();
  mj_defaultVFS(files.get());
  const char* name = "wholehand.xml";
  mj_makeEmptyFileVFS(files.get(), name, static_cast<int>(text.size()));
  std::memcpy(files->filedata[0], text.data(), text.size());
  std::array<char, 500> error{};
  mjModel* model = mj_loadXML(name, files.get(), error.data(), static_cast<int>(error.size()));
  mj_deleteVFS(files.get());
  mj_freeLastXML();
  if (model == nullptr) {
    return Diagnostic{scene.path,
                      0,
                      "--engine",
                      "mujoco",
                      std::string("does not accept hand or scene: ") + error.data(),
                      "change what it names, or use --engine bullet"};
  }
  if (model->nbody > kMostBodies) {
    const std::string all = std::to_string(model->nbody - 1);
    mj_deleteModel(model);
    return Diagnostic{scene.path,
                      0,
                      "bodies",
                      all,
                      "links of the hand and bodies are more than the engine mujoco sorts without "
                      "asking for memory in a tick",
                      "at most " + std::to_string(kMostBodies - 1) +
                          " together: remove bodies, or use --engine bullet"};
  }
  std::unique_ptr<MujocoEngine> engine(new MujocoEngine(hand, scene, settings, model));
  if (!engine->data_) {
    return Diagnostic{scene.path,
                      0,
                      "--engine",
                      "mujoco",
                      "has no memory for hand and scene",
                      "close other programs, or use --engine bullet"};
  }
  if (Diagnostics refused = engine->map_.refuse(); !refused.empty()) return refused;
  return engine;
}

MujocoEngine::MujocoEngine(const HandModel& hand, const SceneModel& scene,
                           const SolverSettings& settings, mjModel* model)
    : q_s(hand.axis_count),
      qd_s(hand.axis_count),
      model_(model),
      map_(hand, *model),
      constraints_(map_, *model, settings),
      settings_(settings),
      scene_path_(scene.path),
      let_go_(hand.self_contacts.size(), 0),
      still_deep_(hand.self_contacts.size(), 0),
      surface_velocity_(3 * model->nconmax, 0.0) {
  mjData* data = nullptr;
  if (!endsWell([&] { data = mj_makeData(model); }) || data == nullptr) return;
  data_.reset(data);
  // Touches the memory, so that no step causes page faults.
  std::fill_n(data->stack, data->nstack, 0.0);
  listBodies(scene);
  listGeoms(scene);
  pairSelf();
  map_.put(*data_, q_s, qd_s);
}

void MujocoEngine::listBodies(const SceneModel& scene) {
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const SceneBody& body = scene.bodies[i];
    Body& added = bodies_.emplace_back();
    body_names_.push_back(body.name);
    added.id = mj_name2id(model_.get(), mjOBJ_BODY, bodyName(static_cast<int>(i)).c_str());
    added.mocap = model_->body_mocapid[added.id];
    added.mass_kg = body.mass_kg;
    added.damping_per_s = body.linear_damping_per_s;
    if (body.fixed) continue;
    const int joint = model_->body_jntadr[added.id];
    added.position = model_->jnt_qposadr[joint];
    added.dof = model_->jnt_dofadr[joint];
  }
}

void MujocoEngine::listGeoms(const SceneModel& scene) {
  owners_.resize(model_->ngeom);
  for (int c = 0; c < static_cast<int>(map_.hand().capsules.size()); ++c) {
    const int geom = mj_name2id(model_.get(), mjOBJ_GEOM, capsuleName(c).c_str());
    owners_[geom] = {c, -1, scene.hand_friction};
  }
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const int first = model_->body_geomadr[bodies_[i].id];
    for (int k = 0; k < model_->body_geomnum[bodies_[i].id]; ++k) {
      owners_[first + k] = {-1, static_cast<int>(i), scene.bodies[i].friction};
    }
  }
}

void MujocoEngine::pairSelf() {
  const HandModel& hand = map_.hand();
  const std::size_t count = hand.capsules.size();
  self_pair_.assign(count * count, -1);
  for (std::size_t i = 0; i < hand.self_contacts.size(); ++i) {
    const std::size_t a = hand.self_contacts[i].capsule_a, b = hand.self_contacts[i].capsule_b;
    self_pair_[a * count + b] = self_pair_[b * count + a] = static_cast<int>(i);
  }
}

Diagnostics MujocoEngine::placeHand(const AxisPosition& position) {
  q_s = position;
  qd_s = AxisVelocity(map_.hand().axis_count);
  map_.put(*data_, q_s, qd_s);
  std::fill_n(data_->qacc_warmstart, model_->nv, 0.0);
  std::fill(let_go_.begin(), let_go_.end(), 0);
  overflows_ = 0;
  HandOverlaps overlaps(bodies_.size());
  const bool found = endsWell([&] {
    mj_kinematics(model_.get(), data_.get());
    mj_comPos(model_.get(), data_.get());
    mj_collision(model_.get(), data_.get());
  });
  data_->nefc = 0;
  if (!found) {
    return {{scene_path_, 0, "--engine", "mujoco", "cannot place the hand", "use --engine bullet"}};
  }
  const std::size_t count = map_.hand().capsules.size();
  for (int i = 0; i < data_->ncon; ++i) {
    const mjContact& contact = data_->contact[i];
    const Owner &a = owner(contact.geom1), &b = owner(contact.geom2);
    if (a.capsule >= 0 && b.capsule >= 0) {
      const int pair = self_pair_[a.capsule * count + b.capsule];
      if (contact.dist < 0.0) let_go_[pair] = 1;
    } else if (a.capsule >= 0 || b.capsule >= 0) {
      overlaps.add(std::max(a.body, b.body), std::max(a.capsule, b.capsule), -contact.dist);
    }
  }
  data_->ncon = 0;  // no step has found contacts yet
  return overlaps.refuse(map_.hand(), scene_path_, body_names_);
}

void MujocoEngine::place(const BodyPlacement& placement) noexcept {
  if (placement.body < 0 || placement.body >= bodyCount() || !isPose(placement)) return;
  Body& body = bodies_[placement.body];
  const Eigen::Quaterniond turned = placement.orientation_xyzw.eigen().normalized();
  double* position =
      body.mocap >= 0 ? data_->mocap_pos + 3 * body.mocap : data_->qpos + body.position;
  double* orientation = body.mocap >= 0 ? data_->mocap_quat + 4 * body.mocap : position + 3;
  Vector3dMap{position} = placement.position_m.eigen();
  orientation[0] = turned.w();
  Vector3dMap{orientation + 1} = turned.vec();
  if (body.mocap >= 0) {
    body.velocity_m_s = placement.velocity_m_s.eigen();
  } else {
    Vector3dMap{data_->qvel + body.dof} = placement.velocity_m_s.eigen();
    std::fill_n(data_->qvel + body.dof + 3, 3, 0.0);
  }
}

BodyState MujocoEngine::body(int index) const noexcept {
  const Body& body = bodies_[index];
  const bool fixed = body.mocap >= 0;
  const double* position = fixed ? data_->mocap_pos + 3 * body.mocap : data_->qpos + body.position;
  const double* q = fixed ? data_->mocap_quat + 4 * body.mocap : position + 3;
  BodyState state;
  state.position_m = Vec3::from(ConstVector3dMap(position));
  state.orientation_xyzw = {q[1], q[2], q[3], q[0]};
  if (fixed) {
    state.velocity_m_s = Vec3::from(body.velocity_m_s);
    return state;
  }
  // MuJoCo's angular velocity is in body axes.
  const Eigen::Quaterniond turned(q[0], q[1], q[2], q[3]);
  state.velocity_m_s = Vec3::from(ConstVector3dMap(data_->qvel + body.dof));
  state.angular_velocity_rad_s =
      Vec3::from(turned.normalized() * Vector3d(ConstVector3dMap(data_->qvel + body.dof + 3)));
  return state;
}

/// Applies the force that removes the damped share of the velocity in this step. MuJoCo has no
/// damping by a share per second.
void MujocoEngine::dampBodies(double period_s) noexcept {
  for (const Body& body : bodies_) {
    if (body.dof < 0 || body.damping_per_s == 0.0) continue;
    const double lost = 1.0 - std::pow(1.0 - body.damping_per_s, period_s);
    for (int k = body.dof; k < body.dof + 3; ++k) {
      data_->qfrc_applied[k] = -body.mass_kg * lost / period_s * data_->qvel[k];
    }
  }
}

/// Sets the friction and surface velocity of a contact, and excludes hand pairs that overlapped at
/// placement.
void MujocoEngine::checkContact(int index) noexcept {
  mjContact& contact = data_->contact[index];
  const Owner &a = owner(contact.geom1), &b = owner(contact.geom2);
  contact.friction[0] = contact.friction[1] = std::sqrt(a.friction * b.friction);
  contact.friction[2] = settings_.spinning_friction_m;
  if (contact.friction[0] == 0.0) contact.dim = 1;
  Vector3d speed = Vector3d::Zero();
  if (b.body >= 0) speed += bodies_[b.body].velocity_m_s;
  if (a.body >= 0) speed -= bodies_[a.body].velocity_m_s;
  Vector3dMap{&surface_velocity_[3 * index]} = speed;
  if (a.capsule < 0 || b.capsule < 0) return;
  const std::size_t count = map_.hand().capsules.size();
  const int pair = self_pair_[a.capsule * count + b.capsule];
  if (let_go_[pair] == 0) return;
  contact.exclude = 1;
  if (contact.dist < 0.0) still_deep_[pair] = 1;
}

void MujocoEngine::findContacts() noexcept {
  const int before = overflows(*data_);
  mj_kinematics(model_.get(), data_.get());
  mj_comPos(model_.get(), data_.get());
  mj_collision(model_.get(), data_.get());
  std::fill(still_deep_.begin(), still_deep_.end(), 0);
  for (int i = 0; i < data_->ncon; ++i) checkContact(i);
  let_go_ = still_deep_;
  mj_crb(model_.get(), data_.get());
  mj_factorM(model_.get(), data_.get());
  mj_makeConstraint(model_.get(), data_.get());
  overflows_ = overflows(*data_) - before;
}

bool MujocoEngine::step(const HandDrive& drive, double period_s) noexcept {
  bool advanced = false;
  const bool ended = endsWell([&] {
    map_.drive(*model_, *data_, drive);
    dampBodies(period_s);
    advanced = advance(period_s);
  });
  for (Body& body : bodies_) {
    if (body.mocap >= 0) body.velocity_m_s.setZero();
  }
  return ended && advanced;
}

/// Runs the parts of mj_step() and projects the constraints onto the hand's synergy in between.
bool MujocoEngine::advance(double period_s) noexcept {
  model_->opt.timestep = period_s;
  findContacts();
  if (!constraints_.project(*model_, *data_)) return false;
  mj_fwdVelocity(model_.get(), data_.get());
  kickByGravityOnly();
  constraints_.aim(*data_, surface_velocity_.data(), period_s);
  mj_fwdActuation(model_.get(), data_.get());
  mj_fwdAcceleration(model_.get(), data_.get());
  mj_fwdConstraint(model_.get(), data_.get());
  return integrate(period_s);
}

// First part of the step of a free body: forces change its velocity at its old pose; moveFreely()
// then moves it without forces. The gyroscopic term of MuJoCo's own step is left out, because its
// explicit integration adds energy.
void MujocoEngine::kickByGravityOnly() noexcept {
  for (Body& body : bodies_) {
    if (body.dof < 0) continue;
    const double* q = data_->qpos + body.position;
    body.before_m = ConstVector3dMap(q);
    body.turned = Quaterniond(q[3], q[4], q[5], q[6]).normalized();
    const Vector3d weight_n = model_->body_mass[body.id] * ConstVector3dMap(model_->opt.gravity);
    const ConstVector3dMap com_m(model_->body_ipos + 3 * body.id);
    Vector3dMap{data_->qfrc_bias + body.dof} = -weight_n;
    Vector3dMap{data_->qfrc_bias + body.dof + 3} = -com_m.cross(body.turned.conjugate() * weight_n);
  }
}

// Replaces the motion that mj_Euler() computed from the new velocity.
void MujocoEngine::moveFreely(const Body& body, double period_s) noexcept {
  Vector3dMap velocity(data_->qvel + body.dof), spin(data_->qvel + body.dof + 3);
  const Vector3d com_m = ConstVector3dMap(model_->body_ipos + 3 * body.id);
  const double* principal = model_->body_iquat + 4 * body.id;
  const Quaterniond to_axes(principal[0], principal[1], principal[2], principal[3]);
  const Vector3d world_spin = body.turned * Vector3d(spin);
  const Vector3d arm_m = body.turned * com_m;
  const Vector3d com_velocity = velocity + world_spin.cross(arm_m);
  const FreeRotation moved =
      turnFree({body.turned * to_axes, world_spin},
               ConstVector3dMap(model_->body_inertia + 3 * body.id), period_s);
  const Quaterniond turned = (moved.axes * to_axes.conjugate()).normalized();
  const Vector3d arm_after_m = turned * com_m;
  double* q = data_->qpos + body.position;
  Vector3dMap{q} = body.before_m + arm_m + period_s * com_velocity - arm_after_m;
  q[3] = turned.w(), q[4] = turned.x(), q[5] = turned.y(), q[6] = turned.z();
  velocity = com_velocity - moved.spin_rad_s.cross(arm_after_m);
  spin = turned.conjugate() * moved.spin_rad_s;
}

bool MujocoEngine::integrate(double period_s) noexcept {
  // The solver satisfies M q̈ = f approximately; here the motion is computed exactly from the
  // reported forces.
  mj_solveM(model_.get(), data_.get(), data_->qacc, data_->qfrc_constraint, 1);
  for (int i = 0; i < model_->nv; ++i) {
    data_->qacc[i] += data_->qacc_smooth[i];
    if (!std::isfinite(data_->qacc[i])) return false;
  }
  mj_Euler(model_.get(), data_.get());
  for (const Body& body : bodies_) {
    if (body.dof >= 0) moveFreely(body, period_s);
  }
  coupling_error_rad = map_.take(*data_, q_s, qd_s);
  map_.put(*data_, q_s, qd_s);
  return true;
}

// The functions below convert the solver's results to the form of the record.

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
