#pragma once

#include <string>

namespace wholehand {

/// `wholehand measures`: prints one line of JSON (replay/recording_measures.hpp). Returns the exit
/// code.
/// @param answers CSV file for the answers of an exercise that compares; empty: none
int measuresCommand(const std::string& recording, const std::string& answers);

}  // namespace wholehand
