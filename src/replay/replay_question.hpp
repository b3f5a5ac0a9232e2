#pragma once

#include "core/expected.hpp"

#include <cstdint>
#include <string>
#include <string_view>

namespace wholehand {

inline constexpr std::uint64_t kMostStates = 256;
inline constexpr double kLongestSeries_s = 60.0;
inline constexpr int kMostColumns = 2000;

/// Asks for the rows first, first + step, ... of a recording.
struct StatesQuestion {
  std::uint64_t first = 0, count = 0, step = 1;
};

/// Asks for the extremes of every channel in each of `columns` equal parts of a time interval.
struct SeriesQuestion {
  double from_s = 0.0, to_s = 0.0;
  int columns = 0;
};

/// A page's question about a recording: docs/protocol.md.
struct ReplayQuestion {
  enum class What { kAbout, kScene, kStates, kSeries, kBodies };
  What what = What::kAbout;
  StatesQuestion states;
  SeriesQuestion series;
};

/// Parses "about", "scene", "bodies", "states?tick=..&count=..&step=.." or
/// "series?from_s=..&to_s=..&columns=..". Ignores other keys of the query. An unknown question is
/// refused with key "", a missing or out-of-range number with its key.
[[nodiscard]] Expected<ReplayQuestion> parseReplayQuestion(std::string_view question);

/// The question in the form that parseReplayQuestion() reads, without other keys.
[[nodiscard]] std::string textOf(const ReplayQuestion& question);

}  // namespace wholehand
