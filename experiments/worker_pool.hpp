#pragma once

#include <functional>
#include <string>

namespace wholehand {

/// Does `jobs` pieces of work in that many processes of their own (each with the engine's globals
/// to itself, so that results do not depend on how many there are), and tells the result of each as
/// it comes, in the calling process. False where a worker died or was stopped before its work was
/// done; what was told until then stands. Call it before any thread has been started.
/// @param work  in a worker: job -> one line of text
/// @param done  in the calling process: job and its line, in any order
[[nodiscard]] bool workInProcesses(
    int jobs, int workers, const std::function<std::string(int job)>& work,
    const std::function<void(int job, const std::string& line)>& done);

}  // namespace wholehand
