#pragma once

#include <cstdint>
#include <string>

namespace wholehand {

/// A notice is given when the disk has room for less than this.
inline constexpr double kRoomWorthTelling_s = 1800.0;

/// Notice to give before a recording begins: "the disk has room for about 4 minutes of recording:
/// out/run.h5 (28 MB)". Empty when there is room for half an hour, or for the known length, or when
/// the free space is unknown. Accesses the disk.
/// @param length_s of the recording; 0: unknown
[[nodiscard]] std::string roomNotice(const std::string& recording, double period_s,
                                     double length_s);

/// The notice for a number of free bytes; for roomNotice() and tests.
[[nodiscard]] std::string roomSentence(const std::string& recording, std::uint64_t free_bytes,
                                       double period_s, double length_s);

}  // namespace wholehand
