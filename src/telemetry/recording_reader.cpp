#include "telemetry/black_box_reader.hpp"
#include "telemetry/disk_reserve.hpp"
#include "telemetry/recording.hpp"
#include "telemetry/recording_bounds.hpp"
#include "telemetry/recording_layout.hpp"
#include "telemetry/recording_meta.hpp"
#include "telemetry/recording_view.hpp"
#include "telemetry/side_table.hpp"
#include "telemetry/table_reader.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <optional>
#include <sys/stat.h>

namespace wholehand {
namespace {

using hdf5::Handle;
using hdf5::readAttribute;
using recording::SideTable;

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
constexpr std::uint64_t kMostRowsPerByte = 10;
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
  if (in.gcount() == 0) return refusal(path, "is empty", kGiveRecording);
  if (in.gcount() < 12 ||
      !std::equal(hdf5::kSignature.begin(), hdf5::kSignature.end(), head.begin())) {
    return refusal(path, "is no HDF5 file", kGiveRecording);
  }
  constexpr char kWriteBits = 0x01 | 0x04;  // open for writing; for single writer, many readers
  return head[8] >= 3 && (head[11] & kWriteBits) != 0;
}

class Hdf5Reader final : public RecordingReader {
 public:
  /// @param chunks_at_once that are read around a tick
  /// @param marks a file that its writer left open as one that is read
  Hdf5Reader(std::uint64_t chunks_at_once, bool marks)
      : chunks_at_once_(chunks_at_once), marks_(marks) {}
  /// Opens and checks. What is wrong, or Done.
  Expected<Done> open(const std::string& path, bool left_open);
  [[nodiscard]] bool endsWhole() {
    return rows_.empty() || holds(rows_.back()) || loadAround(rows_.back());
  }
  /// Leaves out the last ticks where they cannot be read: the number of the first of these.
  std::optional<std::uint64_t> leaveOutDamagedEnd();

  [[nodiscard]] const RecordingMeta& meta() const override { return meta_; }
  [[nodiscard]] std::uint64_t size() const override { return rows_.size(); }
  [[nodiscard]] const RecordingOutline& outline() const override { return outline_; }
  bool read(std::uint64_t i, TickRecord& record) override;

 private:
  Expected<Done> readDescription(const std::string& path);
  template <class Row>
  std::string openTable(const char* name, recording::TableReader<Row>& table);
  /// Opens the tables and counts the ticks that are complete. What is wrong, or nothing.
  std::string openTables();
  std::string findTicks();
  std::string countMissing();
  // Of a row of the file.
  bool loadAround(std::uint64_t row);
  bool load(std::uint64_t row, std::uint64_t rows);
  [[nodiscard]] bool holds(std::uint64_t row) const;

  Handle file_;
  RecordingMeta meta_;
  std::unique_ptr<recording::TableReader<TickRecord>> ticks_;
  std::unique_ptr<SideTable<recording::ContactRow>> contacts_;
  std::unique_ptr<SideTable<recording::EventRow>> events_;
  std::unique_ptr<SideTable<recording::CommandRow>> commands_;
  std::vector<std::uint64_t> rows_;  ///< of the file, that hold a whole tick
  RecordingOutline outline_;
  const std::uint64_t chunks_at_once_;
  const bool marks_;
  std::uint64_t block_ = 1;                      ///< rows of a chunk
  std::uint64_t unreadable_block_ = UINT64_MAX;  ///< the one that was tried last
};

Expected<Done> Hdf5Reader::open(const std::string& path, bool left_open) {
  outline_.being_written = left_open && DiskReserve::isOpenElsewhere(path);
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_file_locking(access.get(), marks_ || !left_open, true);
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
  if (!recording::readMeta(file_.get(), group.get(), meta_)) {
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
  if (!group.ok()) return std::string("is truncated: it has no ").append(name);
  const std::string problem = table.open(group.get());
  return problem.empty() ? problem : "is damaged: it " + problem;
}

std::string Hdf5Reader::openTables() {
  using namespace recording;
  ticks_ = std::make_unique<TableReader<TickRecord>>(tickColumns(meta_));
  contacts_.reset(new SideTable<ContactRow>{TableReader<ContactRow>(contactColumns()), {}});
  events_.reset(new SideTable<EventRow>{TableReader<EventRow>(eventColumns()), {}});
  commands_.reset(new SideTable<CommandRow>{TableReader<CommandRow>(commandColumns(meta_)), {}});
  block_ = chunkRows(meta_.period_s);
  ticks_->unpack(predictions(shapesOf(tickColumns(meta_)), meta_), block_);
  for (const std::string& problem :
       {openTable("ticks", *ticks_), openTable("contacts", contacts_->table),
        openTable("events", events_->table), openTable("commands", commands_->table)}) {
    if (!problem.empty()) return problem;
  }
  return findTicks();
}

// A row whose number, contacts, events or commands never reached the disk is a hole: what follows
// it is read all the same, and the ticks' numbers tell of it.
std::string Hdf5Reader::findTicks() {
  std::vector<std::int32_t> contacts, events, commands;
  std::vector<std::uint64_t> numbers;
  hsize_t bytes = 0;
  if (H5Fget_filesize(file_.get(), &bytes) < 0) return "is truncated or damaged";
  for (const std::uint64_t rows :
       {ticks_->rows(), contacts_->table.rows(), events_->table.rows(), commands_->table.rows()}) {
    if (rows / kMostRowsPerByte > bytes) {
      return "is damaged: it claims more ticks than a file of its size can hold";
    }
  }
  const std::uint64_t ticks = ticks_->rows();
  if (!ticks_->readAll("contact_count", contacts) || !ticks_->readAll("tick", numbers) ||
      !ticks_->readAll("event_count", events) || !ticks_->readAll("command_count", commands) ||
      !contacts_->assign(ticks) || !events_->assign(ticks) || !commands_->assign(ticks)) {
    return "is truncated or damaged: its ticks cannot be read";
  }
  for (std::uint64_t i = 0; i < ticks; ++i) {
    if (numbers[i] != UINT64_MAX && contacts_->isWhole(i, contacts[i], kMaxContacts) &&
        events_->isWhole(i, events[i], kMaxExerciseEvents) &&
        commands_->isWhole(i, commands[i], kMaxCommands)) {
      rows_.push_back(i);
      outline_.numbers.push_back(numbers[i]);
    }
  }
  return countMissing();
}

// Reads no column of an hour for a recording in which every tick follows the one before.
std::string Hdf5Reader::countMissing() {
  const std::vector<std::uint64_t>& numbers = outline_.numbers;
  if (numbers.empty() || numbers.back() - numbers.front() + 1 == numbers.size()) return {};
  std::vector<std::uint32_t> elapsed;
  if (!ticks_->readAll("elapsed_periods", elapsed)) {
    return "is truncated or damaged: its ticks cannot be read";
  }
  for (std::size_t i = 1; i < numbers.size(); ++i) {
    outline_.missing += missingBetween(numbers[i - 1], numbers[i], elapsed[rows_[i]]);
  }
  return {};
}

bool Hdf5Reader::load(std::uint64_t row, std::uint64_t rows) {
  const std::uint64_t first = row / rows * rows;
  const std::uint64_t end = std::min(ticks_->rows(), first + rows);
  return ticks_->load(first, end - first) && contacts_->load(first, end) &&
         events_->load(first, end) && commands_->load(first, end);
}

// A damaged chunk spoils no other, and is not tried again with each of its rows.
bool Hdf5Reader::loadAround(std::uint64_t row) {
  if (row / block_ == unreadable_block_) return false;
  if (chunks_at_once_ > 1 && load(row, chunks_at_once_ * block_)) return true;
  if (load(row, block_)) return true;
  unreadable_block_ = row / block_;
  return false;
}

std::optional<std::uint64_t> Hdf5Reader::leaveOutDamagedEnd() {
  std::optional<std::uint64_t> first;
  while (!endsWhole()) {
    const std::uint64_t block = rows_.back() / block_;
    while (!rows_.empty() && rows_.back() / block_ == block) {
      first = outline_.numbers.back();
      rows_.pop_back();
      outline_.numbers.pop_back();
    }
  }
  return first;
}

bool Hdf5Reader::holds(std::uint64_t row) const {
  return ticks_->holds(row) && contacts_->holds(row) && events_->holds(row) &&
         commands_->holds(row);
}

bool Hdf5Reader::read(std::uint64_t index, TickRecord& record) {
  if (index >= rows_.size()) return false;
  const std::uint64_t i = rows_[index];
  hdf5::beginHdf5();
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

Expected<std::unique_ptr<Hdf5Reader>> openHdf5(const std::string& path,
                                               std::uint64_t chunks_at_once, bool marks) {
  hdf5::beginHdf5();
  const auto left_open = leftOpen(path);
  if (!left_open) return left_open.errors();
  auto reader = std::make_unique<Hdf5Reader>(chunks_at_once, marks);
  if (auto opened = reader->open(path, *left_open); !opened) return opened.errors();
  return reader;
}

}  // namespace

Expected<std::unique_ptr<RecordingReader>> RecordingReader::open(const std::string& path) {
  if (BlackBoxReader::isBox(path)) {
    auto box = BlackBoxReader::openBox(path);
    if (!box) return box.errors();
    return Expected<std::unique_ptr<RecordingReader>>(std::move(*box));
  }
  auto reader = openHdf5(path, 1, true);
  if (!reader) return reader.errors();
  // The last rows lie at the end of the file: a copy that stopped early shows here.
  if (!(*reader)->endsWhole()) {
    return refusal(path, "is truncated: its last ticks cannot be read", kBrokenCopy);
  }
  return Expected<std::unique_ptr<RecordingReader>>(std::move(*reader));
}

Expected<ViewedRecording> viewRecording(const std::string& path, std::uint64_t chunks_at_once) {
  auto reader = openHdf5(path, chunks_at_once, false);
  if (!reader) return reader.errors();
  ViewedRecording viewed;
  const auto& numbers = (*reader)->outline().numbers;
  viewed.last_tick = numbers.empty() ? 0 : numbers.back();
  viewed.unreadable_from_tick = (*reader)->leaveOutDamagedEnd();
  viewed.reader = std::move(*reader);
  return viewed;
}

std::uint64_t missingBetween(std::uint64_t before, std::uint64_t tick,
                             std::uint32_t elapsed_periods) {
  const std::uint64_t next = before + elapsed_periods;
  return tick > next ? tick - next : 0;
}

Diagnostic unreadable(const std::string& path, std::uint64_t i, std::uint64_t size) {
  return refusal(path,
                 "is damaged: tick " + std::to_string(i + 1) + " of " + std::to_string(size) +
                     " cannot be read",
                 kBrokenCopy);
}

}  // namespace wholehand
