#pragma once

#include "loop/core/tick_record.hpp"
#include "record/hdf5_handle.hpp"
#include "record/recording.hpp"

#include <cstddef>
#include <string>
#include <vector>

/// Description of a recording in its file: attributes of /meta, file texts in /meta/files; packed
/// in a black box and beside its inputs. And the limits of a file's description and ticks, checked
/// when it is opened and for every tick read. Documented in docs/recording.md. Private to
/// telemetry.
namespace wholehand::recording {

inline constexpr const char* kFormat = "wholehand-recording";

/// Writes the description; false when HDF5 refuses a part of it.
[[nodiscard]] bool writeMeta(hid_t file, const RecordingMeta& meta);
/// Reads the description from the group /meta, `id`. Returns what is missing or of another type, or
/// an empty text.
[[nodiscard]] std::string readMeta(hid_t file, hid_t id, RecordingMeta& meta);
/// True where a text of the description has a variable length, as h5py writes them.
[[nodiscard]] bool hasVariableText(hid_t file);

/// Reason why this meta cannot describe a TickRecord (too many axes, joints, bodies ...), or an
/// empty text.
[[nodiscard]] std::string unusable(const RecordingMeta& meta);
/// False when a number that every reader computes with cannot have been written by a tick: a time
/// that is not finite, an impossible count.
[[nodiscard]] bool isPlausible(const TickRecord& record);
/// True when isPlausible(), and every array and count of the tick matches the description.
[[nodiscard]] bool fits(const TickRecord& record, const RecordingMeta& meta);

}  // namespace wholehand::recording

namespace wholehand::black_box {

/// Serialises a recording's meta, and parses it. False when damaged.
[[nodiscard]] std::vector<std::byte> packMeta(const RecordingMeta& meta);
[[nodiscard]] bool unpackMeta(const std::byte* in, std::size_t bytes, RecordingMeta& meta);

}  // namespace wholehand::black_box
