#pragma once

#include "loop/core/expected.hpp"
#include "loop/core/tick_record.hpp"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace wholehand {

/// Schema version of recordings, and the oldest one that is read; files of others are refused.
inline constexpr std::uint64_t kRecordingSchema = 10, kOldestSchema = 9;
/// The version of a recording with a prescription. Its tables are those of kRecordingSchema; an
/// earlier program would run it again without the walls of the prescription.
inline constexpr std::uint64_t kPrescribedSchema = 11;

/// Everything needed to understand a recording and to repeat the run; written once into its /meta.
struct RecordingMeta {
  std::uint64_t schema = kRecordingSchema;  ///< of the file that was read
  std::string created_utc;                  ///< ISO 8601
  std::string git_version;                  ///< version of the program
  std::uint64_t seed = 0;
  double period_s = 1e-3;
  std::string engine;  ///< name of the physics engine
  bool simulated_clock = false;
  bool uncertified = false;  ///< the gains failed the stability check and were allowed by the user
  bool paper = false;
  /// The rendered models differ from the files, because the models were changed in memory or the
  /// files on disk were changed. The run cannot be repeated.
  bool models_changed = false;
  bool simulated_device = true;  ///< simulated: late ticks and stuck encoders were only counted
  /// Digest of the passport of a real device, or "without" if it had none and --without-passport
  /// was given; empty for other devices.
  std::string passport;
  std::string title;    ///< "Reach and grasp"; shown by the report
  std::string profile;  ///< code of the person whose profile was open;
                        ///< empty: none
  /// Visit in the clinic's records and item of its plan; 0: none.
  std::uint64_t clinic_visit = 0, clinic_item = 0;
  std::vector<std::string> axis_names, axis_units;  ///< "m" or "rad"
  std::vector<double> effort_limits;                ///< per axis [N or N·m]
  std::vector<double> lever_arms_m;                 ///< per axis; 0: no tip
  std::vector<double> encoder_step;                 ///< per axis [m or rad]; 0: none
  std::vector<double> armed_position;               ///< device position at arming
  std::vector<std::string> joint_names, body_names, capsule_names;
  std::vector<std::string> body_joint_names;  ///< recorded bodies on joints, ascending
  std::vector<std::string> body_joint_units;  ///< one each: "m" or "rad"
  /// Number of slots for the bodies of a game; they are the last entries of body_names. With 0 the
  /// commands have no numbers.
  std::uint64_t game_slots = 0;
  std::string exercise;  ///< empty: none
  int level = 0;
  std::vector<std::string> parameter_names, value_names, event_names;
  /// Results among value_names: labels and units as shown, factors from the value to the shown
  /// number, and decimals. Empty in older files and in black box files.
  std::vector<std::string> result_names, result_labels, result_units;
  std::vector<double> result_factors, result_decimals;
  std::vector<double> parameter_values;  ///< live parameters at arming, one per name
  /// name -> full text of each configuration file used (device, hand, rendering, patient, scene,
  /// motion, and every mesh or URDF by its path), so that the recording is self-contained.
  std::vector<std::pair<std::string, std::string>> files;
};

/// Writes every tick to HDF5 in single-writer-multiple-reader mode. Not real-time safe. Layout:
/// docs/recording.md.
class RecordingWriter {
 public:
  /// Creates the file under a temporary name and renames it when its parameters are completely
  /// written; an existing file is replaced only then. A journal of the inputs exists in the same
  /// folder until the recording is complete (record/input_log.hpp).
  static Expected<std::unique_ptr<RecordingWriter>> create(const std::string& path,
                                                           const RecordingMeta& meta);
  virtual ~RecordingWriter() = default;

  /// Appends a tick. Returns false when it could not be written (disk full or disk error). The tick
  /// is then counted as dropped and writing is retried later, after a disk error in a new part
  /// (recordingParts()). Never throws.
  virtual bool append(const TickRecord& record) = 0;
  /// Writes all data to disk; the recorder calls it at least once a second.
  virtual void flush() = 0;
  /// Completes the recording. If its file was removed meanwhile, every tick counts as dropped.
  /// Idempotent.
  virtual void close() = 0;
  [[nodiscard]] virtual std::uint64_t written() const = 0;
  [[nodiscard]] virtual std::uint64_t dropped() const = 0;
  /// File size after the last written rows. Any thread; does not access the disk.
  [[nodiscard]] virtual std::uint64_t bytes() const = 0;
};

/// Paths of the files that continue the recording at `path`. After the disk refused a write, a new
/// part ("run.part2.h5") begins when the disk responds again. Accesses the disk.
[[nodiscard]] std::vector<std::string> recordingParts(const std::string& path);

/// Facts about a recording's ticks that are known without reading them.
struct RecordingOutline {
  std::vector<std::uint64_t> numbers;  ///< tick numbers in order (TickRecord::tick)
  std::uint64_t missing = 0;           ///< ticks between these that ran but are not in the file
  /// First tick that counts as missing because other rows contradict its row, and the
  /// contradiction: "has 1 row in /events, its event_count says 0".
  std::optional<std::uint64_t> contradicted_tick;
  std::string contradiction;
  /// Parts of the tables that cannot be read, or a contradiction between the tables of a closed
  /// file; empty: none.
  std::string flaw;
  bool being_written = false;
};

/// Reads a recording, including one whose writer was killed or is still writing, or the last
/// seconds in a black box file.
class RecordingReader {
 public:
  /// Opens a recording. Refuses a foreign, truncated or newer file with the reason.
  static Expected<std::unique_ptr<RecordingReader>> open(const std::string& path);
  virtual ~RecordingReader() = default;

  [[nodiscard]] virtual const RecordingMeta& meta() const = 0;
  /// Number of complete ticks in the file. Lost ticks appear as gaps between tick numbers.
  [[nodiscard]] virtual std::uint64_t size() const = 0;
  /// Outline at opening, with size() numbers.
  [[nodiscard]] virtual const RecordingOutline& outline() const = 0;
  /// Reads the i-th complete tick without stage times. Returns false past the end and if the file
  /// is damaged there (unreadable()).
  virtual bool read(std::uint64_t i, TickRecord& record) = 0;
  /// Digest of the tick that was read last, as the loop computed it (loop/core/tick_digest.hpp).
  [[nodiscard]] virtual std::uint64_t digest() const = 0;
  /// True when the numbers of read() are bit-identical to those of the tick. The numbers of a
  /// recording are rounded to single precision, except those that a re-run needs.
  [[nodiscard]] virtual bool isExact() const = 0;
};

/// Number of ticks missing between two consecutive ticks of a recording, without ticks that the
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

/// Datasets that a reader skips and that may be missing. Their numbers stay as in an empty record.
struct LeftOut {
  std::vector<std::string> of_ticks, of_contacts;
};

/// Opens a recording like RecordingReader::open(), but reads a file with unreadable ticks at its
/// end up to them. Refuses black box files. A file that is being written or whose writer was killed
/// is not marked as being read, so that a later reader can still distinguish these two cases
/// (RecordingOutline::being_written).
[[nodiscard]] Expected<ViewedRecording> viewRecording(const std::string& path,
                                                      const LeftOut& left_out = {});

/// Ticks of a recording that read() refused.
struct UnreadTicks {
  std::uint64_t count = 0, first = 0;  ///< `first`: index of the first one
};

/// Notices about the parts of a recording that are not shown, with reasons; empty: everything is
/// shown.
[[nodiscard]] Diagnostics notShown(const ViewedRecording& viewed, const UnreadTicks& unread,
                                   const std::string& path);

}  // namespace wholehand
