#pragma once

#include <string>

namespace wholehand {

/// `wholehand measures`: prints one line of JSON (replay/recording_measures.hpp). Returns the exit
/// code.
int measuresCommand(const std::string& recording);

}  // namespace wholehand
