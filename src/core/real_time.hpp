#pragma once

/// Marks a function that the tick calls: it never allocates, locks, throws, logs or blocks. Where
/// the compiler knows the attribute (clang >= 20 with -fsanitize=realtime) it is checked.
#if defined(__has_cpp_attribute) && __has_cpp_attribute(clang::nonblocking)
#define WHOLEHAND_RT [[clang::nonblocking]]
#else
#define WHOLEHAND_RT
#endif
