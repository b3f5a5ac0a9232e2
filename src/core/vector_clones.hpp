#pragma once

#include "core/sanitized.hpp"

/// Compiles a function twice, for processors with AVX and for any x86-64; the loader takes the one
/// that the processor can run. AVX brings no fused multiply-add: both give the same bits, and a
/// recording replays on either machine. Builds for sanitizers have no clones: they cannot
/// instrument what the loader calls to choose.
#if defined(__x86_64__) && !WHOLEHAND_SANITIZED
#define WHOLEHAND_VECTOR_CLONES [[gnu::target_clones("avx", "default")]]
#else
#define WHOLEHAND_VECTOR_CLONES
#endif
