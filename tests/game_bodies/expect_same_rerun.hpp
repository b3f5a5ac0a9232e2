#pragma once

#include "record/black_box_reader.hpp"
#include "replay/resimulation/resimulation.hpp"
#include "support/rig_tools.hpp"

namespace wholehand::test {

/// Expects that a recording or black box file, simulated again, is bit-identical.
inline void expectSameRerun(const std::string& path, int ticks) {
  if (path.ends_with(".h5")) {
    const auto reader = orThrow(RecordingReader::open(path));
    const auto again = orThrow(resimulate(*reader, path));
    EXPECT_GE(again.compared, static_cast<std::uint64_t>(ticks));
    EXPECT_TRUE(again.same()) << "tick " << again.visible_tick;
    return;
  }
  const auto box = orThrow(BlackBoxReader::open(path));
  const auto again = orThrow(resimulate(*box, path));
  EXPECT_GE(again.compared, static_cast<std::uint64_t>(ticks));
  EXPECT_TRUE(again.same()) << "tick " << again.visible_tick;
}

}  // namespace wholehand::test
