#pragma once

#include "loop/core/expected.hpp"

#include <array>
#include <map>
#include <string>
#include <vector>

namespace wholehand::clinic {

using Parameters = std::map<std::string, double>;  ///< live parameters, in their own unit

/// One entry of a plan.
struct PlanItem {
  std::string exercise;
  int level = 1;
  double minutes = 10.0;
  std::string help = "some";  ///< "full", "some", "none"
  Parameters parameters;      ///< in addition to the person's own
};
using Plan = std::vector<PlanItem>;

struct ForcePreset {
  std::string id;
  Parameters parameters;
};
struct PlanPreset {
  std::string id;
  Plan items;
};
struct ExerciseFacts {
  std::string id;
  int levels = 1;
  std::vector<std::string> parameters;  ///< parameters of this exercise, without the device's
};

/// config/clinic/presets.toml. Immutable.
struct Presets {
  std::string path;
  std::vector<ForcePreset> force;  ///< from the gentlest on
  std::vector<PlanPreset> plans;
  std::vector<PlanPreset> goals;  ///< what shall become easier, and the items that train it
  int course_weeks = 6, course_visits_a_week = 3;
  std::vector<ExerciseFacts> exercises;
  std::map<std::string, std::array<double, 2>> bounds;  ///< bounds of every parameter that may be
                                                        ///< set
  std::vector<std::string> device;                      ///< parameters that every exercise has
  std::vector<std::string> limits;                      ///< those of them that bound efforts

  [[nodiscard]] const ForcePreset* forceOf(const std::string& id) const;
  [[nodiscard]] const ExerciseFacts* exercise(const std::string& id) const;
};
[[nodiscard]] Expected<Presets> loadPresets(const std::string& path);

/// A hand that ships with the program.
struct ShippedHand {
  std::string name, side;
  double length_m = 0.0, breadth_m = 0.0;
};
[[nodiscard]] Expected<std::vector<ShippedHand>> loadShippedHands(const std::string& folder);
/// Name of the shipped hand of this size, within 0.5 mm of length and breadth; empty: none.
[[nodiscard]] std::string shippedHand(const std::vector<ShippedHand>& hands,
                                      const std::string& side, double length_m, double breadth_m);
/// Writes a hand file of any size with the joints, couplings and self contacts of the median hand.
/// @param folder folder of the shipped hands  @param name also the file name, without .toml
[[nodiscard]] Expected<Done> writeHandFile(const std::string& folder, const std::string& path,
                                           const std::string& name, const std::string& side,
                                           double length_m, double breadth_m);

}  // namespace wholehand::clinic
