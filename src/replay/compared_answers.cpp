#include "replay/compared_answers.hpp"

#include "loop/psychometrics/threshold.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <string>
#include <vector>

namespace wholehand {
namespace {

using Json = nlohmann::json;

constexpr int kCurvePoints = 41;
constexpr std::array kSayerNames = {"squeeze", "player", "therapist"};

const char* nameOf(SaidBy by) {
  return by == SaidBy::kEarlier ? "earlier" : kSayerNames[static_cast<std::size_t>(by)];
}

/// What may be missing for a threshold, as pages know it and in English.
const std::map<std::string, std::string> kMissing = {
    {"answers", fmt::format("at least {} are needed", kLeastAnswers)},
    {"guesses", "they do not depend on the difference"},
    {"one_answer", "nearly all are the same"},
    {"compares_other", "the depth of the squeeze explains them better"},
    {"misses_catches", "differences that everybody feels were missed"},
    {"beyond_range", "the differences were too small"}};

/// Largest threshold that is stated when |x| is at most most_x, as a ratio.
double mostRatio(double most_x) {
  return ratioAtThreeOfFour(most_x / kSigmasInRange);
}

Json missingOf(const ThresholdFinding& finding) {
  Json out = Json::array();
  const auto add = [&out](bool is_missing, const char* key) {
    if (is_missing) out.push_back(key);
  };
  add(finding.missing > 0, "answers");
  add(finding.doubts.guesses, "guesses");
  add(finding.doubts.one_answer, "one_answer");
  add(finding.doubts.compares_other, "compares_other");
  add(finding.doubts.misses_catches, "misses_catches");
  add(finding.beyond_range, "beyond_range");
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
  bool persons = !answers.empty();
  for (const RecordedAnswer& answer : log.answers()) {
    const Comparison& c = answer.comparison;
    persons = persons && answer.moved_by == Mover::kPerson;
    ++(answer.by == SaidBy::kEarlier ? earlier : said[static_cast<std::size_t>(answer.by)]);
    list.push_back(
        {c.x, c.other, c.said_second, c.is_catch, static_cast<int>(answer.by), answer.time_s});
  }
  Json by = {{"earlier", earlier}};
  for (std::size_t i = 0; i < said.size(); ++i) by[kSayerNames[i]] = said[i];
  Json out = {{"version", kThresholdVersion}, {"answers", answers.size()}, {"said_by", by},
              {"least_x", log.least_x()},     {"most_x", log.most_x()},    {"list", list},
              {"points", pointsOf(answers)}};
  out["persons"] = persons;
  out["most_ratio"] = mostRatio(log.most_x());
  const ThresholdFinding finding = findThreshold(answers, {log.least_x(), log.most_x()});
  out["missing"] = missingOf(finding);
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

std::vector<ComparedFigure> comparedFigures(const Json& compared) {
  if (!compared.is_object() || !compared.value("enough", false)) return {};
  const auto percent = [&](const char* key) { return 100.0 * (compared[key].get<double>() - 1.0); };
  return {{"threshold_percent", "%", percent("ratio")},
          {"threshold_low_percent", "%", percent("ratio_low")},
          {"threshold_high_percent", "%", percent("ratio_high")}};
}

std::string comparedText(const Json& compared) {
  if (!compared.is_object()) return {};
  const auto answers = compared["answers"].get<std::size_t>();
  const std::vector<ComparedFigure> figures = comparedFigures(compared);
  if (figures.empty()) {
    std::string missing;
    for (const Json& key : compared["missing"]) {
      missing += (missing.empty() ? "" : "; ") + kMissing.at(key.get<std::string>());
      if (key == "beyond_range") {
        missing += fmt::format(" (with them, thresholds up to {:.0f} % are stated)",
                               100.0 * (compared["most_ratio"].get<double>() - 1.0));
      }
    }
    return fmt::format("not enough for a threshold ({} answers): {}", answers, missing);
  }
  return fmt::format(
      "threshold {:.0f} % (95 %: {:.0f} to {:.0f} %) from {} answers{}; who compares only the "
      "depth of the squeeze is right in {:.0f} %",
      figures[0].value, figures[1].value, figures[2].value, answers,
      compared["at_device_limit"] ? ", at the device's limit" : "",
      100.0 * compared["other_right"].get<double>());
}

std::string comparedCsv(const Json& compared) {
  std::string out = "x,other,said_second,is_catch,said_by,time_s\n";
  if (!compared.is_object()) return out;
  for (const Json& answer : compared["list"]) {
    out += fmt::format("{:.17g},{:.17g},{:d},{:d},{},{:.3f}\n", answer[0].get<double>(),
                       answer[1].get<double>(), answer[2].get<bool>(), answer[3].get<bool>(),
                       nameOf(static_cast<SaidBy>(answer[4].get<int>())), answer[5].get<double>());
  }
  return out;
}

}  // namespace wholehand
