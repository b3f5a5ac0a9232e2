#pragma once

/// Marks a function that the tick calls: it never allocates, locks, throws, logs or blocks. Where
/// the compiler knows the attribute (clang >= 20 with -fsanitize=realtime) it is checked.
// In GNU spelling: the effect belongs to the function's type, so that [[clang::nonblocking]] before
// a declaration, where a reader looks for it, is an error.
#if defined(__has_cpp_attribute) && __has_cpp_attribute(clang::nonblocking)
#define WHOLEHAND_RT __attribute__((nonblocking))
#else
#define WHOLEHAND_RT
#endif
