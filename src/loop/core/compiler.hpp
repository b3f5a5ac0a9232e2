#pragma once

/// 1 when a sanitizer intercepts the C library. The allocation and system call counters intercept
/// it too and are then disabled.
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

/// Compiles a function twice, for processors with AVX and for any x86-64; the loader chooses the
/// version that the processor can run. AVX has no fused multiply-add: both versions give the same
/// bits, and a recording replays on either machine. Sanitizer builds have no clones, because a
/// sanitizer cannot instrument the function with which the loader chooses.
#if defined(__x86_64__) && !WHOLEHAND_SANITIZED
#define WHOLEHAND_VECTOR_CLONES [[gnu::target_clones("avx", "default")]]
#else
#define WHOLEHAND_VECTOR_CLONES
#endif
