#pragma once

#include "exercise/cocktail_bar/bar_parts.hpp"
#include "model/hand/hand_model.hpp"
#include "model/scene/scene_model.hpp"

/// Bodies of a bar. Private to bar_*.cpp.
namespace wholehand {

/// Finds the bodies that the file names and takes their dimensions; reports those that do not fit.
void readBodies(TomlTable& root, const SceneModel& scene, BarParts& parts, Bar& bar);

/// Keeps only the level's dispensers, in row order, puts the glass under the first nozzle (for
/// fixed dispensers), and sets body indices and initial places. For a left hand reach and places
/// are mirrored in y. @pre no faults were reported
void keepBodies(const BarParts& parts, Side side, Bar& bar, SceneModel& scene);

}  // namespace wholehand
