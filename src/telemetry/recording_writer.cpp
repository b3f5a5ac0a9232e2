#include "telemetry/disk_reserve.hpp"
#include "telemetry/recording.hpp"
#include "telemetry/recording_layout.hpp"
#include "telemetry/table_writer.hpp"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <sys/stat.h>
#include <unistd.h>

namespace wholehand {
namespace {

using hdf5::Handle;
using hdf5::writeAttribute;
using Clock = std::chrono::steady_clock;

/// Rows older than this are written although their chunk is not full: a kill costs less than 1 s.
constexpr auto kOldest = std::chrono::milliseconds(400);
/// How long a full disk is left alone before writing is tried again.
constexpr auto kRetryAfter = std::chrono::milliseconds(100);
/// What HDF5's own tables may grow by in one write, beside the rows.
constexpr std::uint64_t kTablesBytes = std::uint64_t{1} << 20U;

bool writeMeta(hid_t file, const RecordingMeta& meta) {
  const Handle group(H5Gcreate2(file, "meta", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
  const hid_t id = group.get();
  const auto flag = [](bool b) { return std::uint64_t{b ? 1U : 0U}; };
  bool ok = group.ok() && writeAttribute(id, "format", std::string(recording::kFormat)) &&
            writeAttribute(id, "schema_version", kRecordingSchema) &&
            writeAttribute(id, "created_utc", meta.created_utc) &&
            writeAttribute(id, "git_version", meta.git_version) &&
            writeAttribute(id, "title", meta.title) && writeAttribute(id, "seed", meta.seed) &&
            writeAttribute(id, "period_s", meta.period_s) &&
            writeAttribute(id, "engine", meta.engine) &&
            writeAttribute(id, "simulated_clock", flag(meta.simulated_clock)) &&
            writeAttribute(id, "uncertified", flag(meta.uncertified)) &&
            writeAttribute(id, "paper", flag(meta.paper)) &&
            writeAttribute(id, "simulated_device", flag(meta.simulated_device)) &&
            writeAttribute(id, "axis_names", meta.axis_names) &&
            writeAttribute(id, "axis_units", meta.axis_units) &&
            writeAttribute(id, "effort_limits", meta.effort_limits) &&
            writeAttribute(id, "lever_arms_m", meta.lever_arms_m) &&
            writeAttribute(id, "armed_position", meta.armed_position) &&
            writeAttribute(id, "joint_names", meta.joint_names) &&
            writeAttribute(id, "body_names", meta.body_names) &&
            writeAttribute(id, "capsule_names", meta.capsule_names) &&
            writeAttribute(id, "exercise", meta.exercise) &&
            writeAttribute(id, "level", static_cast<std::uint64_t>(std::max(meta.level, 0))) &&
            writeAttribute(id, "parameter_names", meta.parameter_names) &&
            writeAttribute(id, "parameter_values", meta.parameter_values) &&
            writeAttribute(id, "value_names", meta.value_names) &&
            writeAttribute(id, "event_names", meta.event_names);
  const Handle files(H5Gcreate2(file, "meta/files", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                     H5Gclose);
  for (std::size_t i = 0; ok && i < meta.files.size(); ++i) {
    const auto& [name, text] = meta.files[i];
    ok = hdf5::writeText(files.get(), std::to_string(i).c_str(), name, text);
  }
  return ok && files.ok();
}

std::uint64_t metaBytes(const RecordingMeta& meta) {
  std::uint64_t n = kTablesBytes;
  for (const auto& [name, text] : meta.files) n += name.size() + text.size() + 4096;
  return n;
}

class Hdf5Writer final : public RecordingWriter {
 public:
  explicit Hdf5Writer(const RecordingMeta& meta)
      : ticks_(recording::tickColumns(meta), recording::chunkRows(meta.period_s)),
        contacts_(recording::contactColumns(), recording::kContactChunkRows),
        events_(recording::eventColumns(), recording::kRareChunkRows),
        commands_(recording::commandColumns(meta), recording::kRareChunkRows),
        most_pending_(recording::chunkRows(meta.period_s)) {}
  ~Hdf5Writer() override { close(); }

  /// Creates the file with everything but ticks. What went wrong, or nothing.
  std::string create(const std::string& path, const RecordingMeta& meta);

  bool append(const TickRecord& record) override;
  void flush() override {
    hdf5::silenceErrors();
    writeOut();
  }
  void close() override;
  [[nodiscard]] std::uint64_t written() const override { return written_; }
  [[nodiscard]] std::uint64_t dropped() const override { return dropped_; }
  [[nodiscard]] std::uint64_t bytes() const override { return bytes_; }

 private:
  bool writeOut();
  [[nodiscard]] bool claimRoom();
  void noteBytes() {
    if (hsize_t end = 0; H5Fget_filesize(file_.get(), &end) >= 0) bytes_ = end;
  }

  DiskReserve reserve_;
  Handle file_;
  recording::TableWriter<TickRecord> ticks_;
  recording::TableWriter<recording::ContactRow> contacts_;
  recording::TableWriter<recording::EventRow> events_;
  recording::TableWriter<recording::CommandRow> commands_;
  std::uint64_t most_pending_;
  Clock::time_point oldest_pending_{};
  Clock::time_point failed_at_ = Clock::time_point::min();
  bool failing_ = false;
  std::atomic<std::uint64_t> written_{0}, dropped_{0}, bytes_{0};
};

std::string Hdf5Writer::create(const std::string& path, const RecordingMeta& meta) {
  const int error = reserve_.create(path);
  if (error != 0) return std::string("cannot be created: ") + std::strerror(error);
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_libver_bounds(access.get(), H5F_LIBVER_V110, H5F_LIBVER_V110);
  H5Pset_file_locking(access.get(), true, true);  // not every file system can lock
  file_ = Handle(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access.get()), H5Fclose);
  // After H5Fcreate: it empties the file, which would give the claimed space back.
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
  // From here on a reader may follow along, and a kill leaves a readable file.
  if (H5Fstart_swmr_write(file_.get()) < 0) return "cannot be opened to readers (SWMR)";
  noteBytes();
  return {};
}

bool Hdf5Writer::append(const TickRecord& record) {
  hdf5::silenceErrors();
  if (!file_.ok() || (ticks_.pending() >= most_pending_ && !writeOut())) {
    ++dropped_;
    return false;
  }
  if (ticks_.pending() == 0) oldest_pending_ = Clock::now();
  const std::uint64_t row = ticks_.written() + ticks_.pending();
  ticks_.push(record);
  for (int i = 0; i < std::min<int>(record.contact_count, kMaxContacts); ++i) {
    contacts_.push({row, record.contacts[static_cast<std::size_t>(i)]});
  }
  for (int i = 0; i < std::min<int>(record.exercise.event_count, kMaxExerciseEvents); ++i) {
    events_.push({row, record.exercise.events[static_cast<std::size_t>(i)]});
  }
  for (int i = 0; i < std::min<int>(record.command_count, kMaxCommands); ++i) {
    commands_.push({row, record.commands[static_cast<std::size_t>(i)]});
  }
  if (ticks_.atChunkEnd() || Clock::now() - oldest_pending_ > kOldest) writeOut();
  return true;
}

bool Hdf5Writer::claimRoom() {
  hsize_t end = 0;
  if (H5Fget_filesize(file_.get(), &end) < 0) return false;
  // A chunk may be written anew as a whole, hence twice the rows.
  const std::uint64_t rows = ticks_.pendingBytes() + contacts_.pendingBytes() +
                             events_.pendingBytes() + commands_.pendingBytes();
  return reserve_.claim(end + 2 * rows + kTablesBytes);
}

bool Hdf5Writer::writeOut() {
  if (!file_.ok()) return false;
  if (ticks_.pending() == 0) return true;
  if (failing_ && Clock::now() - failed_at_ < kRetryAfter) return false;
  // Ticks last: a tick on the disk then has its contacts, events and commands there too.
  failing_ = !claimRoom() || !contacts_.write() || !events_.write() || !commands_.write() ||
             !ticks_.write() || H5Fflush(file_.get(), H5F_SCOPE_GLOBAL) < 0;
  if (failing_) {
    failed_at_ = Clock::now();
    return false;
  }
  contacts_.commit();
  events_.commit();
  commands_.commit();
  ticks_.commit();
  written_ = ticks_.written();
  noteBytes();
  return true;
}

void Hdf5Writer::close() {
  hdf5::silenceErrors();
  if (!file_.ok()) return;
  failing_ = false;  // a last try, whenever the one before was
  writeOut();
  dropped_ += ticks_.pending();
  ticks_.close();
  contacts_.close();
  events_.close();
  commands_.close();
  file_.reset();
  reserve_.release();
  if (!reserve_.hasName()) dropped_ += written_.exchange(0);
}

}  // namespace

Expected<std::unique_ptr<RecordingWriter>> RecordingWriter::create(const std::string& path,
                                                                   const RecordingMeta& meta) {
  hdf5::silenceErrors();
  const auto refuse = [&path](std::string problem) {
    Diagnostic d;
    d.file = path;
    d.problem = std::move(problem);
    d.remedy = "name a file in a folder that exists, is writable and has room";
    return d;
  };
  if (const std::string reason = recording::unusable(meta); !reason.empty()) {
    return refuse("cannot be recorded: the description " + reason);
  }
  struct stat status {};
  if (::stat(path.c_str(), &status) == 0 && !S_ISREG(status.st_mode)) {
    return refuse("is no regular file");
  }
  const std::string temporary = path + ".part";
  auto writer = std::make_unique<Hdf5Writer>(meta);
  std::string problem = writer->create(temporary, meta);
  if (problem.empty() && std::rename(temporary.c_str(), path.c_str()) != 0) {
    problem = std::string("cannot be created: ") + std::strerror(errno);
  }
  if (!problem.empty()) {
    writer.reset();
    ::unlink(temporary.c_str());
    return refuse(std::move(problem));
  }
  return Expected<std::unique_ptr<RecordingWriter>>(std::move(writer));
}

}  // namespace wholehand
