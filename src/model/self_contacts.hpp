#pragma once

#include "core/expected.hpp"
#include "model/hand_file.hpp"
#include "model/toml/toml_file.hpp"

namespace wholehand {

/// `[self_contacts]`: capsule = the capsules that stop it. Names that are none, a capsule against
/// itself and a pair that is listed twice are faults of the file.
void readSelfContacts(TomlTable& root, HandFile& hand);

/// The pairs of the file that no hand can have: of one rigid link, or overlapping in the reference
/// posture, when every coordinate of [synergy] is driven. @pre every joint is there
[[nodiscard]] Diagnostics checkSelfContacts(const HandFile& hand);

/// Gives an assembled hand the pairs that move against each other with its device. A fault for each
/// that overlaps in the reference posture which that device allows.
void addSelfContacts(const HandFile& hand, HandModel& model, Diagnostics& faults);

}  // namespace wholehand
