#include "exercise/cocktail_bar/hand_posture.hpp"

#include <algorithm>
#include <array>
#include <limits>

namespace wholehand {
namespace {

using Eigen::Vector3d;

/// Cosine of the angle between the surface's outward direction and the palmar one, at least.
constexpr double kPalmar = 0.5;
/// Contacts within 60° of each other are on one side. Fingers that press a bottle into the palm do
/// so at 110° and more; a flat hand's contacts are less than a right angle apart.
constexpr double kSameSide = 0.5, kOppositeSide = -0.3;
/// A squeeze counts up to this many times what the weaker of its two sides bears.
constexpr double kWeakerSide = 5.0;

/// Where a digit's link bends to, and where the palm faces. Flexion turns fingers about +y and the
/// thumb about -z of its link; a left hand is the mirror image in y.
Vector3d palmarOf(const Capsule& capsule, Side side) {
  if (capsule.part != HandPart::kThumb) return -Vector3d::UnitZ();
  const Vector3d axis = side == Side::kLeft ? Vector3d::UnitZ() : Vector3d(-Vector3d::UnitZ());
  return axis.cross(capsule.b_m - capsule.a_m).normalized();
}

/// Smallest distance of the segment a b from the upright segment of half length `half_m` about the
/// origin (Ericson, Real-Time Collision Detection, 5.1.9).
double distanceFromUpright(const Vector3d& a, const Vector3d& b, double half_m) noexcept {
  const Vector3d way = b - a;
  const double length2 = way.squaredNorm();
  const double across2 = length2 - way.z() * way.z();  // squared, seen from above
  double along = 0.0;
  if (across2 > 1e-12) along = std::clamp(-a.head<2>().dot(way.head<2>()) / across2, 0.0, 1.0);
  const double z = std::clamp(a.z() + along * way.z(), -half_m, half_m);
  if (length2 > 1e-12) {
    along = std::clamp((Vector3d(0.0, 0.0, z) - a).dot(way) / length2, 0.0, 1.0);
  }
  const Vector3d at = a + along * way;
  return (at - Vector3d(0.0, 0.0, std::clamp(at.z(), -half_m, half_m))).norm();
}

}  // namespace

HandPosture::HandPosture(const HandModel& hand) : hand_(hand), body_(hand_) {
  for (const Capsule& c : hand_.capsules) palmar_.push_back(palmarOf(c, hand_.side));
}

void HandPosture::update(const JointPosition& theta) noexcept {
  known_ = theta.size() == hand_.joint_count && allFinite(theta);
  if (known_) body_.updateKinematics(theta);
}

bool HandPosture::isPalmar(const Contact& contact) const noexcept {
  const auto at = static_cast<std::size_t>(contact.capsule);
  if (!known_ || at >= palmar_.size()) return false;
  const Vector3d palmar = body_.linkPose(hand_.capsules[at].link).rotation * palmar_[at];
  return -contact.normal.eigen().dot(palmar) > kPalmar;
}

double HandPosture::clearance_m(const Vector3d& center_m, double radius_m,
                                double height_m) const noexcept {
  if (!known_) return 0.0;
  double least_m = std::numeric_limits<double>::infinity();
  for (const Capsule& c : hand_.capsules) {
    const Pose& link = body_.linkPose(c.link);
    const double apart_m =
        distanceFromUpright(link * c.a_m - center_m, link * c.b_m - center_m, 0.5 * height_m);
    least_m = std::min(least_m, apart_m - c.radius_m - radius_m);
  }
  return least_m;
}

double gripForce_n(const TickRecord& record, int body, const HandPosture& posture) noexcept {
  std::array<Vector3d, kMaxContacts> normal;
  std::array<double, kMaxContacts> force_n{};
  std::size_t count = 0;
  double sum_n = 0.0;
  for (int i = 0; i < record.contact_count; ++i) {
    const Contact& c = record.contacts[static_cast<std::size_t>(i)];
    if (c.body != body) continue;
    const double bears_n = c.force_n.eigen().dot(c.normal.eigen());
    if (!(bears_n > 0.0) || !posture.isPalmar(c)) continue;
    normal[count] = c.normal.eigen();
    force_n[count++] = bears_n;
    sum_n += bears_n;
  }
  double weaker_n = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    double with_n = 0.0, against_n = 0.0;
    for (std::size_t k = 0; k < count; ++k) {
      const double cosine = normal[i].dot(normal[k]);
      if (cosine > kSameSide) with_n += force_n[k];
      if (cosine < kOppositeSide) against_n += force_n[k];
    }
    weaker_n = std::max(weaker_n, std::min(with_n, against_n));
  }
  return std::min(sum_n, kWeakerSide * weaker_n);
}

}  // namespace wholehand
