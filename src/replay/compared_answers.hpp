#pragma once

#include "loop/psychometrics/answer_log.hpp"

#include <nlohmann/json_fwd.hpp>

#include <string>
#include <vector>

namespace wholehand {

/// Version of comparedJson(); increases with every change of meaning.
inline constexpr int kThresholdVersion = 1;

/// What a person's answers say about a threshold, as web/src/report/report_data.ts reads it: the
/// fit with its interval, doubts, what is missing, points and curve; "persons": a person moved the
/// hand at every answer. Null for an exercise that does not compare.
[[nodiscard]] nlohmann::json comparedJson(const AnswerLog& log);

/// The same in one line of English; empty for an exercise that does not compare.
[[nodiscard]] std::string comparedText(const nlohmann::json& compared);

/// A figure of the threshold.
struct ComparedFigure {
  std::string name, unit;
  double value = 0.0;
};
/// The threshold and the ends of its interval, as the percentage by which one of both must be more
/// so that three of four are told apart. Empty where it is not enough for a threshold.
[[nodiscard]] std::vector<ComparedFigure> comparedFigures(const nlohmann::json& compared);

/// The answers as `experiment thresholds --fit` reads them: x,other,said_second,is_catch, then who
/// said it and when.
[[nodiscard]] std::string comparedCsv(const nlohmann::json& compared);

}  // namespace wholehand
