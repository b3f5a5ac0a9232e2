#pragma once

#include "core/expected.hpp"
#include "core/tick_record.hpp"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace wholehand {

/// Of the recordings that are written; those of kOldestRecordingSchema on are read. Below 3 a tick
/// has no safety_state (disarmed) and no fault_axis (-1). Below kSchemaOfLaw it was rendered under
/// another law (docs/adr/0018-one-spring.md): it reads and replays, but does not run again to the
/// bit. Below kPackedSchema every number stands in its dataset as it is; a recording of schema 4
/// can still be written, for readers that know of no packing.
inline constexpr std::uint64_t kRecordingSchema = 5, kOldestRecordingSchema = 2, kSchemaOfLaw = 4,
                               kPackedSchema = 5;

/// The numbers of the law that was rendered, by which a recording is packed. All empty where nobody
/// told them.
struct RecordedLaw {
  std::vector<double> k_pm, k_dm, gamma;  ///< per axis, as CouplingGains
  std::vector<double> filter_tau_s;       ///< per axis, of the velocity filter
  std::vector<double> theta0;             ///< per joint
  std::vector<double> synergy;            ///< G, a row for each joint
  std::vector<double> encoder_step;       ///< per axis, of the device [m or rad]
  std::uint64_t output_delay_ticks = 0;   ///< of the device
};

/// All that is needed to understand a recording and to run it again: written once into its /meta.
struct RecordingMeta {
  std::string created_utc;  ///< ISO 8601
  std::string git_version;  ///< of the program
  std::uint64_t seed = 0;
  double period_s = 1e-3;
  std::string engine;  ///< name of the physics engine
  bool simulated_clock = false;
  bool uncertified = false;  ///< gains that the stability check refused were allowed
  bool paper = false;
  /// What was rendered is not what the files say: the models were changed in memory, or the files
  /// on the disk. It cannot be run again.
  bool models_changed = false;
  bool simulated_device = true;  ///< lateness and stuck encoders were counted only
  /// Digest of the passport that a real device was armed with, or "without" where it had none and
  /// --without-passport said so; empty on other devices, and in files from before passports.
  std::string passport;
  RecordedLaw law;
  std::uint64_t schema = kRecordingSchema;          ///< of the file it was read from, or goes to
  std::string title;                                ///< "Reach and grasp", shown by the report
  std::vector<std::string> axis_names, axis_units;  ///< "m" or "rad"
  std::vector<double> effort_limits;                ///< per axis [N or N·m]
  std::vector<double> lever_arms_m;                 ///< per axis, 0 where there is no tip
  std::vector<double> armed_position;  ///< device position at which rendering was armed
  std::vector<std::string> joint_names, body_names, capsule_names;
  std::string exercise;  ///< name of the exercise; empty: none
  int level = 0;
  std::vector<std::string> parameter_names, value_names, event_names;
  /// Those of value_names that count at the end, each with its label and unit as shown, the factor
  /// from value to shown number, and the decimals of that. Empty in files from before results, and
  /// in black boxes.
  std::vector<std::string> result_names, result_labels, result_units;
  std::vector<double> result_factors, result_decimals;
  std::vector<double> parameter_values;  ///< live parameters when rendering was armed, one a name
  /// name -> full text of each configuration file used (device, hand, rendering, patient, scene,
  /// motion, and every mesh or URDF by its path), so that the recording stands alone.
  std::vector<std::pair<std::string, std::string>> files;
};

/// Writes every tick to HDF5 in single-writer-multiple-reader mode. Not for the real-time thread.
/// Layout: docs/recording.md.
class RecordingWriter {
 public:
  /// Creates the file; an existing one is not overwritten silently but replaced only when complete
  /// parameters were written (temporary name, then rename).
  static Expected<std::unique_ptr<RecordingWriter>> create(const std::string& path,
                                                           const RecordingMeta& meta);
  virtual ~RecordingWriter() = default;

  /// Appends one tick. False when it could not be written (disk full, or an error of the disk): the
  /// tick is counted as dropped, writing is tried again later, after an error into a fresh part
  /// (recordingParts()); nothing throws.
  virtual bool append(const TickRecord& record) = 0;
  /// Brings everything to the disk; called at least once a second by the recorder.
  virtual void flush() = 0;
  /// Ends the recording properly. Where its file was removed meanwhile, every tick counts as
  /// dropped. Idempotent.
  virtual void close() = 0;
  [[nodiscard]] virtual std::uint64_t written() const = 0;
  [[nodiscard]] virtual std::uint64_t dropped() const = 0;
  /// Of the file, as of the last rows that were written. Any thread; asks no disk.
  [[nodiscard]] virtual std::uint64_t bytes() const = 0;
};

/// The files beside `path` in which its recording goes on: where the disk refused a write, a fresh
/// part begins ("run.part2.h5") once it answers again. Looks at the disk.
[[nodiscard]] std::vector<std::string> recordingParts(const std::string& path);

/// What is known of a recording's ticks without reading them.
struct RecordingOutline {
  std::vector<std::uint64_t> numbers;  ///< of the ticks, in their order (TickRecord::tick)
  std::uint64_t missing = 0;           ///< ticks between them that ran, and that it does not hold
  bool being_written = false;
};

/// Reads a recording, also one that was cut off by kill -9 or is still being written; or the last
/// seconds in a black box.
class RecordingReader {
 public:
  /// Refuses a foreign, truncated or newer-version file with the reason.
  static Expected<std::unique_ptr<RecordingReader>> open(const std::string& path);
  virtual ~RecordingReader() = default;

  [[nodiscard]] virtual const RecordingMeta& meta() const = 0;
  /// Ticks that the file holds whole. Where some were lost between them, their numbers tell.
  [[nodiscard]] virtual std::uint64_t size() const = 0;
  /// As it was opened; size() numbers.
  [[nodiscard]] virtual const RecordingOutline& outline() const = 0;
  /// The i-th of them, complete but for stage times. False past the end, and where the file is
  /// damaged there (unreadable()).
  virtual bool read(std::uint64_t i, TickRecord& record) = 0;
};

/// Ticks between two that follow each other in a recording and that it does not hold; those that
/// the loop skipped (elapsed_periods of the later one) are none of them.
[[nodiscard]] std::uint64_t missingBetween(std::uint64_t before, std::uint64_t tick,
                                           std::uint32_t elapsed_periods);

/// What is said of a tick that a file claims and that cannot be read.
[[nodiscard]] Diagnostic unreadable(const std::string& path, std::uint64_t i, std::uint64_t size);

}  // namespace wholehand
