#pragma once

#include <sys/file.h>

namespace wholehand {

/// Takes what is open there for this opening alone, until it is closed: a line, a bus or a segment
/// that two programs write to obeys neither. Before anything is set or written. False: somebody has
/// it. TIOCEXCL does not stop root; this holds against every driver of this project.
[[nodiscard]] inline bool takeAlone(int descriptor) noexcept {
  return ::flock(descriptor, LOCK_EX | LOCK_NB) == 0;
}

inline constexpr const char* kTaken = "is held by another program";
inline constexpr const char* kEndTheOther =
    "end that session, host or inspection first: nobody looks on beside it";

}  // namespace wholehand
