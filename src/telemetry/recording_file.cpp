#include "telemetry/recording_file.hpp"

#include "telemetry/recording_meta.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <unistd.h>

namespace wholehand::recording {
namespace {

using hdf5::Handle;

/// Growth limit of HDF5's own structures per write, beside the rows.
constexpr std::uint64_t kTablesBytes = std::uint64_t{1} << 20U;

std::uint64_t metaBytes(const RecordingMeta& meta) {
  std::uint64_t n = kTablesBytes;
  for (const auto& [name, text] : meta.files) n += name.size() + text.size() + 4096;
  return n;
}

}  // namespace

RecordingFile::RecordingFile(const RecordingMeta& meta)
    : ticks_(tickColumns(meta), chunkRows(meta.period_s)),
      contacts_(contactColumns(), kContactChunkRows),
      events_(eventColumns(), kRareChunkRows),
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
  H5Pset_file_locking(access.get(), true, true);  // not every file system supports locking
  file_ = Handle(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access.get()), H5Fclose);
  // After H5Fcreate, which truncates the file and would release the reserved space.
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
  // From here on, readers may follow, and a kill leaves a readable file.
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

RecordingFile::Written RecordingFile::write() {
  if (!claimRoom()) return Written::kNoRoom;
  // Ticks last: a tick on disk then has its contacts, events and commands on disk as well.
  if (!contacts_.write() || !events_.write() || !commands_.write() || !ticks_.write() ||
      H5Fflush(file_.get(), H5F_SCOPE_GLOBAL) < 0) {
    return Written::kRefused;
  }
  contacts_.commit();
  events_.commit();
  commands_.commit();
  ticks_.commit();
  noteBytes();
  return Written::kAll;
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
