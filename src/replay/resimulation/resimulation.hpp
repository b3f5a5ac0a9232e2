#pragma once

#include "loop/core/tick_record.hpp"
#include "record/black_box_reader.hpp"
#include "record/input_log.hpp"
#include "record/recording.hpp"
#include "rig/models.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace wholehand {

/// Models from the files that a recording contains. Errors name the recording and the file in it.
[[nodiscard]] Expected<Models> recordedModels(const RecordingMeta& meta,
                                              const std::string& recording_path);

/// Device models at the worst corners of the recording's passport
/// (devices/passport/passport.hpp); none without a passport.
[[nodiscard]] Expected<std::vector<DeviceModel>> recordedCorners(const RecordingMeta& meta,
                                                                 const DeviceModel& device,
                                                                 const std::string& recording_path);

/// A dataset in which two ticks differ.
struct TickDifference {
  std::string column;  ///< "coupling", "contacts/force_n"
  int place = 0;       ///< position of the first difference: an axis, or an index through all rows
  int numbers = 0;     ///< count of different numbers; 0: the two have different lengths
  double recorded = 0.0, again = 0.0;  ///< the first two numbers that differ, or the counts
};

/// Compares the recorded tick with the re-simulated one, column by column.
/// @param exact bit by bit; else in the precision of a recording: single, or double for the columns
/// that it keeps in double
[[nodiscard]] std::vector<TickDifference> differences(const TickRecord& recorded,
                                                      const TickRecord& again, bool exact);

/// Describes a difference: "coupling of thumb_flexion: recorded 1.25, now 1.5, 0.25 more".
[[nodiscard]] std::string describe(const TickDifference& difference,
                                   const std::vector<std::string>& axis_names);

/// Result of a re-simulation.
struct Resimulation {
  std::uint64_t ticks = 0;     ///< ticks run again
  std::uint64_t compared = 0;  ///< ticks of these that were compared with the recording
  /// First tick that differs in a bit: in its digest, or in a number of a black box file.
  std::optional<std::uint64_t> different_tick;
  /// First tick from different_tick on in which recorded numbers differ, and these differences. A
  /// digest also shows differences below single precision.
  std::uint64_t visible_tick = 0;
  std::vector<TickDifference> visible;

  [[nodiscard]] bool same() const noexcept { return !different_tick && visible.empty(); }
};

/// Runs the recorded inputs (positions, skipped periods, device faults, stop requests, commands)
/// through a renderer built from the recording's own files, and compares the results. Refused when
/// ticks are missing.
[[nodiscard]] Expected<Resimulation> resimulate(RecordingReader& recording,
                                                const std::string& path);

/// Does the same with the inputs of a black box file, from arming on; compares the ticks that the
/// file holds completely. Refused when inputs are missing.
[[nodiscard]] Expected<Resimulation> resimulate(BlackBoxReader& box, const std::string& path);

/// Runs the inputs of a journal again and records every tick. The result equals the original
/// recording except for clock times and the numbers of the virtual patient.
/// @return number of recorded ticks
[[nodiscard]] Expected<std::uint64_t> recordAgain(InputJournalReader& journal,
                                                  const std::string& path, RecordingWriter& writer);

}  // namespace wholehand
