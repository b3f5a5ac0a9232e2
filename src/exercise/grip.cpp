#include "exercise/grip.hpp"

#include <algorithm>
#include <array>

namespace wholehand {
namespace {

using Eigen::Vector3d;

/// Contacts within 60° are on the same side, contacts beyond about 107° on opposite sides. Fingers
/// that press a bottle into the palm are at 110° and more; contacts of a flat hand are less than
/// 90° apart.
constexpr double kSameSide = 0.5, kOppositeSide = -0.3;
/// Largest squeeze over the force of its weaker side.
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

}  // namespace

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
    for (int a = 0; a < walls.axes; ++a) {
      on_axis[a] += posture.opposes(a, c.capsule, c.point_m.eigen(), c.force_n.eigen());
    }
  });
  double sum_n = 0.0;
  for (int a = 0; a < walls.axes; ++a) {
    if (!(walls.stiffness[a] > 0.0) && !(walls.damping[a] > 0.0)) continue;
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
