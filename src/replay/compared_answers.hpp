#pragma once

#include "loop/psychometrics/answer_log.hpp"

#include <nlohmann/json_fwd.hpp>

#include <string>

namespace wholehand {

/// Version of comparedJson(); increases with every change of meaning.
inline constexpr int kThresholdVersion = 1;

/// What a person's answers say about a threshold, as web/src/report/report_data.ts reads it: the
/// fit with its interval, doubts, what is missing, points and curve. Null for an exercise that
/// does not compare.
[[nodiscard]] nlohmann::json comparedJson(const AnswerLog& log);

/// The same in one line of English; empty for an exercise that does not compare.
[[nodiscard]] std::string comparedText(const AnswerLog& log);

/// The answers as `experiment thresholds --fit` reads them: x,other,said_second,is_catch, then who
/// said it and when.
[[nodiscard]] std::string comparedCsv(const AnswerLog& log);

}  // namespace wholehand
