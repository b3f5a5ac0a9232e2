#pragma once

#include "apps/wholehand/run/run_command.hpp"
#include "loop/model/device_model.hpp"
#include "rig/models.hpp"
#include "rig/rehearsal.hpp"
#include "rig/run/run.hpp"
#include "rig/safety_log.hpp"

#include <nlohmann/json.hpp>

#include <optional>
#include <string>
#include <vector>

namespace wholehand {

/// Safety events of a run.
struct RunSafety {
  std::vector<SafetyTransition> transitions;
  std::optional<Rehearsal> rehearsal;  ///< none on the simulated clock
};

/// Title of a run: "cocktail-bar, level 1 of 4"; "Four shapes, reach-grasp-00".
[[nodiscard]] std::string titleOf(const Models& models);

/// Prints the models before a run: device, patient, hand, scene, prescription.
void printOpening(const Models& models, bool real_device = false);

/// Prints the results, and the files written.
void printSummary(const RunOptions& options, const Models& models, const RunOutcome& outcome,
                  const RunSafety& safety);

/// Percentiles as {"p50":..,"p99":..,"p999":..,"max":..} in microseconds.
[[nodiscard]] nlohmann::ordered_json microseconds(const Percentiles& p);

/// JSON of `run --json`; efforts in the axis's unit.
[[nodiscard]] nlohmann::ordered_json summaryJson(const DeviceModel& device,
                                                 const RunOutcome& outcome,
                                                 const RunSafety& safety);

}  // namespace wholehand
