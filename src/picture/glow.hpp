#pragma once

#include "core/tick_record.hpp"
#include "picture/camera.hpp"
#include "picture/studio.hpp"

#include <vector>

namespace wholehand {

/// A picture in sRGB 0 .. 1, rows from the top.
struct Canvas {
  int width_px = 0, height_px = 0;
  std::vector<Eigen::Array3f> pixel;

  [[nodiscard]] std::size_t index(int x, int y) const noexcept {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_px) +
           static_cast<std::size_t>(x);
  }
};

/// The contacts of one tick as light: the points of one capsule on one body glow together, at their
/// middle weighted by force. Contacts that carry nothing, or are not finite, do not glow.
[[nodiscard]] std::vector<Ember> embersOf(const std::vector<Contact>& contacts);

/// Lays a soft amber disc with a white core over each contact; its size follows the force, and it
/// shows through what hides it at 60 %.
void drawGlow(const std::vector<Ember>& embers, const Diorama& diorama, const Camera& camera,
              Canvas& canvas);

}  // namespace wholehand
