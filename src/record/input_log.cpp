#include "record/input_log.hpp"

#include "loop/core/crc32.hpp"
#include "record/recording_meta.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <unistd.h>
#include <utility>

namespace wholehand {

namespace {

// Bits of a tick's first byte. They state which fields follow, in this order.
enum : unsigned {
  kElapsed = 1U,   // elapsed_periods, if not 1
  kFaults = 2U,    // faults out of kInputFaults
  kCommands = 4U,  // number of commands, then the commands
  kRaw = 8U,       // one bit for each axis that is not at a whole encoder count
  kMoved = 16U,    // per moved axis: the change in counts, or eight bytes
  kMover = 32U     // mover and helper, if they changed
};

/// Largest number of counts; all integers up to it are exact doubles.
constexpr double kMostCounts = 4503599627370496.0;  // 2^52

std::uint64_t zigzag(std::int64_t n) noexcept {
  return static_cast<std::uint64_t>(n) << 1U ^ static_cast<std::uint64_t>(n >> 63);
}
std::int64_t zagzig(std::uint64_t n) noexcept {
  return static_cast<std::int64_t>(n >> 1U) ^ -static_cast<std::int64_t>(n & 1U);
}

// Appends numbers to a buffer. @pre the buffer has room
class Out {
 public:
  explicit Out(std::byte* at) noexcept : at_(at) {}
  void number(std::uint64_t n) noexcept {
    for (; n >= 0x80; n >>= 7U) *at_++ = static_cast<std::byte>(n | 0x80U);
    *at_++ = static_cast<std::byte>(n);
  }
  void real(double value) noexcept {
    std::memcpy(at_, &value, sizeof value);
    at_ += sizeof value;
  }
  [[nodiscard]] std::byte* at() const noexcept { return at_; }

 private:
  std::byte* at_;
};

// Reads numbers from bytes that may be damaged.
class In {
 public:
  In(const std::byte* at, std::size_t bytes) noexcept : at_(at), end_(at + bytes) {}
  std::uint64_t number() noexcept {
    std::uint64_t n = 0;
    for (unsigned shift = 0; shift < 64; shift += 7) {
      if (at_ == end_) break;
      const auto b = std::to_integer<std::uint64_t>(*at_++);
      n |= (b & 0x7FU) << shift;
      if (b < 0x80) return n;
    }
    ok_ = false;
    return 0;
  }
  double real() noexcept {
    double value = 0.0;
    if (end_ - at_ < static_cast<std::ptrdiff_t>(sizeof value)) {
      ok_ = false;
      at_ = end_;
      return value;
    }
    std::memcpy(&value, at_, sizeof value);
    at_ += sizeof value;
    return value;
  }
  std::int32_t small() noexcept { return static_cast<std::int32_t>(zagzig(number())); }
  /// Reads a number of at most `most`.
  std::uint64_t upTo(std::uint64_t most) noexcept {
    const std::uint64_t n = number();
    ok_ = ok_ && n <= most;
    return ok_ ? n : 0;
  }
  [[nodiscard]] const std::byte* at() const noexcept { return at_; }
  [[nodiscard]] bool ok() const noexcept { return ok_; }

 private:
  const std::byte* at_;
  const std::byte* end_;
  bool ok_ = true;
};

double atCounts(std::int64_t counts, double step) noexcept {
  return step * static_cast<double>(counts);
}

/// True when the position is exactly a whole number of counts.
bool inCounts(double q, double step, std::int64_t& counts) noexcept {
  if (!(step > 0.0)) return false;
  const double n = std::round(q / step);
  if (!(std::abs(n) < kMostCounts)) return false;
  counts = static_cast<std::int64_t>(n);
  return std::bit_cast<std::uint64_t>(atCounts(counts, step)) == std::bit_cast<std::uint64_t>(q);
}

/// Count of a command's numbers without trailing zeros.
int usedNumbers(const Command& c) noexcept {
  int used = kOrderNumbers;
  while (used > 0 && std::bit_cast<std::uint64_t>(c.numbers[used - 1]) == 0) --used;
  return used;
}

void logCommands(const TickRecord& record, Out& out) noexcept {
  const int count = std::min(record.command_count, kMaxCommands);
  out.number(static_cast<std::uint64_t>(count));
  for (int i = 0; i < count; ++i) {
    const Command& c = record.commands[i];
    out.number(zigzag(static_cast<std::int64_t>(c.type)));
    out.number(zigzag(c.index));
    out.real(c.value);
    out.number(static_cast<std::uint64_t>(c.aim.size()));
    for (double q : c.aim) out.real(q);
    if (!isBodyOrder(c.type)) continue;
    const int used = usedNumbers(c);
    out.number(static_cast<std::uint64_t>(used));
    for (int n = 0; n < used; ++n) out.real(c.numbers[n]);
  }
}

void readCommands(In& in, TickInput& input) {
  input.command_count = static_cast<std::int32_t>(in.upTo(kMaxCommands));
  for (int i = 0; i < input.command_count; ++i) {
    Command& c = input.commands[i];
    c.type = static_cast<CommandType>(in.small());
    c.index = in.small();
    c.value = in.real();
    c.aim = AxisPosition(static_cast<int>(in.upTo(kMaxAxes)));
    for (int a = 0; a < c.aim.size(); ++a) c.aim[a] = in.real();
    if (!isBodyOrder(c.type)) continue;
    const auto used = static_cast<int>(in.upTo(kOrderNumbers));
    for (int n = 0; n < used; ++n) c.numbers[n] = in.real();
  }
}

/// Describes which axes moved by how many counts and which are not at a whole count.
struct Motion {
  std::array<std::int64_t, kMaxAxes> delta{};
  std::uint32_t raw = 0;
  bool moved = false;
};

Motion motionOf(InputLogState& state, const AxisPosition& q_m) noexcept {
  Motion m;
  for (int i = 0; i < state.encoder_step.size(); ++i) {
    std::int64_t counts = 0;
    if (!inCounts(q_m[i], state.encoder_step[i], counts)) {
      m.raw |= 1U << static_cast<unsigned>(i);
      continue;
    }
    m.delta[i] = counts - state.counts[i];
    m.moved = m.moved || m.delta[i] != 0;
    state.counts[i] = counts;
  }
  m.moved = m.moved || m.raw != 0;
  return m;
}

}  // namespace

InputLogState inputLogOf(const RecordingMeta& meta) {
  InputLogState state;
  state.encoder_step = AxisPosition(static_cast<int>(meta.encoder_step.size()));
  std::copy(meta.encoder_step.begin(), meta.encoder_step.end(), state.encoder_step.data());
  return state;
}

std::size_t logInput(InputLogState& state, const TickRecord& record, std::byte* out) noexcept {
  const Motion motion = motionOf(state, record.q_m);
  const Fault faults = record.faults & kInputFaults;
  // The first byte states which fields follow.
  unsigned what = 0;
  if (record.elapsed_periods != 1) what |= kElapsed;
  if (any(faults)) what |= kFaults;
  if (record.command_count > 0) what |= kCommands;
  if (motion.raw != 0) what |= kRaw;
  if (motion.moved) what |= kMoved;
  if (record.moved_by != state.moved_by || record.help != state.help) what |= kMover;
  Out to(out);
  to.number(what);
  if ((what & kElapsed) != 0) to.number(record.elapsed_periods);
  if ((what & kFaults) != 0) to.number(static_cast<std::uint64_t>(faults));
  if ((what & kMover) != 0) {
    state.moved_by = record.moved_by;
    state.help = record.help;
    to.number(static_cast<std::uint64_t>(state.moved_by));
    to.number(static_cast<std::uint64_t>(state.help));
  }
  if ((what & kCommands) != 0) logCommands(record, to);
  if ((what & kRaw) != 0) to.number(motion.raw);
  if (motion.moved) {
    for (int i = 0; i < state.encoder_step.size(); ++i) {
      if ((motion.raw >> static_cast<unsigned>(i) & 1U) != 0) {
        to.real(record.q_m[i]);
      } else {
        to.number(zigzag(motion.delta[i]));
      }
    }
  }
  return to.at() - out;
}

std::size_t readInput(InputLogState& state, const std::byte* in, std::size_t bytes,
                      TickInput& input) {
  In from(in, bytes);
  input = TickInput{};
  const std::uint64_t what = from.upTo(kElapsed | kFaults | kCommands | kRaw | kMoved | kMover);
  if ((what & kElapsed) != 0) {
    input.elapsed_periods = static_cast<std::uint32_t>(from.upTo(UINT32_MAX));
  }
  if ((what & kFaults) != 0)
    input.faults = static_cast<Fault>(from.upTo(UINT32_MAX)) & kInputFaults;
  if ((what & kMover) != 0) {
    state.moved_by = static_cast<Mover>(from.upTo(kMovers - 1));
    state.help = static_cast<Help>(from.upTo(kHelps - 1));
  }
  input.moved_by = state.moved_by;
  input.help = state.help;
  if ((what & kCommands) != 0) readCommands(from, input);
  const std::uint64_t raw = (what & kRaw) != 0 ? from.upTo(UINT32_MAX) : 0;
  input.q_m = AxisPosition(state.encoder_step.size());
  for (int i = 0; i < input.q_m.size(); ++i) {
    std::int64_t& counts = state.counts[i];
    if ((raw >> static_cast<unsigned>(i) & 1U) != 0) {
      input.q_m[i] = from.real();
      continue;
    }
    if ((what & kMoved) != 0) {  // unsigned arithmetic, because damaged counts may overflow
      counts = static_cast<std::int64_t>(static_cast<std::uint64_t>(counts) +
                                         static_cast<std::uint64_t>(zagzig(from.number())));
    }
    input.q_m[i] = atCounts(counts, state.encoder_step[i]);
  }
  return from.ok() ? from.at() - in : 0;
}

namespace fs = std::filesystem;

namespace {

constexpr std::array<char, 8> kMagic = {'W', 'H', 'I', 'N', 'P', 'U', 'T', '3'};
constexpr auto kSyncAfter = std::chrono::seconds(1);

/// Head of the description and of each block of inputs.
struct BlockHead {
  std::uint32_t bytes = 0;
  std::uint32_t crc = 0;  ///< CRC-32 of the block's bytes
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
  const bool follows = last_tick_
                           ? missingBetween(*last_tick_, record.tick, record.elapsed_periods) == 0
                           : record.tick == 0;
  if (!follows) {
    write();
    broken_ = true;
    return;
  }
  last_tick_ = record.tick;
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
  if (!fs::is_regular_file(fs::symlink_status(path, error)))
    return false;  // opening a pipe would block
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
  // Reading ends at a block that is cut off or whose bytes never reached the disk.
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
