#pragma once

#include "assembly/rig.hpp"
#include "core/expected.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace wholehand {

/// A level of the cocktail bar, played once by a virtual patient.
struct CocktailPlan {
  ModelFiles files;        ///< with exercise and level
  std::uint64_t seed = 1;  ///< of the patient's start, aim and strength
  double most_s = 600.0;   ///< simulated; not completed by then: failed
  std::string record;      ///< HDF5 file; empty: none
  RigOptions rig;
};

/// How it went. The figures are those of the exercise's last record.
struct CocktailResult {
  int level = 1;
  std::uint64_t seed = 1;
  bool ended = false;      ///< the level was played to its end, however well
  bool completed = false;  ///< every drink of the level served within tolerance, no fault
  double score = 0.0;      ///< 0 .. 100
  double spilt_l = 0.0;
  double amount_error_max_l = 0.0;  ///< of all steps: |poured - asked|
  int steps = 0;                    ///< that were done
  int steps_in_tolerance = 0;
  int wrong_dispenser = 0;  ///< times that another one was engaged
  int knocked_over = 0;
  double volume_error_l = 0.0;  ///< largest |in glasses + spilt + left - start|
  double time_s = 0.0;          ///< simulated
  double wall_s = 0.0;
  bool faulted = false;
  bool interrupted = false;
};

/// Plays it on the simulated clock, without any port. Refused where the exercise is not one with
/// drinks, or has no virtual patient.
[[nodiscard]] Expected<CocktailResult> runCocktail(const CocktailPlan& plan);

}  // namespace wholehand
