#pragma once

#include <string>

namespace wholehand {

/// `wholehand measures`: prints one line of JSON (replay/therapy_facts.hpp). Returns the exit
/// code.
int measuresCommand(const std::string& recording);

}  // namespace wholehand
