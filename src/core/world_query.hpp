#pragma once

#include "core/geometry.hpp"

#include <array>
#include <cstdint>

namespace wholehand {

/// What an exercise wants to know of the world before the next tick.
struct WorldQuery {
  std::uint32_t targets = 0;  ///< bit b: body b counts for palm_body and palm_target_distance_m
  std::int32_t closure_body = -1;  ///< axes are closed on to this body; -1: not asked
};

/// Where a body is put before the step, at rest or moving: a fixed body that the exercise slides, a
/// free one that is stood up again.
struct BodyPlacement {
  std::int32_t body = -1;
  std::int32_t reserved = 0;
  Vec3 position_m;  ///< of its centre of mass, as in BodyState
  QuatXyzw orientation_xyzw;
  Vec3 velocity_m_s;
};

/// The most bodies that are placed in one tick.
inline constexpr int kMaxPlacements = 8;

struct BodyPlacements {
  std::int32_t count = 0;
  std::int32_t reserved = 0;
  std::array<BodyPlacement, kMaxPlacements> items{};
};

}  // namespace wholehand
