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
  std::uint64_t clock = 0, uncertified = 0, paper = 0;
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
  meta.simulated_clock = clock != 0;
  meta.uncertified = uncertified != 0;
  meta.paper = paper != 0;
  return ok && readFiles(file, meta);
}

class Hdf5Reader final : public RecordingReader {
 public:
  /// Opens and checks. What is wrong, or Done.
  Expected<Done> open(const std::string& path, bool left_open);

  [[nodiscard]] const RecordingMeta& meta() const override { return meta_; }
  [[nodiscard]] std::uint64_t size() const override { return size_; }
  bool read(std::uint64_t i, TickRecord& record) override;

 private:
  Expected<Done> readDescription(const std::string& path);
  /// Opens the two tables and counts the ticks that are complete. What is wrong, or nothing.
  std::string openTables();
  std::string countTicks();
  bool loadAround(std::uint64_t i);
  [[nodiscard]] bool holds(std::uint64_t i) const;

  Handle file_;
  RecordingMeta meta_;
  std::unique_ptr<recording::TableReader<TickRecord>> ticks_;
  std::unique_ptr<recording::TableReader<recording::ContactRow>> contacts_;
  std::vector<std::uint64_t> first_contact_;  ///< of each tick, and the end of the last
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
  if (version != recording::kSchemaVersion) {
    const bool newer = version > recording::kSchemaVersion;
    auto d =
        refusal(path, newer ? "was written by a newer Wholehand" : "is of an unknown version",
                "this program reads schema version " + std::to_string(recording::kSchemaVersion) +
                    (newer ? "; update it" : "; record anew"));
    d.key = "schema_version";
    d.value = std::to_string(version);
    return d;
  }
  if (!readMeta(file_.get(), group.get(), meta_)) {
    return refusal(path, "is truncated or damaged: its description cannot be read", kBrokenCopy);
  }
  if (const std::string reason = recording::unusable(meta_); !reason.empty()) {
    return refusal(path, "is damaged: its description " + reason, kBrokenCopy);
  }
  return Done{};
}

std::string Hdf5Reader::openTables() {
  ticks_ = std::make_unique<recording::TableReader<TickRecord>>(recording::tickColumns(meta_));
  contacts_ =
      std::make_unique<recording::TableReader<recording::ContactRow>>(recording::contactColumns());
  const Handle tick_group(H5Gopen2(file_.get(), "ticks", H5P_DEFAULT), H5Gclose);
  const Handle contact_group(H5Gopen2(file_.get(), "contacts", H5P_DEFAULT), H5Gclose);
  if (!tick_group.ok() || !contact_group.ok()) return "is truncated: it has no ticks or contacts";
  for (const std::string& problem :
       {ticks_->open(tick_group.get()), contacts_->open(contact_group.get())}) {
    if (!problem.empty()) return "is damaged: it " + problem;
  }
  block_ = recording::chunkRows(meta_.period_s);
  if (std::string problem = countTicks(); !problem.empty()) return problem;
  // The last rows lie at the end of the file: a copy that stopped early shows here.
  if (size_ > 0 && !loadAround(size_ - 1)) return "is truncated: its last ticks cannot be read";
  return {};
}

std::string Hdf5Reader::countTicks() {
  std::vector<std::int32_t> counts;
  std::vector<std::uint64_t> numbers;
  hsize_t bytes = 0;
  if (H5Fget_filesize(file_.get(), &bytes) < 0 || ticks_->rows() / kMostTicksPerByte > bytes) {
    return "is damaged: it claims more ticks than a file of its size can hold";
  }
  if (!ticks_->readAll("contact_count", counts) || !ticks_->readAll("tick", numbers)) {
    return "is truncated or damaged: its ticks cannot be read";
  }
  first_contact_.assign(1, 0);
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const auto count = static_cast<std::uint64_t>(std::clamp(counts[i], 0, kMaxContacts));
    const std::uint64_t end = first_contact_.back() + count;
    if (numbers[i] == UINT64_MAX || end > contacts_->rows()) break;  // the kill came in between
    first_contact_.push_back(end);
  }
  size_ = first_contact_.size() - 1;
  return {};
}

bool Hdf5Reader::loadAround(std::uint64_t i) {
  const std::uint64_t first = i / block_ * block_;
  const std::uint64_t last = std::min(size_, first + block_);
  return ticks_->load(first, last - first) &&
         contacts_->load(first_contact_[first], first_contact_[last] - first_contact_[first]);
}

// Of a damaged file the ticks may have been read and their contacts not.
bool Hdf5Reader::holds(std::uint64_t i) const {
  if (!ticks_->holds(i)) return false;
  if (first_contact_[i] == first_contact_[i + 1]) return true;
  return contacts_->holds(first_contact_[i]) && contacts_->holds(first_contact_[i + 1] - 1);
}

bool Hdf5Reader::read(std::uint64_t i, TickRecord& record) {
  if (i >= size_) return false;
  hdf5::silenceErrors();
  if (!holds(i) && !loadAround(i)) return false;
  record = TickRecord{};
  ticks_->get(i, record);
  record.body_count =
      std::clamp(record.body_count, 0, static_cast<std::int32_t>(meta_.body_names.size()));
  record.contact_count = static_cast<std::int32_t>(first_contact_[i + 1] - first_contact_[i]);
  for (std::int32_t c = 0; c < record.contact_count; ++c) {
    recording::ContactRow row;
    contacts_->get(first_contact_[i] + static_cast<std::uint64_t>(c), row);
    record.contacts[static_cast<std::size_t>(c)] = row.contact;
  }
  return true;
}

}  // namespace

Expected<std::unique_ptr<RecordingReader>> RecordingReader::open(const std::string& path) {
  hdf5::silenceErrors();
  const auto left_open = leftOpen(path);
  if (!left_open) return left_open.errors();
  auto reader = std::make_unique<Hdf5Reader>();
  if (auto opened = reader->open(path, *left_open); !opened) return opened.errors();
  return Expected<std::unique_ptr<RecordingReader>>(std::move(reader));
}

}  // namespace wholehand
