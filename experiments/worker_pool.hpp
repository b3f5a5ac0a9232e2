#pragma once

#include <functional>
#include <string>

namespace wholehand {

/// Runs `jobs` jobs in `workers` child processes and passes each result to the calling process as
/// it arrives. Each child has its own engine globals, so results do not depend on the number of
/// processes. Each child takes the next free job. The children die with the calling process.
/// Returns false when a worker died or was stopped early; results passed before remain valid. Call
/// it before any thread is started.
/// @param work called in a worker: job -> one line of text
/// @param done called in the calling process with job and line, in any order
/// @param stop called in the calling process a few times a second; when it returns true, workers
/// end
///             after their current job
[[nodiscard]] bool workInProcesses(
    int jobs, int workers, const std::function<std::string(int job)>& work,
    const std::function<void(int job, const std::string& line)>& done,
    const std::function<bool()>& stop = {});

}  // namespace wholehand
