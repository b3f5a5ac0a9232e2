#pragma once

#include "loop/core/expected.hpp"
#include "loop/core/tick_record.hpp"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace wholehand {

/// Schema version of recordings; files of another one are refused.
inline constexpr std::uint64_t kRecordingSchema = 9;

/// Everything needed to understand a recording and to run it again; written once into its /meta.
struct RecordingMeta {
  std::string created_utc;  ///< ISO 8601
  std::string git_version;  ///< version of the program
  std::uint64_t seed = 0;
  double period_s = 1e-3;
  std::string engine;  ///< name of the physics engine
  bool simulated_clock = false;
  bool uncertified = false;  ///< the gains failed the stability check and were allowed nevertheless
  bool paper = false;
  /// The rendered models differ from the files: they were changed in memory, or the files on disk
  /// were. The recording cannot be run again.
  bool models_changed = false;
  bool simulated_device = true;  ///< late ticks and stuck encoders were only counted
  /// Digest of the passport of a real device, or "without" if it had none and --without-passport
  /// was given; empty for other devices.
  std::string passport;
  std::string title;    ///< "Reach and grasp"; shown by the report
  std::string profile;  ///< code of the person whose profile was open;
                        ///< empty: none
  /// Visit of the clinic's records and item of its plan; 0: none.
  std::uint64_t clinic_visit = 0, clinic_item = 0;
  std::vector<std::string> axis_names, axis_units;  ///< "m" or "rad"
  std::vector<double> effort_limits;                ///< per axis [N or N·m]
  std::vector<double> lever_arms_m;                 ///< per axis; 0: no tip
  std::vector<double> encoder_step;                 ///< per axis [m or rad]; 0: none
  std::vector<double> armed_position;               ///< device position at arming
  std::vector<std::string> joint_names, body_names, capsule_names;
  /// Slots for the bodies of a game, the last of body_names. With 0 the commands have no numbers.
  std::uint64_t game_slots = 0;
  std::string exercise;  ///< empty: none
  int level = 0;
  std::vector<std::string> parameter_names, value_names, event_names;
  /// The value_names that are results: labels and units as shown, factors from value to shown
  /// number, and decimals. Empty in files older than results, and in black boxes.
  std::vector<std::string> result_names, result_labels, result_units;
  std::vector<double> result_factors, result_decimals;
  std::vector<double> parameter_values;  ///< live parameters at arming, one per name
  /// name -> full text of each configuration file used (device, hand, rendering, patient, scene,
  /// motion, and every mesh or URDF by its path), so that the recording is self-contained.
  std::vector<std::pair<std::string, std::string>> files;
};

/// Writes every tick to HDF5 in single-writer-multiple-reader mode. Not for the real-time thread.
/// Layout: docs/recording.md.
class RecordingWriter {
 public:
  /// Creates the file under a temporary name and renames it when its parameters are completely
  /// written; only then is an existing file replaced. Beside it stand its inputs until it is
  /// complete (record/input_log.hpp).
  static Expected<std::unique_ptr<RecordingWriter>> create(const std::string& path,
                                                           const RecordingMeta& meta);
  virtual ~RecordingWriter() = default;

  /// Appends a tick. False when it could not be written (disk full, or a disk error): the tick is
  /// counted as dropped, and writing is retried later; after a disk error in a new part
  /// (recordingParts()). Never throws.
  virtual bool append(const TickRecord& record) = 0;
  /// Writes all data to disk; the recorder calls it at least once a second.
  virtual void flush() = 0;
  /// Finishes the recording. If its file was removed meanwhile, every tick counts as dropped.
  /// Idempotent.
  virtual void close() = 0;
  [[nodiscard]] virtual std::uint64_t written() const = 0;
  [[nodiscard]] virtual std::uint64_t dropped() const = 0;
  /// File size after the last written rows. Any thread; does not access the disk.
  [[nodiscard]] virtual std::uint64_t bytes() const = 0;
};

/// The files that continue the recording at `path`: after the disk refused a write, a new part
/// ("run.part2.h5") begins once it responds again. Accesses the disk.
[[nodiscard]] std::vector<std::string> recordingParts(const std::string& path);

/// What is known of a recording's ticks without reading them.
struct RecordingOutline {
  std::vector<std::uint64_t> numbers;  ///< tick numbers in order (TickRecord::tick)
  std::uint64_t missing = 0;           ///< ticks between them that ran, but are not in the file
  /// The first tick that is missing although it has a row, since other rows contradict it, and how:
  /// "has 1 row in /events, its event_count says 0".
  std::optional<std::uint64_t> contradicted_tick;
  std::string contradiction;
  /// What of the tables cannot be read, or in what those of a file that was closed contradict each
  /// other; empty: nothing.
  std::string flaw;
  bool being_written = false;
};

/// Reads a recording, also one that was truncated by kill -9 or is still being written; or the last
/// seconds of a black box.
class RecordingReader {
 public:
  /// Opens a recording. Refuses a foreign, truncated or newer file with the reason.
  static Expected<std::unique_ptr<RecordingReader>> open(const std::string& path);
  virtual ~RecordingReader() = default;

  [[nodiscard]] virtual const RecordingMeta& meta() const = 0;
  /// Number of complete ticks in the file. Lost ticks show as gaps between tick numbers.
  [[nodiscard]] virtual std::uint64_t size() const = 0;
  /// Outline at opening, with size() numbers.
  [[nodiscard]] virtual const RecordingOutline& outline() const = 0;
  /// Reads the i-th complete tick without stage times. False past the end, and where the file is
  /// damaged (unreadable()).
  virtual bool read(std::uint64_t i, TickRecord& record) = 0;
  /// Digest of the tick that was read last, as it was computed (loop/core/tick_digest.hpp).
  [[nodiscard]] virtual std::uint64_t digest() const = 0;
  /// Whether the numbers of read() are those of the tick to the bit. Those of a recording are
  /// rounded to single precision, but for what a re-run needs.
  [[nodiscard]] virtual bool isExact() const = 0;
};

/// Number of ticks missing between two consecutive ticks of a recording, without those that the
/// loop skipped (elapsed_periods of the later one).
[[nodiscard]] std::uint64_t missingBetween(std::uint64_t before, std::uint64_t tick,
                                           std::uint32_t elapsed_periods);

/// Error for a tick that a file claims to hold but that cannot be read.
[[nodiscard]] Diagnostic unreadable(const std::string& path, std::uint64_t i, std::uint64_t size);

/// The readable part of a recording.
struct ViewedRecording {
  std::unique_ptr<RecordingReader> reader;
  /// Number of the first tick of a damaged end, before which the reader ends; empty: undamaged.
  std::optional<std::uint64_t> unreadable_from_tick;
  std::uint64_t last_tick = 0;  ///< number of the last tick, which may be unreadable
};

/// Datasets that a reader skips, and that may be missing: their numbers stay as in an empty record.
struct LeftOut {
  std::vector<std::string> of_ticks, of_contacts;
};

/// As RecordingReader::open(), but a file with unreadable ticks at its end is read up to them.
/// Refuses black boxes. A file that is being written, or whose writer was killed, is not marked as
/// read, so that a later reader can still distinguish these two cases
/// (RecordingOutline::being_written).
[[nodiscard]] Expected<ViewedRecording> viewRecording(const std::string& path,
                                                      const LeftOut& left_out = {});

/// Ticks of a recording that read() refused.
struct UnreadTicks {
  std::uint64_t count = 0, first = 0;  ///< `first`: the place of the first one
};

/// What of a recording is not shown, and why; empty: all of it is.
[[nodiscard]] Diagnostics notShown(const ViewedRecording& viewed, const UnreadTicks& unread,
                                   const std::string& path);

}  // namespace wholehand
