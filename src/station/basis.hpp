#pragma once

#include "vocabulary/backend.hpp"
#include "vocabulary/person_limits.hpp"

#include <cstdint>
#include <deque>
#include <string>

namespace wholehand {

/// Numbers what a start is based on: the visit, the profile, the hand with its side, the exercise,
/// the level and the effort limits. An order that starts or raises names the number that its client
/// was shown last, so that nobody starts another person than the one on the screen
/// (docs/adr/0016-arm-order-names-the-last-stop.md). One thread at a time.
class Basis {
 public:
  [[nodiscard]] std::uint32_t number() const { return number_; }
  /// Notes a change. A lowered limit needs none: what was shown is then above what is in force.
  /// @param client the client whose order changed it @param what for people, in English
  void change(std::uint32_t client, std::string what);
  /// Refuses an order that is based on an older number, with what changed since. Changes by the
  /// client's own orders do not count: a press of Start with another level loads and then arms.
  /// @param seen number that the client was shown; 0: its messages have no such field
  [[nodiscard]] OrderReply refuseOutdated(std::uint32_t seen, std::uint32_t client) const;

  /// What differs for a person who presses Start, in English; empty: nothing.
  [[nodiscard]] static std::string differences(const SceneFacts& before,
                                               const PersonLimits& limits_before,
                                               const SceneFacts& now,
                                               const PersonLimits& limits_now);

 private:
  /// Older changes count as those of another client.
  static constexpr std::size_t kRemembered = 256;
  struct Change {
    std::uint32_t client = 0;
    std::string what;
  };

  std::uint32_t number_ = 1;
  std::deque<Change> changes_;  ///< the last one led to number_
};

}  // namespace wholehand
