#pragma once

/// Marks a function that the tick calls. It never allocates, locks, throws, logs or blocks.
/// Compilers that know the attribute check it (clang >= 20 with -fsanitize=realtime).
// GNU spelling: the attribute belongs to the function's type, and [[clang::nonblocking]] before a
// declaration is an error.
#if defined(__has_cpp_attribute) && __has_cpp_attribute(clang::nonblocking)
#define WHOLEHAND_RT __attribute__((nonblocking))
#else
#define WHOLEHAND_RT
#endif
