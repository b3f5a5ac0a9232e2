#include "files/text/text_file.hpp"
#include "loop/core/tick_record.hpp"
#include "record/disk_reserve.hpp"
#include "record/hdf5_handle.hpp"
#include "record/hdf5_tables.hpp"
#include "record/input_log.hpp"
#include "record/recording.hpp"
#include "record/recording_layout.hpp"
#include "record/recording_meta.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>
#include <utility>
#include <vector>

namespace wholehand::recording {
namespace {

using hdf5::Handle;

/// Growing datasets of equal length with their buffered rows. Not real-time safe.
template <class Row>
class TableWriter {
 public:
  TableWriter(std::vector<Column<Row>> columns, std::uint64_t chunk_rows)
      : columns_(std::move(columns)), chunk_rows_(chunk_rows), buffers_(columns_.size()) {
    for (const ColumnShape& c : columns_) row_bytes_.push_back(c.rowBytes());
  }
  /// Makes every write begin a new chunk, because a growing chunk is compressed again at another
  /// place of the file. The rows in between stay unwritten.
  void beginChunks() noexcept { begins_chunks_ = true; }

  /// Creates the datasets with their attributes in `group`.
  bool create(hid_t group);
  /// Buffers a row until the next write().
  void push(const Row& row);
  /// Writes the buffered rows after the committed rows and keeps them in the buffer. If a later
  /// step fails, the same rows are written to the same place again.
  bool write();
  /// Marks the written rows as safe on disk, drops them from the buffer and continues after them.
  void commit();
  /// Takes over the buffered rows of another table. In a side table it subtracts `ticks`, the
  /// number of tick rows in the other table's file, from the tick row numbers.
  void takeRowsOf(TableWriter& other, std::uint64_t ticks);
  /// Closes the datasets.
  void close() { datasets_.clear(); }

  [[nodiscard]] std::uint64_t written() const noexcept { return written_; }
  [[nodiscard]] std::uint64_t pending() const noexcept { return pending_; }
  /// True when the buffered rows complete a chunk, which is the cheapest time to write.
  [[nodiscard]] bool atChunkEnd() const noexcept {
    return pending_ > 0 && (written_ + pending_) % chunk_rows_ == 0;
  }
  [[nodiscard]] std::uint64_t pendingBytes() const noexcept;

 private:
  std::vector<Column<Row>> columns_;
  std::uint64_t chunk_rows_;
  std::vector<std::size_t> row_bytes_;
  std::vector<std::vector<std::byte>> buffers_;  ///< buffered rows, by column
  std::vector<hdf5::Handle> datasets_;
  std::uint64_t written_ = 0, pending_ = 0;
  bool begins_chunks_ = false;
};

template <class Row>
bool TableWriter<Row>::create(hid_t group) {
  for (const Column<Row>& column : columns_) {
    datasets_.push_back(createDataset(group, column, chunk_rows_));
    if (!datasets_.back().ok()) return false;
  }
  return true;
}

template <class Row>
void TableWriter<Row>::push(const Row& row) {
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    const std::size_t bytes = row_bytes_[i];
    std::vector<std::byte>& buffer = buffers_[i];
    buffer.resize(buffer.size() + bytes);
    columns_[i].store(row, buffer.data() + buffer.size() - bytes);
  }
  ++pending_;
}

template <class Row>
bool TableWriter<Row>::write() {
  if (pending_ == 0) return true;
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    if (!writeRows(datasets_[i].get(), columns_[i], written_, pending_, buffers_[i].data())) {
      return false;
    }
  }
  return true;
}

template <class Row>
void TableWriter<Row>::commit() {
  written_ += pending_;
  if (begins_chunks_) written_ += (chunk_rows_ - written_ % chunk_rows_) % chunk_rows_;
  pending_ = 0;
  for (std::vector<std::byte>& rows : buffers_) rows.clear();
}

template <class Row>
void TableWriter<Row>::takeRowsOf(TableWriter& other, std::uint64_t ticks) {
  buffers_.swap(other.buffers_);
  std::swap(pending_, other.pending_);
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    if (columns_[i].name != "row") continue;
    for (std::size_t at = 0; at < buffers_[i].size(); at += sizeof(std::uint64_t)) {
      std::uint64_t row = 0;
      std::memcpy(&row, buffers_[i].data() + at, sizeof row);
      row -= ticks;
      std::memcpy(buffers_[i].data() + at, &row, sizeof row);
    }
  }
}

template <class Row>
std::uint64_t TableWriter<Row>::pendingBytes() const noexcept {
  std::uint64_t n = 0;
  for (const std::size_t bytes : row_bytes_) n += bytes;
  return n * pending_;
}

/// One HDF5 file of a recording with its buffered rows. Not real-time safe.
class RecordingFile {
 public:
  enum class WriteResult { kAll, kNoRoom, kRefused };

  explicit RecordingFile(const RecordingMeta& meta);

  /// Creates the file with everything except ticks, then replaces an older one. Returns the error,
  /// or an empty text.
  std::string create(const std::string& path, const RecordingMeta& meta);
  /// Buffers a tick until the next write().
  void push(const TickRecord& record);
  /// Writes the buffered rows to disk, or keeps them in the buffer. After kRefused, HDF5's state of
  /// this file is unreliable, and another file must continue the recording.
  [[nodiscard]] WriteResult write();
  /// Takes over the buffered rows of `before` as the first rows of this file.
  void takeRowsOf(RecordingFile& before);
  /// Closes the file; buffered rows are lost.
  void end();

  [[nodiscard]] std::uint64_t written() const noexcept { return ticks_.written(); }
  [[nodiscard]] std::uint64_t pending() const noexcept { return ticks_.pending(); }
  [[nodiscard]] bool atChunkEnd() const noexcept { return ticks_.atChunkEnd(); }
  [[nodiscard]] std::uint64_t bytes() const noexcept { return bytes_; }
  /// False when the file was removed meanwhile.
  [[nodiscard]] bool hasName() const { return reserve_.hasName(); }

 private:
  std::string createAt(const std::string& path, const RecordingMeta& meta);
  [[nodiscard]] bool claimRoom();
  void noteBytes();

  DiskReserve reserve_;
  hdf5::Handle file_;
  TableWriter<TickRecord> ticks_;
  TableWriter<ContactRow> contacts_;
  TableWriter<EventRow> events_;
  TableWriter<CommandRow> commands_;
  std::uint64_t bytes_ = 0;
};

/// Upper bound for the growth of HDF5's own structures per write, in addition to the rows.
constexpr std::uint64_t kTablesBytes = std::uint64_t{1} << 20U;

std::uint64_t metaBytes(const RecordingMeta& meta) {
  std::uint64_t n = kTablesBytes;
  for (const auto& [name, text] : meta.files) n += name.size() + text.size() + 4096;
  return n;
}

/// Maximum number of parts, so that a failing disk does not fill a folder with files.
constexpr int kMostParts = 99;

/// "a/run.h5", 2: "a/run.part2.h5".
std::string partPath(const std::string& path, int part) {
  const std::filesystem::path first = path;
  const std::string name = first.stem().string() + ".part" + std::to_string(part);
  return (first.parent_path() / (name + first.extension().string())).string();
}

/// Reason why an existing file must not be replaced by a new recording; empty: it may be.
std::string reasonNotToReplace(const std::string& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) return {};
  if (!S_ISREG(status.st_mode)) return "is no regular file";
  std::ifstream in(path, std::ios::binary);
  std::array<char, hdf5::kSignature.size()> head{};
  in.read(head.data(), head.size());
  if (status.st_size > 0 && head != hdf5::kSignature)
    return "holds something else than a recording";
  if (DiskReserve::isOpenElsewhere(path)) return "is open in another program";
  return {};
}

/// Removes the parts after the first, except those with a reasonNotToReplace().
void removeParts(const std::string& path) {
  for (const std::string& part : recordingParts(path)) {
    if (reasonNotToReplace(part).empty()) ::unlink(part.c_str());
  }
}

}  // namespace

RecordingFile::RecordingFile(const RecordingMeta& meta)
    : ticks_(tickColumns(meta), chunkRows(meta.period_s)),
      contacts_(contactColumns(meta), kContactChunkRows),
      events_(eventColumns(meta), kRareChunkRows),
      commands_(commandColumns(meta), kRareChunkRows) {
  contacts_.beginChunks();
}

std::string RecordingFile::create(const std::string& path, const RecordingMeta& meta) {
  const std::string temporary = path + ".part";
  std::string problem = createAt(temporary, meta);
  if (problem.empty() && std::rename(temporary.c_str(), path.c_str()) != 0) {
    problem = std::string("cannot be created: ") + std::strerror(errno);
  }
  if (!problem.empty()) {
    end();
    ::unlink(temporary.c_str());
  }
  return problem;
}

std::string RecordingFile::createAt(const std::string& path, const RecordingMeta& meta) {
  const int error = reserve_.create(path);
  if (error != 0) return std::string("cannot be created: ") + std::strerror(error);
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_libver_bounds(access.get(), H5F_LIBVER_V110, H5F_LIBVER_V110);
  H5Pset_file_locking(access.get(), true, true);  // ignores missing lock support of a file system
  file_ = Handle(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access.get()), H5Fclose);
  // Space is reserved after H5Fcreate, which truncates the file and would release it.
  if (!reserve_.claim(metaBytes(meta))) return "cannot be created: the disk is full";
  if (!file_.ok() || !writeMeta(file_.get(), meta)) return "cannot be written by HDF5";
  const auto make_table = [this](const char* name, auto& table) {
    const Handle group(H5Gcreate2(file_.get(), name, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                       H5Gclose);
    return group.ok() && table.create(group.get());
  };
  if (!make_table("ticks", ticks_) || !make_table("contacts", contacts_) ||
      !make_table("events", events_) || !make_table("commands", commands_)) {
    return "cannot be written by HDF5";
  }
  // From now on readers can follow, and a kill leaves a readable file.
  if (H5Fstart_swmr_write(file_.get()) < 0) return "cannot be opened to readers (SWMR)";
  reserve_.mark();
  noteBytes();
  return {};
}

void RecordingFile::noteBytes() {
  if (hsize_t end = 0; H5Fget_filesize(file_.get(), &end) >= 0) bytes_ = end;
}

void RecordingFile::push(const TickRecord& record) {
  const std::uint64_t row = ticks_.written() + ticks_.pending();
  ticks_.push(record);
  for (int i = 0; i < std::min<int>(record.contact_count, kMaxContacts); ++i) {
    contacts_.push({row, record.contacts[i]});
  }
  for (int i = 0; i < std::min<int>(record.exercise.event_count, kMaxExerciseEvents); ++i) {
    events_.push({row, record.exercise.events[i]});
  }
  for (int i = 0; i < std::min<int>(record.command_count, kMaxCommands); ++i) {
    commands_.push({row, record.commands[i]});
  }
}

bool RecordingFile::claimRoom() {
  hsize_t end = 0;
  if (H5Fget_filesize(file_.get(), &end) < 0) return false;
  // A chunk may be rewritten as a whole, hence twice the rows.
  const std::uint64_t rows = ticks_.pendingBytes() + contacts_.pendingBytes() +
                             events_.pendingBytes() + commands_.pendingBytes();
  return reserve_.claim(end + 2 * rows + kTablesBytes);
}

RecordingFile::WriteResult RecordingFile::write() {
  if (!claimRoom()) return WriteResult::kNoRoom;
  // Ticks are written last, so that a tick on disk has its contacts, events and commands on disk as
  // well.
  if (!contacts_.write() || !events_.write() || !commands_.write() || !ticks_.write() ||
      H5Fflush(file_.get(), H5F_SCOPE_GLOBAL) < 0) {
    return WriteResult::kRefused;
  }
  contacts_.commit();
  events_.commit();
  commands_.commit();
  ticks_.commit();
  noteBytes();
  return WriteResult::kAll;
}

void RecordingFile::takeRowsOf(RecordingFile& before) {
  const std::uint64_t rows = before.written();
  contacts_.takeRowsOf(before.contacts_, rows);
  events_.takeRowsOf(before.events_, rows);
  commands_.takeRowsOf(before.commands_, rows);
  ticks_.takeRowsOf(before.ticks_, rows);
}

void RecordingFile::end() {
  ticks_.close();
  contacts_.close();
  events_.close();
  commands_.close();
  file_.reset();
  reserve_.release();
}

}  // namespace wholehand::recording

namespace wholehand {
namespace {

using recording::RecordingFile;
using Clock = std::chrono::steady_clock;

/// Rows older than this are written before their chunk is full, so that a kill loses less than 1.5
/// s.
constexpr auto kOldest = std::chrono::milliseconds(1200);
/// Time before writing is retried after a disk refused a write.
constexpr auto kRetryAfter = std::chrono::milliseconds(100);

class Hdf5Writer final : public RecordingWriter {
 public:
  Hdf5Writer(std::string path, RecordingMeta meta)
      : path_(std::move(path)),
        meta_(std::move(meta)),
        most_pending_(recording::chunkRows(meta_.period_s)),
        file_(std::make_unique<RecordingFile>(meta_)) {}
  ~Hdf5Writer() override { close(); }

  /// Creates the file with everything except ticks. Returns the error, or an empty text.
  std::string create();

  bool append(const TickRecord& record) override;
  void flush() override {
    hdf5::beginHdf5();
    writeOut();
  }
  void close() override;
  [[nodiscard]] std::uint64_t written() const override { return written_; }
  [[nodiscard]] std::uint64_t dropped() const override { return dropped_; }
  [[nodiscard]] std::uint64_t bytes() const override { return bytes_; }

 private:
  bool writeOut();
  bool beginPart();
  void endFile();

  const std::string path_;
  const RecordingMeta meta_;
  const std::uint64_t most_pending_;
  std::unique_ptr<RecordingFile> file_;  ///< null: closed, or never created
  std::unique_ptr<InputJournal> journal_;
  int part_ = 1;
  bool refused_ = false;                            ///< the disk refused a write to this file
  std::uint64_t ended_rows_ = 0, ended_bytes_ = 0;  ///< rows and bytes of the previous parts
  Clock::time_point oldest_pending_{};
  Clock::time_point failed_at_ = Clock::time_point::min();
  bool failing_ = false;
  std::atomic<std::uint64_t> written_{0}, dropped_{0}, bytes_{0};
};

std::string Hdf5Writer::create() {
  std::string problem = InputJournal::create(InputJournal::pathOf(path_), meta_, journal_);
  if (problem.empty()) problem = file_->create(path_, meta_);
  if (problem.empty()) {
    bytes_ = file_->bytes();
  } else {
    file_.reset();
    if (journal_) journal_->remove();
  }
  return problem;
}

bool Hdf5Writer::append(const TickRecord& record) {
  hdf5::beginHdf5();
  if (journal_) journal_->append(record);
  if (file_ == nullptr || (file_->pending() >= most_pending_ && !writeOut())) {
    ++dropped_;
    return false;
  }
  if (file_->pending() == 0) oldest_pending_ = Clock::now();
  file_->push(record);
  if (file_->atChunkEnd() || Clock::now() - oldest_pending_ > kOldest) writeOut();
  return true;
}

bool Hdf5Writer::writeOut() {
  if (file_ == nullptr) return false;
  if (file_->pending() == 0) return true;
  if (failing_ && Clock::now() - failed_at_ < kRetryAfter) return false;
  failing_ = true;
  if (!refused_ || beginPart()) {
    const RecordingFile::WriteResult done = file_->write();
    failing_ = done != RecordingFile::WriteResult::kAll;
    refused_ = done == RecordingFile::WriteResult::kRefused;
  }
  if (failing_) {
    failed_at_ = Clock::now();
    return false;
  }
  written_ = ended_rows_ + file_->written();
  bytes_ = ended_bytes_ + file_->bytes();
  return true;
}

// Begins a new part of the recording. HDF5 cannot repair a file after a write that the disk
// refused.
bool Hdf5Writer::beginPart() {
  if (part_ >= recording::kMostParts) return false;
  const std::string path = recording::partPath(path_, part_ + 1);
  auto part = std::make_unique<RecordingFile>(meta_);
  if (!recording::reasonNotToReplace(path).empty() || !part->create(path, meta_).empty())
    return false;
  part->takeRowsOf(*file_);
  endFile();
  file_ = std::move(part);
  ++part_;
  return true;
}

void Hdf5Writer::endFile() {
  file_->end();
  if (file_->hasName()) {
    (void)syncDurably(part_ == 1 ? path_ : recording::partPath(path_, part_));
    ended_rows_ += file_->written();
    ended_bytes_ += file_->bytes();
  } else {
    dropped_ += file_->written();
  }
  written_ = ended_rows_;
}

void Hdf5Writer::close() {
  hdf5::beginHdf5();
  if (file_ == nullptr) return;
  failing_ = false;  // one last attempt, without waiting for the retry interval
  if (!writeOut() && refused_) {
    failing_ = false;
    writeOut();
  }
  dropped_ += file_->pending();
  endFile();
  file_.reset();
  if (journal_ && dropped_ > 0) journal_->flush();
  // Keeps the journal if ticks were dropped, because they can be rebuilt from it.
  if (journal_ && dropped_ == 0) journal_->remove();
  journal_.reset();
}

}  // namespace

std::vector<std::string> recordingParts(const std::string& path) {
  std::vector<std::string> parts;
  std::error_code error;
  for (int part = 2; part <= recording::kMostParts; ++part) {
    std::string name = recording::partPath(path, part);
    if (!std::filesystem::is_regular_file(name, error)) break;
    parts.push_back(std::move(name));
  }
  return parts;
}

Expected<std::unique_ptr<RecordingWriter>> RecordingWriter::create(const std::string& path,
                                                                   const RecordingMeta& meta) {
  hdf5::beginHdf5();
  const auto refuse = [&path](std::string problem) {
    return fileFault(path, std::move(problem),
                     "name a file in a folder that exists, is writable and has room");
  };
  if (const std::string reason = recording::unusable(meta); !reason.empty()) {
    return refuse("cannot be recorded: the description " + reason);
  }
  if (const std::string why = recording::reasonNotToReplace(path); !why.empty()) return refuse(why);
  auto writer = std::make_unique<Hdf5Writer>(path, meta);
  if (std::string problem = writer->create(); !problem.empty()) return refuse(std::move(problem));
  recording::removeParts(path);  // removes the parts of the replaced recording
  return Expected<std::unique_ptr<RecordingWriter>>(std::move(writer));
}

}  // namespace wholehand
