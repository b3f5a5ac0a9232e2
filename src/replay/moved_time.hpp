#pragma once

#include "core/tick_record.hpp"

#include <nlohmann/json_fwd.hpp>

#include <array>
#include <cstdint>

namespace wholehand {

/// Time by who moved the hand [periods].
///
/// Whose a part of a session is (a drink, a level, a band of force, a reach, a grip, a touch): it
/// is the person's if the person moved the hand in the tick in which it began and in every tick
/// until the one in which it finished. If somebody else moved in some of them, it is shared: it is
/// named with the person's share of the time, and no sum counts it. If the person moved in none of
/// them, it is somebody else's. Ticks that are missing in the recording are nobody's word and do
/// not matter. A drink begins when a grasp of a dispenser begins or the first of it flows, a band
/// when the force first enters it, and a level with the first of its drinks or bands.
struct MovedTime {
  std::array<std::uint64_t, kMovers> by{};
  std::array<std::uint64_t, kHelps> helped{};  ///< of the person's time

  void add(Mover mover, Help help, std::uint32_t elapsed_periods);
  [[nodiscard]] std::uint64_t sum() const;
  [[nodiscard]] std::uint64_t persons() const {
    return by[static_cast<std::size_t>(Mover::kPerson)];
  }
  [[nodiscard]] bool isPersons() const { return persons() > 0 && persons() == sum(); }
  [[nodiscard]] bool isShared() const { return persons() > 0 && persons() < sum(); }
  /// The person's share, 0 .. 1.
  [[nodiscard]] double share() const;
  /// Who moved longest.
  [[nodiscard]] Mover mostly() const;
  /// The most help that was given in any tick of the person; kUnsaid where none was named.
  [[nodiscard]] Help mostHelp() const;
  /// "by", "share", "help" as web/src/report/report_data.ts reads them.
  [[nodiscard]] nlohmann::json json() const;
};

/// The time between two moments.
[[nodiscard]] MovedTime operator-(const MovedTime& end, const MovedTime& begin);

}  // namespace wholehand
