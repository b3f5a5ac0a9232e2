#pragma once

#include "files/patient/prescription_file.hpp"
#include "loop/core/expected.hpp"
#include "loop/model/device_model.hpp"
#include "loop/model/hand_model.hpp"

#include <optional>
#include <string>
#include <vector>

namespace wholehand {

/// An end of a person's own movement, from a recording of an exercise of the kind own_range.
struct OwnMovementEnd {
  int axis = 0;        ///< index into DeviceModel::axes
  bool upper = false;  ///< which end of the axis
  double value = 0.0;  ///< [m or rad]
};

/// Own movement of one person, with the device and the side of the hand that measured it.
struct OwnMovement {
  DeviceModel device;
  Side side = Side::kRight;
  std::vector<OwnMovementEnd> ends;
};

/// Reads recordings of one person, device and side, in time order: a later value replaces an
/// earlier one. Refuses a recording that measured nothing. Not real-time safe.
[[nodiscard]] Expected<OwnMovement> ownMovementOf(const std::vector<std::string>& recordings);

/// Limits at the ends of own movement, and what was left out: one sentence each.
struct LimitsFound {
  std::vector<LimitText> limits;
  std::vector<std::string> notices;
};

/// An end that was not measured stays the device's; an axis whose own range is
/// narrower than its walls gets no limit.
[[nodiscard]] LimitsFound limitsFrom(const OwnMovement& own);

}  // namespace wholehand
