#pragma once

#include "lab/stiffness_trial.hpp"
#include "loop/core/expected.hpp"
#include "rig/models.hpp"

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace wholehand {

/// Scenes for comparing engines.
enum class EngineScene {
  kFree,     ///< a grasp's motion without bodies
  kFixed,    ///< a hand that closes on a fixed cylinder and keeps pressing
  kHeld,     ///< a free cylinder of 50 mm that is grasped, carried 20 cm and held
  kResting,  ///< bodies that rest on a table away from the hand
  kGripped,  ///< the free cylinder, gripped while every joint moves: the paper's Fig. 6
  kCount
};
inline constexpr int kEngineScenes = static_cast<int>(EngineScene::kCount);
[[nodiscard]] const char* engineSceneName(EngineScene scene);

/// CPU time of complete ticks.
struct TickCost {
  double p50_us = 0.0, p999_us = 0.0;
  std::vector<double> times_us;  ///< sorted
};

/// Results of one engine. Smaller is better.
struct EngineFigures {
  std::string engine;
  std::array<TickCost, kEngineScenes> cost;
  double penetration_m = 0.0;       ///< kFixed: deepest overlap with the pressed cylinder
  double virtual_work_error = 0.0;  ///< kFixed: ContactBalance::driveError()
  double felt_error = 0.0;          ///< kFixed: ContactBalance::feltError()
  double gripped = 0.0;  ///< share of the ticks of kGripped with more than 1 N on the cylinder
  bool held = false;     ///< the free cylinder was held
  double slip_m = 0.0;   ///< slip in the palm during the hold
  double noise_n = 0.0;  ///< rms of the rendered effort during the hold, worst axis
  double coupling_error_rad = 0.0;  ///< largest error before correction, over all steps and scenes
  double energy_drift_j = 0.0;      ///< largest energy change of the bodies on the table
  bool faulted = false;             ///< a fault stopped one of the scenes
  StableStiffness stiffness;        ///< only for engines that allow persons
};

struct EngineComparison {
  std::vector<EngineFigures> engines;  ///< the default first
  bool interrupted = false;            ///< interrupted by Ctrl-C: the results are partial
  double rate_hz = 1000.0;
  /// CPU time of a tick (p50) of the default engine divided by that of bullet-paper; 0 without
  /// bullet-paper.
  [[nodiscard]] double ratioToPaper(EngineScene scene) const;
};

struct EnginePlan {
  ModelFiles files;                      ///< hand, device, rendering, patient
  std::string resting_file;              ///< scene of resting bodies
  std::string folder;                    ///< folder for the scene files
  double hold_s = 2.0;                   ///< duration of holding and of resting
  double rate_hz = 1000.0;               ///< tick rate
  std::uint64_t gripped_ticks = 100000;  ///< number of ticks in kGripped
  std::function<void(const char* scene)> status;
};

/// Runs every built-in engine through every scene on the simulated clock. The engines take turns
/// tick by tick, so that other load affects all equally. Then searches the largest stable stiffness
/// of each engine that allows persons.
[[nodiscard]] Expected<EngineComparison> compareEngines(const EnginePlan& plan);

}  // namespace wholehand
