#pragma once

#include "telemetry/hdf5_handle.hpp"
#include "telemetry/recording.hpp"

#include <string>

/// Description of a recording in its file: attributes of /meta, file texts in /meta/files.
/// Documented in docs/recording.md. Private to telemetry.
namespace wholehand::recording {

inline constexpr const char* kFormat = "wholehand-recording";

/// Writes the description; false when HDF5 refuses a part of it.
[[nodiscard]] bool writeMeta(hid_t file, const RecordingMeta& meta);
/// Reads the description from the group /meta, `id`. Returns what is missing or of another type, or
/// an empty text.
[[nodiscard]] std::string readMeta(hid_t file, hid_t id, RecordingMeta& meta);
/// True where a text of the description has a variable length, as h5py writes them.
[[nodiscard]] bool hasVariableText(hid_t file);

}  // namespace wholehand::recording
