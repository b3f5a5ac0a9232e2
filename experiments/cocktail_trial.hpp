#pragma once

#include "loop/core/expected.hpp"
#include "rig/rig.hpp"

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace wholehand {

/// One level of the cocktail bar, played by a virtual patient.
struct CocktailPlan {
  ModelFiles files;        ///< with exercise and level
  std::uint64_t seed = 1;  ///< of the patient's start, aim and strength
  double most_s = 600.0;   ///< time limit, simulated; a longer trial has failed
  std::string record;      ///< HDF5 file; empty: none
  std::vector<std::pair<std::string, double>> parameters;  ///< live ones other than the file's
  RigOptions rig;
};

/// Result of a trial. The figures are those of the exercise's last record.
struct CocktailResult {
  int level = 1;
  std::uint64_t seed = 1;
  bool ended = false;      ///< the level was played to its end, with any result
  bool completed = false;  ///< every drink of the level served within tolerance, no fault
  double score = 0.0;      ///< 0 .. 100
  double spilt_l = 0.0;
  double amount_error_max_l = 0.0;  ///< largest |poured - asked| of all steps
  int steps = 0;                    ///< completed steps
  int steps_in_tolerance = 0;
  int wrong_dispenser = 0;  ///< times that a wrong dispenser was engaged
  int knocked_over = 0;
  double volume_error_l = 0.0;  ///< largest |in glasses + spilt + left - start|
  double time_s = 0.0;          ///< simulated
  double step_max_s = 0.0;      ///< longest step, from the end of the one before
  double wall_s = 0.0;
  bool faulted = false;
  bool interrupted = false;
};

/// Plays the level on the simulated clock, without opening a port. Refused for an exercise without
/// drinks or without a virtual patient, and for a parameter that it lacks or a value out of range.
[[nodiscard]] Expected<CocktailResult> runCocktail(const CocktailPlan& plan);

}  // namespace wholehand
