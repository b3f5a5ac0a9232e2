#pragma once

#include <functional>
#include <string>

namespace wholehand {

/// Runs `jobs` jobs in a number of child processes and passes each result, as it arrives, to the
/// calling process. Each child has its own engine globals, so results do not depend on the number
/// of processes. Each takes the next job that nobody has. They die with the calling process. False
/// when a worker died or was stopped early; results passed before remain valid. Call before any
/// thread is started.
/// @param work  in a worker: job -> one line of text
/// @param done  in the calling process: job and its line, in any order
/// @param stop  in the calling process, asked a few times a second: workers end with their present
///              job
[[nodiscard]] bool workInProcesses(
    int jobs, int workers, const std::function<std::string(int job)>& work,
    const std::function<void(int job, const std::string& line)>& done,
    const std::function<bool()>& stop = {});

}  // namespace wholehand
