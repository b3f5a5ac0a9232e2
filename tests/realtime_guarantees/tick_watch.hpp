#pragma once

#include "loop/runtime/session.hpp"

#include <array>
#include <cstdint>
#include <string>

/// Counts the events that a tick must not cause while it works.
namespace wholehand::test {

enum class Kind : std::uint8_t {
  kAllocation,
  kRelease,
  kLock,
  kWait,
  kWake,
  kSystemCall,
  kClock,
  kSleep,
  kMinorFault,
  kMajorFault,
  kVoluntarySwitch,
  kInvoluntarySwitch
};
inline constexpr std::size_t kKinds = 12;
[[nodiscard]] const char* kindName(Kind kind);

using Counts = std::array<std::int64_t, kKinds>;
[[nodiscard]] inline std::int64_t of(const Counts& counts, Kind kind) {
  return counts[static_cast<std::size_t>(kind)];
}

/// Is notified of every tick and notifies another listener. Counts what the loop's thread does
/// between the two calls (the tick, with the players that receive it), and from there to the next
/// tick (the queue, the sleep, the sink of a simulated run).
class TickWatch final : public TickListener {
 public:
  struct Plan {
    std::uint64_t warm_ticks = 0;  ///< first ticks, counted separately
    std::uint64_t last_tick = 0;   ///< last tick counted: the thread may end after it
  };
  /// @param inner notified of every tick within the counted time; outlives this object
  TickWatch(TickListener& inner, const Plan& plan) : inner_(inner), plan_(plan) {}

  void beforeTick(const TickRecord& record) noexcept override;
  void afterTick(const TickRecord& record) noexcept override;

  // Read these after the end of the session.
  [[nodiscard]] const Counts& inTick() const { return in_tick_; }
  [[nodiscard]] const Counts& between() const { return between_; }
  [[nodiscard]] const Counts& inWarmTicks() const { return in_warm_ticks_; }
  [[nodiscard]] std::uint64_t ticks() const { return ticks_; }
  /// Why system calls are not counted here; empty if they are.
  [[nodiscard]] const std::string& noSystemCalls() const { return no_system_calls_; }
  /// The last tick with an event of this kind; -1: never.
  [[nodiscard]] std::int64_t lastTickWith(Kind kind) const { return of(last_tick_with_, kind); }
  /// Prints the count of each kind and the number of ticks.
  void print(const std::string& title) const;

 private:
  void count(Counts& into, std::int64_t tick) noexcept;
  void noteCall() noexcept;
  [[nodiscard]] bool watches(const TickRecord& record) const noexcept {
    return record.tick <= plan_.last_tick;
  }

  TickListener& inner_;
  Plan plan_;
  Counts before_{}, in_tick_{}, between_{}, in_warm_ticks_{}, last_tick_with_{};
  std::uint64_t ticks_ = 0, warm_ = 0;
  bool begun_ = false;
  int system_call_ = -1;  ///< number of a system call that is not allowed
  std::string no_system_calls_;
};

/// Ticks in which caches are filled and functions bound; their counts are printed separately.
inline constexpr std::uint64_t kWarmTicks = 100;

/// False under a sanitizer: the sessions still run for it, but nothing is counted.
[[nodiscard]] bool counting();
/// Whether the loop's thread was granted the resource `what` ("locked memory").
[[nodiscard]] bool granted(const SetupReport& setup, const std::string& what);

/// Counts of everything that this thread has done so far.
[[nodiscard]] Counts countsOfThisThread() noexcept;

}  // namespace wholehand::test
