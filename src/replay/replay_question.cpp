#include "replay/replay_question.hpp"

#include "loop/core/printable.hpp"
#include "station/server/http_line.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <string>

namespace wholehand {
namespace {

constexpr std::uint64_t kMostRows = 1'000'000'000'000;
constexpr double kLongestTime_s = 1e9;

/// Reads the numbers of a query and collects errors.
class Numbers {
 public:
  explicit Numbers(std::string_view query) : query_(query) {}

  template <class T>
  T read(std::string_view key, T lower, T upper) {
    const std::string_view text = queryValue(query_, key);
    T value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    const bool whole = error == std::errc() && end == text.data() + text.size() && !text.empty();
    if (whole && value >= lower && value <= upper) return value;
    refuse(key, text, text.empty() ? "is missing" : "cannot be used",
           fmt::format("give a number from {} to {}", lower, upper));
    return lower;
  }
  void refuse(std::string_view key, std::string_view value, std::string problem,
              std::string remedy) {
    faults_.push_back(
        {"", 0, std::string(key), printable(value, 40), std::move(problem), std::move(remedy)});
  }
  [[nodiscard]] const Diagnostics& faults() const { return faults_; }

 private:
  std::string_view query_;
  Diagnostics faults_;
};

StatesQuestion readStates(Numbers& numbers) {
  StatesQuestion q;
  q.first = numbers.read<std::uint64_t>("tick", 0, kMostRows);
  q.count = numbers.read<std::uint64_t>("count", 1, kMostStates);
  q.step = numbers.read<std::uint64_t>("step", 1, kMostRows);
  return q;
}

SeriesQuestion readSeries(Numbers& numbers) {
  SeriesQuestion q;
  q.from_s = numbers.read("from_s", -kLongestTime_s, kLongestTime_s);
  q.to_s = numbers.read("to_s", -kLongestTime_s, kLongestTime_s);
  q.columns = numbers.read("columns", 1, kMostColumns);
  if (!numbers.faults().empty()) return q;
  if (!(q.from_s < q.to_s)) {
    numbers.refuse("to_s", fmt::format("{}", q.to_s), "is not after from_s",
                   fmt::format("give more than {} s", q.from_s));
  } else if (q.to_s - q.from_s > kLongestSeries_s * (1.0 + 1e-9)) {
    numbers.refuse("to_s", fmt::format("{}", q.to_s), "is too long after from_s",
                   fmt::format("ask for at most {} s at a time", kLongestSeries_s));
  }
  return q;
}

}  // namespace

Expected<ReplayQuestion> parseReplayQuestion(std::string_view question) {
  const std::size_t mark = question.find('?');
  const std::string_view what = question.substr(0, mark);
  Numbers numbers(mark == std::string_view::npos ? std::string_view() : question.substr(mark + 1));
  ReplayQuestion q;
  if (what == "about") {
    q.what = ReplayQuestion::Kind::kAbout;
  } else if (what == "scene") {
    q.what = ReplayQuestion::Kind::kScene;
  } else if (what == "bodies") {
    q.what = ReplayQuestion::Kind::kBodies;
  } else if (what == "states") {
    q.what = ReplayQuestion::Kind::kStates;
    q.states = readStates(numbers);
  } else if (what == "series") {
    q.what = ReplayQuestion::Kind::kSeries;
    q.series = readSeries(numbers);
  } else {
    return keyFault("", "", printable(what, 40), "is nothing that a recording is asked",
                    "ask for about, scene, bodies, states or series");
  }
  if (!numbers.faults().empty()) return numbers.faults();
  return q;
}

std::string textOf(const ReplayQuestion& question) {
  const StatesQuestion& states = question.states;
  const SeriesQuestion& series = question.series;
  switch (question.what) {
    case ReplayQuestion::Kind::kAbout:
      return "about";
    case ReplayQuestion::Kind::kScene:
      return "scene";
    case ReplayQuestion::Kind::kBodies:
      return "bodies";
    case ReplayQuestion::Kind::kStates:
      return fmt::format("states?tick={}&count={}&step={}", states.first, states.count,
                         states.step);
    case ReplayQuestion::Kind::kSeries:
      return fmt::format("series?from_s={}&to_s={}&columns={}", series.from_s, series.to_s,
                         series.columns);
  }
  return {};
}

}  // namespace wholehand
