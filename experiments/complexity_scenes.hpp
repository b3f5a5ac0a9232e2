#pragma once

#include "loop/patient/motion.hpp"
#include "rig/models.hpp"

namespace wholehand {

/// What a scene has more and more of.
enum class ComplexityKind {
  kPile,      ///< balls that lie on one another in a tray, the hand in their midst
  kStacks,    ///< boxes in stacks of four, side by side, the hand on top
  kApart,     ///< boxes that rest apart on a table, below the hand
  kFar,       ///< the same, a metre beyond its reach
  kVertices,  ///< corners of the one mesh that the hand presses upon
  kContacts,  ///< small fixed balls that the hand lies on
  kCount
};
inline constexpr int kComplexityKinds = static_cast<int>(ComplexityKind::kCount);
/// "pile", as in JSON and in the names of sentences.
[[nodiscard]] const char* complexityName(ComplexityKind kind);

/// The hand comes down from here, presses, and sways there until the end.
[[nodiscard]] Intention swayingHand(const DeviceModel& device, double duration_s);

/// A scene with so many of them where the hand will come. @pre device and hand are loaded
[[nodiscard]] Expected<SceneModel> complexityScene(ComplexityKind kind, int count,
                                                   const Models& models);

}  // namespace wholehand
