#include "loop/core/printable.hpp"
#include "record/black_box_reader.hpp"
#include "record/disk_reserve.hpp"
#include "record/hdf5_tables.hpp"
#include "record/recorded_tables.hpp"
#include "record/recording.hpp"
#include "record/recording_meta.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <fcntl.h>
#include <fstream>
#include <optional>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

namespace wholehand {
namespace {

using hdf5::Handle;
using hdf5::readAttribute;

constexpr const char* kGiveRecording = "give a .h5 file that `wholehand run --record` wrote";
constexpr const char* kBrokenCopy =
    "copy it again from where it was recorded; what is missing cannot be restored";

/// Checks the superblock in the first bytes: returns an error if the file is not HDF5, and true if
/// its writer left it open (killed or still writing).
Expected<bool> leftOpen(const std::string& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) {
    return fileFault(path, std::string("cannot be read: ") + std::strerror(errno), kGiveRecording);
  }
  if (!S_ISREG(status.st_mode)) return fileFault(path, "is no regular file", kGiveRecording);
  std::ifstream in(path, std::ios::binary);
  std::array<char, 12> head{};
  if (!in)
    return fileFault(path, std::string("cannot be read: ") + std::strerror(errno), kGiveRecording);
  in.read(head.data(), head.size());
  if (in.gcount() == 0) return fileFault(path, "is empty", kGiveRecording);
  if (in.gcount() < 12 ||
      !std::equal(hdf5::kSignature.begin(), hdf5::kSignature.end(), head.begin())) {
    return fileFault(path, "is no HDF5 file", kGiveRecording);
  }
  // Open for writing; open in single-writer-multiple-reader mode.
  constexpr char kWriteBits = 0x01 | 0x04;
  return head[8] >= 3 && (head[11] & kWriteBits) != 0;
}

/// Reads the description in a child process; returns none if that process fails. HDF5 1.10 reads
/// beyond its memory in damaged texts of variable length, which only other programs write.
std::optional<RecordingMeta> readMetaApart(hid_t file, hid_t meta_group, std::uint64_t schema) {
  constexpr unsigned kPatience_s = 10;
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) return std::nullopt;
  const pid_t child = ::fork();
  if (child == 0) {
    ::alarm(kPatience_s);
    RecordingMeta meta;
    meta.schema = schema;
    std::string kind;
    const bool read = readAttribute(meta_group, "format", kind) && kind == recording::kFormat &&
                      recording::readMeta(file, meta_group, meta).empty();
    const std::vector<std::byte> packed = black_box::packMeta(meta);
    std::size_t sent = 0;
    while (read && sent < packed.size()) {
      const ssize_t more = ::write(ends[1], packed.data() + sent, packed.size() - sent);
      if (more <= 0) break;
      sent += static_cast<std::size_t>(more);
    }
    ::_exit(read && sent == packed.size() ? 0 : 1);
  }
  ::close(ends[1]);
  std::vector<std::byte> packed;
  std::array<std::byte, 4096> piece{};
  for (ssize_t more = 1; child > 0 && more != 0;) {
    more = ::read(ends[0], piece.data(), piece.size());
    if (more < 0 && errno != EINTR) break;
    if (more > 0) packed.insert(packed.end(), piece.begin(), piece.begin() + more);
  }
  ::close(ends[0]);
  int status = -1;
  while (child > 0 && ::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  RecordingMeta meta;
  meta.schema = schema;
  if (child <= 0 || !WIFEXITED(status) || WEXITSTATUS(status) != 0 ||
      !black_box::unpackMeta(packed.data(), packed.size(), meta)) {
    return std::nullopt;
  }
  return meta;
}

class Hdf5Reader final : public RecordingReader {
 public:
  /// @param marks true: marks a file that its writer left open as being read
  Hdf5Reader(bool marks, LeftOut left_out) : marks_(marks), left_out_(std::move(left_out)) {}
  /// Opens and checks the file. Returns the error, or Done.
  Expected<Done> open(const std::string& path, bool left_open);
  /// Forwarded to RecordedTables. @pre open() succeeded
  [[nodiscard]] bool endsWhole() { return tables_->endsWhole(); }
  std::optional<std::uint64_t> leaveOutDamagedEnd() { return tables_->leaveOutDamagedEnd(); }

  [[nodiscard]] const RecordingMeta& meta() const override { return meta_; }
  [[nodiscard]] std::uint64_t size() const override { return tables_->size(); }
  [[nodiscard]] const RecordingOutline& outline() const override { return tables_->outline(); }
  bool read(std::uint64_t i, TickRecord& record) override { return tables_->read(i, record); }
  [[nodiscard]] std::uint64_t digest() const override { return tables_->digest(); }
  [[nodiscard]] bool isExact() const override { return false; }

 private:
  Expected<Done> readDescription(const std::string& path);

  Handle file_;
  RecordingMeta meta_;
  std::optional<recording::RecordedTables> tables_;
  const bool marks_;
  const LeftOut left_out_;
};

Expected<Done> Hdf5Reader::open(const std::string& path, bool left_open) {
  const auto writer = !left_open                           ? recording::WriterState::kClosed
                      : DiskReserve::isOpenElsewhere(path) ? recording::WriterState::kWriting
                                                           : recording::WriterState::kLeft;
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_file_locking(access.get(), marks_ || !left_open, true);
  // HDF5 doubles its waiting time before each new attempt, starting at 1 ns. Its default of 100
  // attempts on a damaged part of a file left open would practically never end.
  if (left_open) H5Pset_metadata_read_attempts(access.get(), 25);
  // A file whose writer was killed is opened like one that is still being written, so it needs no
  // repair.
  const unsigned mode = H5F_ACC_RDONLY | (left_open ? H5F_ACC_SWMR_READ : 0U);
  file_ = Handle(H5Fopen(path.c_str(), mode, access.get()), H5Fclose);
  if (!file_.ok()) return fileFault(path, "is truncated or damaged", kBrokenCopy);
  if (auto described = readDescription(path); !described) return described;
  tables_.emplace(meta_, left_out_);
  recording::Hdf5Tables tables(file_.get());
  if (const std::string problem = tables_->open(tables, writer); !problem.empty()) {
    return fileFault(path, problem, kBrokenCopy);
  }
  return Done{};
}

Expected<Done> Hdf5Reader::readDescription(const std::string& path) {
  const Handle group(H5Gopen2(file_.get(), "meta", H5P_DEFAULT), H5Gclose);
  const bool apart = group.ok() && recording::hasVariableText(file_.get());
  std::string kind;
  std::uint64_t version = 0;
  if (!group.ok() || !readAttribute(group.get(), "schema_version", version) ||
      (!apart && !(readAttribute(group.get(), "format", kind) && kind == recording::kFormat))) {
    return fileFault(path, "is an HDF5 file, but no Wholehand recording", kGiveRecording);
  }
  meta_.schema = version;
  if (version < kOldestSchema || version > kPrescribedSchema) {
    const bool newer = version > kPrescribedSchema;
    std::string by;
    const bool said =
        !apart && readAttribute(group.get(), "git_version", by) && isPrintable(by, 500);
    auto d =
        fileFault(path, newer ? "was written by a newer Wholehand" : "is of an earlier version",
                  "this program reads schema versions " + std::to_string(kOldestSchema) + " to " +
                      std::to_string(kPrescribedSchema) +
                      (newer ? "; update it"
                             : "; record anew, or read it with a program of its time" +
                                   (said ? ": " + by : "")));
    d.key = "schema_version";
    d.value = std::to_string(version);
    return d;
  }
  if (apart) {
    auto meta = readMetaApart(file_.get(), group.get(), version);
    if (!meta) return fileFault(path, "is damaged: its texts cannot be read", kBrokenCopy);
    meta_ = std::move(*meta);
  } else if (const std::string unread = recording::readMeta(file_.get(), group.get(), meta_);
             !unread.empty()) {
    return fileFault(path, "is truncated or damaged: " + unread + " cannot be read", kBrokenCopy);
  }
  if (const std::string reason = recording::unusable(meta_); !reason.empty()) {
    return fileFault(path, "is damaged: its description " + reason, kBrokenCopy);
  }
  return Done{};
}

Expected<std::unique_ptr<Hdf5Reader>> openHdf5(const std::string& path, bool marks,
                                               const LeftOut& left_out) {
  hdf5::beginHdf5();
  const auto left_open = leftOpen(path);
  if (!left_open) return left_open.errors();
  auto reader = std::make_unique<Hdf5Reader>(marks, left_out);
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
  auto reader = openHdf5(path, true, {});
  if (!reader) return reader.errors();
  // The last rows lie at the end of the file, so this check detects an incomplete copy.
  if (!(*reader)->endsWhole()) {
    return fileFault(path, "is truncated: its last ticks cannot be read", kBrokenCopy);
  }
  return Expected<std::unique_ptr<RecordingReader>>(std::move(*reader));
}

Expected<ViewedRecording> viewRecording(const std::string& path, const LeftOut& left_out) {
  auto reader = openHdf5(path, false, left_out);
  if (!reader) return reader.errors();
  ViewedRecording viewed;
  const auto& numbers = (*reader)->outline().numbers;
  viewed.last_tick = numbers.empty() ? 0 : numbers.back();
  viewed.unreadable_from_tick = (*reader)->leaveOutDamagedEnd();
  viewed.reader = std::move(*reader);
  return viewed;
}

Diagnostics notShown(const ViewedRecording& viewed, const UnreadTicks& unread,
                     const std::string& path) {
  Diagnostics all;
  const RecordingOutline& outline = viewed.reader->outline();
  if (!outline.flaw.empty()) {
    all.push_back(fileFault(path, "is damaged: " + outline.flaw, kBrokenCopy));
  }
  if (outline.contradicted_tick) {
    all.push_back(fileFault(path,
                            "is damaged: tick " + std::to_string(*outline.contradicted_tick) + " " +
                                outline.contradiction,
                            kBrokenCopy));
  }
  if (outline.missing > 0) {
    all.push_back(fileFault(path,
                            "is not whole: " + std::to_string(outline.missing) +
                                (outline.missing == 1 ? " tick is missing" : " ticks are missing"),
                            "where a .inputs file stands beside it, `wholehand replay` makes the "
                            "recording again of that"));
  }
  if (unread.count > 0) {
    all.push_back(unreadable(path, unread.first, viewed.reader->size()));
  }
  if (viewed.unreadable_from_tick) {
    all.push_back(fileFault(path,
                            "is damaged: nothing can be read from tick " +
                                std::to_string(*viewed.unreadable_from_tick) + " on",
                            kBrokenCopy));
  }
  return all;
}

std::uint64_t missingBetween(std::uint64_t before, std::uint64_t tick,
                             std::uint32_t elapsed_periods) {
  const std::uint64_t next = before + elapsed_periods;
  return tick > next ? tick - next : 0;
}

Diagnostic unreadable(const std::string& path, std::uint64_t i, std::uint64_t size) {
  return fileFault(path,
                   "is damaged: tick " + std::to_string(i + 1) + " of " + std::to_string(size) +
                       " cannot be read",
                   kBrokenCopy);
}

}  // namespace wholehand
