#pragma once

#include "core/expected.hpp"

#include <cstdint>
#include <string>
#include <string_view>

namespace wholehand {

inline constexpr std::uint64_t kMostStates = 256;
inline constexpr double kLongestSeries_s = 60.0;
inline constexpr int kMostColumns = 2000;

/// Rows first, first + step, ... of a recording.
struct StatesQuestion {
  std::uint64_t first = 0, count = 0, step = 1;
};

/// The extremes of every channel in each of so many equal parts of a stretch of time.
struct SeriesQuestion {
  double from_s = 0.0, to_s = 0.0;
  int columns = 0;
};

/// What a page asks of a recording, docs/protocol.md.
struct ReplayQuestion {
  enum class What { kAbout, kScene, kStates, kSeries };
  What what = What::kAbout;
  StatesQuestion states;
  SeriesQuestion series;
};

/// Of "about", "scene", "states?tick=..&count=..&step=.." or
/// "series?from_s=..&to_s=..&columns=.."; other keys of the query are left alone. Refuses what is
/// none of these with key "" and a number that is missing or out of range with its key.
[[nodiscard]] Expected<ReplayQuestion> parseReplayQuestion(std::string_view question);

/// As parseReplayQuestion() takes it, with nothing beside it.
[[nodiscard]] std::string textOf(const ReplayQuestion& question);

}  // namespace wholehand
