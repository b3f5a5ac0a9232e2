#pragma once

#include "assembly/rig.hpp"
#include "telemetry/black_box.hpp"
#include "telemetry/recording.hpp"

#include <cstdint>
#include <memory>
#include <string>

namespace wholehand {

/// Where the black box of a run goes: beside its recording ("run.h5" → "run.wbb"), or, without one,
/// out/blackbox/<time>.wbb, in the folder for temporary files where nothing can be written here.
[[nodiscard]] std::string blackBoxPath(const std::string& recording);

/// Arms the black box of a rig that is armed itself.
[[nodiscard]] Expected<std::unique_ptr<BlackBox>> armBlackBox(const Rig& rig,
                                                              const RecordingMeta& meta,
                                                              const std::string& path,
                                                              std::uint64_t most_ticks);

/// Writes the box where a stopping fault or an emergency stop calls for it; what there is to say
/// of it in one line, nothing where it was not needed. After the run.
[[nodiscard]] std::string keepBlackBox(BlackBox& box);

}  // namespace wholehand
