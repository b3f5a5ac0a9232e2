#pragma once

#include "telemetry/hdf5_handle.hpp"
#include "telemetry/recording.hpp"

/// The description of a recording in its file: attributes of /meta, texts of the files in
/// /meta/files. Told to people in docs/recording.md. Private to telemetry.
namespace wholehand::recording {

inline constexpr const char* kFormat = "wholehand-recording";

/// False where HDF5 refuses a part of it.
[[nodiscard]] bool writeMeta(hid_t file, const RecordingMeta& meta);
/// @param id the group /meta @param meta its schema is known
/// False where something is missing that a file of that schema has.
[[nodiscard]] bool readMeta(hid_t file, hid_t id, RecordingMeta& meta);

}  // namespace wholehand::recording
