#pragma once

#include <cstdint>
#include <string>

namespace wholehand {

/// Less room than for this long a recording is told of.
inline constexpr double kRoomWorthTelling_s = 1800.0;

/// What a person should know of the disk before a recording begins: "the disk has room for about
/// 4 minutes of recording: out/run.h5 (28 MB)". Empty where there is room for half an hour, or for
/// the length that is known; where nothing can be said of that folder, too. Looks at the disk.
/// @param length_s of the recording; 0: nobody knows
[[nodiscard]] std::string roomNotice(const std::string& recording, double period_s,
                                     double length_s);

/// The sentence for so many bytes that are free; for roomNotice() and tests.
[[nodiscard]] std::string roomSentence(const std::string& recording, std::uint64_t free_bytes,
                                       double period_s, double length_s);

}  // namespace wholehand
