#include "telemetry/black_box_reader.hpp"
#include "telemetry/recording.hpp"
#include "telemetry/recording_layout.hpp"
#include "telemetry/table_reader.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <sys/stat.h>

namespace wholehand {
namespace {

using hdf5::Handle;
using hdf5::readAttribute;

Diagnostic refusal(const std::string& path, std::string problem, std::string remedy) {
  Diagnostic d;
  d.file = path;
  d.problem = std::move(problem);
  d.remedy = std::move(remedy);
  return d;
}

constexpr const char* kGiveRecording = "give a .h5 file that `wholehand run --record` wrote";
constexpr const char* kVariableTexts = "holds texts of variable length, which are not read";
constexpr const char* kFixedTexts =
    "write its texts with a fixed length (h5py: numpy.bytes_), or record anew";
/// Far above what a file of a byte can hold: a damaged file must not make us ask for terabytes.
constexpr std::uint64_t kMostTicksPerByte = 10;
constexpr const char* kBrokenCopy =
    "copy it again from where it was recorded; what is missing cannot be restored";

/// Looks at the first bytes, by the HDF5 format's description of the superblock: is it HDF5, and
/// did its writer leave it open (killed, or still writing)?
Expected<bool> leftOpen(const std::string& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) {
    return refusal(path, std::string("cannot be read: ") + std::strerror(errno), kGiveRecording);
  }
  if (!S_ISREG(status.st_mode)) return refusal(path, "is no regular file", kGiveRecording);
  std::ifstream in(path, std::ios::binary);
  std::array<char, 12> head{};
  if (!in)
    return refusal(path, std::string("cannot be read: ") + std::strerror(errno), kGiveRecording);
  in.read(head.data(), head.size());
  static constexpr std::array<char, 8> kSignature = {'\x89', 'H',  'D',    'F',
                                                     '\r',   '\n', '\x1a', '\n'};
  if (in.gcount() == 0) return refusal(path, "is empty", kGiveRecording);
  if (in.gcount() < 12 || !std::equal(kSignature.begin(), kSignature.end(), head.begin())) {
    return refusal(path, "is no HDF5 file", kGiveRecording);
  }
  constexpr char kWriteBits = 0x01 | 0x04;  // open for writing; for single writer, many readers
  return head[8] >= 3 && (head[11] & kWriteBits) != 0;
}

bool readFiles(hid_t file, RecordingMeta& meta) {
  const Handle group(H5Gopen2(file, "meta/files", H5P_DEFAULT), H5Gclose);
  H5G_info_t info{};
  if (!group.ok() || H5Gget_info(group.get(), &info) < 0) return false;
  for (hsize_t i = 0; i < info.nlinks; ++i) {
    std::string name, text;
    if (!hdf5::readText(group.get(), std::to_string(i).c_str(), name, text)) return false;
    meta.files.emplace_back(std::move(name), std::move(text));
  }
  return true;
}

bool readMeta(hid_t file, hid_t id, RecordingMeta& meta) {
  std::uint64_t clock = 0, uncertified = 0, paper = 0, simulated = 1;
  const bool ok =
      readAttribute(id, "created_utc", meta.created_utc) &&
      readAttribute(id, "git_version", meta.git_version) &&
      readAttribute(id, "title", meta.title) && readAttribute(id, "seed", meta.seed) &&
      readAttribute(id, "period_s", meta.period_s) && readAttribute(id, "engine", meta.engine) &&
      readAttribute(id, "simulated_clock", clock) &&
      readAttribute(id, "uncertified", uncertified) && readAttribute(id, "paper", paper) &&
      readAttribute(id, "axis_names", meta.axis_names) &&
      readAttribute(id, "axis_units", meta.axis_units) &&
      readAttribute(id, "effort_limits", meta.effort_limits) &&
      readAttribute(id, "lever_arms_m", meta.lever_arms_m) &&
      readAttribute(id, "armed_position", meta.armed_position) &&
      readAttribute(id, "joint_names", meta.joint_names) &&
      readAttribute(id, "body_names", meta.body_names) &&
      readAttribute(id, "capsule_names", meta.capsule_names);
  std::uint64_t level = 0;
  const bool exercise = readAttribute(id, "exercise", meta.exercise) &&
                        readAttribute(id, "level", level) &&
                        readAttribute(id, "parameter_names", meta.parameter_names) &&
                        readAttribute(id, "parameter_values", meta.parameter_values) &&
                        readAttribute(id, "value_names", meta.value_names) &&
                        readAttribute(id, "event_names", meta.event_names);
  // Before schema 3 no device was watched for lateness: to a re-simulation all were simulated.
  const bool watched = meta.schema < 3 || readAttribute(id, "simulated_device", simulated);
  meta.simulated_device = simulated != 0;
  meta.level = static_cast<int>(std::min<std::uint64_t>(level, 1000));
  meta.simulated_clock = clock != 0;
  meta.uncertified = uncertified != 0;
  meta.paper = paper != 0;
  return ok && exercise && watched && readFiles(file, meta);
}

/// A table with any number of rows for a tick: its reader, and which rows belong to which tick.
template <class Row>
struct SideTable {
  recording::TableReader<Row> table;
  std::vector<std::uint64_t> first = {0};  ///< of each tick, and the end of the last

  /// Takes how many rows each tick has. False where the table ends before that tick's do.
  bool follow(std::int32_t count, int most) {
    const std::uint64_t end = first.back() + static_cast<std::uint64_t>(std::clamp(count, 0, most));
    if (end > table.rows()) return false;
    first.push_back(end);
    return true;
  }
  bool load(std::uint64_t tick, std::uint64_t end_tick) {
    return table.load(first[tick], first[end_tick] - first[tick]);
  }
  // Of a damaged file the ticks may have been read and these rows not.
  [[nodiscard]] bool holds(std::uint64_t tick) const {
    if (first[tick] == first[tick + 1]) return true;
    return table.holds(first[tick]) && table.holds(first[tick + 1] - 1);
  }
  [[nodiscard]] std::int32_t count(std::uint64_t tick) const {
    return static_cast<std::int32_t>(first[tick + 1] - first[tick]);
  }
  [[nodiscard]] Row row(std::uint64_t tick, std::int32_t i) const {
    Row row;
    table.get(first[tick] + static_cast<std::uint64_t>(i), row);
    return row;
  }
};

class Hdf5Reader final : public RecordingReader {
 public:
  /// Opens and checks. What is wrong, or Done.
  Expected<Done> open(const std::string& path, bool left_open);

  [[nodiscard]] const RecordingMeta& meta() const override { return meta_; }
  [[nodiscard]] std::uint64_t size() const override { return size_; }
  bool read(std::uint64_t i, TickRecord& record) override;

 private:
  Expected<Done> readDescription(const std::string& path);
  template <class Row>
  std::string openTable(const char* name, recording::TableReader<Row>& table);
  /// Opens the tables and counts the ticks that are complete. What is wrong, or nothing.
  std::string openTables();
  std::string countTicks();
  bool loadAround(std::uint64_t i);
  [[nodiscard]] bool holds(std::uint64_t i) const;

  Handle file_;
  RecordingMeta meta_;
  std::unique_ptr<recording::TableReader<TickRecord>> ticks_;
  std::unique_ptr<SideTable<recording::ContactRow>> contacts_;
  std::unique_ptr<SideTable<recording::EventRow>> events_;
  std::unique_ptr<SideTable<recording::CommandRow>> commands_;
  std::uint64_t size_ = 0, block_ = 1;
};

Expected<Done> Hdf5Reader::open(const std::string& path, bool left_open) {
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_file_locking(access.get(), true, true);
  // HDF5 waits twice as long before each new attempt, from 1 ns on: of its usual 100 attempts at a
  // broken piece of a file left open, nobody would see the end.
  if (left_open) H5Pset_metadata_read_attempts(access.get(), 25);
  // A file whose writer was killed is opened as one that is still written: no repair is needed.
  const unsigned mode = H5F_ACC_RDONLY | (left_open ? H5F_ACC_SWMR_READ : 0U);
  file_ = Handle(H5Fopen(path.c_str(), mode, access.get()), H5Fclose);
  if (!file_.ok()) return refusal(path, "is truncated or damaged", kBrokenCopy);
  if (auto described = readDescription(path); !described) return described;
  if (const std::string problem = openTables(); !problem.empty()) {
    return refusal(path, problem, kBrokenCopy);
  }
  return Done{};
}

Expected<Done> Hdf5Reader::readDescription(const std::string& path) {
  const Handle group(H5Gopen2(file_.get(), "meta", H5P_DEFAULT), H5Gclose);
  std::string kind;
  std::uint64_t version = 0;
  if (group.ok() && hdf5::hasVariableText(group.get())) {
    return refusal(path, kVariableTexts, kFixedTexts);
  }
  if (!group.ok() || !readAttribute(group.get(), "format", kind) || kind != recording::kFormat ||
      !readAttribute(group.get(), "schema_version", version)) {
    return refusal(path, "is an HDF5 file, but no Wholehand recording", kGiveRecording);
  }
  if (version < kOldestRecordingSchema || version > kRecordingSchema) {
    const bool newer = version > kRecordingSchema;
    auto d = refusal(
        path, newer ? "was written by a newer Wholehand" : "is of an unknown version",
        "this program reads schema versions " + std::to_string(kOldestRecordingSchema) + " to " +
            std::to_string(kRecordingSchema) + (newer ? "; update it" : "; record anew"));
    d.key = "schema_version";
    d.value = std::to_string(version);
    return d;
  }
  meta_.schema = version;
  if (!readMeta(file_.get(), group.get(), meta_)) {
    return refusal(path, "is truncated or damaged: its description cannot be read", kBrokenCopy);
  }
  if (const std::string reason = recording::unusable(meta_); !reason.empty()) {
    return refusal(path, "is damaged: its description " + reason, kBrokenCopy);
  }
  return Done{};
}

template <class Row>
std::string Hdf5Reader::openTable(const char* name, recording::TableReader<Row>& table) {
  const Handle group(H5Gopen2(file_.get(), name, H5P_DEFAULT), H5Gclose);
  if (!group.ok()) return std::string("is truncated: it has no ") + name;
  const std::string problem = table.open(group.get());
  return problem.empty() ? problem : "is damaged: it " + problem;
}

std::string Hdf5Reader::openTables() {
  using namespace recording;
  ticks_ = std::make_unique<TableReader<TickRecord>>(tickColumns(meta_));
  contacts_.reset(new SideTable<ContactRow>{TableReader<ContactRow>(contactColumns())});
  events_.reset(new SideTable<EventRow>{TableReader<EventRow>(eventColumns())});
  commands_.reset(new SideTable<CommandRow>{TableReader<CommandRow>(commandColumns(meta_))});
  for (const std::string& problem :
       {openTable("ticks", *ticks_), openTable("contacts", contacts_->table),
        openTable("events", events_->table), openTable("commands", commands_->table)}) {
    if (!problem.empty()) return problem;
  }
  block_ = chunkRows(meta_.period_s);
  if (std::string problem = countTicks(); !problem.empty()) return problem;
  // The last rows lie at the end of the file: a copy that stopped early shows here.
  if (size_ > 0 && !loadAround(size_ - 1)) return "is truncated: its last ticks cannot be read";
  return {};
}

std::string Hdf5Reader::countTicks() {
  std::vector<std::int32_t> contacts, events, commands;
  std::vector<std::uint64_t> numbers;
  hsize_t bytes = 0;
  if (H5Fget_filesize(file_.get(), &bytes) < 0 || ticks_->rows() / kMostTicksPerByte > bytes) {
    return "is damaged: it claims more ticks than a file of its size can hold";
  }
  if (!ticks_->readAll("contact_count", contacts) || !ticks_->readAll("tick", numbers) ||
      !ticks_->readAll("event_count", events) || !ticks_->readAll("command_count", commands)) {
    return "is truncated or damaged: its ticks cannot be read";
  }
  size_ = 0;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    // Where a table ends early the kill came in between.
    if (numbers[i] == UINT64_MAX || !contacts_->follow(contacts[i], kMaxContacts) ||
        !events_->follow(events[i], kMaxExerciseEvents) ||
        !commands_->follow(commands[i], kMaxCommands)) {
      break;
    }
    ++size_;
  }
  return {};
}

bool Hdf5Reader::loadAround(std::uint64_t i) {
  const std::uint64_t first = i / block_ * block_;
  const std::uint64_t end = std::min(size_, first + block_);
  return ticks_->load(first, end - first) && contacts_->load(first, end) &&
         events_->load(first, end) && commands_->load(first, end);
}

bool Hdf5Reader::holds(std::uint64_t i) const {
  return ticks_->holds(i) && contacts_->holds(i) && events_->holds(i) && commands_->holds(i);
}

bool Hdf5Reader::read(std::uint64_t i, TickRecord& record) {
  if (i >= size_) return false;
  hdf5::silenceErrors();
  if (!holds(i) && !loadAround(i)) return false;
  record = TickRecord{};
  ticks_->get(i, record);
  record.body_count =
      std::clamp(record.body_count, 0, static_cast<std::int32_t>(meta_.body_names.size()));
  record.contact_count = contacts_->count(i);
  for (std::int32_t c = 0; c < record.contact_count; ++c) {
    record.contacts[static_cast<std::size_t>(c)] = contacts_->row(i, c).contact;
  }
  record.parameter_count = static_cast<std::int32_t>(meta_.parameter_names.size());
  record.exercise.value_count = static_cast<std::int32_t>(meta_.value_names.size());
  record.exercise.event_count = events_->count(i);
  for (std::int32_t c = 0; c < record.exercise.event_count; ++c) {
    record.exercise.events[static_cast<std::size_t>(c)] = events_->row(i, c).event;
  }
  record.command_count = commands_->count(i);
  for (std::int32_t c = 0; c < record.command_count; ++c) {
    record.commands[static_cast<std::size_t>(c)] = commands_->row(i, c).command;
  }
  return true;
}

}  // namespace

Expected<std::unique_ptr<RecordingReader>> RecordingReader::open(const std::string& path) {
  if (BlackBoxReader::isBox(path)) {
    auto box = BlackBoxReader::openBox(path);
    if (!box) return box.errors();
    return Expected<std::unique_ptr<RecordingReader>>(std::move(*box));
  }
  hdf5::silenceErrors();
  const auto left_open = leftOpen(path);
  if (!left_open) return left_open.errors();
  auto reader = std::make_unique<Hdf5Reader>();
  if (auto opened = reader->open(path, *left_open); !opened) return opened.errors();
  return Expected<std::unique_ptr<RecordingReader>>(std::move(reader));
}

}  // namespace wholehand
