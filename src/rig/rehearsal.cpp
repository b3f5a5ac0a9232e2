#include "rig/rehearsal.hpp"

#include "files/mesh/convex_hull.hpp"
#include "files/mesh/convex_mesh.hpp"
#include "loop/core/compiler.hpp"
#include "loop/core/tick_record.hpp"
#include "loop/device/simulated/simulated_device.hpp"
#include "loop/dynamics/articulated_body.hpp"
#include "loop/dynamics/synergy.hpp"
#include "loop/model/device_model.hpp"
#include "loop/model/game_shapes.hpp"
#include "loop/model/hand_model.hpp"
#include "loop/model/patient_config.hpp"
#include "loop/model/scene_model.hpp"
#include "loop/patient/player.hpp"
#include "loop/patient/reach.hpp"
#include "loop/realtime/thread_setup.hpp"
#include "loop/runtime/session.hpp"

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

namespace wholehand {
namespace {

/// One contact of a rehearsal, from free space to full pressure.
struct RehearsalMove {
  int body = -1;  ///< index into SceneModel::bodies
  std::vector<AxisPosition>
      starts;         ///< candidate start poses; the first one without contact is used
  AxisPosition goal;  ///< arm inside the body, hand closed or straight
};

/// Plans the moves that press a hand against bodies as hard as possible: the palm while all fingers
/// close, and the back of the fingers. Not real-time safe.
class RehearsalPlan {
 public:
  /// @param start initial pose of the session's hand; its base rotations are kept
  RehearsalPlan(const HandModel& hand, const DeviceModel& device, const SceneModel& scene,
                const AxisPosition& start);

  /// Moves that reach the body at its current place; none if it is out of the device's reach.
  /// @param observed the newest record; null: bodies are at their places in the scene
  [[nodiscard]] std::vector<RehearsalMove> movesFor(int index, const TickRecord* observed) const;

 private:
  [[nodiscard]] AxisPosition posture(double closed) const;
  [[nodiscard]] AxisPosition moved(const AxisPosition& q, const Eigen::Vector3d& by_m) const;
  [[nodiscard]] Eigen::Vector3d moveBy(const AxisPosition& q) const;
  [[nodiscard]] RehearsalMove move(int body, const Eigen::Vector3d& target_m,
                                   const Eigen::Vector3d& point_m, const Eigen::Vector3d& push,
                                   double closed) const;

  const DeviceModel& device_;
  const SceneModel& scene_;
  AxisPosition start_;
  // World coordinates with the base translations at 0.
  Eigen::Vector3d palmar_;    ///< outward normal of the palm, unit
  Eigen::Vector3d pocket_m_;  ///< centre of the space in a half-closed hand
  Eigen::Vector3d back_m_;    ///< back of the straight fingers
};

/// A strong, compliant person who replaces the patient and makes the worst contacts.
[[nodiscard]] PatientConfig strongPerson(const DeviceModel& device);

/// Player that performs one move at a time at a share of the device's speed. The hand takes its
/// posture at the start, then the arm presses.
class Rehearser final : public Player {
 public:
  explicit Rehearser(const DeviceModel& device) : device_(device) {}
  /// Sets the move that begins when the device is opened with open(). Not real-time safe.
  void begin(const AxisPosition& from, const AxisPosition& goal);
  void press() noexcept;
  /// Continues from the hand's current pose to another goal.
  void moveTo(const AxisPosition& goal) noexcept;
  [[nodiscard]] bool pressing() const noexcept { return pressing_; }
  [[nodiscard]] bool arrived() const noexcept { return reach_.done(); }

  [[nodiscard]] AxisPosition start() const override { return from_; }
  void reset() override;
  WHOLEHAND_RT void advance(double period_s, AxisPosition& q, AxisVelocity& qd) noexcept override;
  WHOLEHAND_RT void onRecord(const TickRecord&) noexcept override {}

 private:
  void reachFor(const AxisPosition& goal) noexcept;

  const DeviceModel& device_;
  AxisPosition from_, goal_, q_;
  AxisVelocity qd_;
  bool pressing_ = false;
  Reach reach_;
};

constexpr double kSpeedShare = 0.7;  // peak speed, as a share of each axis's speed limit
constexpr double kPush_m = 0.04;     // depth of the goal beyond the first touch
// A body within this distance of the nearest pose counts as reachable.
constexpr double kWithinReach_m = 0.06;
constexpr double kGraspable_m = 0.12;  // wider bodies are pressed at their nearest point
// Start distance of the back of the fingers from the body's middle.
constexpr double kBackAway_m = 0.05;
constexpr std::array kFurther_m{0.0, 0.02, 0.04, 0.06, 0.08};
constexpr std::array kLift_m{0.0, 0.03, 0.06, 0.09};

Eigen::Vector3d middle(const Capsule& capsule, const ArticulatedBody& hand) {
  return hand.linkPose(capsule.link) * (0.5 * (capsule.a_m + capsule.b_m));
}

// Bounding box of a body along its own axes.
Eigen::AlignedBox3d boxOf(const SceneBody& body) {
  Eigen::AlignedBox3d box;
  for (const Shape& shape : body.shapes) box.extend(boxOf(shape));
  return box;
}

// Point of a body to touch: the middle of a graspable dimension, the nearest point otherwise.
Eigen::Vector3d target(const Eigen::AlignedBox3d& box, const Eigen::Vector3d& from_m) {
  Eigen::Vector3d at = box.center();
  for (int i = 0; i < 3; ++i) {
    if (box.sizes()[i] > kGraspable_m) {
      at[i] = std::clamp(from_m[i], box.min()[i] + 0.25 * kGraspable_m,
                         box.max()[i] - 0.25 * kGraspable_m);
    }
  }
  return at;
}

Pose poseNow(const SceneBody& body, int index, const TickRecord* observed) {
  if (observed == nullptr || index >= observed->body_count) return body.pose;
  const BodyState& state = observed->bodies[index];
  Pose pose;
  pose.rotation = state.orientation_xyzw.eigen().toRotationMatrix();
  pose.translation_m = state.position_m.eigen() - pose.rotation * body.com_m;
  return pose;
}

double distance(const SceneBody& body, const Eigen::Vector3d& point_m) {
  double nearest_m = std::numeric_limits<double>::infinity();
  for (const Shape& shape : body.shapes) {
    nearest_m = std::min(nearest_m, signedDistance(shape, point_m));
  }
  return nearest_m;
}

RehearsalPlan::RehearsalPlan(const HandModel& hand, const DeviceModel& device,
                             const SceneModel& scene, const AxisPosition& start)
    : device_(device), scene_(scene), start_(start) {
  ArticulatedBody body(hand);
  const Synergy synergy(hand);
  const auto at = [&](double closed) {
    AxisPosition q = posture(closed);
    q = moved(q, -moveBy(q));
    JointPosition theta;
    synergy.expand(q, theta);
    body.updateKinematics(theta);
  };
  const auto mean_of = [&](auto&& belongs) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    int count = 0;
    for (const Capsule& c : hand.capsules) {
      if (!belongs(c)) continue;
      sum += middle(c, body);
      ++count;
    }
    return Eigen::Vector3d(count > 0 ? Eigen::Vector3d(sum / count) : sum);
  };
  at(0.5);
  // The pocket is the space between palm, fingers and thumb.
  pocket_m_ = (mean_of([](const Capsule& c) { return c.part == HandPart::kPalm; }) +
               mean_of([](const Capsule& c) { return c.part == HandPart::kThumb; }) +
               2.0 * mean_of([](const Capsule& c) {
                 return c.part != HandPart::kPalm && c.part != HandPart::kThumb;
               })) /
              4.0;
  at(0.0);
  palmar_ = -body.linkPose(hand.palm_link).rotation.col(2);
  back_m_ = mean_of(
      [](const Capsule& c) { return c.part != HandPart::kPalm && c.part != HandPart::kThumb; });
}

AxisPosition RehearsalPlan::posture(double closed) const {
  AxisPosition q = start_;
  for (int i = 0; i < q.size(); ++i) {
    const DeviceAxis& axis = device_.axes[i];
    if (axis.group == AxisGroup::kHand) q[i] = axis.lower + closed * (axis.upper - axis.lower);
  }
  return q;
}

Eigen::Vector3d RehearsalPlan::moveBy(const AxisPosition& q) const {
  Eigen::Vector3d at = Eigen::Vector3d::Zero();
  for (int i = 0; i < 3; ++i) {
    const int axis = device_.axisIndex(std::string(1, "xyz"[i]));
    if (axis >= 0) at[i] = q[axis];
  }
  return at;
}

// The pose moved by `by_m`, clamped to the device's range.
AxisPosition RehearsalPlan::moved(const AxisPosition& q, const Eigen::Vector3d& by_m) const {
  AxisPosition out = q;
  for (int i = 0; i < 3; ++i) {
    const int index = device_.axisIndex(std::string(1, "xyz"[i]));
    if (index < 0) continue;
    const DeviceAxis& axis = device_.axes[index];
    out[index] = std::clamp(q[index] + by_m[i], axis.lower, axis.upper);
  }
  return out;
}

RehearsalMove RehearsalPlan::move(int body, const Eigen::Vector3d& target_m,
                                  const Eigen::Vector3d& point_m, const Eigen::Vector3d& push,
                                  double closed) const {
  const AxisPosition open = posture(0.0);
  const Eigen::Vector3d there = target_m - point_m - moveBy(open);
  RehearsalMove move;
  move.body = body;
  for (const double lift_m : kLift_m) {  // reaches bodies on a table from above
    for (const double further_m : kFurther_m) {
      const Eigen::Vector3d by_m = there - further_m * push + lift_m * Eigen::Vector3d::UnitZ();
      move.starts.push_back(moved(open, by_m));
    }
  }
  move.goal = moved(posture(closed), there + kPush_m * push);
  return move;
}

std::vector<RehearsalMove> RehearsalPlan::movesFor(int index, const TickRecord* observed) const {
  const SceneBody& body = scene_.bodies[index];
  const Pose pose = poseNow(body, index, observed);
  const Eigen::AlignedBox3d box = boxOf(body);
  std::vector<RehearsalMove> moves;
  const auto add = [&](const Eigen::Vector3d& point_m, double away_m, const Eigen::Vector3d& push,
                       double closed) {
    const Eigen::Vector3d home = point_m + moveBy(start_);
    const Eigen::Vector3d at = pose * target(box, pose.inverse() * home);
    const RehearsalMove found = move(index, at - away_m * push, point_m, push, closed);
    const Eigen::Vector3d reached = point_m + moveBy(found.goal);
    if (distance(body, pose.inverse() * reached) < kWithinReach_m) moves.push_back(found);
  };
  add(pocket_m_, 0.0, palmar_, 1.0);
  add(back_m_, kBackAway_m, -palmar_, 0.0);
  return moves;
}

PatientConfig strongPerson(const DeviceModel& device) {
  PatientConfig person;
  person.name = "rehearsal";
  for (const DeviceAxis& axis : device.axes) {
    PatientAxis out;
    out.name = axis.name;
    out.mass = axis.mass;
    out.stiffness = axis.effort_limit / (0.1 * (axis.upper - axis.lower));
    out.damping = 2.0 * std::sqrt(out.stiffness * (axis.mass + out.mass));
    person.axes.push_back(out);
  }
  return person;
}

void Rehearser::begin(const AxisPosition& from, const AxisPosition& goal) {
  from_ = from;
  goal_ = goal;
  reset();
}

void Rehearser::reset() {
  q_ = from_;
  qd_ = AxisVelocity(from_.size());
  pressing_ = false;
  AxisPosition posture = from_;
  for (int i = 0; i < posture.size(); ++i) {
    if (device_.axes[i].group == AxisGroup::kHand) posture[i] = goal_[i];
  }
  reachFor(posture);
}

void Rehearser::press() noexcept {
  pressing_ = true;
  reachFor(goal_);
}

void Rehearser::moveTo(const AxisPosition& goal) noexcept {
  pressing_ = true;
  reachFor(goal);
}

void Rehearser::reachFor(const AxisPosition& goal) noexcept {
  std::array<double, kMaxAxes> needs_s{};
  double longest_s = 1e-3;
  for (int i = 0; i < goal.size(); ++i) {
    const double speed = kSpeedShare * device_.axes[i].speed_limit;
    const double need_s = kMinimumJerkPeak * std::abs(goal[i] - q_[i]) / speed;
    needs_s[i] = need_s;
    longest_s = std::max(longest_s, need_s);
  }
  reach_.begin(q_, qd_, goal, longest_s);
  for (int i = 0; i < goal.size(); ++i) {
    const double share = needs_s[i] / longest_s;
    reach_.during(i, 0.0, std::clamp(share, 1e-3, 1.0));
  }
}

void Rehearser::advance(double period_s, AxisPosition& q, AxisVelocity& qd) noexcept {
  reach_.advance(period_s, q, qd);
  q_ = q;
  qd_ = qd;
}

/// A separate rig in which the hand of a strong person performs moves.
struct RehearsalRig {
  std::unique_ptr<Rig> rig;
  Rehearser* hand = nullptr;
  TickTimer timer;
  TickRecord record;
  std::uint64_t ticks = 0;

  /// @pre models outlive the result
  [[nodiscard]] static Expected<std::unique_ptr<RehearsalRig>> build(const Models& models,
                                                                     const GameBudget& game,
                                                                     const AxisPosition& start,
                                                                     const RigOptions& options) {
    auto player = std::make_unique<Rehearser>(models.device);
    auto out = std::make_unique<RehearsalRig>();
    out->hand = player.get();
    player->begin(start, start);
    Models of_its_own = models;
    of_its_own.patient = strongPerson(models.device);
    of_its_own.scene.game = game;
    auto rig = buildRig(std::move(of_its_own), std::move(player), options);
    if (!rig) return rig.errors();
    out->rig = std::move(*rig);
    return out;
  }

  /// Runs one tick of the loop. Returns false for the first ticks, which have cold caches and do
  /// not count.
  bool tick() {
    constexpr std::uint64_t kFirst_ticks = 20;
    record.tick = ticks;
    record.time_s = static_cast<double>(ticks) * rig->options.period_s;
    timer.start();
    rig->renderer->tick(1, record, &timer);
    timer.finish(record);
    return ticks++ >= kFirst_ticks;
  }

  [[nodiscard]] int ticksIn(double time_s) const {
    return static_cast<int>(std::lround(time_s / rig->options.period_s));
  }
};

Expected<Done> unlessCancelled(const RehearsalOptions& options) {
  if (!options.cancelled || !options.cancelled()) return Done{};
  return fileFault("", "the rehearsal was stopped", "");
}

constexpr double kPiece_m = 0.012;  // thickness of thin rods: many fit around a hand ...
constexpr double kLength = 5.0;  // length per thickness: they touch each other along their length
// Least spacing of the overlapping pieces of a body, in extents of a piece.
constexpr double kClosest = 0.5;
constexpr double kCloser = 0.05;  // step of the search for the least allowed spacing
constexpr double kMass_kg = 0.1;  // a driven body of 0.1 kg reaches the largest speed of 0.5 m/s
constexpr double kClear = 1.02;   // distance between appearing bodies, in sizes of a body
constexpr double kReach_m = 0.3;  // a body farther than this from the pocket is brought back
// Largest step of a target; steps of 0.25 m or more are teleports.
constexpr double kTargetStep_m = 0.2;
constexpr int kPause = 20;
constexpr double kEmpty_m = -9.0;  // empty slots lie 10 m below the origin

/// Points of a cubic lattice, the nearest to the origin first.
std::vector<Eigen::Vector3d> lattice(int half) {
  std::vector<Eigen::Vector3d> points;
  for (int x = -half; x <= half; ++x) {
    for (int y = -half; y <= half; ++y) {
      for (int z = -half; z <= half; ++z) points.emplace_back(x, y, z);
    }
  }
  std::stable_sort(points.begin(), points.end(),
                   [](const auto& a, const auto& b) { return a.squaredNorm() < b.squaredNorm(); });
  return points;
}

/// A prism with at most `vertices` vertices. Flat faces in contact with each other cost more than
/// round ones.
Expected<Shape> prismMesh(int vertices, double size_m, double length_m) {
  std::vector<Eigen::Vector3d> points;
  const int corners = vertices / 2;
  for (int i = 0; i < corners; ++i) {
    const double turn = 2.0 * std::numbers::pi * i / corners;
    for (const double z : {-1.0, 1.0}) {
      points.emplace_back(0.5 * size_m * std::cos(turn), 0.5 * size_m * std::sin(turn),
                          0.5 * length_m * z);
    }
  }
  if (vertices % 2 != 0) points.emplace_back(0.0, 0.0, 0.55 * length_m);
  auto hull = convexHull(points);
  if (!hull) return hull.errors();
  return convexMesh(hull->points, hull->triangles);
}

Shape box(double size_m) {
  Shape shape;
  shape.half_extents_m = Eigen::Vector3d::Constant(0.5 * size_m);
  return shape;
}

/// The costliest piece that the budget admits: a mesh, or a box if all extents must be equal.
Shape worstPiece(const GameBudget& budget, double size_m) {
  const double length_m =
      std::clamp(kLength * size_m, size_m, std::max(size_m, 0.7 * budget.most_m));
  auto mesh = prismMesh(budget.vertices, size_m, length_m);
  if (!mesh) return box(size_m);
  const double least_m = ownBox(*mesh).sizes().minCoeff(),
               most_m = ownBox(*mesh).sizes().maxCoeff();
  const double scale = std::max(1.0, budget.least_m / least_m) * (1.0 + 1e-9);
  if (scale * most_m > budget.most_m) return box(size_m);
  for (Eigen::Vector3d& point : mesh->points_m) point *= scale;
  return *mesh;
}

double distance(const Eigen::Vector3d& p, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const Eigen::Vector3d along = b - a;
  const double length_sq = along.squaredNorm();
  const double t = length_sq > 0.0 ? std::clamp((p - a).dot(along) / length_sq, 0.0, 1.0) : 0.0;
  return (p - a - t * along).norm();
}

ArticulatedBody handAt(const HandModel& hand, const AxisPosition& q_s) {
  ArticulatedBody body(hand);
  JointPosition theta;
  Synergy(hand).expand(q_s, theta);
  body.updateKinematics(theta);
  return body;
}

constexpr double kGather_s = 0.3;        // time in which driven bodies come to the hand
constexpr double kMove_s = 0.3;          // time limit for each move of the hand
constexpr int kPoolHopeless_ticks = 50;  // number of slow ticks that noise cannot explain
constexpr double kToSpare = 0.9;  // share of the limit that a budget named as a remedy may use
constexpr Fault kOfTheWorld = Fault::kNonFiniteEffort | Fault::kNonFiniteState |
                              Fault::kPhysicsStep | Fault::kSingularInertia;

/// A move of the hand through the bodies.
struct Move {
  std::array<double, 3> by_m;  ///< displacement of the arm from the start
  double closed;               ///< finger posture as a share of the range; 1: closed
};
constexpr std::array kMoves{Move{{0.0, 0.0, 0.0}, 1.0}, Move{{0.0, 0.0, -0.04}, 1.0},
                            Move{{0.0, 0.0, 0.0}, 0.0}, Move{{0.04, 0.0, 0.0}, 1.0},
                            Move{{0.0, 0.04, 0.0}, 0.0}};

/// One world with filled slots and a hand that moves through it.
class FilledWorld {
 public:
  FilledWorld(RehearsalRig& its, WorstCaseBodies& filling, const RehearsalOptions& options)
      : its_(its), rig_(*its.rig), filling_(filling), options_(options) {}

  /// @param limit_ns limit of a tick's CPU time; an attempt with too many slow ticks ends early
  [[nodiscard]] Expected<Done> run(const AxisPosition& start, double limit_ns) {
    limit_ns_ = limit_ns;
    its_.hand->begin(start, start);
    if (Expected<Done> armed = rig_.renderer->arm(); !armed) return armed;
    while (!filling_.spawned()) {
      if (Expected<Done> done = tick(); !done) return done;
    }
    if (Expected<Done> done = ticks(kGather_s, false); !done) return done;
    for (const Move& move : kMoves) {
      its_.hand->moveTo(goal(start, move));
      if (Expected<Done> done = ticks(kMove_s, true); !done) return done;
      if (hopeless()) return Done{};
      if (ended_) return moves_ > 0 ? Expected<Done>(Done{}) : Expected<Done>(unmoved());
      ++moves_;
    }
    return Done{};
  }

  [[nodiscard]] PoolMeasurement result() const {
    PoolMeasurement out;
    out.budget = rig_.models.scene.game;
    out.summary = statistics_.snapshot();
    out.limit_us = 1e-3 * limit_ns_;
    out.bodies_max = bodies_max_;
    out.moving_max = moving_max_;
    const auto& owners = filling_.owners();
    out.driven = static_cast<int>(std::count(owners.begin(), owners.end(), BodyOwner::kGame));
    out.free = static_cast<int>(std::count(owners.begin(), owners.end(), BodyOwner::kLoop));
    return out;
  }

  [[nodiscard]] bool hopeless() const { return too_slow_ >= kPoolHopeless_ticks; }

 private:
  [[nodiscard]] AxisPosition goal(const AxisPosition& start, const Move& move) const {
    AxisPosition q = start;
    const DeviceModel& device = rig_.models.device;
    for (int i = 0; i < q.size(); ++i) {
      const DeviceAxis& axis = device.axes[i];
      if (axis.group == AxisGroup::kHand)
        q[i] = axis.lower + move.closed * (axis.upper - axis.lower);
    }
    for (int i = 0; i < 3; ++i) {
      const int index = device.axisIndex(std::string(1, "xyz"[i]));
      if (index < 0) continue;
      const DeviceAxis& axis = device.axes[index];
      q[index] = std::clamp(start[index] + move.by_m[i], axis.lower, axis.upper);
    }
    return q;
  }

  /// Runs ticks for a time or, if `moving`, until the hand has arrived.
  [[nodiscard]] Expected<Done> ticks(double time_s, bool moving) {
    const int count = its_.ticksIn(time_s);
    for (int k = 0; k < count && !ended_ && !hopeless(); ++k) {
      if (Expected<Done> done = tick(); !done) return done;
      if (moving && its_.hand->arrived()) break;
    }
    return Done{};
  }

  [[nodiscard]] Expected<Done> tick() {
    if (Expected<Done> goes_on = unlessCancelled(options_); !goes_on) return goes_on;
    filling_.order(record_);
    if (its_.tick()) count();
    countBodies();
    if (!any(record_.faults & kStoppingFaults)) return Done{};
    ended_ = true;  // the strong hand's own motion or a body that it threw caused the fault
    stopped_by_ = record_.faults & kStoppingFaults;
    const Fault fault = record_.faults & kOfTheWorld;
    if (!any(fault)) return Done{};
    return keyFault(rig_.models.files.exercise, "budget", "",
                    "the worst bodies of a game broke the simulated world: " + faultNames(fault),
                    "narrow the masses and sizes that it allows");
  }

  [[nodiscard]] Diagnostic unmoved() const {
    return keyFault(rig_.models.files.exercise, "budget", "",
                    "the rehearsal's hand could not be closed round the worst bodies of a game: " +
                        faultNames(stopped_by_),
                    "narrow the masses and sizes that it allows");
  }

  void count() {
    if (options_.extra_ns) {
      record_.cpu_ns += std::max<std::int64_t>(0, options_.extra_ns(record_));
    }
    statistics_.add(record_);
    if (static_cast<double>(record_.cpu_ns) > limit_ns_) ++too_slow_;
  }

  void countBodies() {
    int bodies = 0, moving = 0;
    const std::size_t first = rig_.models.scene.bodies.size();
    for (std::size_t slot = 0; slot < filling_.owners().size(); ++slot) {
      const BodyState& state = record_.bodies[first + slot];
      if (WorstCaseBodies::isEmpty(state)) continue;
      ++bodies;
      if (state.velocity_m_s.eigen().norm() > 0.0) ++moving;
    }
    bodies_max_ = std::max(bodies_max_, bodies);
    moving_max_ = std::max(moving_max_, moving);
  }

  RehearsalRig& its_;
  Rig& rig_;
  WorstCaseBodies& filling_;
  const RehearsalOptions& options_;
  TickRecord& record_ = its_.record;
  double limit_ns_ = 0.0;
  TickStatistics statistics_;
  int moves_ = 0, too_slow_ = 0, bodies_max_ = 0, moving_max_ = 0;
  bool ended_ = false;
  Fault stopped_by_ = Fault::kNone;
};

/// Measures a budget several times and returns the best attempt.
Expected<PoolMeasurement> measure(const Models& models, const GameBudget& budget,
                                  const AxisPosition& start, const RigOptions& rig_options,
                                  const RehearsalOptions& options, double share, int attempts) {
  const double limit_ns = share * options.allowed_period_share * rig_options.period_s * 1e9;
  std::optional<PoolMeasurement> best;
  for (int attempt = 1; attempt <= std::max(1, attempts); ++attempt) {
    auto rig = RehearsalRig::build(models, budget, start, rig_options);
    if (!rig) return rig.errors();
    WorstCaseBodies filling((*rig)->rig->models, budget, start);
    FilledWorld world(**rig, filling, options);
    if (Expected<Done> done = world.run(start, limit_ns); !done) return done.errors();
    PoolMeasurement now = world.result();
    if (!best || now.summary.cpu.p999_ns < best->summary.cpu.p999_ns) best = now;
    best->attempts = attempt;
    if (best->passes() || world.hopeless()) break;
  }
  if (best->passes() && best->bodies_max < budget.slots) {
    return keyFault(models.files.exercise, "budget.slots", std::to_string(budget.slots),
                    fmt::format("cannot be rehearsed: only {} bodies of this size find a place "
                                "near the hand",
                                best->bodies_max),
                    "allow smaller bodies (budget.size_m), or state fewer slots");
  }
  return *best;
}

}  // namespace

WorstCaseBodies::WorstCaseBodies(const Models& models, const GameBudget& budget,
                                 const AxisPosition& at, std::vector<Shape> pieces)
    : models_(models),
      mass_kg_(std::clamp(kMass_kg, budget.least_kg, budget.most_kg)),
      pieces_(std::move(pieces)) {
  if (pieces_.empty()) makePieces(budget);
  centerPieces();
  findPlaces(budget, at);
  auto prepared = prepareShapes(pieces_, budget);
  if (!prepared) return;  // no body fits, so the slots stay empty
  for (const Command& command : shapeCommands(0, *prepared)) waiting_.push_back(command);
  for (std::size_t slot = 0; slot < owners_.size(); ++slot) {
    waiting_.push_back(spawnCommand(spawnOf(static_cast<int>(slot))));
  }
}

// Arranges pieces in two columns, as close together as prepareShapes() admits.
void WorstCaseBodies::makePieces(const GameBudget& budget) {
  const double size_m = std::clamp(kPiece_m, budget.least_m, budget.most_m);
  const Shape piece = worstPiece(budget, size_m);
  const Eigen::Vector3d extent_m = ownBox(piece).sizes();
  for (double spacing = kClosest; spacing < 1.0 + kCloser; spacing += kCloser) {
    pieces_.assign(budget.pieces, piece);
    for (int i = 0; i < budget.pieces; ++i) {
      const int column = i % 2, row = i / 2;
      pieces_[i].in_body.translation_m =
          spacing * extent_m.cwiseProduct(Eigen::Vector3d(column, row, 0.0));
    }
    if (prepareShapes(pieces_, budget)) break;
  }
}

// Moves the pieces so that their common centre of mass is the body's origin.
void WorstCaseBodies::centerPieces() {
  Eigen::Vector3d middle_m = Eigen::Vector3d::Zero();
  for (const Shape& piece : pieces_) {
    middle_m += moments(piece).center_m / static_cast<double>(pieces_.size());
  }
  for (Shape& piece : pieces_) {
    piece.in_body.translation_m -= middle_m;
    const double piece_radius_m = 0.5 * ownBox(piece).sizes().norm();
    radius_m_ = std::max(radius_m_, piece.in_body.translation_m.norm() + piece_radius_m);
  }
}

// Finds the free places nearest to the hand. The lowest ones are for fixed bodies, which support
// the others.
void WorstCaseBodies::findPlaces(const GameBudget& budget, const AxisPosition& at) {
  const Eigen::Vector3d grasp_centre_m = graspCentre(at);
  const ArticulatedBody hand = handAt(models_.hand, at);
  for (const Eigen::Vector3d& site : lattice(6)) {
    if (std::cmp_equal(places_m_.size(), budget.slots)) break;
    const Eigen::Vector3d place_m = grasp_centre_m + 2.0 * kClear * radius_m_ * site;
    if (isClear(place_m, hand)) places_m_.push_back(place_m);
  }
  owners_.assign(places_m_.size(), BodyOwner::kFixed);
  generations_.assign(places_m_.size(), 1);
  pause_.assign(places_m_.size(), kPause);
  targets_m_ = places_m_;
  std::vector<std::size_t> order(places_m_.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return places_m_[a].z() > places_m_[b].z();
  });
  const auto awake = std::min<std::size_t>(order.size(), budget.awake);
  for (std::size_t i = 0; i < awake; ++i) {
    owners_[order[i]] = i % 2 == 0 ? BodyOwner::kGame : BodyOwner::kLoop;
  }
}

bool WorstCaseBodies::isEmpty(const BodyState& slot) noexcept {
  return slot.position_m.z < kEmpty_m;
}

bool WorstCaseBodies::isClear(const Eigen::Vector3d& place_m, const ArticulatedBody& hand) const {
  const double clear_m = kClear * radius_m_;
  for (const Capsule& capsule : models_.hand.capsules) {
    const Pose& link = hand.linkPose(capsule.link);
    if (distance(place_m, link * capsule.a_m, link * capsule.b_m) < capsule.radius_m + clear_m) {
      return false;
    }
  }
  for (const SceneBody& body : models_.scene.bodies) {
    const Eigen::Vector3d in_body_m = body.pose.inverse() * place_m;
    for (const Shape& shape : body.shapes) {
      if (signedDistance(shape, in_body_m) < clear_m) return false;
    }
  }
  return true;
}

Eigen::Vector3d WorstCaseBodies::graspCentre(const AxisPosition& q_s) const {
  AxisPosition half_closed = q_s;
  for (int i = 0; i < half_closed.size(); ++i) {
    const DeviceAxis& axis = models_.device.axes[i];
    if (axis.group == AxisGroup::kHand) half_closed[i] = 0.5 * (axis.lower + axis.upper);
  }
  const ArticulatedBody hand = handAt(models_.hand, half_closed);
  Eigen::Vector3d palm_m = Eigen::Vector3d::Zero(), fingers_m = palm_m;
  double palm = 0.0, fingers = 0.0;
  for (const Capsule& capsule : models_.hand.capsules) {
    const bool of_palm = capsule.part == HandPart::kPalm;
    (of_palm ? palm_m : fingers_m) +=
        hand.linkPose(capsule.link) * Eigen::Vector3d(0.5 * (capsule.a_m + capsule.b_m));
    (of_palm ? palm : fingers) += 1.0;
  }
  if (palm == 0.0 || fingers == 0.0) return (palm_m + fingers_m) / std::max(1.0, palm + fingers);
  return 0.5 * (palm_m / palm + fingers_m / fingers);
}

SpawnOrder WorstCaseBodies::spawnOf(int slot) const {
  SpawnOrder order;
  order.slot = slot;
  order.generation = generations_[slot];
  order.owner = owners_[slot];
  order.mass_kg = mass_kg_;
  order.pose = {Vec3::from(places_m_[slot]), {}};
  return order;
}

void WorstCaseBodies::respawnLost(int slot, const TickRecord& seen,
                                  const Eigen::Vector3d& grasp_centre_m) {
  const auto index = static_cast<std::size_t>(slot);
  if (owners_[index] == BodyOwner::kFixed || pause_[index]-- > 0) return;
  pause_[index] = 0;
  const auto body = models_.scene.bodies.size() + index;
  if (body >= static_cast<std::size_t>(seen.body_count)) return;
  const Eigen::Vector3d at_m = seen.bodies[body].position_m.eigen();
  if (isEmpty(seen.bodies[body])) {  // the body was removed from the world
    ++generations_[index];
    targets_m_[index] = places_m_[index];
    pause_[index] = kPause;
    waiting_.push_back(spawnCommand(spawnOf(slot)));
    return;
  }
  const int generation = generations_[index];
  if (owners_[index] == BodyOwner::kLoop) {
    if ((at_m - grasp_centre_m).norm() < kReach_m) return;
    waiting_.push_back(teleportCommand(slot, generation, {Vec3::from(places_m_[slot]), {}}));
    return;
  }
  Eigen::Vector3d step_m = grasp_centre_m - targets_m_[index];
  if (step_m.norm() > kTargetStep_m) step_m *= kTargetStep_m / step_m.norm();
  targets_m_[index] += step_m;
  waiting_.push_back(bodyTargetCommand(slot, generation, {Vec3::from(targets_m_[index]), {}}));
}

void WorstCaseBodies::order(TickRecord& record) {
  record.command_count = 0;
  if (spawned_) {
    const Eigen::Vector3d grasp_centre_m = graspCentre(record.q_s);
    for (int i = 0; i < kMaxCommands && !owners_.empty(); ++i) {
      respawnLost(static_cast<int>(next_), record, grasp_centre_m);
      next_ = (next_ + 1) % owners_.size();
    }
  }
  while (record.command_count < kMaxCommands && !waiting_.empty()) {
    record.commands[record.command_count++] = waiting_.front();
    waiting_.pop_front();
  }
  spawned_ = spawned_ || waiting_.empty();
}

Expected<PoolRehearsal> rehearsePool(const Models& models, const AxisPosition& start,
                                     const RigOptions& rig, const RehearsalOptions& options) {
  const GameBudget whole = models.scene.game;
  const auto report = [&](const GameBudget& budget) {
    if (!options.status) return;
    options.status(fmt::format("{} awake bodies of a game, {} pieces of {} vertices each",
                               budget.awake, budget.pieces, budget.vertices));
  };
  PoolRehearsal out;
  report(whole);
  auto measured = measure(models, whole, start, rig, options, 1.0, options.attempts);
  if (!measured) return measured.errors();
  out.measured = *measured;
  if (out.measured.passes()) {
    out.awake = whole.awake;
    return out;
  }
  // Finds the largest number of awake bodies that passes, by bisection.
  const auto largest = [&](GameBudget budget, int most) -> Expected<int> {
    int passes = 0;
    while (most - passes > 1) {
      budget.awake = passes + (most - passes) / 2;
      report(budget);
      auto now = measure(models, budget, start, rig, options, kToSpare, 1);
      if (!now) return now.errors();
      (now->passes() ? passes : most) = budget.awake;
    }
    return passes;
  };
  auto awake = largest(whole, whole.awake);
  if (!awake) return awake.errors();
  out.awake = *awake;
  if (out.awake > 0 || whole.pieces == 1) return out;
  GameBudget of_one = whole;
  of_one.pieces = 1;
  auto alone = largest(of_one, whole.awake + 1);
  if (!alone) return alone.errors();
  out.awake_alone = *alone;
  return out;
}

Diagnostic poolTooSlow(const PoolRehearsal& pool, const Models& models) {
  const PoolMeasurement& m = pool.measured;
  std::string remedy;
  if (pool.awake > 0) {
    remedy = fmt::format(
        "at most {} fit here, with {} pieces of {} vertices: state awake = {}, "
        "or fewer pieces",
        pool.awake, m.budget.pieces, m.budget.vertices, pool.awake);
  } else if (pool.awake_alone > 0) {
    remedy =
        fmt::format("with these pieces even 1 is too many here: state pieces = 1 and awake = {}",
                    pool.awake_alone);
  } else {
    remedy =
        "even 1 is too many here: use fewer slots or vertices, a slower rate or a faster machine";
  }
  return keyFault(
      models.files.exercise, "budget.awake", std::to_string(m.budget.awake),
      fmt::format("is too many for this machine: with its slots full, a tick takes {:.0f} µs of "
                  "CPU time (p99.9); {:.0f} µs are allowed",
                  1e-3 * m.summary.cpu.p999_ns, m.limit_us),
      remedy);
}

std::string describe(const PoolMeasurement& p) {
  return fmt::format(
      "{} awake and {} fixed bodies of a game, {} pieces of {} vertices each: {:.0f} µs CPU at the "
      "median, {:.0f} p99.9, {:.0f} at most ({:.0f} allowed); up to {} moved, up to {} contacts "
      "with the hand",
      p.driven + p.free, p.bodies_max - p.driven - p.free, p.budget.pieces, p.budget.vertices,
      1e-3 * p.summary.cpu.p50_ns, 1e-3 * p.summary.cpu.p999_ns, 1e-3 * p.summary.cpu.max_ns,
      p.limit_us, p.moving_max, p.summary.contacts_max);
}

namespace {

constexpr double kHold_s = 0.1;       // time of pressing after the last movement
constexpr double kBlocked_s = 0.06;   // fingers at rest this long count as closed
constexpr double kNeutral_s = 1.0;    // wait for the ramp to neutral, longer than any ramp
constexpr int kHopeless_ticks = 100;  // number of slow ticks that noise cannot explain ...
constexpr double kHopeless_ns = 1e9;  // ... or their total time
constexpr double kStill_rad_s = 0.2;

/// Faults of the world, caused by the scene. Faults of the device's motion are caused by the
/// rehearsal's own moves.
constexpr Fault kOfTheScene = Fault::kNonFiniteEffort | Fault::kNonFiniteState |
                              Fault::kPhysicsStep | Fault::kSingularInertia |
                              Fault::kBodiesExploded;

/// Cost of one tick; used to find what slow ticks have in common.
struct TickCost {
  std::int64_t cpu_ns = 0;
  std::array<std::int32_t, kStages> stage_ns{};
  int body = -1;  // body with the most contacts, else the target of the move
  int contacts = 0;
};

/// One attempt, in which every move is made once.
class Attempt {
 public:
  /// @param home initial pose of the session; if no body is in reach, the rehearsal takes place
  /// there
  Attempt(RehearsalRig& its, const RehearsalPlan& plan, const AxisPosition& home,
          const RehearsalOptions& options)
      : its_(its),
        rig_(*its.rig),
        player_(*its.hand),
        plan_(plan),
        home_(home),
        options_(options),
        limit_ns_(options.allowed_period_share * rig_.options.period_s * 1e9) {}

  [[nodiscard]] Expected<Done> run() {
    const auto bodies = static_cast<int>(rig_.models.scene.bodies.size());
    touched_.assign(bodies, false);
    // If there are too many bodies, visits a subset spread evenly over them.
    const int step = std::max(1, (bodies + options_.most_bodies - 1) / options_.most_bodies);
    for (int body = 0; body < bodies && !hopeless(); body += step) {
      for (const RehearsalMove& move : plan_.movesFor(body, its_.ticks > 0 ? &record_ : nullptr)) {
        if (!armAtStartOf(move)) continue;
        if (Expected<Done> done = perform(move); !done) return done;
      }
    }
    if (costs_.empty()) return stayAtHome();
    return Done{};
  }

  [[nodiscard]] bool hopeless() const {
    const bool many = 10 * too_slow_ > costs_.size();
    return many && (too_slow_ >= kHopeless_ticks || slow_ns_ >= kHopeless_ns);
  }

  [[nodiscard]] Rehearsal result() const {
    Rehearsal out;
    out.summary = statistics_.snapshot();
    out.limit_us = 1e-3 * limit_ns_;
    out.bodies = static_cast<int>(touched_.size());
    out.bodies_touched = static_cast<int>(std::count(touched_.begin(), touched_.end(), true));
    out.unsettled =
        static_cast<double>(unsettled_) / static_cast<double>(std::max(1, untouched_ticks_));
    explainSlowTicks(out);
    return out;
  }

 private:
  [[nodiscard]] bool armAtStartOf(const RehearsalMove& move) {
    for (const AxisPosition& start : move.starts) {
      player_.begin(start, move.goal);
      if (rig_.renderer->arm()) return true;
    }
    player_.begin(home_, move.goal);  // starts from the initial pose instead
    return rig_.renderer->arm().ok();
  }

  [[nodiscard]] Expected<Done> stayAtHome() {
    RehearsalMove rest;
    rest.goal = home_;
    player_.begin(home_, home_);
    if (Expected<Done> armed = rig_.renderer->arm(); !armed) return armed;
    return perform(rest);
  }

  // Performs a move: closes the fingers as far as possible, then presses with the arm.
  [[nodiscard]] Expected<Done> perform(const RehearsalMove& move) {
    const int hold = its_.ticksIn(kHold_s), still_for = its_.ticksIn(kBlocked_s);
    int held = 0, blocked = 0;
    while (held < hold && !hopeless()) {
      if (Expected<Done> goes_on = unlessCancelled(options_); !goes_on) return goes_on;
      tick(move);
      if (any(record_.faults & kStoppingFaults)) return recover(move);
      blocked = record_.contact_count > 0 && still() ? blocked + 1 : 0;
      if (!player_.pressing() && (player_.arrived() || blocked > still_for)) player_.press();
      if (player_.pressing() && player_.arrived()) ++held;
    }
    return Done{};
  }

  void tick(const RehearsalMove& move) {
    record_.command_count = 0;
    if (its_.tick()) count(move);
  }

  void count(const RehearsalMove& move) {
    statistics_.add(record_);
    TickCost cost;
    cost.cpu_ns = record_.cpu_ns;
    cost.stage_ns = record_.stage_cpu_ns;
    cost.body = move.body;
    std::array<int, kMaxSceneBodies> contacts{};
    for (int i = 0; i < record_.contact_count; ++i) {
      const int body = record_.contacts[i].body;
      if (body < 0 || body >= kMaxSceneBodies) continue;
      const int of_it = ++contacts[body];
      if (std::cmp_less(body, touched_.size())) {
        touched_[body] = true;
      }
      if (of_it <= cost.contacts) continue;
      cost.contacts = of_it;
      cost.body = body;
    }
    costs_.push_back(cost);
    untouched_ = untouched_ && record_.contact_count == 0;
    if (untouched_) {
      ++untouched_ticks_;
      if (any(record_.faults & Fault::kContactsUnsettled)) ++unsettled_;
    }
    if (static_cast<double>(cost.cpu_ns) <= limit_ns_) return;
    ++too_slow_;
    slow_ns_ += static_cast<double>(cost.cpu_ns);
  }

  [[nodiscard]] bool still() const {
    for (int i = 0; i < record_.qd_mf.size(); ++i) {
      if (std::abs(record_.qd_mf[i]) > kStill_rad_s) return false;
    }
    return true;
  }

  // Handles a fault. A fault of the device's motion ends the move; a fault of the world refuses the
  // scene.
  [[nodiscard]] Expected<Done> recover(const RehearsalMove& move) {
    const Fault fault = record_.faults & kOfTheScene;
    if (any(fault)) return broken(fault, move);
    for (int i = 0; i < its_.ticksIn(kNeutral_s) && !rig_.renderer->atNeutral(); ++i) tick(move);
    return Done{};
  }

  [[nodiscard]] Diagnostic broken(Fault fault, const RehearsalMove& move) const {
    const SceneModel& scene = rig_.models.scene;
    const auto body = static_cast<std::size_t>(move.body);
    const std::string name = body < scene.bodies.size() ? scene.bodies[body].name : "nothing";
    return keyFault(scene.path, "bodies", name,
                    "the rehearsal broke the simulated world here: " + faultNames(fault),
                    "correct or remove what lies there: its mass, or what it overlaps");
  }

  // Finds the stage and the body that dominate the slowest hundredth of the ticks.
  void explainSlowTicks(Rehearsal& out) const {
    std::vector<TickCost> slow = costs_;
    const std::size_t count =
        std::max<std::size_t>(slow.size() / 100, std::min<std::size_t>(slow.size(), 10));
    std::partial_sort(slow.begin(), slow.begin() + static_cast<std::ptrdiff_t>(count), slow.end(),
                      [](const TickCost& a, const TickCost& b) { return a.cpu_ns > b.cpu_ns; });
    slow.resize(count);
    std::array<std::int64_t, kStages> stages{};
    std::array<int, kMaxSceneBodies> most{};
    std::array<std::int64_t, kMaxSceneBodies> contacts{};
    for (const TickCost& tick : slow) {
      for (std::size_t s = 0; s < stages.size(); ++s) stages[s] += tick.stage_ns[s];
      if (tick.body < 0) continue;
      most[tick.body] = std::max(most[tick.body], tick.contacts);
      contacts[tick.body] += 1 + tick.contacts;
    }
    out.slowest =
        static_cast<Stage>(std::max_element(stages.begin(), stages.end()) - stages.begin());
    const std::size_t index = std::max_element(contacts.begin(), contacts.end()) - contacts.begin();
    if (contacts[index] == 0 || index >= rig_.models.scene.bodies.size()) return;
    out.heaviest = rig_.models.scene.bodies[index].name;
    out.heaviest_contacts = most[index];
  }

  RehearsalRig& its_;
  Rig& rig_;
  Rehearser& player_;
  const RehearsalPlan& plan_;
  const AxisPosition home_;
  const RehearsalOptions& options_;
  const double limit_ns_;
  TickRecord& record_ = its_.record;
  TickStatistics statistics_;
  std::vector<TickCost> costs_;
  std::vector<bool> touched_;
  std::size_t too_slow_ = 0;
  bool untouched_ = true;
  int untouched_ticks_ = 0, unsettled_ = 0;
  double slow_ns_ = 0.0;
};

std::size_t faces(const SceneBody& body) {
  std::size_t count = 0;
  for (const Shape& shape : body.shapes) count += shape.triangles.size();
  return count;
}

std::string remedyFor(const Rehearsal& r, const Models& models) {
  if (r.slowest == Stage::kExercise)
    return "use a simpler exercise, a slower rate or a faster machine";
  const int index = models.scene.bodyIndex(r.heaviest);
  if (index >= 0) {
    const SceneBody& body = models.scene.bodies[index];
    if (body.shapes.size() > 1) {
      return fmt::format("make \"{}\" of fewer than {} shapes, or remove it", body.name,
                         body.shapes.size());
    }
    if (faces(body) > 50) {
      return fmt::format("give \"{}\" a coarser mesh than {} faces, or remove it", body.name,
                         faces(body));
    }
    return fmt::format("remove \"{}\" or others of the {} bodies, or run at a slower rate",
                       body.name, models.scene.bodies.size());
  }
  return "use a slower rate or a faster machine, or close other programs";
}

/// Diagnostic of a scene whose ticks take too long: the time, the stage, and what to remove.
Diagnostic tooSlow(const Rehearsal& r, const Models& models) {
  std::string where;
  if (r.heaviest_contacts > 0) {
    where = fmt::format(", with {} contacts on \"{}\"", r.heaviest_contacts, r.heaviest);
  } else if (!r.heaviest.empty()) {
    where = fmt::format(", with the hand at \"{}\"", r.heaviest);
  }
  return keyFault(
      models.files.exercise.empty() ? models.scene.path : models.files.exercise, "rehearsal",
      fmt::format("{:.0f} µs", 1e-3 * r.summary.cpu.p999_ns),
      fmt::format(
          "is the CPU time of a tick with the worst contacts (p99.9); {:.0f} µs are allowed, "
          "most of it is {}{}",
          r.limit_us, stageName(r.slowest), where),
      remedyFor(r, models));
}

}  // namespace

double allowedPeriodShare() noexcept {
#if WHOLEHAND_SANITIZED || !defined(__OPTIMIZE__)
  return 100.0;
#else
  return 0.5;
#endif
}

Expected<Rehearsal> rehearse(const Models& models, const AxisPosition& start,
                             const RigOptions& rig_options, const RehearsalOptions& options) {
  const DenormalsFlushed scope;  // denormals are flushed as in the loop
  const RehearsalPlan plan(models.hand, models.device, models.scene, start);
  const bool has_pool = models.scene.game.slots > 0;
  std::optional<Rehearsal> best;
  std::string fingerprint;
  bool passes = false;
  for (int attempt = 1; attempt <= std::max(1, options.attempts) && !passes; ++attempt) {
    auto rig = RehearsalRig::build(models, models.scene.game, start, rig_options);
    if (!rig) return rig.errors();
    fingerprint = (*rig)->rig->renderer->config().rehearsal;
    Attempt run(**rig, plan, start, options);
    if (Expected<Done> done = run.run(); !done) return done.errors();
    Rehearsal now = run.result();
    now.attempts = attempt;
    if (!best || now.summary.cpu.p999_ns < best->summary.cpu.p999_ns) best = std::move(now);
    best->attempts = attempt;
    passes = 1e-3 * best->summary.cpu.p999_ns <= best->limit_us;
    if (run.hopeless()) break;
  }
  if (!passes) return tooSlow(*best, models);
  if (has_pool && options.fill_pool) {
    auto pool = rehearsePool(models, start, rig_options, options);
    if (!pool) return pool.errors();
    if (!pool->measured.passes()) return poolTooSlow(*pool, models);
    best->pool = pool->measured;
  }
  const auto bodies = static_cast<int>(models.scene.bodies.size());
  const bool whole = options.most_bodies >= bodies && (!has_pool || best->pool);
  if (options.allowed_period_share <= allowedPeriodShare() && whole) {
    best->passed = RehearsalPassed(fingerprint);
  }
  return *best;
}

std::string describe(const Rehearsal& r) {
  const std::string pool = r.pool ? "; with " + describe(*r.pool) : "";
  const std::string unsettled =
      r.unsettled > 0.0
          ? fmt::format(
                "; before the hand touches anything, contact forces do not settle in {:.1f} % of "
                "the ticks: what is heavy sinks into what is light below it",
                100.0 * r.unsettled)
          : "";
  return fmt::format(
      "{:.0f} µs CPU at the median, {:.0f} p99.9, {:.0f} at most ({:.0f} allowed), mostly {}; "
      "up to {} contacts, {} of {} bodies touched{}{}",
      1e-3 * r.summary.cpu.p50_ns, 1e-3 * r.summary.cpu.p999_ns, 1e-3 * r.summary.cpu.max_ns,
      r.limit_us, stageName(r.slowest), r.summary.contacts_max, r.bodies_touched, r.bodies,
      unsettled, pool);
}

}  // namespace wholehand
