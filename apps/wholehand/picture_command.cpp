#include "picture_command.hpp"

#include "core/printable.hpp"
#include "exit_code.hpp"

#include <cstdio>

namespace wholehand {

int pictureCommand(const PictureOptions& options) {
  auto drawn = drawMoment(options.recording, options.moment, options.png);
  if (!drawn) return refuse(drawn.errors());
  std::printf("%s: %s\n", printable(options.png).c_str(), printable(*drawn).c_str());
  return kExitDone;
}

}  // namespace wholehand
