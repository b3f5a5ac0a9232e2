#pragma once

#include "loop/core/body_order.hpp"
#include "loop/core/tick_record.hpp"
#include "loop/model/scene_model.hpp"
#include "loop/physics/body_joint.hpp"
#include "loop/physics/bullet/box_sweep.hpp"
#include "loop/physics/bullet/bullet_types.hpp"
#include "loop/physics/bullet/shape_sets.hpp"
#include "loop/physics/joint_chain.hpp"

#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <memory>
#include <optional>
#include <vector>

namespace wholehand::bullet {

/// A scene body in Bullet: a rigid body that moves but has no shape, and separate colliders.
/// Bullet's body frame is the principal frame of inertia at the centre of mass.
class BulletBody {
 public:
  /// Creates the body at its initial pose. @param index in the scene @param reach_m margin of the
  /// colliders' boxes
  BulletBody(const SceneBody& body, int index, double reach_m);

  /// Creates an empty slot for a body of a game: it does not move and has no shape.
  /// @param pieces largest number of colliders
  BulletBody(int index, int pieces, double reach_m);

  [[nodiscard]] btRigidBody& rigid() { return *rigid_; }
  /// The joint on which the body moves; null: it is free, or fixed.
  [[nodiscard]] BodyJoint* joint() { return joint_ ? &*joint_ : nullptr; }
  /// Makes the body a link of a tree of joints. @param lead index in the scene of the tree's first
  /// link
  void joinChain(JointChain& chain, int link, int lead);
  /// The tree of joints that moves the body; null: none.
  [[nodiscard]] JointChain* chain() { return chain_; }
  /// Position and rate of its joint. Real-time safe. @pre joint() or chain()
  [[nodiscard]] double jointPosition() const noexcept {
    return joint_ ? joint_->position() : chain_->jointPosition(link_);
  }
  [[nodiscard]] double jointRate() const noexcept {
    return joint_ ? joint_->rate() : chain_->jointRate(link_);
  }
  /// True for a link of a tree other than its first one, which stands for it in the solver.
  [[nodiscard]] bool isLed() const noexcept { return link_ > 0; }
  /// A body that rests and wakes with this one: the first link of its tree, or itself.
  [[nodiscard]] int restsWith() const noexcept { return lead_; }
  /// Sets the velocities of a link from the rates of its tree. Real-time safe.
  void moveWithChain() noexcept;
  /// Places a link where its tree is. Real-time safe.
  void placeOnChain() noexcept;
  /// Sets the velocities of a body on a joint from its q̇. Real-time safe.
  void moveWithJoint() noexcept;
  /// Ends a step of a body on a joint. Real-time safe.
  void finishJoint(double step_s) noexcept;
  /// False for a fixed body, which is only placed.
  [[nodiscard]] bool moves() const { return !rigid_->isStaticObject(); }
  /// Partners with which a collider collides. In a soft body, the digits collide with the core and
  /// everything else with the shape.
  enum class Meets { kAll, kAllButDigits, kDigits };
  struct Collider {
    Meets meets = Meets::kAll;
    Shape form;  ///< in the collider's frame
    ColliderTag tag;
    std::unique_ptr<btCollisionShape> shape;  ///< shape of a scene body's collider
    SlotShape slot_shape;                     ///< shape of a slot's collider
    std::unique_ptr<btCollisionObject> object;
    bool used = true;  ///< false: a slot's collider without a piece; its box is empty
    btTransform in_rigid;
    WorldBox box;
  };
  [[nodiscard]] const std::vector<std::unique_ptr<Collider>>& colliders() const {
    return colliders_;
  }

  /// Sets mass, inertia and friction of a slot's body; with mass 0 it does not move. Real-time
  /// safe.
  void setMass(double mass_kg, const btVector3& moments, double friction,
               const btVector3& gravity) noexcept;
  /// Sets the shapes of a slot: `count` pieces, in the rigid body's frame. With 0 the slot is
  /// empty. Real-time safe.
  void setPieces(const SlotPiece* pieces, int count, const Eigen::Quaterniond& from_body) noexcept;
  /// Places a slot's body at this pose; all its contacts are lost. Real-time safe.
  void putAt(const BodyPose& pose, const Vec3& velocity_m_s) noexcept;

  /// Moves the colliders to the rigid body's pose. Their boxes include the motion in the time
  /// ahead. Real-time safe.
  void placeColliders(double ahead_s) noexcept;
  /// Places the body for an exercise; stops its rotation. A fixed body has the given velocity in
  /// the next step only. An invalid placement is ignored. Returns true when the body was moved
  /// farther than it could slide while keeping its contacts. A link of a tree of joints is not
  /// placed: its place follows from the whole tree. Real-time safe.
  bool place(const BodyPlacement& placement) noexcept;
  /// Call before every step: a fixed body that was not placed since the last step gets zero
  /// velocity. Real-time safe.
  void beginStep() noexcept;
  /// Sets both velocities to zero. Real-time safe.
  void stand() noexcept;
  /// Resets to the initial pose, at rest.
  void putAtStart() noexcept;
  /// State at the centre of mass, with the orientation of the scene's body frame. Real-time safe.
  [[nodiscard]] BodyState state() const noexcept;

 private:
  void put(const btTransform& at, const btVector3& velocity) noexcept;
  void addCollider(const SceneBody& body, const Shape& shape, Meets meets);
  void addEmptyCollider();

  Pose from_body_;     ///< Bullet's frame in the scene's body frame
  btTransform start_;  ///< pose of Bullet's frame
  std::unique_ptr<btCollisionShape> no_shape_;
  std::unique_ptr<btRigidBody> rigid_;
  std::optional<BodyJoint> joint_;
  JointChain* chain_ = nullptr;
  int link_ = -1;  ///< of the tree
  int index_;
  int lead_;  ///< index of the tree's first link, or index_
  double reach_m_;
  bool placed_ = false;
  std::vector<std::unique_ptr<Collider>> colliders_;  ///< addresses must stay: Bullet points to the
                                                      ///< tags
};

}  // namespace wholehand::bullet
