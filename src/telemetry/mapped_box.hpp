#pragma once

#include "telemetry/black_box.hpp"
#include "telemetry/black_box_layout.hpp"
#include "telemetry/crash_guard.hpp"
#include "telemetry/input_log.hpp"
#include "telemetry/prefaulted_memory.hpp"
#include "telemetry/signal_safe_file.hpp"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <ctime>
#include <memory>
#include <string>
#include <vector>

namespace wholehand {

/// More ticks than the loop can begin while a box's header is filled in.
inline constexpr std::size_t kSpareEntries = 8;
/// Index of the first entry that a box contains, of a ring of `slots` with `end` finished entries.
/// Slots that the loop writes next are excluded.
[[nodiscard]] constexpr std::uint64_t firstKept(std::uint64_t end, std::uint64_t slots) noexcept {
  return end - std::min<std::uint64_t>(end, slots - kSpareEntries);
}

/// The black box in preallocated memory. black_box.cpp fills it; black_box_crash.cpp writes it to a
/// file, in a signal handler if needed.
class MappedBox final : public BlackBox, public CrashHandler {
 public:
  MappedBox(const RecordingMeta& meta, const BlackBoxPlan& plan);
  ~MappedBox() override { leaveSignalStack(arming_stack_.data()); }
  /// Takes all memory. Returns the error, or an empty text.
  std::string takeMemory();

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
  // The following functions are async-signal-safe.
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

  // Written by the thread that ticks, read by a handler in any thread: everything before these
  // counts is complete.
  std::atomic<std::uint64_t> ticks_begun_{0}, ticks_done_{0};
  std::atomic<int> ticking_thread_{0};
  std::atomic<int> writing_thread_{0};
  std::atomic<std::uint64_t> input_bytes_{0};
  std::atomic<bool> inputs_whole_{true};
  std::atomic<std::uint64_t> entries_begun_{0}, entries_done_{0};
  std::atomic<std::uint64_t> data_begun_{0}, data_done_{0};
  black_box::Header header_;  ///< the tick notes its faults; the rest is filled in when it is
                              ///< written
  SignalSafeFile file_;
  std::unique_ptr<CrashGuard> guard_;  ///< last member: destroyed before the data that a handler
                                       ///< reads
};

}  // namespace wholehand
