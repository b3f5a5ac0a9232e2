#include "record/black_box.hpp"

#include "files/text/text_file.hpp"
#include "loop/core/crc32.hpp"
#include "loop/core/record_packing.hpp"
#include "record/black_box_layout.hpp"
#include "record/crash_guard.hpp"
#include "record/input_log.hpp"
#include "record/recording_meta.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <fcntl.h>
#include <memory>
#include <string>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>
#include <vector>

namespace wholehand {
namespace {

using black_box::Entry;
using black_box::Header;
using black_box::Part;

/// Memory for inputs that is mapped ahead of the tick: over a minute of six axes.
constexpr std::size_t kAhead_bytes = std::size_t{4} << 20U;

/// Memory whose pages are mapped before the tick writes to them, so that it causes no page fault.
class PrefaultedMemory {
 public:
  PrefaultedMemory() = default;
  ~PrefaultedMemory();
  PrefaultedMemory(const PrefaultedMemory&) = delete;
  PrefaultedMemory& operator=(const PrefaultedMemory&) = delete;

  /// Allocates the memory and maps its first pages. Returns false and sets errno on failure.
  /// @pre not allocated yet; bytes > 0
  [[nodiscard]] bool take(std::size_t bytes, std::size_t mapped) noexcept;
  [[nodiscard]] bool take(std::size_t bytes) noexcept { return take(bytes, bytes); }
  /// Maps the pages below `end`. False if the kernel cannot, or has no memory; then the writer's
  /// page faults map them. One thread at a time; another one may write.
  bool mapUntil(std::size_t end) noexcept;
  [[nodiscard]] std::byte* data() const noexcept { return data_; }
  /// The memory as an array; initially zero.
  template <class T>
  [[nodiscard]] T* as() const noexcept {
    return reinterpret_cast<T*>(data_);
  }

 private:
  std::byte* data_ = nullptr;
  std::size_t bytes_ = 0, mapped_ = 0;
  static constexpr std::size_t kPage_bytes = 4096, kStep_bytes = std::size_t{1} << 20U;
  static constexpr int kPopulateWrite = 23;  ///< MADV_POPULATE_WRITE of Linux 5.14
};

/// Writes a file through a temporary file in the same folder, with a CRC-32 of the data written
/// since the last takeCrc(). Async-signal-safe: uses only open, write, fsync, close, rename and
/// unlink, and only its own memory. The data may change during writing, because file and CRC are
/// made from one copy.
class SignalSafeFile {
 public:
  /// Creates the temporary file, which must not exist yet. Returns 0 or an errno.
  /// @param temporary renamed to `path` by close() @pre both are zero-terminated and outlive this
  [[nodiscard]] int create(const char* temporary, const char* path) noexcept;
  /// Writes data. After a failure nothing more is written; close() reports the failure.
  void put(const void* bytes, std::size_t count) noexcept;
  /// CRC-32 of the data since the last call.
  [[nodiscard]] std::uint32_t takeCrc() noexcept;
  /// Syncs the file to disk and renames it to its final path. Returns 0, or an errno; after an
  /// error no file remains.
  [[nodiscard]] int close() noexcept;

 private:
  void writeOut() noexcept;

  const char* temporary_ = nullptr;
  const char* path_ = nullptr;
  int fd_ = -1;
  int error_ = 0;
  std::uint32_t crc_ = 0;
  std::size_t used_ = 0;
  alignas(64) std::array<std::byte, std::size_t{64} << 10U> buffer_{};
};

/// The black box in preallocated memory. The tick fills it. It is written to the black box file, in
/// a signal handler if needed.
class MappedBox final : public BlackBox, public CrashHandler {
 public:
  MappedBox(const RecordingMeta& meta, const BlackBoxPlan& plan);
  ~MappedBox() override { leaveSignalStack(arming_stack_.data()); }
  /// Allocates all memory. Returns the error, or an empty text.
  std::string takeMemory();

  void provideMemory() noexcept override {
    (void)inputs_.mapUntil(input_bytes_.load(std::memory_order_relaxed) + kAhead_bytes);
  }
  void beforeTick(const TickRecord& record) noexcept override;
  void afterTick(const TickRecord& record) noexcept override;
  void crashed(int signal) noexcept override;

  [[nodiscard]] bool wanted() const noexcept override { return header_.faults != 0; }
  [[nodiscard]] Expected<Done> write() override;
  [[nodiscard]] const std::string& path() const noexcept override { return path_; }
  [[nodiscard]] std::uint64_t inputBytes() const noexcept override { return input_bytes_.load(); }
  [[nodiscard]] bool inputsWhole() const noexcept override { return inputs_whole_.load(); }

 private:
  struct Sizes {
    std::size_t entries = 0, data = 0, inputs = 0;
  };
  [[nodiscard]] static Sizes sizesOf(const RecordingMeta& meta, const BlackBoxPlan& plan);

  void keepInputs(const TickRecord& record) noexcept;
  void keepWhole(const TickRecord& record) noexcept;
  void noteFaults(const TickRecord& record) noexcept;
  [[nodiscard]] black_box::Entry* entryAt(std::uint64_t n) const noexcept {
    return entries_.as<black_box::Entry>() + n % sizes_.entries;
  }
  // The functions below are async-signal-safe.
  [[nodiscard]] bool mayWrite() noexcept;
  [[nodiscard]] int writeFile(int signal) noexcept;
  void describe(int signal) noexcept;
  void putPart(black_box::Part part, std::uint64_t bytes) noexcept;
  void endPart() noexcept;
  void putEntries() noexcept;
  void putData() noexcept;

  void waitForNeutral(const timespec& since) const noexcept;

  const std::string path_, temporary_, crash_text_;
  void (*const stop_)(void*) noexcept;
  void* const stop_whom_;
  const std::vector<std::string> folders_;
  const std::vector<std::byte> meta_;
  const Sizes sizes_;
  InputLogState log_;
  PrefaultedMemory entries_, data_, inputs_, arming_stack_, ticking_stack_;
  bool first_tick_ = true;

  // Written by the thread that ticks and read by a handler in any thread. All entries before these
  // counts are complete.
  std::atomic<std::uint64_t> ticks_begun_{0}, ticks_done_{0};
  std::atomic<int> ticking_thread_{0};
  std::atomic<int> writing_thread_{0};
  std::atomic<std::uint64_t> input_bytes_{0};
  std::atomic<bool> inputs_whole_{true};
  std::atomic<std::uint64_t> entries_begun_{0}, entries_done_{0};
  std::atomic<std::uint64_t> data_begun_{0}, data_done_{0};
  black_box::Header header_;  ///< the tick stores its faults; the rest is filled in at writing
  SignalSafeFile file_;
  std::unique_ptr<CrashGuard> guard_;  ///< last member: destroyed before the data that a handler
                                       ///< reads
};

constexpr Fault kWanting = kStoppingFaults | Fault::kEmergencyStop;
/// Time after a run's end for the ramp to neutral, with a margin.
constexpr double kRamp_s = 1.0;
/// Contacts of a tick that the memory is made for: a firm grasp has about twenty. With more, fewer
/// ticks are kept.
constexpr int kUsualContacts = 24;
/// Factor on the requested time. The additional ticks may be overwritten while a crash is being
/// written.
constexpr double kMargin = 1.1;

/// Every parent folder of a file, outermost first.
std::vector<std::string> foldersOf(const std::string& path) {
  std::vector<std::string> folders;
  for (std::size_t at = path.find('/', 1); at != std::string::npos; at = path.find('/', at + 1)) {
    folders.push_back(path.substr(0, at));
  }
  return folders;
}

/// Longest ramp to neutral, with a margin for a late loop.
constexpr long kNeutralWithin_ns = 130'000'000;

}  // namespace

bool PrefaultedMemory::take(std::size_t bytes, std::size_t mapped) noexcept {
  void* memory = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) return false;
  data_ = static_cast<std::byte*>(memory);
  bytes_ = bytes;
  if (mapUntil(mapped)) return true;
  // A kernel before 5.14 maps everything now.
  for (std::size_t at = 0; at < bytes; at += kPage_bytes) data_[at] = std::byte{0};
  mapped_ = bytes;
  return true;
}

bool PrefaultedMemory::mapUntil(std::size_t end) noexcept {
  end = std::min(bytes_, (end + kStep_bytes - 1) / kStep_bytes * kStep_bytes);
  if (end <= mapped_) return true;
  if (::madvise(data_ + mapped_, end - mapped_, kPopulateWrite) != 0) return false;
  mapped_ = end;
  return true;
}

PrefaultedMemory::~PrefaultedMemory() {
  if (data_ != nullptr) ::munmap(data_, bytes_);
}

int SignalSafeFile::create(const char* temporary, const char* path) noexcept {
  temporary_ = temporary;
  path_ = path;
  error_ = 0;
  crc_ = 0;
  used_ = 0;
  fd_ = ::open(temporary, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (fd_ < 0) error_ = errno;
  return error_;
}

void SignalSafeFile::put(const void* bytes, std::size_t count) noexcept {
  const auto* from = static_cast<const std::byte*>(bytes);
  while (count > 0 && error_ == 0) {
    const std::size_t piece = std::min(count, buffer_.size() - used_);
    std::memcpy(buffer_.data() + used_, from, piece);
    crc_ = crc32(crc_, buffer_.data() + used_, piece);
    used_ += piece;
    from += piece;
    count -= piece;
    if (used_ == buffer_.size()) writeOut();
  }
}

void SignalSafeFile::writeOut() noexcept {
  std::size_t done = 0;
  while (done < used_ && error_ == 0) {
    const ssize_t n = ::write(fd_, buffer_.data() + done, used_ - done);
    if (n >= 0) {
      done += n;
    } else if (errno != EINTR) {
      error_ = errno;
    }
  }
  used_ = 0;
}

std::uint32_t SignalSafeFile::takeCrc() noexcept {
  const std::uint32_t crc = crc_;
  crc_ = 0;
  return crc;
}

int SignalSafeFile::close() noexcept {
  if (fd_ < 0) return error_;
  writeOut();
  if (error_ == 0 && ::fsync(fd_) != 0) error_ = errno;
  if (::close(fd_) != 0 && error_ == 0) error_ = errno;
  fd_ = -1;
  if (error_ == 0 && ::rename(temporary_, path_) != 0) error_ = errno;
  if (error_ != 0) ::unlink(temporary_);
  return error_;
}

MappedBox::Sizes MappedBox::sizesOf(const RecordingMeta& meta, const BlackBoxPlan& plan) {
  const auto count = [](const auto& list) { return static_cast<int>(list.size()); };
  const double run = static_cast<double>(plan.most_ticks) + kRamp_s / meta.period_s;
  const double kept = std::clamp(std::ceil(kMargin * plan.keep_s / meta.period_s), 1.0, run);
  const int values = count(meta.value_names) + count(meta.parameter_names);
  const auto tick_bytes =
      static_cast<double>(packedBytes(count(meta.axis_names), count(meta.joint_names),
                                      count(meta.body_names), values, kUsualContacts));
  Sizes sizes;
  sizes.entries = static_cast<std::size_t>(kept) + kSpareEntries;
  // Adds one tick, because the last tick before the ring wraps may not fit, and room for commands.
  sizes.data = std::min(static_cast<std::size_t>(kept * tick_bytes), plan.most_tick_bytes) +
               2 * kMostPackedBytes;
  // A game that moves its bodies sends about two commands per tick with seven numbers each.
  const double orders_bytes = meta.game_slots > 0 ? 128.0 : 0.0;
  const double axes_bytes =
      orders_bytes + 10.0 + static_cast<double>(sizeof(double)) * count(meta.axis_names);
  sizes.inputs = static_cast<std::size_t>(
      std::min(run * axes_bytes + 64.0 * kMostInputBytes, static_cast<double>(plan.input_bytes)));
  return sizes;
}

MappedBox::MappedBox(const RecordingMeta& meta, const BlackBoxPlan& plan)
    : path_(plan.path),
      temporary_(plan.path + "." + randomName() + ".part"),
      crash_text_("\nwholehand: crashed; the last seconds are in " + plan.path +
                  ": wholehand replay " + plan.path + " --resimulate\n"),
      stop_(plan.stop),
      stop_whom_(plan.stop_whom),
      folders_(foldersOf(plan.path)),
      meta_(black_box::packMeta(meta)),
      sizes_(sizesOf(meta, plan)) {
  log_ = inputLogOf(meta);
  header_.header_bytes = sizeof(Header);
  const std::size_t length = std::min(meta.git_version.size(), header_.program.size() - 1);
  std::copy_n(meta.git_version.begin(), length, header_.program.begin());
  header_.record_bytes = sizeof(TickRecord);
  header_.record_layout = recordLayout();
  header_.entry_slots = sizes_.entries;
  header_.data_capacity = sizes_.data;
}

std::string MappedBox::takeMemory() {
  const bool taken = entries_.take(sizes_.entries * sizeof(Entry)) && data_.take(sizes_.data) &&
                     inputs_.take(sizes_.inputs, kAhead_bytes) &&
                     arming_stack_.take(kSignalStackBytes) &&
                     ticking_stack_.take(kSignalStackBytes);
  if (!taken) return std::string("has no memory: ") + std::strerror(errno);
  useSignalStack(arming_stack_.data());
  guard_ = std::make_unique<CrashGuard>(*this);
  if (!guard_->stands()) {
    return "cannot be armed: " + std::to_string(kMostWitnesses) + " of them are";
  }
  return {};
}

void MappedBox::beforeTick(const TickRecord&) noexcept {
  if (first_tick_) {
    useSignalStack(ticking_stack_.data());
    ticking_thread_.store(callingThread(), std::memory_order_relaxed);
    first_tick_ = false;
  }
  ticks_begun_.store(ticks_begun_.load(std::memory_order_relaxed) + 1, std::memory_order_release);
}

void MappedBox::afterTick(const TickRecord& record) noexcept {
  keepInputs(record);
  keepWhole(record);
  noteFaults(record);
  ticks_done_.store(ticks_begun_.load(std::memory_order_relaxed), std::memory_order_release);
}

void MappedBox::keepInputs(const TickRecord& record) noexcept {
  const std::uint64_t used = input_bytes_.load(std::memory_order_relaxed);
  if (!inputs_whole_.load(std::memory_order_relaxed)) return;
  if (used + kMostInputBytes > sizes_.inputs) {
    inputs_whole_.store(false, std::memory_order_release);
    return;
  }
  const std::size_t bytes = logInput(log_, record, inputs_.data() + used);
  input_bytes_.store(used + bytes, std::memory_order_release);
}

void MappedBox::keepWhole(const TickRecord& record) noexcept {
  std::uint64_t begin = data_done_.load(std::memory_order_relaxed);
  const std::uint64_t n = entries_done_.load(std::memory_order_relaxed);
  const std::uint64_t at = begin % sizes_.data;
  if (at + kMostPackedBytes > sizes_.data)
    begin += sizes_.data - at;  // the bytes of a tick are contiguous
  // Announces the range before it is overwritten, so that a concurrent reader knows afterwards
  // which data is invalid.
  entries_begun_.store(n + 1, std::memory_order_relaxed);
  data_begun_.store(begin + kMostPackedBytes, std::memory_order_relaxed);
  std::atomic_thread_fence(std::memory_order_release);
  const std::size_t bytes = packRecord(record, data_.data() + begin % sizes_.data);
  *entryAt(n) = {begin, record.tick, bytes};
  data_done_.store(begin + bytes, std::memory_order_release);
  entries_done_.store(n + 1, std::memory_order_release);
}

void MappedBox::noteFaults(const TickRecord& record) noexcept {
  const Fault wanting = record.faults & kWanting;
  if (!any(wanting)) return;
  if (header_.faults == 0) {
    header_.fault_axis = record.fault_axis;
    header_.fault_tick = record.tick;
  }
  header_.faults |= static_cast<std::uint32_t>(wanting);
}

Expected<std::unique_ptr<BlackBox>> BlackBox::arm(const RecordingMeta& meta,
                                                  const BlackBoxPlan& plan) {
  auto box = std::make_unique<MappedBox>(meta, plan);
  if (const std::string problem = box->takeMemory(); !problem.empty()) {
    return fileFault(plan.path, "the black box " + problem,
                     "close other programs, raise `ulimit -l`, or end another session");
  }
  return Expected<std::unique_ptr<BlackBox>>(std::unique_ptr<BlackBox>(std::move(box)));
}

void MappedBox::describe(int signal) noexcept {
  header_.signal = signal;
  timespec now{};
  ::clock_gettime(CLOCK_REALTIME, &now);
  header_.unix_ns = std::int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec;
  header_.ticks_done = ticks_done_.load(std::memory_order_acquire);
  header_.ticks_begun = ticks_begun_.load(std::memory_order_acquire);
  header_.end_entry = entries_done_.load(std::memory_order_acquire);
  // The loop may overwrite the oldest entries, so the start of the data must not be taken from
  // them.
  header_.first_entry = firstKept(header_.end_entry, sizes_.entries);
  header_.data_end = data_done_.load(std::memory_order_acquire);
  header_.data_begin = header_.end_entry > 0 ? entryAt(header_.first_entry)->begin : 0;
  // If the data ring was too small for the entries, the oldest are lost.
  if (header_.data_end - header_.data_begin > sizes_.data) {
    header_.data_begin = header_.data_end - sizes_.data;
  }
  header_.inputs_whole = inputs_whole_.load(std::memory_order_acquire) ? 1 : 0;
  header_.crc = 0;
}

void MappedBox::putPart(Part part, std::uint64_t bytes) noexcept {
  const black_box::PartHeader head{static_cast<std::uint32_t>(part), 0, bytes};
  file_.put(&head, sizeof head);
}

void MappedBox::endPart() noexcept {
  const std::uint32_t crc = file_.takeCrc();
  file_.put(&crc, sizeof crc);
  (void)file_.takeCrc();  // resets the CRC, because the CRC of the next part begins with its head
}

void MappedBox::putEntries() noexcept {
  for (std::uint64_t n = header_.first_entry; n < header_.end_entry; ++n) {
    file_.put(entryAt(n), sizeof(Entry));
  }
}

void MappedBox::putData() noexcept {
  for (std::uint64_t at = header_.data_begin; at < header_.data_end;) {
    const std::uint64_t in_ring = at % sizes_.data;
    const std::uint64_t piece = std::min(header_.data_end - at, sizes_.data - in_ring);
    file_.put(data_.data() + in_ring, piece);
    at += piece;
  }
}

int MappedBox::writeFile(int signal) noexcept {
  for (const std::string& folder : folders_) ::mkdir(folder.c_str(), 0777);
  if (const int error = file_.create(temporary_.c_str(), path_.c_str()); error != 0) return error;
  describe(signal);
  // The input size is read after the number of complete ticks, so that every tick has its inputs
  // even if the loop continues.
  const std::uint64_t input_bytes = input_bytes_.load(std::memory_order_acquire);
  file_.put(&header_, offsetof(black_box::Header, crc));
  endPart();
  putPart(Part::kMeta, meta_.size());
  file_.put(meta_.data(), meta_.size());
  endPart();
  putPart(Part::kInputs, input_bytes);
  file_.put(inputs_.data(), input_bytes);
  endPart();
  putPart(Part::kEntries, (header_.end_entry - header_.first_entry) * sizeof(Entry));
  putEntries();
  endPart();
  putPart(Part::kData, header_.data_end - header_.data_begin);
  putData();
  endPart();
  std::atomic_thread_fence(std::memory_order_acquire);
  const black_box::End end{entries_begun_.load(std::memory_order_relaxed),
                           data_begun_.load(std::memory_order_relaxed)};
  putPart(Part::kEnd, sizeof end);
  file_.put(&end, sizeof end);
  endPart();
  return file_.close();
}

// Waits while the loop ramps to neutral in a thread other than the crashed one. If the loop's own
// thread crashed, the device depends on its own watchdog.
void MappedBox::waitForNeutral(const timespec& since) const noexcept {
  const int ticking = ticking_thread_.load(std::memory_order_relaxed);
  if (stop_ == nullptr || ticking == 0 || ticking == callingThread()) return;
  timespec until = since;
  until.tv_nsec += kNeutralWithin_ns;
  if (until.tv_nsec >= 1'000'000'000) {
    until.tv_nsec -= 1'000'000'000;
    ++until.tv_sec;
  }
  while (::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) == EINTR) {
  }
}

// True for the only thread that may write. A loop stopped by a crash ends meanwhile, and its run
// would otherwise write the file again without the signal.
bool MappedBox::mayWrite() noexcept {
  int nobody = 0;
  return writing_thread_.compare_exchange_strong(nobody, callingThread()) ||
         nobody == callingThread();
}

void MappedBox::crashed(int signal) noexcept {
  if (stop_ != nullptr) stop_(stop_whom_);
  timespec began{};
  ::clock_gettime(CLOCK_MONOTONIC, &began);
  const bool ticked = ticks_done_.load(std::memory_order_acquire) > 0;
  if (ticked && mayWrite() && writeFile(signal) == 0) {
    const ssize_t ignored = ::write(STDERR_FILENO, crash_text_.data(), crash_text_.size());
    (void)ignored;
  }
  waitForNeutral(began);
}

Expected<Done> MappedBox::write() {
  if (!mayWrite()) return Done{};
  const int error = writeFile(0);
  writing_thread_.store(0);
  if (error == 0) return Done{};
  return fileFault(path_, std::string("cannot be written: ") + std::strerror(error),
                   "make room, or record into another folder");
}

}  // namespace wholehand
