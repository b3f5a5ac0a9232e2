#pragma once

#include <cstdint>
#include <string>
#include <sys/types.h>
#include <vector>

// Starting and ending child processes. Private to process.
namespace wholehand::process {

/// Starts a program without file descriptors other than the standard ones and without blocked
/// signals. Uses posix_spawn instead of fork, so that the pages of a running loop are not marked
/// copy-on-write. Returns 0 or an errno.
/// @param input, output descriptors of its standard input and output; -1: inherited
[[nodiscard]] int spawn(const std::string& program, std::vector<std::string> arguments, int input,
                        int output, pid_t& child);
/// Limits a running child's resources and disables its core dump.
/// @param idle lowest CPU and disk priority
void limit(pid_t child, std::uint64_t memory_bytes, bool idle);
/// True when the child has ended; reaps it.
[[nodiscard]] bool isOver(pid_t child, int& status);
/// Kills the child and reaps it. A child that hangs in disk I/O is abandoned after 0.5 s.
void kill(pid_t child);

}  // namespace wholehand::process
