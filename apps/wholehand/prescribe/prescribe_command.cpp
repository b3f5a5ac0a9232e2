#include "apps/wholehand/prescribe/prescribe_command.hpp"

#include "apps/wholehand/shared/exit_code.hpp"
#include "files/patient/prescription_file.hpp"
#include "files/text/text_file.hpp"
#include "replay/own_movement.hpp"

#include <cstdio>

namespace wholehand {

int prescribeCommand(const PrescribeOptions& options) {
  const auto own = ownMovementOf(options.recordings);
  if (!own) return refuse(own.errors());
  const LimitsFound found = limitsFrom(*own);
  for (const std::string& notice : found.notices)
    std::fprintf(stderr, "note: %s\n", notice.c_str());
  const std::string text =
      prescriptionText(options.name, own->side == Side::kLeft ? "left" : "right", found.limits);
  if (options.output.empty()) {
    std::printf("%s", text.c_str());
    return kExitDone;
  }
  if (auto done = writeText(options.output, text); !done) return refuse(done.errors());
  std::printf(
      "Wrote %s: %zu limits. Narrow or widen them there, then\n"
      "  wholehand run --prescription %s\n",
      options.output.c_str(), found.limits.size(), options.output.c_str());
  return kExitDone;
}

}  // namespace wholehand
