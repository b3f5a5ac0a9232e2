#pragma once

#include "rig/impedance/impedance_measurement.hpp"

#include <string>

namespace wholehand {

/// Predicts and measures the felt impedance, prints it as a table, and writes JSON and a Bode plot
/// on request. Returns the exit code: kExitDone if the measurement agrees with the prediction,
/// kExitNotCertified if not, kExitBadInput for incompatible files.
int impedanceCommand(const Models& models, const ImpedanceOptions& options, const std::string& json,
                     const std::string& charts);

}  // namespace wholehand
