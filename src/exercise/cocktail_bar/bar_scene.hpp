#pragma once

#include "exercise/cocktail_bar/bar_parts.hpp"
#include "model/hand_model.hpp"
#include "model/scene_model.hpp"

/// The bodies of a bar. Private to bar_*.cpp.
namespace wholehand {

/// Finds the bodies that the file names and takes their measures; reports what does not fit.
void readBodies(TomlTable& root, const SceneModel& scene, BarParts& parts, Bar& bar);

/// Keeps of the dispensers the level's, in their row, puts the glass under the first one's nozzle
/// (where they are fixed), and fills in body indices and homes. For a left hand reach and places
/// are the mirror image in y. @pre nothing was reported
void keepBodies(const BarParts& parts, Side side, Bar& bar, SceneModel& scene);

}  // namespace wholehand
