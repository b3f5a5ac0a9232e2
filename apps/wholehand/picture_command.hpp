#pragma once

#include <string>

namespace wholehand {

struct PictureOptions {
  std::string recording;
  std::string png;
  double time_s = -1.0;  ///< negative: where the contact force is largest
  double azimuth_deg = 50.0, elevation_deg = 20.0, distance_m = 0.6;
};

/// Draws one moment of a recording. Returns the program's exit code.
int pictureCommand(const PictureOptions& options);

}  // namespace wholehand
