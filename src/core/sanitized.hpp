#pragma once

/// 1 when a sanitizer intercepts the C library, as the counters do. The counters are then disabled.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define WHOLEHAND_SANITIZED 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || \
    __has_feature(memory_sanitizer) || __has_feature(realtime_sanitizer)
#define WHOLEHAND_SANITIZED 1
#endif
#endif
#if !defined(WHOLEHAND_SANITIZED)
#define WHOLEHAND_SANITIZED 0
#endif
