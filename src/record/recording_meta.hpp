#pragma once

#include "loop/core/record_fields.hpp"
#include "record/hdf5_handle.hpp"
#include "record/recording.hpp"

#include <cstddef>
#include <string>
#include <vector>

/// Reads and writes the description of a recording: attributes of /meta and file texts in
/// /meta/files; a packed form is stored in a black box file and in the journal of inputs. Also
/// checks the limits of a file's description at opening and of every tick read. Documented in
/// docs/recording.md. Private to src/record.
namespace wholehand::recording {

inline constexpr const char* kFormat = "wholehand-recording";

/// Writes the description; false when HDF5 refuses a part of it.
[[nodiscard]] bool writeMeta(hid_t file, const RecordingMeta& meta);
/// Reads the description from the group /meta with the identifier `id`. Returns the name of an item
/// that is missing or has another type, or an empty text.
[[nodiscard]] std::string readMeta(hid_t file, hid_t id, RecordingMeta& meta);
/// True when a text of the description has a variable length, as h5py writes texts.
[[nodiscard]] bool hasVariableText(hid_t file);

/// Reason why this meta cannot describe a TickRecord (too many axes, joints, bodies ...), or an
/// empty text.
[[nodiscard]] std::string unusable(const RecordingMeta& meta);
/// False when a number that every reader computes with cannot have been written by a tick: a time
/// that is not finite, an impossible count.
[[nodiscard]] bool isPlausible(const TickRecord& record);
/// Names of the elements of a field with these labels.
[[nodiscard]] const std::vector<std::string>& labelsOf(const RecordingMeta& meta,
                                                       FieldLabels labels);
/// True when isPlausible(), and every array and count of the tick matches the description.
[[nodiscard]] bool fits(const TickRecord& record, const RecordingMeta& meta);

}  // namespace wholehand::recording

namespace wholehand::black_box {

/// Serialises and parses the description of a recording. Parsing returns false when the bytes are
/// damaged.
[[nodiscard]] std::vector<std::byte> packMeta(const RecordingMeta& meta);
[[nodiscard]] bool unpackMeta(const std::byte* in, std::size_t bytes, RecordingMeta& meta);

}  // namespace wholehand::black_box
