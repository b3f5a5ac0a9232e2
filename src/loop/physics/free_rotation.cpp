#include "loop/physics/free_rotation.hpp"

#include <cmath>

namespace wholehand {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr int kMostIterations = 20;  // bound of the fixed-point iteration
constexpr double kExact = 1e-14;     // tolerance of the iteration, relative to the angular velocity

/// The rotation that a constant angular velocity makes in a time.
Quaterniond turnBy(const Vector3d& spin, double seconds) {
  const double rate = spin.norm();
  if (rate * seconds < 1e-12) return Quaterniond::Identity();
  Quaterniond turn;
  turn.w() = std::cos(0.5 * rate * seconds);
  turn.vec() = std::sin(0.5 * rate * seconds) / rate * spin;
  return turn;
}

}  // namespace

FreeRotation turnFree(const FreeRotation& from, const Vector3d& moments, double step_s) noexcept {
  const Eigen::Matrix3d axes = from.axes.toRotationMatrix();
  const Vector3d momentum = axes * moments.cwiseProduct(axes.transpose() * from.spin_rad_s);
  const auto spin_in = [&](const Quaterniond& pose) -> Vector3d {
    const Eigen::Matrix3d turned = pose.toRotationMatrix();
    return turned * (turned.transpose() * momentum).cwiseQuotient(moments);
  };
  Vector3d middle = from.spin_rad_s;
  for (int i = 0; i < kMostIterations; ++i) {
    const Vector3d next = spin_in(turnBy(middle, 0.5 * step_s) * from.axes);
    const bool there = (next - middle).squaredNorm() <= kExact * kExact * next.squaredNorm();
    middle = next;
    if (there) break;
  }
  FreeRotation out;
  out.axes = (turnBy(middle, step_s) * from.axes).normalized();
  out.spin_rad_s = spin_in(out.axes);
  return out;
}

}  // namespace wholehand
