#pragma once

#include "loop/core/expected.hpp"
#include "loop/core/geometry.hpp"
#include "loop/core/real_time.hpp"
#include "loop/model/shape.hpp"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace wholehand {

/// Contacts between bodies are found up to this speed (tests/loop/physics/body_laws_test.cpp).
inline constexpr double kMostBodySpeed_m_s = 15.0;
/// A body may rest on another one that is lighter by up to this factor; it then sinks in by less
/// than 0.1 mm.
inline constexpr double kMostMassRatio = 100.0;

/// A joint of a body to the world. Its coordinate q is 0 in the body's initial pose and counts
/// along or about the axis, right-handed. Units in brackets: of a hinge; of a slide.
struct SceneJoint {
  enum class Type { kHinge, kSlide };
  Type type = Type::kHinge;
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();    ///< unit, body frame
  Eigen::Vector3d point_m = Eigen::Vector3d::Zero();  ///< a point on a hinge's axis, body frame
  /// Ends of the range [rad; m]; least <= 0 <= most.
  double least = -std::numeric_limits<double>::infinity();
  double most = std::numeric_limits<double>::infinity();
  double dry_friction = 0.0;      ///< [N·m; N]
  double viscous_friction = 0.0;  ///< [N·m·s/rad; N·s/m]
  double spring_stiffness = 0.0;  ///< [N·m/rad; N/m]
  double spring_rest = 0.0;       ///< q without spring force [rad; m]
  double latch_energy_j = 0.0;    ///< U₀: energy from the bottom of a detent to the top beside it
  double latch_wave = 0.0;        ///< n: periods of the latch's potential per 2π of q [1/rad; 1/m]
  double latch_at = 0.0;          ///< q at the bottom of a detent [rad; m]
  int parent = -1;                ///< body on another joint that carries this one; -1: the world
  int follows = -1;  ///< body whose joint this one follows: its q is ratio · the other q; -1: none
  double ratio = 1.0;  ///< [this unit / unit of the other]

  [[nodiscard]] bool isHinge() const { return type == Type::kHinge; }
};

/// Pose of a body frame at q, of a body that nothing else carries. @param start pose at q = 0.
/// Real-time safe.
[[nodiscard]] WHOLEHAND_RT Pose poseOn(const SceneJoint& joint, const Pose& start,
                                       double q) noexcept;
/// The q within the joint's range at which the body frame is nearest to a pose; for a hinge without
/// ends, q is in (-π, π]. Real-time safe.
[[nodiscard]] WHOLEHAND_RT double positionOn(const SceneJoint& joint, const Pose& start,
                                             const Pose& pose) noexcept;
/// The same for a body that was at `last` less than half a turn ago: whole turns of a hinge count.
/// Real-time safe.
[[nodiscard]] WHOLEHAND_RT double positionOn(const SceneJoint& joint, const Pose& start,
                                             const Pose& pose, double last) noexcept;

/// Energy that spring and latch of a joint store at q [J]; 0 at the spring's rest and in a detent.
/// Real-time safe.
[[nodiscard]] WHOLEHAND_RT inline double storedEnergy(const SceneJoint& joint, double q) noexcept {
  const double stretch = q - joint.spring_rest;
  return 0.5 * joint.spring_stiffness * stretch * stretch +
         0.5 * joint.latch_energy_j * (1.0 - std::cos(joint.latch_wave * (q - joint.latch_at)));
}

/// A body of the scene.
struct SceneBody {
  std::string name;
  bool fixed = false;
  double mass_kg = 0.0;                                     ///< > 0 unless fixed
  Eigen::Vector3d com_m = Eigen::Vector3d::Zero();          ///< body frame
  Eigen::Matrix3d inertia_kg_m2 = Eigen::Matrix3d::Zero();  ///< about the com, body axes
  Pose pose;  ///< initial pose of the body frame in the world
  /// At least one, except of a link without a collider that moves others.
  std::vector<Shape> shapes;
  double friction = 0.8;              ///< Coulomb coefficient against the hand
  double linear_damping_per_s = 0.0;  ///< fraction of velocity lost per second, 0 .. 1
  /// Depth by which fingers and thumb sink into the side before they reach a rigid core, without
  /// contact force; the palm and other bodies collide with the shape itself. Upright cylinders only
  /// [m].
  double soft_m = 0.0;
  std::string color = "#3B6FD1";  ///< for pictures and pages, #RRGGBB
  /// The joint of a body that moves on one joint to the world. Such a body collides with the hand
  /// and with free bodies only; its range of q ends its motion.
  std::optional<SceneJoint> joint;

  /// Its shape if that is a single cylinder; null otherwise.
  [[nodiscard]] const Shape* cylinder() const {
    return shapes.size() == 1 && shapes[0].isCylinder() ? shapes.data() : nullptr;
  }
  /// True when the two bodies never collide: a body on a joint with another such body or with a
  /// fixed body.
  [[nodiscard]] bool passes(const SceneBody& other) const {
    return (joint && (other.fixed || other.joint)) || (fixed && other.joint);
  }
};

/// Bodies whose joints move each other: a joint on a body that moves on a joint, or one that
/// follows another. Each list ascends; bodies whose joint stands alone are in none.
[[nodiscard]] std::vector<std::vector<int>> jointChains(const std::vector<SceneBody>& bodies);

/// Limits for the bodies that a game may put into the running world (loop/core/body_order.hpp).
struct GameBudget {
  int slots = 0;  ///< largest number of bodies at once, 0 .. kMaxSlots; 0: the scene accepts none
  /// Largest number of moving bodies at once; further ones are not spawned; 1 .. slots.
  int awake = 0;
  int shape_sets = 0;                    ///< 1 .. kMaxShapeSets
  int pieces = 0;                        ///< convex pieces of a body, 1 .. kMaxSlotPieces
  int vertices = 0;                      ///< vertices of a convex mesh, 4 .. kMaxPieceVertices
  double least_kg = 0.0, most_kg = 0.0;  ///< mass of a body
  double least_m = 0.0, most_m = 0.0;    ///< smallest and largest extent of a piece
};

/// A scene: bodies, gravity, and where the hand starts.
struct SceneModel {
  std::string path;
  std::string made_text;  ///< the scene file that was made of `path`, a URDF; empty: a scene file
  std::string name;
  Eigen::Vector3d gravity_m_s2{0.0, 0.0, -9.81};
  /// 0 .. kMaxSceneBodies; in a file, those beyond kMaxBodies are fixed.
  std::vector<SceneBody> bodies;
  double hand_friction = 0.8;       ///< Coulomb coefficient of the hand's capsules
  std::vector<std::string> assets;  ///< paths of the scene's meshes and URDFs
  Diagnostics notices;              ///< information for the user, not faults
  GameBudget game;                  ///< limits for a game; its slots follow `bodies` in the record

  /// Names of the bodies in a record: the scene's bodies, then a game's slots ("slot 0" ..); at
  /// most kMaxBodies.
  [[nodiscard]] std::vector<std::string> recordedBodies() const;
  /// Indices of the recorded bodies on joints, ascending.
  [[nodiscard]] std::vector<int> recordedJoints() const;
  [[nodiscard]] int bodyIndex(const std::string& body_name) const;
};

/// Reflects a scene in the plane y = 0, for a left hand: bodies, shapes, joints and gravity.
void mirror(SceneModel& scene);

/// Core with which fingers and thumb collide: the shape itself; for a cylinder, its radius is
/// reduced by the soft depth.
[[nodiscard]] Shape coreOf(const SceneBody& body, const Shape& shape);

/// Moments of the union of shapes, as a sum. Where shapes overlap, a midpoint sum over a grid
/// takes off what the sum counts more than once (within 1 % of the overlap).
[[nodiscard]] ShapeMoments moments(const std::vector<Shape>& shapes);

/// Mass, centre of mass and inertia of a rigid body, all in one frame.
struct MassProperties {
  double mass_kg = 0.0;
  Eigen::Vector3d com_m = Eigen::Vector3d::Zero();
  Eigen::Matrix3d inertia_kg_m2 = Eigen::Matrix3d::Zero();  ///< about the centre of mass
};

/// Mass properties of the union of shapes with one density and this total mass [kg].
[[nodiscard]] MassProperties uniformDensity(const std::vector<Shape>& shapes, double mass_kg);

/// Mass properties of two rigidly joined bodies (parallel axes); both in the same frame.
[[nodiscard]] MassProperties combined(const MassProperties& a, const MassProperties& b);

/// Transforms mass properties into an outer frame: `inner_in_outer` is the pose of the inner one.
[[nodiscard]] MassProperties moved(const MassProperties& m, const Pose& inner_in_outer);

/// Reason why an inertia about the centre of mass is impossible, or empty. Principal moments must
/// be positive, and none larger than the sum of the other two.
[[nodiscard]] std::string inertiaFault(const Eigen::Matrix3d& inertia_kg_m2);

}  // namespace wholehand
