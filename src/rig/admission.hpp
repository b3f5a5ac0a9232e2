#pragma once

#include "rig/models.hpp"
#include "rig/rehearsal.hpp"
#include "rig/rig.hpp"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace wholehand {

/// Result of an admission test of a scene on this machine.
struct Admission {
  bool admitted = false;
  Rehearsal measured;               ///< measurement of the whole scene
  std::vector<std::string> remove;  ///< bodies to remove; empty if admitted, or if no removal helps
  Rehearsal without;                ///< measurement without those bodies
  /// Measurement with the slots of a game's scene filled; empty: the scene has no slots, or its own
  /// bodies already take too long.
  std::optional<PoolRehearsal> pool;
};

/// Maximum number of bodies that the hand visits in one measurement; limits the time for a large
/// scene.
inline constexpr int kAdmissionBodies = 12;

/// Measures the scene's tick in a rehearsal and compares it with the share of the period that
/// arming requires. If the tick takes longer, searches for bodies to remove: first the body touched
/// in the slow ticks, then the fewest moving bodies from the top down, so that no body loses its
/// support. The slots of a game's scene are filled as before arming (rehearsePool()); if that takes
/// too long, the largest number of awake bodies that passes is found. Not real-time safe.
/// @param status called before each measurement with its description; may be null
[[nodiscard]] Expected<Admission> admit(const Models& models, const RigOptions& rig,
                                        const RehearsalOptions& options = {},
                                        const std::function<void(const std::string&)>& status = {});

}  // namespace wholehand
