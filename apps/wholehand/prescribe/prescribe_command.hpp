#pragma once

#include <string>
#include <vector>

namespace wholehand {

struct PrescribeOptions {
  std::vector<std::string> recordings;  ///< of the exercise own-range, in time order
  std::string name = "person";          ///< code of the person
  std::string output;                   ///< file to be written; empty: standard output
};

/// `wholehand prescribe`: makes a prescription whose limits are the ends of a person's own
/// movement. Returns the exit code.
int prescribeCommand(const PrescribeOptions& options);

}  // namespace wholehand
