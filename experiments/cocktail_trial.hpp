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
  ModelFiles files;        ///< files including exercise and level
  std::uint64_t seed = 1;  ///< seed of the patient's start pose, aim and strength
  double most_s = 600.0;   ///< limit of the simulated time; a longer trial counts as failed
  std::string record;      ///< HDF5 file; empty: none
  std::vector<std::pair<std::string, double>>
      parameters;  ///< live parameters that differ from the file
  RigOptions rig;
};

/// Result of a trial. The figures are those of the exercise's last record.
struct CocktailResult {
  int level = 1;
  std::uint64_t seed = 1;
  bool ended = false;  ///< the level was played to its end, whatever the result
  /// Every drink of the level was served within tolerance, without a fault.
  bool completed = false;
  double score = 0.0;  ///< 0 .. 100
  double spilt_l = 0.0;
  double amount_error_max_l = 0.0;  ///< largest |poured - requested| of all steps
  int steps = 0;                    ///< completed steps
  int steps_in_tolerance = 0;
  int wrong_dispenser = 0;  ///< number of times a wrong dispenser was engaged
  int knocked_over = 0;
  double volume_error_l = 0.0;  ///< largest |in glasses + spilt + left - initial volume|
  double time_s = 0.0;          ///< simulated
  double step_max_s = 0.0;      ///< longest step, measured from the end of the previous one
  double wall_s = 0.0;
  bool faulted = false;
  bool interrupted = false;
};

/// Plays the level on the simulated clock without opening a port. Returns an error for an exercise
/// without drinks or without a virtual patient, for an unknown parameter, and for a value out of
/// range.
[[nodiscard]] Expected<CocktailResult> runCocktail(const CocktailPlan& plan);

}  // namespace wholehand
