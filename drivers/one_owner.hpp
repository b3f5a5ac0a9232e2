#pragma once

#include <sys/file.h>

namespace wholehand {

/// Locks an open line, bus or segment for this program until it is closed, because a device cannot
/// obey two programs. Call before anything is set or written. False: another program holds it.
/// TIOCEXCL does not stop root; this lock works against every driver of this project.
[[nodiscard]] inline bool takeAlone(int descriptor) noexcept {
  return ::flock(descriptor, LOCK_EX | LOCK_NB) == 0;
}

inline constexpr const char* kTaken = "is held by another program";
inline constexpr const char* kEndTheOther =
    "end that session, host or inspection first: nobody looks on beside it";

}  // namespace wholehand
