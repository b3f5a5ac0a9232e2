#pragma once

#include "moment_picture.hpp"

#include <string>

namespace wholehand {

struct PictureOptions {
  std::string recording;
  std::string png;
  Moment moment;
};

/// Draws one moment of a recording. Returns the program's exit code.
int pictureCommand(const PictureOptions& options);

}  // namespace wholehand
