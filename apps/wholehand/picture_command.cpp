#include "picture_command.hpp"

#include "exit_code.hpp"

#include <cstdio>

namespace wholehand {

int pictureCommand(const PictureOptions& options) {
  auto drawn = drawMoment(options.recording, options.moment, options.png);
  if (!drawn) return refuse(drawn.errors());
  std::printf("%s: %s\n", options.png.c_str(), drawn->c_str());
  return kExitDone;
}

}  // namespace wholehand
