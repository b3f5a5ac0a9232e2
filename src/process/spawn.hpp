#pragma once

#include <cstdint>
#include <string>
#include <sys/types.h>
#include <vector>

// How a child process begins and ends. Private to process.
namespace wholehand::process {

/// Starts a program with no file but the standard ones, and with no blocked signals. posix_spawn,
/// no fork: the pages of a running loop are not marked for copying. 0 or an errno.
/// @param input, output descriptors that become its standard input and output; -1: this process's
[[nodiscard]] int spawn(const std::string& program, std::vector<std::string> arguments, int input,
                        int output, pid_t& child);
/// What a child may use from now on; it leaves no core.
/// @param idle lowest priority of CPU and disk
void limit(pid_t child, std::uint64_t memory_bytes, bool idle);
/// True where it has ended; its status is taken.
[[nodiscard]] bool isOver(pid_t child, int& status);
/// Kills it and takes its status. Where it waits for a disk it is left to itself after 0.5 s.
void kill(pid_t child);

}  // namespace wholehand::process
