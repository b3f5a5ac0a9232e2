#pragma once

#include <cstdint>
#include <string>

namespace wholehand {

/// Lets the kernel hand the calling thread's system calls to a counter, whoever makes them: nothing
/// that sleeps, waits, reads, writes or grows memory can hide from it. Clocks that the kernel
/// serves without a call are none. Once a thread, before it counts; takes the process's SIGSYS.
/// Needs Linux 5.11 on x86-64, and no sanitizer.
/// @return empty; else why it cannot be had here
[[nodiscard]] std::string watchSystemCalls();

/// From here on, or no longer, this thread's system calls are counted; each then takes some
/// microseconds. Nothing where it is not watched. Do not start a thread or a process while they
/// are. Real-time safe.
void countSystemCalls(bool on) noexcept;

/// What was counted in this thread: all, or those of one number of <sys/syscall.h>. Real-time safe.
[[nodiscard]] std::uint64_t threadSystemCalls() noexcept;
[[nodiscard]] std::uint64_t threadSystemCalls(int number) noexcept;

}  // namespace wholehand
