#include "replay/compared_answers.hpp"

#include "loop/psychometrics/threshold.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <utility>
#include <vector>

namespace wholehand {
namespace {

using Json = nlohmann::json;

constexpr int kCurvePoints = 41;
constexpr std::array kSayerNames = {"squeeze", "player", "therapist"};

const char* nameOf(SaidBy by) {
  return by == SaidBy::kEarlier ? "earlier" : kSayerNames[static_cast<std::size_t>(by)];
}

ThresholdFinding findingOf(const AnswerLog& log, const std::vector<Comparison>& answers) {
  return findThreshold(answers, {log.least_x(), log.most_x()});
}

/// What is missing for a threshold, as keys that pages know and as English.
std::vector<std::pair<const char*, std::string>> missingOf(const ThresholdFinding& finding) {
  std::vector<std::pair<const char*, std::string>> out;
  const ThresholdDoubts& doubts = finding.doubts;
  if (finding.missing > 0) {
    out.emplace_back("answers", fmt::format("{} more answers", finding.missing));
  }
  if (doubts.guesses) out.emplace_back("guesses", "answers that depend on the difference");
  if (doubts.one_answer) out.emplace_back("one_answer", "both answers: nearly all are the same");
  if (doubts.compares_other) {
    out.emplace_back("compares_other", "answers by feel: the depth of the squeeze explains them");
  }
  if (doubts.misses_catches) {
    out.emplace_back("misses_catches", "right answers to differences that everybody feels");
  }
  if (finding.beyond_range) out.emplace_back("beyond_range", "larger differences");
  return out;
}

/// How often "the second" was said at each x.
Json pointsOf(const std::vector<Comparison>& answers) {
  std::map<long, std::array<double, 3>> at;  // by x in thousandths: x, answers, "second"
  for (const Comparison& answer : answers) {
    auto& point = at[std::lround(1e3 * answer.x)];
    point = {answer.x, point[1] + 1.0, point[2] + (answer.said_second ? 1.0 : 0.0)};
  }
  Json out = Json::array();
  for (const auto& [_, point] : at) out.push_back(point);
  return out;
}

Json curveOf(const Observer& observer, double most_x) {
  Json out = Json::array();
  for (int i = 0; i < kCurvePoints; ++i) {
    const double x = most_x * (2.0 * i / (kCurvePoints - 1) - 1.0);
    out.push_back({x, observer.saysSecond(x)});
  }
  return out;
}

}  // namespace

Json comparedJson(const AnswerLog& log) {
  if (!log.compares()) return {};
  const std::vector<Comparison> answers = log.comparisons();
  std::array<int, kSayers> said{};
  int earlier = 0;
  Json list = Json::array();
  for (const RecordedAnswer& answer : log.answers()) {
    const Comparison& c = answer.comparison;
    ++(answer.by == SaidBy::kEarlier ? earlier : said[static_cast<std::size_t>(answer.by)]);
    list.push_back(
        {c.x, c.other, c.said_second, c.is_catch, static_cast<int>(answer.by), answer.time_s});
  }
  Json by = {{"earlier", earlier}};
  for (std::size_t i = 0; i < said.size(); ++i) by[kSayerNames[i]] = said[i];
  Json out = {{"version", kThresholdVersion}, {"answers", answers.size()}, {"said_by", by},
              {"least_x", log.least_x()},     {"most_x", log.most_x()},    {"list", list},
              {"points", pointsOf(answers)}};
  const ThresholdFinding finding = findingOf(log, answers);
  Json missing = Json::array();
  for (const auto& [key, _] : missingOf(finding)) missing.push_back(key);
  out["missing"] = missing;
  out["missing_answers"] = finding.missing;
  out["enough"] = finding.enough();
  if (answers.empty()) return out;
  const Threshold& t = finding.threshold;
  out["sigma"] = t.observer.sigma;
  out["sigma_low"] = t.low;
  out["sigma_high"] = t.high;
  out["open_below"] = t.open_below;
  out["open_above"] = t.open_above;
  out["bias"] = t.observer.bias;
  out["lapse"] = t.observer.lapse;
  out["ratio"] = ratioAtThreeOfFour(t.observer.sigma);
  out["ratio_low"] = ratioAtThreeOfFour(t.low);
  out["ratio_high"] = ratioAtThreeOfFour(t.high);
  out["at_device_limit"] = finding.at_device_limit;
  out["other_right"] = finding.doubts.other_right;
  out["curve"] = curveOf(t.observer, log.most_x());
  return out;
}

std::string comparedText(const AnswerLog& log) {
  if (!log.compares()) return {};
  const std::vector<Comparison> answers = log.comparisons();
  const ThresholdFinding finding = findingOf(log, answers);
  std::string missing;
  for (const auto& [_, text] : missingOf(finding)) missing += (missing.empty() ? "" : "; ") + text;
  if (!finding.enough()) {
    return fmt::format("not enough for a threshold ({} answers); missing: {}", answers.size(),
                       missing);
  }
  const auto percent = [](double sigma) { return 100.0 * (ratioAtThreeOfFour(sigma) - 1.0); };
  const Threshold& t = finding.threshold;
  return fmt::format(
      "threshold {:.0f} % (95 %: {:.0f} to {:.0f} %) from {} answers{}; who compares only the "
      "depth of the squeeze is right in {:.0f} %",
      percent(t.observer.sigma), percent(t.low), percent(t.high), answers.size(),
      finding.at_device_limit ? ", at the device's limit" : "", 100.0 * finding.doubts.other_right);
}

std::string comparedCsv(const AnswerLog& log) {
  std::string out = "x,other,said_second,is_catch,said_by,time_s\n";
  for (const RecordedAnswer& answer : log.answers()) {
    const Comparison& c = answer.comparison;
    out += fmt::format("{:.17g},{:.17g},{:d},{:d},{},{:.3f}\n", c.x, c.other, c.said_second,
                       c.is_catch, nameOf(answer.by), answer.time_s);
  }
  return out;
}

}  // namespace wholehand
