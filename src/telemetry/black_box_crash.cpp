#include "telemetry/mapped_box.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <sys/stat.h>
#include <unistd.h>

namespace wholehand {

using black_box::Entry;
using black_box::Part;

namespace {

/// Longest ramp to neutral, with a margin for a late loop.
constexpr long kNeutralWithin_ns = 130'000'000;

}  // namespace

void MappedBox::describe(int signal) noexcept {
  header_.signal = signal;
  timespec now{};
  ::clock_gettime(CLOCK_REALTIME, &now);
  header_.unix_ns = std::int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec;
  header_.ticks_done = ticks_done_.load(std::memory_order_acquire);
  header_.ticks_begun = ticks_begun_.load(std::memory_order_acquire);
  header_.end_entry = entries_done_.load(std::memory_order_acquire);
  // The loop may overwrite the oldest entries: they must not be used to find the start of the data.
  header_.first_entry = firstKept(header_.end_entry, sizes_.entries);
  header_.data_end = data_done_.load(std::memory_order_acquire);
  header_.data_begin = header_.end_entry > 0 ? entryAt(header_.first_entry)->begin : 0;
  // If the ring was too small for its entries, the oldest are lost.
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
  (void)file_.takeCrc();  // resets the CRC: the next part's begins with its head
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
  // Read after counting the complete ticks, so that each has its inputs, even if the loop
  // continues.
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

// A loop in another thread than the crashed one ramps down meanwhile. If the loop's own thread
// crashed, the device depends on its own watchdog.
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

// Only one thread writes. A loop stopped by a crash ends meanwhile, and its run would write the box
// again without the signal.
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
  return Diagnostic{path_,
                    0,
                    "",
                    "",
                    std::string("cannot be written: ") + std::strerror(error),
                    "make room, or record into another folder"};
}

}  // namespace wholehand
