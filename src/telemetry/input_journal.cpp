#include "telemetry/input_journal.hpp"

#include "core/crc32.hpp"
#include "telemetry/recording_meta.hpp"

#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <unistd.h>
#include <utility>

namespace wholehand {
namespace fs = std::filesystem;

namespace {

constexpr std::array<char, 8> kMagic = {'W', 'H', 'I', 'N', 'P', 'U', 'T', '2'};
constexpr auto kSyncAfter = std::chrono::seconds(1);

/// Before the description and before each block of inputs.
struct BlockHead {
  std::uint32_t bytes = 0;
  std::uint32_t crc = 0;  ///< of the bytes
};

std::uint32_t crcOf(const std::byte* bytes, std::size_t count) {
  return crc32(0, bytes, count);
}

bool writeAll(int file, const void* from, std::size_t count) {
  const auto* at = static_cast<const char*>(from);
  while (count > 0) {
    const ssize_t done = ::write(file, at, count);
    if (done < 0 && errno == EINTR) continue;
    if (done <= 0) return false;
    at += done;
    count -= static_cast<std::size_t>(done);
  }
  return true;
}

bool writeBlock(int file, const std::vector<std::byte>& bytes) {
  const BlockHead head{static_cast<std::uint32_t>(bytes.size()), crcOf(bytes.data(), bytes.size())};
  return writeAll(file, &head, sizeof head) && writeAll(file, bytes.data(), bytes.size());
}

Diagnostic refusal(const std::string& path, std::string problem) {
  return fileFault(path, std::move(problem),
                   "copy it again from where it was written; what is missing cannot be restored");
}

}  // namespace

std::string InputJournal::pathOf(const std::string& recording) {
  fs::path path(recording);
  return path.extension() == ".inputs" ? recording + ".inputs"
                                       : path.replace_extension(".inputs").string();
}

std::string InputJournal::create(const std::string& path, const RecordingMeta& meta,
                                 std::unique_ptr<InputJournal>& journal) {
  if (InputJournalReader::isJournal(path)) ::unlink(path.c_str());
  const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
  if (file < 0) return "its inputs cannot be kept in " + path + ": " + std::strerror(errno);
  if (!writeAll(file, kMagic.data(), kMagic.size()) ||
      !writeBlock(file, black_box::packMeta(meta)) || ::fdatasync(file) != 0) {
    const int error = errno;
    ::close(file);
    ::unlink(path.c_str());
    return "its inputs cannot be kept in " + path + ": " + std::strerror(error);
  }
  journal.reset(new InputJournal(path, file, meta));
  return {};
}

InputJournal::InputJournal(std::string path, int file, const RecordingMeta& meta)
    : path_(std::move(path)),
      file_(file),
      log_(inputLogOf(meta)),
      syncing_([this] { syncNowAndThen(); }) {}

InputJournal::~InputJournal() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  ends_.notify_all();
  syncing_.join();
  ::close(file_);
}

void InputJournal::append(const TickRecord& record) {
  constexpr std::size_t kTicksOfABlock = 250;
  if (broken_) return;
  const std::size_t used = waiting_.size();
  waiting_.resize(used + kMostInputBytes);
  waiting_.resize(used + logInput(log_, record, waiting_.data() + used));
  if (++ticks_ >= kTicksOfABlock) write();
}

void InputJournal::write() {
  if (waiting_.empty() || broken_) return;
  broken_ = !writeBlock(file_, waiting_);
  waiting_.clear();
  ticks_ = 0;
  dirty_ = true;
}

void InputJournal::flush() {
  write();
  if (dirty_.exchange(false)) ::fdatasync(file_);
}

void InputJournal::remove() {
  ::unlink(path_.c_str());
}

void InputJournal::syncNowAndThen() {
  std::unique_lock lock(mutex_);
  while (!ends_.wait_for(lock, kSyncAfter, [this] { return ending_; })) {
    if (dirty_.exchange(false)) ::fdatasync(file_);
  }
}

bool InputJournalReader::isJournal(const std::string& path) {
  std::error_code error;
  if (!fs::is_regular_file(fs::symlink_status(path, error))) return false;  // a pipe would block
  std::ifstream in(path, std::ios::binary);
  std::array<char, kMagic.size()> magic{};
  return in.read(magic.data(), magic.size()) && magic == kMagic;
}

Expected<std::unique_ptr<InputJournalReader>> InputJournalReader::open(const std::string& path) {
  if (!isJournal(path)) {
    return fileFault(path, "holds no inputs of a recording",
                     "give a .inputs file that Wholehand left");
  }
  std::ifstream in(path, std::ios::binary | std::ios::ate);
  auto left = static_cast<std::uint64_t>(std::max<std::streamoff>(in.tellg(), 0)) - kMagic.size();
  in.seekg(kMagic.size());
  // A block that is cut off, or whose bytes never reached the disk, ends it.
  const auto next_block = [&in, &left](std::vector<std::byte>& block) {
    BlockHead head;
    if (left < sizeof head || !in.read(reinterpret_cast<char*>(&head), sizeof head)) return false;
    left -= sizeof head;
    if (head.bytes == 0 || head.bytes > left) return false;
    block.resize(head.bytes);
    left -= head.bytes;
    in.read(reinterpret_cast<char*>(block.data()), static_cast<std::streamsize>(block.size()));
    return in.good() && crcOf(block.data(), block.size()) == head.crc;
  };
  auto reader = std::make_unique<InputJournalReader>();
  std::vector<std::byte> block;
  if (!next_block(block) || !black_box::unpackMeta(block.data(), block.size(), reader->meta_)) {
    return refusal(path, "is damaged: its description cannot be read");
  }
  if (const std::string reason = recording::unusable(reader->meta_); !reason.empty()) {
    return refusal(path, "is damaged: its description " + reason);
  }
  while (next_block(block)) {
    reader->inputs_.insert(reader->inputs_.end(), block.begin(), block.end());
  }
  reader->log_ = inputLogOf(reader->meta_);
  return reader;
}

bool InputJournalReader::next(TickInput& input) {
  if (at_ == inputs_.size()) return false;
  const std::size_t bytes = readInput(log_, inputs_.data() + at_, inputs_.size() - at_, input);
  at_ = bytes == 0 ? inputs_.size() : at_ + bytes;
  return bytes > 0;
}

}  // namespace wholehand
