#pragma once

#include "loop/core/geometry.hpp"

#include <array>
#include <bitset>
#include <cstdint>

namespace wholehand {

/// Largest number of bodies in a record, fixed ones included: the first bodies of the scene.
inline constexpr int kMaxBodies = 128;
/// Largest number of bodies in a scene. Bodies beyond kMaxBodies are simulated, but not recorded.
inline constexpr int kMaxSceneBodies = 1024;

/// Set of recorded bodies, one bit each.
using BodySet = std::bitset<kMaxBodies>;

/// What an exercise asks the world to measure in the next tick.
struct WorldQuery {
  BodySet targets;                 ///< bodies considered for palm_body and palm_target_distance_m
  std::int32_t closure_body = -1;  ///< body on which the closure is computed; -1: none
};

/// Pose and velocity that an exercise gives to a body before the step: a fixed body that slides, or
/// a free body that is put upright.
struct BodyPlacement {
  std::int32_t body = -1;
  std::int32_t reserved = 0;
  Vec3 position_m;  ///< centre of mass, as in BodyState
  QuatXyzw orientation_xyzw;
  Vec3 velocity_m_s;
};

/// Largest number of bodies placed in one tick.
inline constexpr int kMaxPlacements = 8;

struct BodyPlacements {
  std::int32_t count = 0;
  std::int32_t reserved = 0;
  std::array<BodyPlacement, kMaxPlacements> items{};
};

}  // namespace wholehand
