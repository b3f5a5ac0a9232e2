#include "record/black_box_reader.hpp"

#include "loop/core/crc32.hpp"
#include "loop/core/record_packing.hpp"
#include "loop/core/tick_digest.hpp"
#include "record/black_box_layout.hpp"
#include "record/recording_layout.hpp"
#include "record/recording_meta.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <span>
#include <system_error>
#include <vector>

namespace wholehand {
namespace {

using black_box::Entry;
using black_box::Header;
using black_box::Part;
using Bytes = std::span<const std::byte>;

constexpr const char* kCopyAgain =
    "copy it again from where it was written; what is missing cannot be restored";
/// Largest accepted file: three times the memory that a BlackBoxPlan allows plus the embedded
/// files.
constexpr std::uintmax_t kLargestBox_bytes = std::uintmax_t{1} << 30U;

std::vector<std::byte> wholeFile(const std::string& path) {
  std::ifstream in(path, std::ios::binary | std::ios::ate);
  const std::streamoff size = in ? static_cast<std::streamoff>(in.tellg()) : 0;
  std::vector<std::byte> bytes(std::max<std::streamoff>(size, 0));
  in.seekg(0);
  in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (!in) bytes.clear();
  return bytes;
}

template <class T>
T copyOf(Bytes bytes, std::size_t at = 0) {
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

std::string versionIn(const Header& header) {
  const auto end = std::find(header.program.begin(), header.program.end(), '\0');
  std::string version(header.program.begin(), end);
  for (char& c : version) {
    if (c < ' ' || c > '~') c = '?';
  }
  return version;
}

class MemoryReader final : public BlackBoxReader {
 public:
  Expected<Done> open(const std::string& path);

  [[nodiscard]] const RecordingMeta& meta() const override { return meta_; }
  [[nodiscard]] std::uint64_t size() const override { return entries_.size(); }
  [[nodiscard]] const RecordingOutline& outline() const override { return outline_; }
  bool read(std::uint64_t i, TickRecord& record) override;
  [[nodiscard]] std::uint64_t digest() const override { return digest_; }
  [[nodiscard]] bool isExact() const override { return true; }
  [[nodiscard]] const BlackBoxCause& cause() const override { return cause_; }
  [[nodiscard]] bool inputsWhole() const override { return header_.inputs_whole != 0; }
  bool nextInput(TickInput& input) override;
  [[nodiscard]] std::uint64_t inputTicks() const override { return input_ticks_; }

 private:
  Expected<Done> checkHeader(const std::string& path);
  /// Finds the parts. Returns the error, or an empty text.
  std::string findParts();
  std::string readMeta();
  std::string readEntries();
  std::string checkTicks();
  std::string readInputs();
  [[nodiscard]] Bytes part(Part p) const { return parts_[static_cast<std::size_t>(p)]; }

  std::vector<std::byte> file_;
  Header header_;
  BlackBoxCause cause_;
  std::array<Bytes, static_cast<std::size_t>(Part::kCount)> parts_{};
  RecordingMeta meta_;
  std::vector<Entry> entries_;  ///< entries that were not overwritten during writing
  RecordingOutline outline_;
  std::uint64_t digest_ = 0;
  InputLogState log_;
  std::size_t next_input_ = 0;  ///< offset in the inputs' part
  std::uint64_t input_ticks_ = 0;
};

Expected<Done> MemoryReader::checkHeader(const std::string& path) {
  if (file_.size() < sizeof(Header)) {
    return fileFault(path, "is a black box that was cut off", kCopyAgain);
  }
  header_ = copyOf<Header>(file_);
  const bool sound = crc32(0, file_.data(), offsetof(Header, crc)) == header_.crc;
  const bool same_format =
      header_.format == black_box::kFormat && header_.header_bytes == sizeof(Header);
  if (same_format && !sound) return fileFault(path, "is a damaged black box", kCopyAgain);
  if (!same_format || header_.record_bytes != sizeof(TickRecord) ||
      header_.record_layout != recordLayout()) {
    const std::string version = versionIn(header_);
    return fileFault(path, "is a black box of another version of Wholehand: " + version,
                     "read it with the program that wrote it");
  }
  return Done{};
}

std::string MemoryReader::findParts() {
  std::size_t at = sizeof(Header);
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    if (file_.size() - at < sizeof(black_box::PartHeader)) return "was cut off";
    const auto head = copyOf<black_box::PartHeader>(file_, at);
    at += sizeof head;
    if (head.part != i) return "is damaged";
    if (head.bytes > file_.size() - at || file_.size() - at - head.bytes < sizeof(std::uint32_t)) {
      return "was cut off";
    }
    parts_[i] = Bytes(file_).subspan(at, head.bytes);
    at += head.bytes;
    const std::size_t begin = at - head.bytes - sizeof head;
    if (crc32(0, file_.data() + begin, at - begin) != copyOf<std::uint32_t>(file_, at)) {
      return "is damaged";
    }
    at += sizeof(std::uint32_t);
  }
  return at == file_.size() ? "" : "is damaged";
}

std::string MemoryReader::readMeta() {
  const Bytes bytes = part(Part::kMeta);
  const bool ok = black_box::unpackMeta(bytes.data(), bytes.size(), meta_) &&
                  recording::unusable(meta_).empty();
  if (!ok) return "is damaged: its description cannot be read";
  log_ = inputLogOf(meta_);
  return {};
}

std::string MemoryReader::readEntries() {
  const Bytes bytes = part(Part::kEntries), data = part(Part::kData);
  const std::uint64_t count = header_.end_entry - header_.first_entry;
  // Compares by division, because a forged count times the size could overflow to the size of the
  // part.
  if (part(Part::kEnd).size() != sizeof(black_box::End) || bytes.size() % sizeof(Entry) != 0 ||
      bytes.size() / sizeof(Entry) != count ||
      data.size() != header_.data_end - header_.data_begin) {
    return "is damaged";
  }
  const auto end = copyOf<black_box::End>(part(Part::kEnd));
  for (std::uint64_t i = 0; i < count; ++i) {
    const auto entry = copyOf<Entry>(bytes, i * sizeof(Entry));
    // The loop may have continued during writing. Ring data that it has overwritten since is
    // invalid.
    const bool kept = header_.first_entry + i + header_.entry_slots >= end.entries_begun &&
                      entry.begin + header_.data_capacity >= end.data_begun &&
                      entry.begin >= header_.data_begin;
    if (!kept) continue;
    if (entry.bytes > kMostPackedBytes || entry.begin > header_.data_end ||
        entry.bytes > header_.data_end - entry.begin) {
      return "is damaged";
    }
    entries_.push_back(entry);
  }
  return {};
}

std::string MemoryReader::checkTicks() {
  TickRecord record;
  for (std::uint64_t i = 0; i < entries_.size(); ++i) {
    if (!read(i, record) || !recording::fits(record, meta_)) {
      return "is damaged: its ticks are not those of its description";
    }
    if (i > 0) {
      outline_.missing +=
          missingBetween(outline_.numbers.back(), record.tick, record.elapsed_periods);
    }
    outline_.numbers.push_back(record.tick);
  }
  return {};
}

std::string MemoryReader::readInputs() {
  TickInput input;
  while (nextInput(input)) ++input_ticks_;
  if (next_input_ != part(Part::kInputs).size()) return "is damaged: its inputs cannot be read";
  next_input_ = 0;
  log_ = inputLogOf(meta_);
  return {};
}

bool MemoryReader::nextInput(TickInput& input) {
  const Bytes rest = part(Part::kInputs).subspan(next_input_);
  if (rest.empty()) return false;
  const std::size_t bytes = readInput(log_, rest.data(), rest.size(), input);
  next_input_ += bytes;
  return bytes > 0;
}

Expected<Done> MemoryReader::open(const std::string& path) {
  std::error_code error;
  if (const auto size = std::filesystem::file_size(path, error);
      !error && size > kLargestBox_bytes) {
    return fileFault(path, "is larger than any black box", kCopyAgain);
  }
  errno = 0;
  file_ = wholeFile(path);
  if (file_.empty() && errno != 0) {
    return fileFault(path, std::string("cannot be read: ") + std::strerror(errno), kCopyAgain);
  }
  if (auto checked = checkHeader(path); !checked) return checked;
  for (auto step : {&MemoryReader::findParts, &MemoryReader::readMeta, &MemoryReader::readEntries,
                    &MemoryReader::checkTicks, &MemoryReader::readInputs}) {
    if (const std::string problem = (this->*step)(); !problem.empty()) {
      return fileFault(path, "is a black box that " + problem, kCopyAgain);
    }
  }
  cause_.signal = header_.signal;
  cause_.faults = static_cast<Fault>(header_.faults);
  cause_.fault_tick = header_.fault_tick;
  cause_.fault_axis = header_.fault_axis;
  cause_.unix_ns = header_.unix_ns;
  cause_.within_tick = header_.ticks_begun > header_.ticks_done;
  return Done{};
}

bool MemoryReader::read(std::uint64_t i, TickRecord& record) {
  if (i >= entries_.size()) return false;
  const Entry& entry = entries_[i];
  const Bytes bytes = part(Part::kData).subspan(entry.begin - header_.data_begin, entry.bytes);
  if (!unpackRecord(bytes.data(), bytes.size(), record) || record.tick != entry.tick) return false;
  digest_ = digestOf(record);
  return true;
}

}  // namespace

bool BlackBoxReader::isBox(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return false;  // opening a pipe would block
  std::ifstream in(path, std::ios::binary);
  std::array<char, black_box::kMagic.size()> magic{};
  return in.read(magic.data(), magic.size()) && magic == black_box::kMagic;
}

Expected<std::unique_ptr<BlackBoxReader>> BlackBoxReader::openBox(const std::string& path) {
  if (!isBox(path))
    return fileFault(path, "is no black box", "give a .wbb file that Wholehand wrote");
  auto reader = std::make_unique<MemoryReader>();
  if (auto opened = reader->open(path); !opened) return opened.errors();
  return Expected<std::unique_ptr<BlackBoxReader>>(std::move(reader));
}

}  // namespace wholehand
