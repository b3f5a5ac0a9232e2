#include "loop/physics/bullet/hand_rows.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace wholehand::bullet {
namespace {

using Eigen::Vector3d;

// A row with a smaller inverse mass moves nothing and is switched off, as in ReducedContactSolver.
constexpr double kLeastInverseMass = 1e-12;
/// A joint nearer to its end than this gets a row: at 1 kHz, 50 rad/s covers this distance in one
/// tick.
constexpr double kNearEnd_rad = 0.05;
/// A rotation of the base stops this far beyond the device's range: free motion never reaches the
/// stop, and an object cannot turn the avatar into a posture that was not certified.
constexpr double kBeyondRange_rad = 0.1;

template <int Width>
double wanted(const AxisRow& row, const double* change) {
  using Axes = Eigen::Map<const Eigen::Matrix<double, Width, 1>>;
  return row.impulse + row.target -
         Axes(row.jacobian.data()).dot(Axes(change)) * row.effective_mass;
}

/// A row is coupled to joint ends only if this leaves it more than this share of its mobility.
constexpr double kLeastLeft = 1e-3;

/// @return the squared change of the impulse
template <int Width>
double apply(AxisRow& row, double impulse, double* change) {
  const double more = impulse - row.impulse;
  if (row.effective_mass == 0.0 || more == 0.0) return 0.0;
  row.impulse = impulse;
  using Axes = Eigen::Matrix<double, Width, 1>;
  Eigen::Map<Axes>(change) += more * Eigen::Map<const Axes>(row.response.data());
  return more * more;
}

}  // namespace

HandRows::HandRows(const HandModel& hand, double friction, const SolverSettings& settings)
    : hand_(hand),
      axes_(hand.axis_count),
      friction_(friction),
      settings_(settings),
      search_(hand),
      touches_(hand.self_contacts.size()),
      kept_(hand.self_contacts.size()) {
  addEnds(hand);
  addBaseEnds(hand);
}

void HandRows::addEnds(const HandModel& hand) {
  for (int i = hand.palm_link + 1; i < static_cast<int>(hand.links.size()); ++i) {
    const HandLink& link = hand.links[i];
    if (link.joint < 0) continue;
    for (const double side : {1.0, -1.0}) {
      JointEnd end;
      double scale = 0.0;
      for (int a = 0; a < axes_; ++a) {
        end.direction[a] = side * hand.synergy(link.joint, a);
        scale = std::max(scale, std::abs(end.direction[a]));
      }
      if (scale == 0.0) continue;
      const double at_zero = hand.theta0[link.joint];
      end.room = side > 0.0 ? at_zero - link.lower : link.upper - at_zero;
      // Scales to the axis that moves the joint most, so that the joints of one axis are
      // comparable.
      for (double& share : end.direction) share /= scale;
      end.room /= scale;
      addEnd(end);
    }
  }
}

void HandRows::addBaseEnds(const HandModel& hand) {
  for (int i = 0; i <= hand.palm_link; ++i) {
    const HandLink& link = hand.links[i];
    if (link.joint < 0 || link.type != JointType::kRevolute) continue;
    for (int a = 0; a < axes_; ++a) {
      if (hand.synergy(link.joint, a) == 0.0) continue;
      JointEnd end;
      end.direction[a] = 1.0;
      end.room = kBeyondRange_rad - hand.axis_lower[a];
      addEnd(end);
      end.direction[a] = -1.0;
      end.room = kBeyondRange_rad + hand.axis_upper[a];
      addEnd(end);
    }
  }
}

void HandRows::addEnd(const JointEnd& end) {
  for (JointEnd& other : ends_) {
    if (other.direction != end.direction) continue;
    other.room = std::min(other.room, end.room);
    return;
  }
  ends_.push_back(end);
}

void HandRows::reset(const ArticulatedBody& at, const AxisPosition& q_s) noexcept {
  for (KeptImpulse& kept : kept_) kept = KeptImpulse{};
  for (JointEnd& end : ends_) end.kept_impulse = 0.0;
  touch_count_ = near_end_count_ = 0;
  search_.reset(&at.linkPose(0), q_s);
}

void HandRows::beginStep(const ArticulatedBody& at, const AxisPosition& q_s) noexcept {
  search_.update(&at.linkPose(0), q_s);
  touch_count_ = search_.count();
  for (int i = 0; i < touch_count_; ++i) {
    touches_[i].pair = search_.near(i).pair;
    touches_[i].gap = search_.near(i).gap;
  }
  near_end_count_ = 0;
  for (std::size_t i = 0; i < ends_.size(); ++i) {
    JointEnd& end = ends_[i];
    end.left = end.room;
    for (int a = 0; a < axes_; ++a) end.left += end.direction[a] * q_s[a];
    if (end.left < kNearEnd_rad) {
      near_end_[near_end_count_++] = static_cast<int>(i);
    } else {
      end.kept_impulse = 0.0;
    }
  }
}

/// Goal velocity of a row. Apart: the gap may close in this step, but no overlap may begin. Beyond:
/// moves back gently.
double HandRows::goal(double left, double slop, double step_s) const noexcept {
  const double gap = left + slop;
  return gap > 0.0 ? -gap / step_s : -gap * settings_.contact_erp / step_s;
}

void HandRows::setUp(const ArticulatedBody& at, const AxisMatrix& inverse, const double* velocity,
                     double step_s) noexcept {
  for (int i = 0; i < touch_count_; ++i) {
    SelfTouch& touch = touches_[i];
    setUpTouch(at, touch);
    const double normal_goal = goal(touch.gap.distance_m, settings_.penetration_slop_m, step_s);
    finishRow(touch.normal_row, inverse, velocity, normal_goal);
    finishRow(touch.tangent1_row, inverse, velocity, 0.0);
    finishRow(touch.tangent2_row, inverse, velocity, 0.0);
  }
  coupled_count_ = 0;
  coupled_impulse_.fill(0.0);
  for (int i = 0; i < near_end_count_; ++i) {
    JointEnd& end = ends_[near_end_[i]];
    end.row.jacobian = end.direction;
    finishRow(end.row, inverse, velocity, goal(end.left, 0.0, step_s));
    end.coupled_index = -1;
    if (end.kept_impulse <= 0.0 || coupled_count_ == kMaxCoupledEnds) continue;
    end.coupled_index = coupled_count_;
    coupled_[coupled_count_++] = near_end_[i];
  }
}

void HandRows::coupleToEnds(const std::array<double, kMaxAxes>& jacobian,
                            std::array<double, kMaxAxes>& response, EndShares& shares,
                            bool one_sided) const noexcept {
  shares.fill(0.0);
  if (coupled_count_ == 0) return;
  using Axes = Eigen::Matrix<double, kMaxAxes, 1>;
  using Few = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxCoupledEnds, 1>;
  using FewByFew =
      Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxCoupledEnds, kMaxCoupledEnds>;
  const auto direction = [&](int k) {
    return Eigen::Map<const Axes>(ends_[coupled_[k]].direction.data());
  };
  Eigen::Map<Axes> moved(response.data());
  std::array<int, kMaxCoupledEnds> bearing{};
  int count = 0;
  for (int k = 0; k < coupled_count_; ++k) {
    // Negative: the row moves the joint towards the end.
    const double approach = direction(k).dot(moved);
    if (approach < 0.0 || (!one_sided && approach > 0.0)) bearing[count++] = k;
  }
  if (count == 0) return;
  FewByFew mobility(count, count);
  Few approach(count);
  for (int m = 0; m < count; ++m) {
    approach[m] = direction(bearing[m]).dot(moved);
    for (int n = 0; n < count; ++n) {
      const AxisRow& row = ends_[coupled_[bearing[n]]].row;
      mobility(m, n) = direction(bearing[m]).dot(Eigen::Map<const Axes>(row.response.data()));
    }
  }
  const Few borne = -mobility.llt().solve(approach);
  Axes rest = moved;
  for (int m = 0; m < count; ++m) {
    const AxisRow& row = ends_[coupled_[bearing[m]]].row;
    rest += borne[m] * Eigen::Map<const Axes>(row.response.data());
  }
  // If the ends leave the row almost no mobility, row and ends are solved in turn, as separate
  // rows.
  const Eigen::Map<const Axes> j(jacobian.data());
  if (!(j.dot(rest) > kLeastLeft * j.dot(moved))) return;
  moved = rest;
  for (int m = 0; m < count; ++m) shares[bearing[m]] = borne[m];
}

void HandRows::start(const EndShares& lead, double* change) noexcept {
  const double share = settings_.self_warm_start;
  for (int i = 0; i < touch_count_; ++i) {
    SelfTouch& touch = touches_[i];
    const KeptImpulse& kept = kept_[touch.pair];
    apply<kMaxAxes>(touch.normal_row, share * kept.normal, change);
    apply<kMaxAxes>(touch.tangent1_row, share * kept.tangent.dot(touch.tangent1), change);
    apply<kMaxAxes>(touch.tangent2_row, share * kept.tangent.dot(touch.tangent2), change);
  }
  for (int i = 0; i < near_end_count_; ++i) {
    JointEnd& end = ends_[near_end_[i]];
    // The contacts coupled to this end have already applied their starting impulses, with the end's
    // shares of them. Only what the end bore beside them in the last step is reduced: less under a
    // contact would throw the light digit against it.
    const int coupled = end.coupled_index;
    if (coupled >= 0) end.row.impulse = coupled_impulse_[coupled];
    const double borne = end.row.impulse;
    const double beside = end.kept_impulse - (coupled >= 0 ? borne - lead[coupled] : borne);
    apply<kMaxAxes>(end.row, borne + share * beside, change);
    if (coupled >= 0) coupled_impulse_[coupled] = end.row.impulse;
  }
}

void HandRows::setUpTouch(const ArticulatedBody& at, SelfTouch& touch) const noexcept {
  const SelfPair& pair = hand_.self_contacts[touch.pair];
  const int link_a = hand_.capsules[pair.capsule_a].link;
  const int link_b = hand_.capsules[pair.capsule_b].link;
  int least = 0;
  touch.gap.normal.cwiseAbs().minCoeff(&least);
  touch.tangent1 = touch.gap.normal.cross(Vector3d(Vector3d::Unit(least))).normalized();
  touch.tangent2 = touch.gap.normal.cross(touch.tangent1);
  const auto row = [&](AxisRow& out, const Vector3d& direction) {
    std::array<double, kMaxAxes> of_b{};
    at.reducedPointRow(link_a, touch.gap.point_m, direction, out.jacobian.data());
    at.reducedPointRow(link_b, touch.gap.point_m, direction, of_b.data());
    for (int a = 0; a < axes_; ++a) out.jacobian[a] -= of_b[a];
  };
  row(touch.normal_row, touch.gap.normal);
  row(touch.tangent1_row, touch.tangent1);
  row(touch.tangent2_row, touch.tangent2);
}

void HandRows::finishRow(AxisRow& row, const AxisMatrix& inverse, const double* velocity,
                         double goal_velocity) const noexcept {
  double inverse_mass = 0.0;
  double speed = 0.0;
  for (int a = 0; a < axes_; ++a) {
    double y = 0.0;
    for (int b = 0; b < axes_; ++b) y += inverse(a, b) * row.jacobian[b];
    row.response[a] = y;
    inverse_mass += y * row.jacobian[a];
    speed += row.jacobian[a] * velocity[a];
  }
  row.effective_mass = inverse_mass > kLeastInverseMass ? 1.0 / inverse_mass : 0.0;
  row.lacking = goal_velocity - speed;
  row.target = row.lacking * row.effective_mass;
  row.impulse = 0.0;
}

template <int Width>
double HandRows::iterate(double* change) noexcept {
  double largest = 0.0;
  const auto set = [&](AxisRow& row, double impulse) {
    largest = std::max(largest, apply<Width>(row, impulse, change));
  };
  for (int i = 0; i < touch_count_; ++i) {
    SelfTouch& touch = touches_[i];
    set(touch.normal_row, std::max(0.0, wanted<Width>(touch.normal_row, change)));
    // Solves both tangents together, so that friction is limited by a disc and not by a square.
    const double limit = friction_ * touch.normal_row.impulse;
    double t1 = 0.0, t2 = 0.0;
    if (limit > 0.0) {
      t1 = wanted<Width>(touch.tangent1_row, change);
      t2 = wanted<Width>(touch.tangent2_row, change);
      const double length = std::sqrt(t1 * t1 + t2 * t2);
      if (length > limit) {
        t1 *= limit / length;
        t2 *= limit / length;
      }
    }
    set(touch.tangent1_row, t1);
    set(touch.tangent2_row, t2);
  }
  for (int i = 0; i < near_end_count_; ++i) {
    JointEnd& end = ends_[near_end_[i]];
    if (end.coupled_index >= 0) end.row.impulse = coupled_impulse_[end.coupled_index];
    set(end.row, std::max(0.0, wanted<Width>(end.row, change)));
    if (end.coupled_index >= 0) coupled_impulse_[end.coupled_index] = end.row.impulse;
  }
  return largest;
}

template double HandRows::iterate<8>(double*) noexcept;
template double HandRows::iterate<kMaxAxes>(double*) noexcept;

void HandRows::finish() noexcept {
  if (any_kept_) std::fill(kept_.begin(), kept_.end(), KeptImpulse{});
  any_kept_ = touch_count_ > 0;
  for (int i = 0; i < touch_count_; ++i) {
    const SelfTouch& touch = touches_[i];
    kept_[touch.pair] = {touch.normal_row.impulse, touch.tangent1 * touch.tangent1_row.impulse +
                                                       touch.tangent2 * touch.tangent2_row.impulse};
  }
  for (int i = 0; i < near_end_count_; ++i) {
    JointEnd& end = ends_[near_end_[i]];
    end.kept_impulse = end.row.impulse;
  }
}

AxisEffort HandRows::endImpulse() const noexcept {
  AxisEffort sum(axes_);
  for (int i = 0; i < near_end_count_; ++i) {
    const JointEnd& end = ends_[near_end_[i]];
    for (int a = 0; a < axes_; ++a) sum[a] += end.direction[a] * end.row.impulse;
  }
  return sum;
}

// Joint ends as cones of ConeNewton.

bool HandRows::addEndsTo(ConeNewton& newton, const AxisRoot& root) const noexcept {
  for (int i = 0; i < near_end_count_; ++i) {
    const AxisRow& end = ends_[near_end_[i]].row;
    ConeNewton::Row* row = newton.add(1, 0.0, 0.0);
    if (row == nullptr) return false;
    root.transpose(end.jacobian.data(), row->along.data());
    row->goal = end.lacking;
    row->start = 0.0;
  }
  return true;
}

void HandRows::takeEndsFrom(const ConeNewton& newton, int row) noexcept {
  for (int i = 0; i < near_end_count_; ++i) {
    ends_[near_end_[i]].row.impulse = newton.row(row++).impulse;
  }
}

bool HandRows::addEndsTo(IslandNewton& newton, int slot, const AxisRoot& root) const noexcept {
  for (int i = 0; i < near_end_count_; ++i) {
    const AxisRow& end = ends_[near_end_[i]].row;
    IslandNewton::Contact* to = newton.add(slot, -1);
    if (to == nullptr) return false;
    to->of_joint = true;
    root.transpose(end.jacobian.data(), to->along_a[0].data());
    to->goal[0] = end.lacking;
    to->start[0] = end.impulse;
  }
  return true;
}

void HandRows::takeEndsFrom(const IslandNewton& newton, int contact) noexcept {
  for (int i = 0; i < near_end_count_; ++i) {
    ends_[near_end_[i]].row.impulse = newton.contact(contact++).impulse[0];
  }
}

}  // namespace wholehand::bullet
