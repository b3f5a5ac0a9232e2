#pragma once

#include "clinic/clinic.hpp"

#include <functional>
#include <string>

namespace wholehand::clinic {

/// Measures by the child `PROGRAM measures FILE`, at the lowest priority, 120 s at most.
/// @param stop ends the child early; any thread
[[nodiscard]] Measure measureByChild(std::string program, std::function<bool()> stop);

/// Forgets every trial and measures the folder's recordings again; visits stay as they are.
/// @return what was found, one sentence
[[nodiscard]] Expected<std::string> rebuildTrials(const std::string& folder,
                                                  const std::string& recordings,
                                                  const Measure& measure);

}  // namespace wholehand::clinic
