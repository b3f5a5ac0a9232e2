#include "loop/physics/axis_closure.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace wholehand {
namespace {

bool moves(const HandModel& hand, int link, int axis) {
  const int joint = hand.links[link].joint;
  return joint >= 0 && hand.synergy(joint, axis) != 0.0;
}

/// The links from the first one that the axis moves to the given link; empty when the axis moves
/// none of them.
std::vector<int> movedLinks(const HandModel& hand, int link, int axis) {
  std::vector<int> path;
  std::size_t moved = 0;
  for (int i = link; i >= 0; i = hand.links[i].parent) {
    path.push_back(i);
    if (moves(hand, i, axis)) moved = path.size();
  }
  path.resize(moved);
  std::reverse(path.begin(), path.end());
  return path;
}

}  // namespace

ClosingChain::ClosingChain(const HandModel& hand, int axis, int capsule) : capsule_(capsule) {
  const Capsule& c = hand.capsules[capsule];
  const std::vector<int> path = movedLinks(hand, c.link, axis);
  root_link_ = hand.links[path.front()].parent;
  radius_m_ = c.radius_m;
  Pose since;
  for (const int i : path) {
    const HandLink& link = hand.links[i];
    since = since * link.parent_to_link;
    if (link.joint < 0) continue;
    const bool turned = since.rotation != Eigen::Matrix3d::Identity();
    joints_.push_back({since, turned, link.axis, link.type == JointType::kRevolute, link.joint,
                       hand.synergy(link.joint, axis)});
    since = Pose{};
  }
  a_m_ = since * c.a_m;
  b_m_ = since * c.b_m;
  boundMotion(std::max(std::abs(hand.axis_lower[axis]), std::abs(hand.axis_upper[axis])));
}

/// Computes bounds of the motion of the capsule's points. A point is farthest from a joint when the
/// chain is stretched out; a sliding joint adds its travel to the distance seen from the joints
/// before it. For joint k let r_k be the ratio, R_k the largest distance, w_k = r_k R_k (r_k for a
/// sliding joint) and Ω_k the sum of the ratios of all rotations before it. Then p' = Σ r_k ω_k ×
/// (p − o_k), so |p'| ≤ Σ w_k, and by one more derivative |p''| ≤ Σ r_k (2 Ω_k R_k + Σ_{j≥k} w_j).
void ClosingChain::boundMotion(double travel) noexcept {
  double reach_m = std::max(a_m_.norm(), b_m_.norm());
  for (std::size_t k = joints_.size(); k-- > 0;) {
    const Joint& joint = joints_[k];
    const double ratio = std::abs(joint.ratio);
    double turn_before = 0.0;
    for (std::size_t j = 0; j < k; ++j) {
      if (joints_[j].revolute) turn_before += std::abs(joints_[j].ratio);
    }
    fastest_ += ratio * (joint.revolute ? reach_m : 1.0);
    sharpest_ += joint.revolute ? ratio * (2.0 * turn_before * reach_m + fastest_)
                                : 2.0 * ratio * turn_before;
    if (!joint.revolute) reach_m += ratio * travel;
    reach_m += joint.from_previous.translation_m.norm();
  }
}

void ClosingChain::place(const Pose& root, const JointPosition& theta, double q_present,
                         double q_axis, MovingSegment& placed) const noexcept {
  Pose at = root;
  placed.joints = static_cast<int>(joints_.size());
  for (std::size_t k = 0; k < joints_.size(); ++k) {
    const Joint& joint = joints_[k];
    const double position = theta[joint.joint] + joint.ratio * (q_axis - q_present);
    at.translation_m = at * joint.from_previous.translation_m;
    if (joint.turned) at.rotation = at.rotation * joint.from_previous.rotation;
    placed.origin_m[k] = at.translation_m;
    placed.screw[k] = at.rotation * joint.axis;
    if (joint.revolute) {
      at.rotation = at.rotation * Eigen::AngleAxisd(position, joint.axis).toRotationMatrix();
    } else {
      at.translation_m += position * placed.screw[k];
    }
  }
  placed.a_m = at * a_m_;
  placed.b_m = at * b_m_;
}

Eigen::Vector3d ClosingChain::MovingSegment::rate(const ClosingChain& chain,
                                                  const Eigen::Vector3d& at_m) const {
  Eigen::Vector3d rate = Eigen::Vector3d::Zero();
  for (int k = 0; k < joints; ++k) {
    const Joint& joint = chain.joints_[k];
    rate += joint.ratio *
            (joint.revolute ? Eigen::Vector3d(screw[k].cross(at_m - origin_m[k])) : screw[k]);
  }
  return rate;
}

std::vector<std::vector<ClosingChain>> ClosingChain::ofAxes(const HandModel& hand) {
  std::vector<std::vector<ClosingChain>> chains(hand.axis_count);
  for (int axis = 0; axis < hand.axis_count; ++axis) {
    const bool has_travel = axis < hand.axis_lower.size();
    if (!has_travel || !movedLinks(hand, hand.palm_link, axis).empty()) continue;
    for (std::size_t c = 0; c < hand.capsules.size(); ++c) {
      if (movedLinks(hand, hand.capsules[c].link, axis).empty()) continue;
      chains[axis].emplace_back(hand, axis, static_cast<int>(c));
    }
  }
  return chains;
}

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr int kDistancesPerTick = 5;  ///< distances that the search computes per tick; tracking the
                                      ///< found touches adds one per axis

// A capsule nearer than this is moved on by Newton's method.
constexpr double kNear_m = 5e-5;
constexpr double kTouching_m = 1e-6;  // accuracy of a touch
constexpr int kNewtonSteps = 4;
constexpr double kBasin_m = 5e-4;  // Newton's method moves at most this far [m of path]
constexpr double kShare = 0.2;     ///< relative accuracy of the search's distances
/// Smallest step of a capsule that passes by without touching [m of path]
constexpr double kLeastStep_m = 5e-6;
/// At a touch the gap closes by at least this share of the path; with a smaller share the surface
/// is only grazed.
constexpr double kLeastShare = 1e-3;
/// A tracked touch moves at most this far [m of path per tick]; a wider gap means that the touch is
/// lost.
constexpr double kStride_m = 3e-3;
// A larger motion between two ticks means that the hand was placed elsewhere.
constexpr double kJump_m = 5e-3;
constexpr double kJump_rad = 0.1;

}  // namespace

AxisClosure::AxisClosure(const HandModel& hand, const SceneModel& scene)
    : bodies_(scene.bodies), axis_count_(hand.axis_count), palm_link_(hand.palm_link) {
  std::size_t most_chains = 0, most_shapes = 0;
  std::vector<std::vector<ClosingChain>> chains = ClosingChain::ofAxes(hand);
  for (int a = 0; a < hand.axis_count; ++a) {
    if (chains[a].empty()) continue;
    most_chains = std::max(most_chains, chains[a].size());
    Axis& axis = axes_.emplace_back();
    axis.index = a;
    axis.lower = hand.axis_lower[a];
    axis.upper = hand.axis_upper[a];
    axis.chains = std::move(chains[a]);
  }
  for (const SceneBody& body : bodies_) most_shapes = std::max(most_shapes, body.shapes.size());
  clear_.resize(most_chains * most_shapes);
  reset();
}

void AxisClosure::reset() noexcept {
  body_ = -1;
  for (Axis& axis : axes_) {
    axis.follows = false;
    axis.touch = kNaN;
  }
}

void AxisClosure::update(const Pose* links, const JointPosition& theta, const AxisPosition& q_s,
                         int body, const BodyState* bodies, AxisPosition& closure) noexcept {
  closure = AxisPosition(axis_count_, kNaN);
  const bool asked = body >= 0 && body < std::min(static_cast<int>(bodies_.size()), kMaxBodies) &&
                     !axes_.empty() && !bodies_[body].shapes.empty();
  if (!asked || body != body_) reset();
  if (!asked) return;
  const SceneBody& model = bodies_[body];
  const Eigen::Matrix3d turn = bodies[body].orientation_xyzw.eigen().toRotationMatrix();
  const Pose in_world{turn, bodies[body].position_m.eigen() - turn * model.com_m};
  const Scene scene{links, &theta, &q_s, &model, in_world.inverse()};
  const bool anew = body != body_;
  body_ = body;
  if (jumped(scene) || anew) {
    for (Axis& axis : axes_) axis.follows = false;
    searched_ = 0;
    beginSearch();
  }
  for (Axis& axis : axes_) follow(scene, axis);
  search(scene);
  for (const Axis& axis : axes_) {
    closure[axis.index] = axis.touch <= axis.lower ? -kInfinity : axis.touch;
  }
}

/// True when the hand or the body moved so far since the last tick that the touches found then are
/// no longer valid.
bool AxisClosure::jumped(const Scene& scene) noexcept {
  const Pose palm = scene.from_world * scene.links[palm_link_];
  bool far = !((palm.translation_m - palm_in_body_.translation_m).norm() <= kJump_m) ||
             !((palm.rotation - palm_in_body_.rotation).norm() <= kJump_rad);
  for (const Axis& axis : axes_) {
    far = far || !(std::abs((*scene.q_s)[axis.index] - q_s_[axis.index]) <= kJump_rad);
  }
  palm_in_body_ = palm;
  q_s_ = *scene.q_s;
  return far;
}

void AxisClosure::measure(const Scene& scene, const Axis& axis, Pair pair, double q, double share,
                          Gap& gap) noexcept {
  const ClosingChain& chain = axis.chains[pair.chain];
  const Pose root =
      chain.rootLink() < 0 ? scene.from_world : scene.from_world * scene.links[chain.rootLink()];
  chain.place(root, *scene.theta, (*scene.q_s)[axis.index], q, gap.at);
  gap.is = segmentDistance(scene.body->shapes[pair.shape], gap.at.a_m, gap.at.b_m, chain.radius_m(),
                           share);
  const Eigen::Vector3d nearest_m = gap.at.a_m + gap.is.along * (gap.at.b_m - gap.at.a_m);
  gap.slope = gap.is.normal.dot(gap.at.rate(chain, nearest_m));
}

/// Range of the axis over which the pair stays apart. The distance from a convex shape is never
/// less than a linear bound, d(x) ≥ d + n·(x − x*), and each end of the capsule satisfies n·p(q +
/// δ) ≥ n·p + δ n·p' − δ²/2 |p''|. The pair is apart up to the δ at which this bound falls to −1
/// µm. With 0 in place of −1 µm, a face that is grazed would be searched in steps of zero length.
double AxisClosure::clearFor(const ClosingChain& chain, const Gap& gap) noexcept {
  const double slow = gap.is.least_m / chain.fastest();
  const Eigen::Vector3d way_m = gap.at.b_m - gap.at.a_m;
  const double rise_m = gap.is.bound_normal.dot(way_m);
  const double bend = chain.maxAcceleration();
  double least = std::numeric_limits<double>::infinity();
  for (const double end : {0.0, 1.0}) {
    const double d = gap.is.least_m + (end - gap.is.along) * rise_m + kTouching_m;
    const double slope =
        gap.is.bound_normal.dot(gap.at.rate(chain, end > 0.0 ? gap.at.b_m : gap.at.a_m));
    const double root = std::sqrt(slope * slope + 2.0 * bend * std::max(d, 0.0));
    // Two forms of the same root, each used where it does not cancel; infinite when the pair does
    // not approach.
    const double clear = slope > 0.0 ? (slope + root) / bend : 2.0 * d / (root - slope);
    least = std::min(least, d > 0.0 ? clear : 0.0);
  }
  return std::max({slow, least, kLeastStep_m / chain.fastest()});
}

void AxisClosure::follow(const Scene& scene, Axis& axis) noexcept {
  if (!axis.follows) return;
  const double fastest = axis.chains[axis.pair.chain].fastest();
  Gap now;
  measure(scene, axis, axis.pair, axis.touch, 0.0, now);
  const double gap_m = now.is.distance_m;
  const bool closes = now.slope < -kLeastShare * fastest;
  double step = gap_m / fastest;  // smallest motion that can remove an overlap
  if (closes) step = std::clamp(-gap_m / now.slope, -kStride_m / fastest, kStride_m / fastest);
  const double touch = axis.touch + step;
  if (gap_m > kStride_m || (gap_m > 0.0 && !closes) || !(touch <= axis.upper)) {
    // The capsule passes by, or the touch is out of range: the search finds the present touch.
    axis.follows = false;
    return;
  }
  axis.touch = std::max(touch, axis.lower);
}

void AxisClosure::beginSearch() noexcept {
  std::fill(clear_.begin(), clear_.end(), axes_[searched_].lower);
}

/// Advances the search. It always continues with the pair whose known clear range is shortest, so
/// the first pair that touches gives the first touch.
void AxisClosure::search(const Scene& scene) noexcept {
  const auto shapes = static_cast<int>(scene.body->shapes.size());
  auto axes_left = axes_.size();  // ends the loop when all axes overlap at their open ends
  for (int left = kDistancesPerTick; left > 0 && axes_left > 0;) {
    Axis& axis = axes_[searched_];
    const auto pairs = static_cast<std::ptrdiff_t>(axis.chains.size()) * shapes;
    const auto least = std::min_element(clear_.begin(), clear_.begin() + pairs);
    const auto at = static_cast<int>(least - clear_.begin());
    const Pair pair{at / shapes, at % shapes};
    const bool through = *least >= (axis.follows ? axis.touch : axis.upper);
    if (through) {
      if (!axis.follows) axis.touch = kNaN;
      searched_ = (searched_ + 1) % static_cast<int>(axes_.size());
      beginSearch();
      --axes_left;
      continue;
    }
    left -= look(scene, axis, pair, *least);
  }
}

/// Advances one pair from the end of its known clear range. Returns the number of distances
/// computed.
int AxisClosure::look(const Scene& scene, Axis& axis, Pair pair, double& clear) noexcept {
  const ClosingChain& chain = axis.chains[pair.chain];
  Gap here;
  measure(scene, axis, pair, clear, kShare, here);
  const double gap_m = here.is.distance_m;
  if (gap_m <= 0.0 && clear == axis.lower) {
    meet(axis, pair, axis.lower);
    return 1;
  }
  int used = 1;
  if (gap_m < kNear_m && here.slope < -kLeastShare * chain.fastest()) {
    double touch = clear;
    used += refine(scene, axis, pair, touch);
    if (touch != clear) {
      if (!axis.follows || touch < axis.touch) meet(axis, pair, touch);
      clear = std::max(clear, axis.touch);
      return used;
    }
  }
  if (gap_m < -kNear_m) {
    beginSearch();  // the hand has moved, so the known clear ranges are no longer valid
  } else {
    clear += clearFor(chain, here);
  }
  return used;
}

void AxisClosure::meet(Axis& axis, Pair pair, double touch) noexcept {
  axis.follows = true;
  axis.touch = touch;
  axis.pair = pair;
}

/// Finds the touch by Newton's method from a small gap; leaves q unchanged when there is no touch.
/// Returns the number of distances computed.
int AxisClosure::refine(const Scene& scene, const Axis& axis, Pair pair, double& q) noexcept {
  const double fastest = axis.chains[pair.chain].fastest();
  double touch = q;
  for (int i = 1; i <= kNewtonSteps; ++i) {
    Gap now;
    measure(scene, axis, pair, touch, 0.0, now);
    if (!(now.slope < -kLeastShare * fastest)) return i;
    touch -= now.is.distance_m / now.slope;
    if (!(std::abs(touch - q) < kBasin_m / fastest)) return i;
    if (std::abs(now.is.distance_m) > kTouching_m) continue;
    if (touch <= axis.upper) q = std::max(touch, axis.lower);
    return i;
  }
  return kNewtonSteps;
}

}  // namespace wholehand
