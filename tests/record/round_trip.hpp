#pragma once

#include "record/recording.hpp"
#include "record/synthetic_recording.hpp"
#include "support/tolerance.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace wholehand::synthetic {

/// Four chunks; two under a sanitizer.
inline const std::uint64_t kManyTicks = test::kReducedCounts ? 500 : 1000;

/// Writes ticks and reads them back; check(written, read) compares them.
template <class Check>
void roundTrip(const std::vector<TickRecord>& ticks, Check&& check,
               const RecordingMeta& as = meta()) {
  const Folder folder;
  const std::string path = folder.file("a.h5");
  writeRecording(path, ticks, as);
  const auto reader = RecordingReader::open(path).value();
  ASSERT_EQ(reader->size(), ticks.size());
  TickRecord got;
  for (std::size_t i = 0; i < ticks.size() && !testing::Test::HasFailure(); ++i) {
    ASSERT_TRUE(reader->read(i, got)) << "tick " << i;
    SCOPED_TRACE(i);
    check(ticks[i], got);
  }
}

}  // namespace wholehand::synthetic
