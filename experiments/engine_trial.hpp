#pragma once

#include "assembly/models.hpp"
#include "core/expected.hpp"

#include <array>
#include <functional>
#include <string>
#include <vector>

namespace wholehand {

/// The scenes that engines are compared in.
enum class EngineScene {
  kFree,     ///< the motion of a grasp with nothing there
  kFixed,    ///< a hand that closes on a fixed cylinder and presses on
  kHeld,     ///< a free cylinder of 50 mm grasped, carried 20 cm and held
  kResting,  ///< things on a table, the hand away from them
  kCount
};
inline constexpr int kEngineScenes = static_cast<int>(EngineScene::kCount);
[[nodiscard]] const char* engineSceneName(EngineScene scene);

/// CPU time of whole ticks.
struct TickCost {
  double p50_us = 0.0, p999_us = 0.0;
  std::vector<double> times_us;  ///< sorted
};

/// What one engine did. A smaller number is a better one.
struct EngineFigures {
  std::string engine;
  std::array<TickCost, kEngineScenes> cost;
  double penetration_m = 0.0;       ///< deepest overlap with the fixed cylinder, pressed upon
  double virtual_work_error = 0.0;  ///< there: ContactBalance::driveError()
  double felt_error = 0.0;          ///< there: ContactBalance::feltError()
  bool held = false;                ///< the free cylinder
  double slip_m = 0.0;              ///< in the palm, over the hold
  double noise_n = 0.0;             ///< of what is felt, over the hold; worst axis, rms
  double coupling_error_rad = 0.0;  ///< largest that any scene's step left, before correction
  double energy_drift_j = 0.0;      ///< largest change of energy of the things on the table
  bool faulted = false;             ///< a fault stopped one of the scenes
};

struct EngineComparison {
  std::vector<EngineFigures> engines;  ///< the default first
  bool interrupted = false;            ///< by Ctrl-C: the figures are of a part
  /// CPU time of a tick, p50, of the default engine over that of bullet-paper; 0 without one.
  [[nodiscard]] double ratioToPaper(EngineScene scene) const;
};

struct EnginePlan {
  ModelFiles files;          ///< hand, device, rendering, patient
  std::string resting_file;  ///< the scene of what rests
  std::string folder;        ///< for the scene files
  double hold_s = 2.0;       ///< how long the cylinder is held, and things rest
  std::function<void(const char* scene)> status;
};

/// Runs every engine that is built in through every scene on the simulated clock: one tick of each
/// in turn, so that what else the machine does hits all alike.
[[nodiscard]] Expected<EngineComparison> compareEngines(const EnginePlan& plan);

}  // namespace wholehand
