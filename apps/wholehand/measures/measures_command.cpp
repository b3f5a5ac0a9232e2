#include "apps/wholehand/measures/measures_command.hpp"

#include "apps/wholehand/shared/exit_code.hpp"
#include "replay/therapy_facts.hpp"

#include <nlohmann/json.hpp>

#include <cstdio>

namespace wholehand {

int measuresCommand(const std::string& recording) {
  const auto measures = recordingMeasures(recording);
  if (!measures) return refuse(measures.errors());
  std::printf("%s\n", measures->dump().c_str());
  return kExitDone;
}

}  // namespace wholehand
