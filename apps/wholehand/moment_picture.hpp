#pragma once

#include "core/expected.hpp"
#include "telemetry/recording.hpp"

#include <string>

namespace wholehand {

/// Which moment of a recording to draw, and from where.
struct Moment {
  double time_s = -1.0;  ///< negative: where the contact force is largest
  double azimuth_deg = 50.0, elevation_deg = 20.0, distance_m = 0.6;
};

/// Draws the hand and the bodies of one tick into a PNG; says in words what it shows.
/// @param meta of the recording; its files are the hand and the scene
[[nodiscard]] Expected<std::string> drawTick(const RecordingMeta& meta, const TickRecord& record,
                                             const std::string& recording_path,
                                             const Moment& moment, const std::string& png_path);

/// The same of a moment that is looked for in the recording.
[[nodiscard]] Expected<std::string> drawMoment(const std::string& recording_path,
                                               const Moment& moment, const std::string& png_path);

}  // namespace wholehand
