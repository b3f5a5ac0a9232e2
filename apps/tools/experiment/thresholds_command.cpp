#include "apps/tools/experiment/experiment_command.hpp"
#include "apps/wholehand/shared/exit_code.hpp"
#include "apps/wholehand/shared/result_files.hpp"
#include "experiments/threshold_trial.hpp"
#include "files/text/text_file.hpp"
#include "loop/core/printable.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <string>
#include <vector>

namespace wholehand {
namespace {

using Json = nlohmann::ordered_json;
using Compares = VirtualObserver::Compares;

constexpr std::size_t kMostAnswers = 100'000;  // of a file

struct Row {
  std::string name;
  VirtualObserver observer;
};

std::vector<Row> observers() {
  std::vector<Row> rows;
  for (const double sigma : {0.05, 0.1, 0.2, 0.4, 0.6}) {
    for (const double lapse : {0.0, 0.02, 0.05}) {
      rows.push_back({fmt::format("sigma {:.2f}, lapse {:.0f} %", sigma, 100.0 * lapse),
                      {Compares::kX, {sigma, 0.0, lapse}}});
    }
  }
  rows.push_back({"sigma 0.20, bias 0.10", {Compares::kX, {0.2, 0.1, 0.0}}});
  rows.push_back({"sigma 0.20, memory fades", {Compares::kX, {0.2, 0.0, 0.0}, 1.0}});
  rows.push_back({"guesses", {Compares::kNothing}});
  rows.push_back({"says the first", {Compares::kFirstAlways}});
  rows.push_back({"compares position", {Compares::kOther}});
  return rows;
}

Json rowJson(const Row& row, const ThresholdTrial& trial) {
  return {{"observer", row.name},
          {"sigma", row.observer.observer.sigma},
          {"lapse", row.observer.observer.lapse},
          {"bias", trial.bias},
          {"sd", trial.sd},
          {"covered", trial.covered},
          {"doubted", trial.doubted},
          {"guesses", trial.guesses},
          {"one_answer", trial.one_answer},
          {"compares_other", trial.compares_other},
          {"misses_catches", trial.misses_catches},
          {"other_right", trial.other_right}};
}

/// Tries all observers and prints what is found of their thresholds.
Json tryAll(const ThresholdsOptions& options) {
  Json out = Json::array();
  std::printf("%d blocks of %d answers each\n%-26s %7s %6s %8s | %8s %7s %6s %6s %7s\n",
              options.blocks, options.answers, "observer", "bias", "sd", "covered", "doubted",
              "guesses", "one", "other", "catches");
  for (const Row& row : observers()) {
    const ThresholdTrial t = tryBlocks(row.observer, options.answers, options.blocks, options.seed);
    const bool compares = row.observer.compares == Compares::kX;
    std::printf("%-26s %7s %6s %8s | %6.1f %% %5.1f %% %4.1f %% %4.1f %% %5.1f %%\n",
                row.name.c_str(), compares ? fmt::format("{:+.1f} %", 100.0 * t.bias).c_str() : "-",
                compares ? fmt::format("{:.0f} %", 100.0 * t.sd).c_str() : "-",
                compares ? fmt::format("{:.1f} %", 100.0 * t.covered).c_str() : "-",
                100.0 * t.doubted, 100.0 * t.guesses, 100.0 * t.one_answer,
                100.0 * t.compares_other, 100.0 * t.misses_catches);
    std::fflush(stdout);
    out.push_back(rowJson(row, t));
  }
  return out;
}

/// Reads answers, a line each: x,other,said_second,is_catch, and perhaps said_by,time_s.
Expected<std::vector<Comparison>> readAnswers(const std::string& path) {
  std::ifstream in(path);
  if (!in) return fileFault(path, "cannot be read", "give a CSV file of answers");
  std::vector<Comparison> answers;
  std::string line;
  for (int number = 1; std::getline(in, line) && answers.size() < kMostAnswers; ++number) {
    if (line.empty() || line[0] == '#' || line.starts_with("x,")) continue;
    Comparison answer;
    int said_second = -1, is_catch = -1;
    char said_by[16] = "";
    double time_s = 0.0;
    int four = 0, six = 0;  // lengths of the line with so many columns
    const int read =
        std::sscanf(line.c_str(), "%lf,%lf,%d,%d %n,%15[a-z],%lf %n", &answer.x, &answer.other,
                    &said_second, &is_catch, &four, said_by, &time_s, &six);
    const auto is_flag = [](int value) { return value == 0 || value == 1; };
    const auto length = static_cast<int>(line.size());
    const bool whole = (read == 4 && four == length) || (read == 6 && six == length);
    if (!whole || !std::isfinite(answer.x) || answer.x == 0.0 || !std::isfinite(answer.other) ||
        !is_flag(said_second) || !is_flag(is_catch)) {
      Diagnostic fault = fileFault(path, "is no answer",
                                   "write x,other,said_second,is_catch: x = ln(second / first), "
                                   "not 0; the last two 0 or 1");
      fault.line = number;
      fault.value = printable(line.substr(0, 80));
      return fault;
    }
    answer.said_second = said_second == 1;
    answer.is_catch = is_catch == 1;
    answers.push_back(answer);
  }
  if (answers.empty()) return fileFault(path, "holds no answers", "give at least one");
  return answers;
}

Json fit(const std::vector<Comparison>& answers) {
  const Threshold threshold = fitThreshold(answers);
  const ThresholdDoubts doubts = doubtsAbout(answers);
  const Observer& o = threshold.observer;
  std::printf("sigma %.4f (95 %%: %s%.4f to %.4f%s), bias %+.3f, lapses %.1f %%, %zu answers\n",
              o.sigma, threshold.open_below ? "below " : "", threshold.low, threshold.high,
              threshold.open_above ? " and above" : "", o.bias, 100.0 * o.lapse, answers.size());
  const auto say = [](bool doubt, const char* text) {
    if (doubt) std::printf("doubt: %s\n", text);
  };
  say(answers.size() < kLeastAnswers, "too few answers for a threshold");
  say(doubts.guesses, "the answers do not depend on the difference");
  say(doubts.one_answer, "nearly always the same answer");
  say(doubts.compares_other, "the other difference explains the answers better");
  say(doubts.misses_catches, "differences that everybody feels were missed");
  return {{"answers", answers.size()},
          {"sigma", o.sigma},
          {"low", threshold.low},
          {"high", threshold.high},
          {"open_below", threshold.open_below},
          {"open_above", threshold.open_above},
          {"bias", o.bias},
          {"lapse", o.lapse},
          {"log_likelihood", logLikelihood(o, answers)},
          {"log_posterior", logPosterior(o, answers)},
          {"enough", answers.size() >= kLeastAnswers},
          {"guesses", doubts.guesses},
          {"one_answer", doubts.one_answer},
          {"compares_other", doubts.compares_other},
          {"misses_catches", doubts.misses_catches},
          {"other_right", doubts.other_right}};
}

}  // namespace

int thresholdsCommand(const ThresholdsOptions& options) {
  Json results;
  if (options.fit.empty()) {
    results = {{"blocks", options.blocks},
               {"answers", options.answers},
               {"seed", options.seed},
               {"observers", tryAll(options)}};
  } else {
    const auto answers = readAnswers(options.fit);
    if (!answers) return refuse(answers.errors());
    results = fit(*answers);
  }
  if (options.json.empty()) return kExitDone;
  if (auto written = writeText(options.json, jsonText(results)); !written) {
    return refuse(written.errors());
  }
  return kExitDone;
}

}  // namespace wholehand
