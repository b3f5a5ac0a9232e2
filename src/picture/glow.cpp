#include "picture/glow.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

namespace wholehand {
namespace {

using Eigen::Array3f;
using Eigen::Vector3d;

constexpr double kSmallest_m = 0.019, kPerNewton_m = 0.0066, kLargest_m = 0.046;
constexpr double kLeastForce_n = 0.01;

struct Stop {
  float at;
  Array3f color;
  float alpha;
};
// Outwards from the white core.
const std::array<Stop, 5> kHalo{{{0.00F, {1.0F, 1.0F, 1.0F}, 1.00F},
                                 {0.16F, {1.0F, 0.965F, 0.84F}, 0.92F},
                                 {0.34F, {1.0F, 0.74F, 0.28F}, 0.52F},
                                 {0.62F, {1.0F, 0.64F, 0.16F}, 0.16F},
                                 {1.00F, {1.0F, 0.58F, 0.10F}, 0.00F}}};

/// A hidden contact shines through as amber only, at 60 %.
void lay(float radius, bool hidden, Array3f& pixel) {
  for (std::size_t i = 1; i < kHalo.size(); ++i) {
    const Stop &a = kHalo[i - 1], &b = kHalo[i];
    if (radius > b.at) continue;
    const float t = (radius - a.at) / (b.at - a.at);
    const float alpha = (hidden ? 0.6F : 1.0F) * (a.alpha + t * (b.alpha - a.alpha));
    const Array3f color = hidden && i < 3 ? kHalo[2].color : a.color + t * (b.color - a.color);
    pixel += alpha * color * (1.0F - pixel);  // light is added: it never darkens
    return;
  }
}

}  // namespace

std::vector<Ember> embersOf(const std::vector<Contact>& contacts) {
  struct Sum {
    Vector3d point = Vector3d::Zero();
    double weight = 0.0;
    Vector3d force = Vector3d::Zero();
  };
  std::map<std::pair<int, int>, Sum> sums;
  for (const Contact& c : contacts) {
    const Vector3d force = c.force_n.eigen(), point = c.point_m.eigen();
    const double size = force.norm();
    if (!std::isfinite(size) || !point.allFinite() || size < kLeastForce_n) continue;
    Sum& sum = sums[{c.capsule, c.body}];
    sum.point += size * point;
    sum.weight += size;
    sum.force += force;
  }
  std::vector<Ember> embers;
  for (const auto& [pair, sum] : sums) {
    embers.push_back({sum.point / sum.weight, sum.force.norm()});
  }
  return embers;
}

void drawGlow(const std::vector<Ember>& embers, const Diorama& diorama, const Camera& camera,
              Canvas& canvas) {
  for (const Ember& e : embers) {
    const Vector3d at = camera.project(e.point_m);
    if (at.z() <= 0.01) continue;
    const double diameter = std::min(kSmallest_m + kPerNewton_m * e.force_n, kLargest_m);
    const double radius = std::max(1.0, 0.5 * diameter * camera.scale(at.z()));
    const Hit hit = diorama.march(camera.ray(at.x(), at.y()));
    const double distance = (e.point_m - camera.frame().eye_m).norm();
    // A contact is always a little inside the finger that makes it: 4 mm of it count as visible.
    const bool hidden = hit.surface != Surface::kNothing && hit.t_m < distance - 0.004;
    const int top = std::max(0, static_cast<int>(at.y() - radius));
    const int left = std::max(0, static_cast<int>(at.x() - radius));
    const int bottom = static_cast<int>(std::min(at.y() + radius + 1.0, canvas.height_px - 1.0));
    const int right = static_cast<int>(std::min(at.x() + radius + 1.0, canvas.width_px - 1.0));
    for (int y = top; y <= bottom; ++y) {
      for (int x = left; x <= right; ++x) {
        const double r = std::hypot(x + 0.5 - at.x(), y + 0.5 - at.y()) / radius;
        lay(static_cast<float>(r), hidden, canvas.pixel[canvas.index(x, y)]);
      }
    }
  }
}

}  // namespace wholehand
