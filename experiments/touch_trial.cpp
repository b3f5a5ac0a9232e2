#include "experiments/touch_trial.hpp"

#include "loop/dynamics/articulated_body.hpp"
#include "loop/model/hand_model.hpp"
#include "loop/physics/physics_world.hpp"
#include "rig/engines.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <optional>
#include <utility>

namespace wholehand {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using std::numbers::pi;

constexpr double kPeriod_s = 1e-3;
constexpr double kTip_m = 0.007;  // radius of the ball
constexpr double kTip_kg = 1.0;   // heavy, so that its spring may be stiff
constexpr double kStiffness_per_s2 = 4e3, kDamping_per_s = 120.0;
constexpr double kMostForce_n = 100.0;
constexpr double kLight_n = 0.2;                           // with which the ball keeps touching
constexpr double kGap_m = 1e-3;                            // between ball and surface at the start
constexpr double kHinge_rad_s = 1.0, kSlide_m_s = 0.25;    // rates of the wanted position
constexpr double kWholeTurn_rad = 2.0 * pi, kFar_m = 1.0;  // asked for where a joint has no end
constexpr double kWithin = 0.01;                           // of the range: counts as its end
constexpr int kPatience = 600;                             // ticks without progress
constexpr int kLongest = 60000;                            // ticks of a touch
constexpr int kMostPoints = 12;                            // that are tried
constexpr double kLeastLever = 0.02;                       // of the longest one
constexpr double kMostRubbing =
    -0.3;  // cosine between normal and way beyond which nothing is tried
// Friction between ball and link that is reckoned with: at most this, and this share of what it is.
constexpr double kFriction = 0.6, kSurely = 0.9;

/// A hand of one ball on three slides.
HandModel fingertip() {
  HandModel hand;
  hand.name = "fingertip";
  hand.joint_count = hand.axis_count = 3;
  hand.joint_names = hand.axis_names = {"x", "y", "z"};
  for (int a = 0; a < 3; ++a) {
    HandLink link;
    link.name = hand.axis_names[a];
    link.parent = a - 1;
    link.type = JointType::kPrismatic;
    link.axis = Vector3d::Unit(a);
    link.joint = a;
    link.lower = -1e3, link.upper = 1e3;
    link.mass_kg = a == 2 ? kTip_kg : 0.0;
    link.inertia_kg_m2 = (a == 2 ? 0.4 * kTip_kg * kTip_m * kTip_m : 0.0) * Matrix3d::Identity();
    hand.links.push_back(std::move(link));
  }
  hand.palm_link = 2;
  hand.capsules.push_back(
      {"index_distal", HandPart::kIndex, 2, Vector3d::Zero(), Vector3d::Zero(), kTip_m});
  hand.theta0 = JointPosition(3);
  hand.synergy = JointAxisMatrix::Identity(3, 3);
  hand.reference = hand.axis_lower = hand.axis_upper = AxisPosition(3);
  for (int a = 0; a < 3; ++a) hand.axis_lower[a] = -1e3, hand.axis_upper[a] = 1e3;
  hand.total_mass_kg = kTip_kg;
  return hand;
}

AxisPosition axesOf(const Vector3d& p) {
  AxisPosition q(3);
  for (int a = 0; a < 3; ++a) q[a] = p[a];
  return q;
}

Pose poseOf(const SceneBody& body, const BodyState& state) {
  const Matrix3d turned = state.orientation_xyzw.eigen().normalized().toRotationMatrix();
  return {turned, state.position_m.eigen() - turned * body.com_m};
}

/// Way of a point of a body per unit of its joint's q. @param at body's pose @param p world
Vector3d wayOf(const SceneJoint& joint, const Pose& at, const Vector3d& p) {
  const Vector3d axis = at.rotation * joint.axis;
  return joint.isHinge() ? axis.cross(p - at * joint.point_m).eval() : axis;
}

/// Coulomb coefficient between ball and body.
double frictionWith(const SceneModel& scene, int body) {
  return std::sqrt(scene.hand_friction * scene.bodies[body].friction);
}

/// Adds points of a circle about z, at heights of z, with the normal outward.
void addRing(std::vector<SurfacePoint>& to, double radius_m, double z_m) {
  constexpr int kAround = 16;
  for (int i = 0; i < kAround; ++i) {
    const double angle = 2.0 * pi * i / kAround;
    const Vector3d out(std::cos(angle), std::sin(angle), 0.0);
    to.push_back({radius_m * out + z_m * Vector3d::UnitZ(), out});
  }
}

std::vector<SurfacePoint> roundPoints(const Shape& shape) {
  std::vector<SurfacePoint> points;
  const bool cylinder = shape.isCylinder();
  const double half_m = shape.coreBox().z();
  for (const double z : {-0.8, 0.0, 0.8}) addRing(points, shape.radius_m, z * half_m);
  for (const double side : {-1.0, 1.0}) {
    const Vector3d up = side * Vector3d::UnitZ();
    if (!cylinder) points.push_back({(half_m + shape.radius_m) * up, up});
    for (int i = 0; i < 8; ++i) {
      const Vector3d out(std::cos(pi * i / 4.0), std::sin(pi * i / 4.0), 0.0);
      const Vector3d slant = (out + up).normalized();
      if (cylinder) {
        points.push_back({half_m * up + 0.8 * shape.radius_m * out, up});
      } else {
        points.push_back({half_m * up + shape.radius_m * slant, slant});
      }
    }
    if (cylinder) points.push_back({half_m * up, up});
  }
  return points;
}

std::vector<SurfacePoint> boxPoints(const Vector3d& half_m) {
  std::vector<SurfacePoint> points;
  for (int a = 0; a < 3; ++a) {
    for (const double side : {-1.0, 1.0}) {
      for (int i = 0; i < 9; ++i) {
        const int row = i / 3, column = i % 3;
        Vector3d p;
        p[a] = side * half_m[a];
        p[(a + 1) % 3] = 0.9 * (column - 1) * half_m[(a + 1) % 3];
        p[(a + 2) % 3] = 0.9 * (row - 1) * half_m[(a + 2) % 3];
        points.push_back({p, side * Vector3d::Unit(a)});
      }
    }
  }
  return points;
}

std::vector<SurfacePoint> meshPoints(const Shape& shape) {
  std::vector<SurfacePoint> points;
  for (const Eigen::Vector3i& t : shape.triangles) {
    const Vector3d &a = shape.points_m[t[0]], &b = shape.points_m[t[1]], &c = shape.points_m[t[2]];
    const Vector3d normal = (b - a).cross(c - a);
    if (!(normal.norm() > 1e-12)) continue;
    const Vector3d middle = (a + b + c) / 3.0, out = normal.normalized();
    points.push_back({middle, out});
    for (const Vector3d* corner : {&a, &b, &c})
      points.push_back({0.2 * middle + 0.8 * *corner, out});
  }
  return points;
}

/// A point at which a joint's link, or one that it carries, is touched.
struct Place {
  int body = -1;
  Vector3d at_m, normal;  ///< in the frame of that body
  double score = 0.0;
};

/// The bodies that a joint moves as one while the joints that they hang on are held: the body
/// itself and those that it carries.
std::vector<int> carriedBy(const SceneModel& scene, int joint) {
  std::vector<int> found = {joint};
  for (std::size_t k = 0; k < found.size(); ++k) {
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
      const auto& other = scene.bodies[i].joint;
      if (other && other->parent == found[k]) found.push_back(static_cast<int>(i));
    }
  }
  return found;
}

/// The largest effort on a joint that a force of kMostForce_n has within the cone of friction at
/// any point of what the joint carries [N·m or N].
double mostEffort(const SceneModel& scene, int joint) {
  const SceneBody& moved = scene.bodies[joint];
  double most = 0.0;
  for (const int i : carriedBy(scene, joint)) {
    const SceneBody& body = scene.bodies[i];
    const double friction = frictionWith(scene, i);
    for (const Shape& shape : body.shapes) {
      for (const SurfacePoint& s : surfacePoints(shape)) {
        const Vector3d way = wayOf(*moved.joint, moved.pose, body.pose * s.at_m);
        const double against = std::abs((body.pose.rotation * s.normal).dot(way));
        const double across = std::sqrt(std::max(0.0, way.squaredNorm() - against * against));
        // The force along the way, if the cone contains it, else at the cone's edge.
        const bool along = across <= friction * against;
        const double at_edge = (against + friction * across) / std::hypot(1.0, friction);
        most = std::max(most, kMostForce_n * (along ? way.norm() : at_edge));
      }
    }
  }
  return most;
}

/// True when a ball of the finger's size would overlap a body there.
bool isOccupied(const SceneModel& scene, const Vector3d& center_m) {
  constexpr double kFree_m = kTip_m + 1e-4;
  for (const SceneBody& body : scene.bodies) {
    const Vector3d in_body = body.pose.inverse() * center_m;
    for (const Shape& shape : body.shapes) {
      if (signedDistance(shape, in_body) < kFree_m) return true;
    }
  }
  return false;
}

/// Places whose touch moves a joint one way, the best first and apart from each other.
std::vector<Place> placesFor(const SceneModel& scene, int joint, double sign) {
  const SceneBody& moved = scene.bodies[joint];
  std::vector<Place> all;
  double longest = 0.0;
  for (const int i : carriedBy(scene, joint)) {
    const SceneBody& body = scene.bodies[i];
    for (const Shape& shape : body.shapes) {
      for (const SurfacePoint& s : surfacePoints(shape)) {
        const Vector3d way =
            sign * wayOf(*moved.joint, moved.pose, body.pose * (s.at_m + kTip_m * s.normal));
        const double lever = way.norm();
        if (!(lever > 1e-9)) continue;
        longest = std::max(longest, lever);
        const double against = -(body.pose.rotation * s.normal).dot(way) / lever;
        if (against < kMostRubbing) continue;
        all.push_back({i, s.at_m, s.normal, (against + 0.5) * lever});
      }
    }
  }
  std::stable_sort(all.begin(), all.end(),
                   [](const Place& a, const Place& b) { return a.score > b.score; });
  std::vector<Place> chosen;
  for (const double apart_m : {0.05, 0.01}) {
    for (const Place& place : all) {
      if (static_cast<int>(chosen.size()) == kMostPoints) return chosen;
      if (place.score < kLeastLever * longest) break;
      const bool near = std::any_of(chosen.begin(), chosen.end(), [&](const Place& c) {
        return c.body == place.body && (c.at_m - place.at_m).norm() < apart_m &&
               c.normal.dot(place.normal) > 0.9;
      });
      const Pose& at = scene.bodies[place.body].pose;
      if (!near && !isOccupied(scene, at * (place.at_m + (kTip_m + kGap_m) * place.normal))) {
        chosen.push_back(place);
      }
    }
  }
  return chosen;
}

/// The scene with all joints held but those that this one moves. @param cleared nothing else is in
/// the way
SceneModel heldScene(const SceneModel& scene, int joint, bool cleared) {
  constexpr double kAway_m = 1e3;
  SceneModel held = scene;
  const std::vector<int> carried = carriedBy(scene, joint);
  const auto moves = [&](int i) {
    for (int k = i; k >= 0; k = scene.bodies[k].joint->follows) {
      if (k == joint) return true;
    }
    return false;
  };
  for (std::size_t i = 0; i < held.bodies.size(); ++i) {
    SceneBody& body = held.bodies[i];
    const int index = static_cast<int>(i);
    if (body.joint && !moves(index)) body.joint->least = body.joint->most = 0.0;
    const bool touched = std::find(carried.begin(), carried.end(), index) != carried.end();
    if (!cleared || touched) continue;
    if (body.joint) {
      body.shapes.clear();
    } else {
      body.pose.translation_m.x() += kAway_m;
      body.fixed = true;
    }
  }
  return held;
}

struct Touch {
  double reached = 0.0, force_n = 0.0;
  bool placed = false;
  int met = -1;  ///< a body other than the moved ones that the ball pressed last
};

/// One touch at one place, one way.
class Finger {
 public:
  Finger(const SceneModel& scene, const HandModel& hand, PhysicsWorld& world, int joint,
         const Place& place, double sign, double wanted)
      : scene_(scene),
        world_(world),
        hand_(hand),
        joint_(joint),
        place_(place),
        sign_(sign),
        wanted_(wanted),
        friction_(std::min(kFriction, kSurely * frictionWith(scene, place.body))),
        carried_(carriedBy(scene, joint)) {
    const std::vector<int> recorded = scene.recordedJoints();
    row_ = static_cast<int>(std::find(recorded.begin(), recorded.end(), joint) - recorded.begin());
  }

  Touch run() {
    const SceneBody& link = scene_.bodies[place_.body];
    const Vector3d out = link.pose.rotation * place_.normal;
    const Vector3d start = link.pose * place_.at_m + (kTip_m + kGap_m) * out;
    if (!world_.placeHand(axesOf(start))) return touch_;
    touch_.placed = true;
    const bool hinge = scene_.bodies[joint_].joint->isHinge();
    const double rate = hinge ? kHinge_rad_s : kSlide_m_s;
    const double beyond = std::max(0.1 * wanted_, hinge ? 0.05 : 0.01);
    double target = 0.0, mark = 0.0;
    const double progress = 1e-3 * wanted_;
    for (int idle = 0, tick = 0; idle < kPatience && tick < kLongest; ++idle, ++tick) {
      target = std::min({target + rate * kPeriod_s, touch_.reached + beyond, wanted_ + beyond});
      if (!step(target, beyond) || touch_.reached >= wanted_ * (1.0 - 1e-6)) break;
      // One that its load took away comes back first.
      if (std::abs(q_ - mark) > progress) mark = q_, idle = 0;
    }
    return touch_;
  }

 private:
  /// One tick towards a position of the joint. @param beyond lag at which the force is largest
  bool step(double target, double beyond) {
    if (world_.observe(state_) != Fault::kNone) return false;
    const double q = q_ = sign_ * state_.body_q[row_];
    touch_.reached = std::max(touch_.reached, std::min(q, wanted_));
    const Pose link = poseOf(scene_.bodies[place_.body], state_.bodies[place_.body]);
    const Pose moved = poseOf(scene_.bodies[joint_], state_.bodies[joint_]);
    const Vector3d normal = link.rotation * place_.normal;
    const Vector3d contact = link * place_.at_m + kTip_m * normal;
    const Vector3d way = sign_ * wayOf(*scene_.bodies[joint_].joint, moved, contact);
    const Vector3d along = way.normalized();
    const double push_n = kMostForce_n * std::clamp((target - q) / beyond, 0.0, 1.0);
    // Presses as much as the cone of friction needs.
    const double against = std::clamp(-normal.dot(along), -1.0, 1.0);
    const double across = std::sqrt(1.0 - against * against);
    const double wanted_n = friction_ > 0.0 ? push_n * (across / friction_ - against) : 0.0;
    const double press_n = std::max(kLight_n, wanted_n);
    Vector3d force_n = push_n * along - press_n * normal;
    if (force_n.norm() > kMostForce_n) force_n *= kMostForce_n / force_n.norm();
    drive(contact, way * sign_ * state_.body_qd[row_], force_n);
    if (any(world_.step(drive_, kPeriod_s) & kStoppingFaults)) return false;
    touch_.force_n = std::max(touch_.force_n, force_n.norm());
    lookAtContacts();
    return true;
  }

  void drive(const Vector3d& contact, const Vector3d& velocity, const Vector3d& force_n) {
    (void)body_.update(state_.theta, state_.theta_dot, scene_.gravity_m_s2);
    inverse_ = body_.reducedInertiaInverse();
    AxisEffort effort(3);
    for (int a = 0; a < 3; ++a) {
      effort[a] = kTip_kg * (kStiffness_per_s2 * (contact[a] - state_.q_s[a]) +
                             kDamping_per_s * (velocity[a] - state_.qd_s[a])) +
                  force_n[a];
    }
    drive_.effort = effort;
    body_.distribute(effort, drive_.torque);
    drive_.reduced_inertia_inverse = &inverse_;
  }

  void lookAtContacts() {
    world_.contacts(contacts_);
    touch_.met = -1;
    for (int i = 0; i < contacts_.count; ++i) {
      const Contact& c = contacts_.points[i];
      if (std::find(carried_.begin(), carried_.end(), c.body) != carried_.end()) continue;
      if (c.force_n.eigen().norm() > 1.0) touch_.met = c.body;
    }
  }

  const SceneModel& scene_;
  PhysicsWorld& world_;
  const HandModel& hand_;
  const int joint_;
  const Place place_;
  const double sign_, wanted_, friction_;
  double q_ = 0.0;  ///< the joint's position, counted along the touch
  const std::vector<int> carried_;
  int row_ = 0;
  ArticulatedBody body_{hand_};
  AxisMatrix inverse_;
  HandDrive drive_;
  PhysicsState state_;
  ContactList contacts_;
  Touch touch_;
};

/// Touches a joint one way at one place after the other, until it moves as far as it should.
Expected<Touch> touchOneWay(const SceneModel& scene, const HandModel& hand,
                            const std::string& engine, int joint, double sign, double wanted) {
  Touch best;
  for (const Place& place : placesFor(scene, joint, sign)) {
    auto world = buildWorld(engine, hand, scene);
    if (!world) return world.errors();
    const Touch touch = Finger(scene, hand, **world, joint, place, sign, wanted).run();
    if (!best.placed || touch.reached > best.reached) best = touch;
    if (best.reached >= wanted * (1.0 - kWithin)) break;
  }
  return best;
}

}  // namespace

bool TouchedJoint::moves() const {
  return reached_most >= most * (1.0 - kWithin) && reached_least <= least * (1.0 - kWithin);
}

bool TouchedJoint::cannotMove() const {
  constexpr double kNone = 1e-6;  // of rounding
  return !follows && most_effort <= std::max(dry_friction, kNone);
}

std::vector<SurfacePoint> surfacePoints(const Shape& shape) {
  std::vector<SurfacePoint> points = shape.isMesh()         ? meshPoints(shape)
                                     : shape.isPolyhedron() ? boxPoints(shape.half_extents_m)
                                                            : roundPoints(shape);
  for (SurfacePoint& p : points) {
    p.at_m = shape.in_body * p.at_m;
    p.normal = shape.in_body.rotation * p.normal;
  }
  return points;
}

namespace {

/// Touches a joint one way, with as little help as it needs.
Expected<Done> touchWay(const SceneModel& scene, const HandModel& hand, const std::string& engine,
                        int joint, double sign, TouchedJoint& out) {
  const double wanted = sign > 0.0 ? out.most : -out.least;
  if (!(wanted > 0.0)) return Done{};
  double reached = 0.0;
  for (const TouchHelp help : {TouchHelp::kNone, TouchHelp::kHeld, TouchHelp::kCleared}) {
    const bool held = help != TouchHelp::kNone;
    const auto touch =
        touchOneWay(held ? heldScene(scene, joint, help == TouchHelp::kCleared) : scene, hand,
                    engine, joint, sign, wanted);
    if (!touch) return touch.errors();
    out.force_n = std::max(out.force_n, touch->force_n);
    // Less than a hundredth more is no reason to name a help.
    if (touch->reached > reached + kWithin * wanted) {
      reached = touch->reached;
      out.help = std::max(out.help, help);
    }
    if (reached >= wanted * (1.0 - kWithin)) break;
    if (touch->met >= 0) out.in_the_way = scene.bodies[touch->met].name;
  }
  (sign > 0.0 ? out.reached_most : out.reached_least) = sign * reached;
  return Done{};
}

TouchedJoint asked(const SceneModel& scene, int body) {
  TouchedJoint out;
  out.body = scene.bodies[body].name;
  const SceneJoint& joint = *scene.bodies[body].joint;
  out.most_effort = mostEffort(scene, body);
  out.dry_friction = joint.dry_friction;
  out.hinge = joint.isHinge();
  const double far = out.hinge ? kWholeTurn_rad : kFar_m;
  out.no_least = !(joint.least >= -far), out.no_most = !(joint.most <= far);
  out.least = std::max(joint.least, -far), out.most = std::min(joint.most, far);
  return out;
}

}  // namespace

Expected<std::vector<TouchedJoint>> touchJoints(const SceneModel& scene,
                                                const std::string& engine) {
  const HandModel hand = fingertip();
  std::vector<TouchedJoint> touched;
  std::vector<int> at(scene.bodies.size(), -1);
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    if (!scene.bodies[i].joint) continue;
    TouchedJoint joint = asked(scene, static_cast<int>(i));
    joint.follows = scene.bodies[i].joint->follows >= 0;
    for (const double sign : {1.0, -1.0}) {
      if (joint.follows) break;
      auto done = touchWay(scene, hand, engine, static_cast<int>(i), sign, joint);
      if (!done) return done.errors();
    }
    at[i] = static_cast<int>(touched.size());
    touched.push_back(std::move(joint));
  }
  // A joint that follows is where its leader puts it, exactly.
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    if (at[i] < 0 || !touched[at[i]].follows) continue;
    TouchedJoint& joint = touched[at[i]];
    double ratio = 1.0;
    int leader = static_cast<int>(i);
    for (; scene.bodies[leader].joint->follows >= 0; leader = scene.bodies[leader].joint->follows) {
      ratio *= scene.bodies[leader].joint->ratio;
    }
    const TouchedJoint& lead = touched[at[leader]];
    const auto [low, high] = std::minmax(ratio * lead.reached_least, ratio * lead.reached_most);
    joint.reached_least = low, joint.reached_most = high;
    const auto [least, most] = std::minmax(ratio * lead.least, ratio * lead.most);
    joint.least = least, joint.most = most;
    joint.help = lead.help;
  }
  if (touched.empty()) {
    return fileFault(scene.path, "has no body on a joint", "give a URDF with a joint that moves");
  }
  return touched;
}

}  // namespace wholehand
