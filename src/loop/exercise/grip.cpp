#include "loop/exercise/grip.hpp"

#include <algorithm>
#include <array>
#include <limits>

namespace wholehand {
namespace {

using Eigen::Vector3d;

/// Least cosine between a contact's outward normal and the palmar direction for a palmar contact.
constexpr double kPalmar = 0.5;
/// Closing an axis presses a point deeper if it moves the point against the normal by at least this
/// [m per rad].
constexpr double kPressing_m = 5e-3;
/// Palmar direction of a capsule's link. Flexion turns fingers about +y and the thumb about -z of
/// its link; a left hand is the mirror image in y.
Vector3d palmarOf(const Capsule& capsule, Side side) {
  if (capsule.part != HandPart::kThumb) return -Vector3d::UnitZ();
  const Vector3d axis = side == Side::kLeft ? Vector3d::UnitZ() : Vector3d(-Vector3d::UnitZ());
  return axis.cross(capsule.b_m - capsule.a_m).normalized();
}

/// Shortest vector from the upright segment of half length `half_m` about the origin to the segment
/// a b (Ericson, Real-Time Collision Detection, 5.1.9), and its end on a b.
struct Way {
  Vector3d way, end;
};
Way wayFromUpright(const Vector3d& a, const Vector3d& b, double half_m) noexcept {
  const Vector3d along_ab = b - a;
  const double length2 = along_ab.squaredNorm();
  const double across2 = length2 - along_ab.z() * along_ab.z();  // squared horizontal length
  double along = 0.0;
  if (across2 > 1e-12) {
    along = std::clamp(-a.head<2>().dot(along_ab.head<2>()) / across2, 0.0, 1.0);
  }
  const double z = std::clamp(a.z() + along * along_ab.z(), -half_m, half_m);
  if (length2 > 1e-12) {
    along = std::clamp((Vector3d(0.0, 0.0, z) - a).dot(along_ab) / length2, 0.0, 1.0);
  }
  const Vector3d at = a + along * along_ab;
  return {at - Vector3d(0.0, 0.0, std::clamp(at.z(), -half_m, half_m)), at};
}

/// Contacts whose normals are within 60° are on the same side; contacts beyond about 107° are on
/// opposite sides. Fingers that press a bottle into the palm are at 110° and more; contacts of a
/// flat hand are less than 90° apart.
constexpr double kSameSide = 0.5, kOppositeSide = -0.3;
/// Largest squeeze, as a multiple of the force of its weaker side.
constexpr double kWeakerSide = 5.0;

/// Normal forces on a body and their directions.
class NormalForces {
 public:
  void add(const Vector3d& normal, double force_n) noexcept {
    if (count_ == normal_.size() || !(force_n > 0.0)) return;
    normal_[count_] = normal;
    force_n_[count_++] = force_n;
    sum_n_ += force_n;
  }
  [[nodiscard]] double sum_n() const noexcept { return sum_n_; }

  /// Largest force common to two opposing sides.
  [[nodiscard]] double opposed_n() const noexcept {
    double opposed_n = 0.0;
    for (std::size_t i = 0; i < count_; ++i) {
      double with_n = 0.0, against_n = 0.0;
      for (std::size_t k = 0; k < count_; ++k) {
        const double cosine = normal_[i].dot(normal_[k]);
        if (cosine > kSameSide) with_n += force_n_[k];
        if (cosine < kOppositeSide) against_n += force_n_[k];
      }
      opposed_n = std::max(opposed_n, std::min(with_n, against_n));
    }
    return opposed_n;
  }

 private:
  std::array<Vector3d, kMaxContacts + kMaxAxes> normal_;
  std::array<double, kMaxContacts + kMaxAxes> force_n_{};
  std::size_t count_ = 0;
  double sum_n_ = 0.0;
};

/// Calls `visit(contact, normal_n)` for contacts that press on the palmar side.
template <class Visit>
void forPalmarContacts(const TickRecord& record, int body, const HandPosture& posture,
                       Visit visit) noexcept {
  for (int i = 0; i < record.contact_count; ++i) {
    const Contact& c = record.contacts[i];
    if (c.body != body) continue;
    const double bears_n = c.force_n.eigen().dot(c.normal.eigen());
    if (bears_n > 0.0 && posture.isPalmar(c.capsule, c.normal.eigen())) visit(c, bears_n);
  }
}

/// True when the axis moves the link relative to the palm.
bool moves(const HandModel& hand, int link, int axis) {
  for (int i = link; i >= 0 && i != hand.palm_link; i = hand.links[i].parent) {
    const int joint = hand.links[i].joint;
    if (joint >= 0 && hand.synergy(joint, axis) != 0.0) return true;
  }
  return false;
}

std::vector<std::uint32_t> axesOfCapsules(const HandModel& hand) {
  std::vector<std::uint32_t> out;
  for (const Capsule& capsule : hand.capsules) {
    std::uint32_t& axes = out.emplace_back(0U);
    for (int a = 0; a < hand.axis_count; ++a) {
      if (moves(hand, capsule.link, a)) axes |= 1U << a;
    }
  }
  return out;
}

}  // namespace

HandPosture::HandPosture(const HandModel& hand)
    : hand_(hand), axes_of_capsule_(axesOfCapsules(hand)) {
  for (const Capsule& c : hand_.capsules) palmar_.push_back(palmarOf(c, hand_.side));
}

bool HandPosture::isPalmar(int capsule, const Vector3d& normal) const noexcept {
  const auto at = static_cast<std::size_t>(capsule);
  if (posed_ == nullptr || at >= palmar_.size()) return false;
  const Vector3d palmar = posed_->linkPose(hand_.capsules[at].link).rotation * palmar_[at];
  return -normal.dot(palmar) > kPalmar;
}

AxisEffort HandPosture::opposingEffort(int capsule, const Vector3d& point_m,
                                       const Vector3d& force_n) const noexcept {
  AxisEffort out(hand_.axis_count);
  const auto at = static_cast<std::size_t>(capsule);
  if (posed_ == nullptr || at >= palmar_.size()) return out;
  std::array<double, kMaxAxes> row{};
  posed_->reducedPointRow(hand_.capsules[at].link, point_m, force_n, row.data());
  for (int a = 0; a < out.size(); ++a) out[a] = -row[a];
  return out;
}

std::uint32_t HandPosture::touchingAxes(const TickRecord& record, int body) const noexcept {
  std::uint32_t axes = 0;
  for (int i = 0; i < record.contact_count; ++i) {
    const Contact& c = record.contacts[i];
    const bool bears = c.force_n.eigen().dot(c.normal.eigen()) > 0.0;
    const auto capsule = static_cast<std::size_t>(c.capsule);  // -1 is out of range
    if (bears && c.body == body && capsule < axes_of_capsule_.size()) {
      axes |= axes_of_capsule_[capsule];
    }
  }
  return axes;
}

std::uint32_t HandPosture::palmarAxes(const TickRecord& record, int body) const noexcept {
  std::uint32_t axes = 0;
  forPalmarContacts(record, body, *this, [&](const Contact& c, double) {
    axes |= axes_of_capsule_[static_cast<std::size_t>(c.capsule)];
  });
  return axes;
}

SoftTouches HandPosture::softTouches(const BodyState& body, double radius_m,
                                     double height_m) const noexcept {
  SoftTouches out;
  if (posed_ == nullptr) return out;
  const Eigen::Matrix3d turn = body.orientation_xyzw.eigen().toRotationMatrix();
  const auto in_body = [&](const Vector3d& p) -> Vector3d {
    return turn.transpose() * (p - body.position_m.eigen());
  };
  for (std::size_t i = 0; i < hand_.capsules.size(); ++i) {
    if (axes_of_capsule_[i] == 0) continue;
    const Capsule& c = hand_.capsules[i];
    const Pose& link = posed_->linkPose(c.link);
    const Way is = wayFromUpright(in_body(link * c.a_m), in_body(link * c.b_m), 0.5 * height_m);
    const double apart_m = is.way.norm(), depth_m = radius_m + c.radius_m - apart_m;
    if (!(depth_m > 0.0 && apart_m > 1e-6) || std::abs(is.end.z()) > 0.5 * height_m) continue;
    const Vector3d normal = turn * is.way / apart_m;
    const Vector3d point_m = body.position_m.eigen() + turn * is.end - c.radius_m * normal;
    const int capsule = static_cast<int>(i);
    const AxisEffort opposing = opposingEffort(capsule, point_m, normal);
    for (int a = 0; a < hand_.axis_count; ++a) {
      if ((axes_of_capsule_[i] >> a & 1U) == 0U) continue;
      if (!(opposing[a] > kPressing_m)) continue;
      SoftTouch& touch = out[a];
      touch.presses = true;
      if (!isPalmar(capsule, normal) || depth_m <= touch.palmar_depth_m) continue;
      touch.palmar_depth_m = depth_m;
      touch.palmar_normal = normal;
    }
  }
  return out;
}

double HandPosture::clearance_m(const Vector3d& center_m, double radius_m,
                                double height_m) const noexcept {
  if (posed_ == nullptr) return 0.0;
  double least_m = std::numeric_limits<double>::infinity();
  for (const Capsule& c : hand_.capsules) {
    const Pose& link = posed_->linkPose(c.link);
    const double apart_m =
        wayFromUpright(link * c.a_m - center_m, link * c.b_m - center_m, 0.5 * height_m).way.norm();
    least_m = std::min(least_m, apart_m - c.radius_m - radius_m);
  }
  return least_m;
}

double gripForce_n(const TickRecord& record, int body, const HandPosture& posture) noexcept {
  NormalForces presses;
  forPalmarContacts(record, body, posture, [&](const Contact& c, double bears_n) {
    presses.add(c.normal.eigen(), bears_n);
  });
  return std::min(presses.sum_n(), kWeakerSide * presses.opposed_n());
}

double feltSqueeze_n(const TickRecord& record, const FeltBody& felt, const HandPosture& posture,
                     const FingerWallConfig& walls, const AxisEffort& effort_limit) noexcept {
  NormalForces presses;
  AxisEffort on_axis(walls.axes);
  forPalmarContacts(record, felt.body, posture, [&](const Contact& c, double bears_n) {
    presses.add(c.normal.eigen(), bears_n);
    const AxisEffort opposing =
        posture.opposingEffort(c.capsule, c.point_m.eigen(), c.force_n.eigen());
    for (int a = 0; a < std::min(walls.axes, opposing.size()); ++a) on_axis[a] += opposing[a];
  });
  double sum_n = 0.0;
  for (int a = 0; a < walls.axes; ++a) {
    if (!(walls.stiffness[a] > 0.0)) continue;
    const SoftTouch& touch = felt.touches[a];
    if (a < felt.wall.size() && touch.palmar_depth_m > 0.0) {
      presses.add(touch.palmar_normal, -felt.wall[a] / walls.lever_arm_m[a]);
      on_axis[a] -= felt.wall[a];
    }
    sum_n += std::clamp(on_axis[a], 0.0, effort_limit[a]) / walls.lever_arm_m[a];
  }
  return std::min(sum_n, kWeakerSide * presses.opposed_n());
}

}  // namespace wholehand
