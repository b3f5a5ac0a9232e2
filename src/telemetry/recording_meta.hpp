#pragma once

#include "telemetry/hdf5_handle.hpp"
#include "telemetry/recording.hpp"

/// Description of a recording in its file: attributes of /meta, file texts in /meta/files.
/// Documented in docs/recording.md. Private to telemetry.
namespace wholehand::recording {

inline constexpr const char* kFormat = "wholehand-recording";

/// Writes the description; false when HDF5 refuses a part of it.
[[nodiscard]] bool writeMeta(hid_t file, const RecordingMeta& meta);
/// Reads the description; false when something is missing that its schema requires.
/// @param id the group /meta @param meta with its schema set
[[nodiscard]] bool readMeta(hid_t file, hid_t id, RecordingMeta& meta);

}  // namespace wholehand::recording
