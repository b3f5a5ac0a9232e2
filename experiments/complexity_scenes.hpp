#pragma once

#include "loop/patient/motion.hpp"
#include "rig/models.hpp"

namespace wholehand {

/// Kinds of scenes of increasing complexity. Each states what increases.
enum class ComplexityKind {
  kPile,      ///< balls piled in a tray, with the hand among them
  kStacks,    ///< boxes in stacks of four, side by side, with the hand on top
  kApart,     ///< separate boxes on a table below the hand
  kFar,       ///< separate boxes one metre beyond the hand's reach
  kVertices,  ///< corners of the single mesh that the hand presses on
  kContacts,  ///< small fixed balls that the hand lies on
  kCount
};
inline constexpr int kComplexityKinds = static_cast<int>(ComplexityKind::kCount);
/// Name of a kind, such as "pile", used in JSON and in the names of sentences.
[[nodiscard]] const char* complexityName(ComplexityKind kind);

/// Motion of the hand: it comes down, presses, and sways there until the end.
[[nodiscard]] Intention swayingHand(const DeviceModel& device, double duration_s);

/// A scene with `count` elements of the kind at the place where the hand comes down. @pre device
/// and hand are loaded
[[nodiscard]] Expected<SceneModel> complexityScene(ComplexityKind kind, int count,
                                                   const Models& models);

}  // namespace wholehand
