#pragma once

#include "support/tolerance.hpp"
#include "telemetry/recording.hpp"
#include "telemetry/synthetic_recording.hpp"

#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <vector>

namespace wholehand::synthetic {

inline RecordingMeta ofSchema(std::uint32_t schema) {
  RecordingMeta m = meta();
  m.schema = schema;
  return m;
}

/// Four chunks; two under a sanitizer.
inline const std::uint64_t kManyTicks = test::kFew ? 500 : 1000;

/// Writes ticks and expects every bit of them back. @returns bytes of the file a tick
inline double roundTrip(const std::vector<TickRecord>& ticks, const RecordingMeta& as = meta(),
                        std::size_t flush_every = SIZE_MAX) {
  const Folder folder;
  const std::string path = folder.file("a.h5");
  const auto writer = RecordingWriter::create(path, as).value();
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    EXPECT_TRUE(writer->append(ticks[i]));
    if (i % flush_every == flush_every - 1) writer->flush();
  }
  writer->close();
  EXPECT_EQ(writer->written(), ticks.size());
  const auto reader = RecordingReader::open(path).value();
  EXPECT_EQ(reader->meta().schema, as.schema);
  EXPECT_EQ(reader->size(), ticks.size());
  TickRecord got;
  for (std::size_t i = 0; i < ticks.size() && !testing::Test::HasFailure(); ++i) {
    EXPECT_TRUE(reader->read(i, got) && identical(got, ticks[i])) << "tick " << i;
  }
  return static_cast<double>(std::filesystem::file_size(path)) / static_cast<double>(ticks.size());
}

}  // namespace wholehand::synthetic
