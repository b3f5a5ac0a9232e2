#pragma once

#include "files/hand/hand_file.hpp"
#include "files/toml/toml_file.hpp"
#include "loop/core/expected.hpp"

namespace wholehand {

/// Reads `[self_contacts]`: each key is a capsule, its value lists the capsules that it may touch.
/// Unknown names, a capsule paired with itself and repeated pairs are faults of the file.
void readSelfContacts(TomlTable& root, HandFile& hand);

/// Faults of pairs that are impossible with any device that drives all coordinates of [synergy]:
/// both capsules on one rigid link, or overlapping in the reference posture. @pre every joint is
/// present
[[nodiscard]] Diagnostics checkSelfContacts(const HandFile& hand);

/// Adds the pairs with relative motion to a hand assembled for a device. Reports each pair that
/// overlaps in the device's reference posture.
void addSelfContacts(const HandFile& hand, HandModel& model, Diagnostics& faults);

}  // namespace wholehand
