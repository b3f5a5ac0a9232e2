#include "apps/wholehand/measures/measures_command.hpp"

#include "apps/wholehand/shared/exit_code.hpp"
#include "files/text/text_file.hpp"
#include "replay/compared_answers.hpp"
#include "replay/recording_measures.hpp"

#include <nlohmann/json.hpp>

#include <cstdio>

namespace wholehand {

int measuresCommand(const std::string& recording, const std::string& answers) {
  const auto measures = recordingMeasures(recording);
  if (!measures) return refuse(measures.errors());
  if (!answers.empty()) {
    if (auto done = writeText(answers, comparedCsv((*measures)["compared"])); !done) {
      return refuse(done.errors());
    }
  }
  std::printf("%s\n", measures->dump().c_str());
  return kExitDone;
}

}  // namespace wholehand
