#pragma once

#include "impedance/impedance_measurement.hpp"

#include <string>

namespace wholehand {

/// Predicts and measures what the person feels, says it as a table, and writes JSON and a Bode plot
/// where asked. Returns the program's exit code: kExitDone where all is as predicted,
/// kExitNotCertified where not, kExitBadInput where the files do not go together.
int impedanceCommand(const Models& models, const ImpedanceOptions& options, const std::string& json,
                     const std::string& charts);

}  // namespace wholehand
