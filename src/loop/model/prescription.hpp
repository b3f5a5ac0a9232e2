#pragma once

#include "loop/core/geometry.hpp"
#include "loop/model/hand_model.hpp"

#include <optional>
#include <string>
#include <vector>

namespace wholehand {

/// Width of the wall at an end of a person's range.
inline constexpr double kLimitBand_m = 0.010, kLimitBand_rad = 5.0 * kDeg;

/// What a therapist allows one person: a file of kind "prescription" (docs/prescription.md). It
/// only resists and narrows; nothing in it moves a hand.
struct Prescription {
  /// The part of an axis's range that is the person's. Its ends are walls.
  struct Limit {
    int axis = 0;  ///< index into DeviceModel::axes
    double lower = 0.0, upper = 0.0;

    bool operator==(const Limit&) const = default;
  };
  /// Resistance beside the straight way to a movement's goal.
  struct Corridor {
    double radius_m = 0.0;
    double stiffness_n_m = 0.0;

    bool operator==(const Corridor&) const = default;
  };
  /// Difficulty that adapts (loop/psychometrics/difficulty.hpp).
  struct Difficulty {
    double aim = 0.7;  ///< wanted share of successes
    double lower = 0.0, upper = 1.0;

    bool operator==(const Difficulty&) const = default;
  };

  std::string path;
  std::string name;  ///< a code, never a person's name
  Side side = Side::kRight;
  std::vector<Limit> limits;
  std::optional<Corridor> corridor;
  std::optional<Difficulty> difficulty;

  /// True when both allow the same, whatever their files.
  [[nodiscard]] bool sameAs(const Prescription& other) const {
    return side == other.side && limits == other.limits && corridor == other.corridor &&
           difficulty == other.difficulty;
  }
};

}  // namespace wholehand
