#pragma once

#include "assembly/models.hpp"
#include "assembly/run.hpp"
#include "run_options.hpp"
#include "summary_json.hpp"

#include <string>

namespace wholehand {

/// "cocktail-bar, level 1 of 4"; "Four shapes, reach-grasp-00"
[[nodiscard]] std::string titleOf(const Models& models);

/// Prints what is about to run: device, patient, hand, scene.
void printOpening(const Models& models, bool real_device = false);

/// Prints the results, and the files written.
void printSummary(const RunOptions& options, const Models& models, const RunOutcome& outcome,
                  const RunSafety& safety);

}  // namespace wholehand
