#include "assembly/pool_rehearsal.hpp"

#include "assembly/rehearsal.hpp"
#include "assembly/rehearsal_moves.hpp"
#include "dynamics/articulated_body.hpp"
#include "dynamics/synergy.hpp"
#include "model/mesh/convex_hull.hpp"
#include "model/mesh/convex_mesh.hpp"
#include "model/scene/game_shapes.hpp"
#include "runtime/session.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <numeric>
#include <utility>

namespace wholehand {
namespace {

constexpr double kPiece_m = 0.012;     // thin rods: many fit round a hand ...
constexpr double kLength = 5.0;        // ... and touch each other along their length
constexpr double kClosest = 0.5;       // pieces of a body overlap: spacing, of their extents ...
constexpr double kCloser = 0.05;       // ... and the step to the least that is allowed
constexpr double kMass_kg = 0.1;       // a driven body of 0.1 kg moves at 0.5 m/s, the most
constexpr double kClear = 1.02;        // bodies appear that share of their size apart
constexpr double kReach_m = 0.3;       // from the pocket; a body further off comes back
constexpr double kTargetStep_m = 0.2;  // targets of 0.25 m or more are teleports
constexpr int kPause = 20;
constexpr double kEmpty_m = -9.0;  // empty slots lie 10 m below the origin

/// Lattice points, the nearest to the origin first.
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

/// A prism with at most that many vertices. Flat faces that lie on each other cost more than round
/// ones.
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

/// The costliest piece of the budget: a mesh, or a box where every extent has to be the same.
Shape worstPiece(const GameBudget& budget, double size_m) {
  const double length_m =
      std::clamp(kLength * size_m, size_m, std::max(size_m, 0.7 * budget.most_m));
  auto mesh = prismMesh(budget.vertices, size_m, length_m);
  if (!mesh) return box(size_m);
  const double least_m = extents(*mesh).minCoeff(), most_m = extents(*mesh).maxCoeff();
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

constexpr int kPoolFirst_ticks = 20;     // first ticks of an attempt, with cold caches
constexpr double kGather_s = 0.3;        // driven bodies come to the hand
constexpr double kMove_s = 0.3;          // at most, for each move of the hand
constexpr int kPoolHopeless_ticks = 50;  // slow ticks that noise does not explain
constexpr double kToSpare = 0.9;         // of the limit, for a budget that is named as a remedy
constexpr Fault kOfTheWorld = Fault::kNonFiniteEffort | Fault::kNonFiniteState |
                              Fault::kPhysicsStep | Fault::kSingularInertia;

/// A move of the hand through the bodies, from where it is.
struct Move {
  std::array<double, 3> by_m;  ///< of the arm, from the start
  double closed;               ///< share of the fingers' range
};
constexpr std::array kMoves{Move{{0.0, 0.0, 0.0}, 1.0}, Move{{0.0, 0.0, -0.04}, 1.0},
                            Move{{0.0, 0.0, 0.0}, 0.0}, Move{{0.04, 0.0, 0.0}, 1.0},
                            Move{{0.0, 0.04, 0.0}, 0.0}};

/// One filled world, and a hand that moves through it.
class FilledWorld {
 public:
  FilledWorld(Rig& rig, Rehearser& hand, PoolFilling& filling, const RehearsalOptions& options)
      : rig_(rig), hand_(hand), filling_(filling), options_(options) {}

  /// @param limit_ns of a tick; an attempt with too many slow ticks ends early
  [[nodiscard]] Expected<Done> run(const AxisPosition& start, double limit_ns) {
    limit_ns_ = limit_ns;
    hand_.begin(start, start);
    if (Expected<Done> armed = rig_.renderer->arm(); !armed) return armed;
    while (!filling_.spawned()) {
      if (Expected<Done> done = tick(); !done) return done;
    }
    if (Expected<Done> done = ticks(kGather_s, false); !done) return done;
    for (const Move& move : kMoves) {
      hand_.moveTo(goal(start, move));
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

  /// Ticks for a time, or until the hand has arrived.
  [[nodiscard]] Expected<Done> ticks(double time_s, bool moving) {
    const auto count = std::lround(time_s / rig_.options.period_s);
    for (long k = 0; k < count && !ended_ && !hopeless(); ++k) {
      if (Expected<Done> done = tick(); !done) return done;
      if (moving && hand_.arrived()) break;
    }
    return Done{};
  }

  [[nodiscard]] Expected<Done> tick() {
    if (options_.cancelled && options_.cancelled()) {
      return fileFault("", "the rehearsal was stopped", "");
    }
    filling_.order(record_);
    record_.tick = ticks_;
    record_.time_s = static_cast<double>(ticks_) * rig_.options.period_s;
    timer_.start();
    rig_.renderer->tick(1, record_, &timer_);
    timer_.finish(record_);
    if (ticks_++ >= kPoolFirst_ticks) count();
    countBodies();
    if (!any(record_.faults & kStoppingFaults)) return Done{};
    ended_ = true;  // by the strong hand's own motion, or by what it threw
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
      if (PoolFilling::isEmpty(state)) continue;
      ++bodies;
      if (state.velocity_m_s.eigen().norm() > 0.0) ++moving;
    }
    bodies_max_ = std::max(bodies_max_, bodies);
    moving_max_ = std::max(moving_max_, moving);
  }

  Rig& rig_;
  Rehearser& hand_;
  PoolFilling& filling_;
  const RehearsalOptions& options_;
  double limit_ns_ = 0.0;
  TickTimer timer_;
  TickRecord record_;
  TickStatistics statistics_;
  std::uint64_t ticks_ = 0;
  int moves_ = 0, too_slow_ = 0, bodies_max_ = 0, moving_max_ = 0;
  bool ended_ = false;
  Fault stopped_by_ = Fault::kNone;
};

/// Measures a budget; the best of the attempts counts.
Expected<PoolMeasurement> measure(const Models& models, const GameBudget& budget,
                                  const AxisPosition& start, const RigOptions& rig_options,
                                  const RehearsalOptions& options, double share, int attempts) {
  const double limit_ns = share * options.most_of_period * rig_options.period_s * 1e9;
  std::optional<PoolMeasurement> best;
  for (int attempt = 1; attempt <= std::max(1, attempts); ++attempt) {
    auto player = std::make_unique<Rehearser>(models.device);
    Rehearser& hand = *player;
    hand.begin(start, start);
    Models of_its_own = models;
    of_its_own.patient = strongPerson(models.device);
    of_its_own.scene.game = budget;
    auto rig = buildRig(std::move(of_its_own), std::move(player), rig_options);
    if (!rig) return rig.errors();
    PoolFilling filling((*rig)->models, budget, start);
    auto world = std::make_unique<FilledWorld>(**rig, hand, filling, options);
    if (Expected<Done> done = world->run(start, limit_ns); !done) return done.errors();
    PoolMeasurement now = world->result();
    if (!best || now.summary.cpu.p999_ns < best->summary.cpu.p999_ns) best = now;
    best->attempts = attempt;
    if (best->passes() || world->hopeless()) break;
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

PoolFilling::PoolFilling(const Models& models, const GameBudget& budget, const AxisPosition& at,
                         std::vector<Shape> pieces)
    : models_(models),
      mass_kg_(std::clamp(kMass_kg, budget.least_kg, budget.most_kg)),
      pieces_(std::move(pieces)) {
  if (pieces_.empty()) makePieces(budget);
  centerPieces();
  findPlaces(budget, at);
  auto prepared = prepareShapes(pieces_, budget);
  if (!prepared) return;  // no body fits: the slots stay empty
  for (const Command& command : shapeCommands(0, *prepared)) waiting_.push_back(command);
  for (std::size_t slot = 0; slot < owners_.size(); ++slot) {
    waiting_.push_back(spawnCommand(spawnOf(static_cast<int>(slot))));
  }
}

// Two columns of pieces, as close together as prepareShapes() admits.
void PoolFilling::makePieces(const GameBudget& budget) {
  const double size_m = std::clamp(kPiece_m, budget.least_m, budget.most_m);
  const Shape piece = worstPiece(budget, size_m);
  const Eigen::Vector3d extent_m = extents(piece);
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

// Bodies have their origin in the centre of mass of these equal pieces.
void PoolFilling::centerPieces() {
  Eigen::Vector3d middle_m = Eigen::Vector3d::Zero();
  for (const Shape& piece : pieces_) {
    middle_m += moments(piece).center_m / static_cast<double>(pieces_.size());
  }
  for (Shape& piece : pieces_) {
    piece.in_body.translation_m -= middle_m;
    const double piece_radius_m = 0.5 * extents(piece).norm();
    radius_m_ = std::max(radius_m_, piece.in_body.translation_m.norm() + piece_radius_m);
  }
}

// The nearest free places; the lowest of them are for fixed bodies, a bed for the others.
void PoolFilling::findPlaces(const GameBudget& budget, const AxisPosition& at) {
  const Eigen::Vector3d pocket_m = pocketAt(at);
  const ArticulatedBody hand = handAt(models_.hand, at);
  for (const Eigen::Vector3d& site : lattice(6)) {
    if (std::cmp_equal(places_m_.size(), budget.slots)) break;
    const Eigen::Vector3d place_m = pocket_m + 2.0 * kClear * radius_m_ * site;
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

bool PoolFilling::isEmpty(const BodyState& slot) noexcept {
  return slot.position_m.z < kEmpty_m;
}

bool PoolFilling::isClear(const Eigen::Vector3d& place_m, const ArticulatedBody& hand) const {
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

Eigen::Vector3d PoolFilling::pocketAt(const AxisPosition& q_s) const {
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

SpawnOrder PoolFilling::spawnOf(int slot) const {
  SpawnOrder order;
  order.slot = slot;
  order.generation = generations_[slot];
  order.owner = owners_[slot];
  order.mass_kg = mass_kg_;
  order.pose = {Vec3::from(places_m_[slot]), {}};
  return order;
}

void PoolFilling::tend(int slot, const TickRecord& seen, const Eigen::Vector3d& pocket_m) {
  const auto index = static_cast<std::size_t>(slot);
  if (owners_[index] == BodyOwner::kFixed || pause_[index]-- > 0) return;
  pause_[index] = 0;
  const auto body = models_.scene.bodies.size() + index;
  if (body >= static_cast<std::size_t>(seen.body_count)) return;
  const Eigen::Vector3d at_m = seen.bodies[body].position_m.eigen();
  if (isEmpty(seen.bodies[body])) {  // it was taken out
    ++generations_[index];
    targets_m_[index] = places_m_[index];
    pause_[index] = kPause;
    waiting_.push_back(spawnCommand(spawnOf(slot)));
    return;
  }
  const int generation = generations_[index];
  if (owners_[index] == BodyOwner::kLoop) {
    if ((at_m - pocket_m).norm() < kReach_m) return;
    waiting_.push_back(teleportCommand(slot, generation, {Vec3::from(places_m_[slot]), {}}));
    return;
  }
  Eigen::Vector3d step_m = pocket_m - targets_m_[index];
  if (step_m.norm() > kTargetStep_m) step_m *= kTargetStep_m / step_m.norm();
  targets_m_[index] += step_m;
  waiting_.push_back(bodyTargetCommand(slot, generation, {Vec3::from(targets_m_[index]), {}}));
}

void PoolFilling::order(TickRecord& record) {
  record.command_count = 0;
  if (spawned_) {
    const Eigen::Vector3d pocket_m = pocketAt(record.q_s);
    for (int i = 0; i < kMaxCommands && !owners_.empty(); ++i) {
      tend(static_cast<int>(next_), record, pocket_m);
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
  const auto tell = [&](const GameBudget& budget) {
    if (!options.status) return;
    options.status(fmt::format("{} awake bodies of a game, {} pieces of {} vertices each",
                               budget.awake, budget.pieces, budget.vertices));
  };
  PoolRehearsal out;
  tell(whole);
  auto measured = measure(models, whole, start, rig, options, 1.0, options.attempts);
  if (!measured) return measured.errors();
  out.measured = *measured;
  if (out.measured.passes()) {
    out.awake = whole.awake;
    return out;
  }
  // The most awake bodies that pass, by halving.
  const auto largest = [&](GameBudget budget, int most) -> Expected<int> {
    int passes = 0;
    while (most - passes > 1) {
      budget.awake = passes + (most - passes) / 2;
      tell(budget);
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

}  // namespace wholehand
