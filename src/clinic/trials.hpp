#pragma once

#include "clinic/clinic.hpp"

#include <functional>
#include <string>

namespace wholehand::clinic {

/// Measures by the child `PROGRAM measures FILE`, at the lowest priority, 120 s at most.
/// @param stop ends the child early; any thread
[[nodiscard]] Measure measureByChild(std::string program, std::function<bool()> stop);

/// Measures the folder's recordings again. Visits stay as they are, and so do the results of
/// recordings that are gone.
/// @return what was found, one sentence
[[nodiscard]] Expected<std::string> rebuildTrials(const std::string& folder,
                                                  const std::string& recordings,
                                                  const Measure& measure);

}  // namespace wholehand::clinic
