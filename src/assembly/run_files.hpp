#pragma once

#include "assembly/rig.hpp"
#include "telemetry/black_box.hpp"
#include "telemetry/recording.hpp"

#include <cstdint>
#include <memory>
#include <string>

namespace wholehand {

/// Name of the device passport within a recording.
inline constexpr const char* kRecordedPassport = "passport/passport.toml";

/// Adds the device's axes, but for armed_position.
void describeAxes(const DeviceModel& device, RecordingMeta& meta);

/// Metadata of a recording of this rig.
[[nodiscard]] Expected<RecordingMeta> describeRecording(const Rig& rig, const std::string& title,
                                                        std::uint64_t seed, bool simulated_clock);

/// Path of a run's black box: beside its recording ("run.h5" → "run.wbb"); without one
/// out/blackbox/<time>-<8 random digits>.wbb, or the folder for temporary files if the working
/// directory is not writable.
[[nodiscard]] std::string blackBoxPath(const std::string& recording);

/// Arms the black box of an armed rig.
[[nodiscard]] Expected<std::unique_ptr<BlackBox>> armBlackBox(const Rig& rig,
                                                              const RecordingMeta& meta,
                                                              const std::string& path,
                                                              std::uint64_t most_ticks);

/// Writes the box after a stopping fault or an emergency stop. Returns one line about it, or
/// nothing where it was not needed. Call after the run.
[[nodiscard]] std::string writeBlackBoxIfNeeded(BlackBox& box);

}  // namespace wholehand
