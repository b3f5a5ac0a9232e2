// wholehand device conform: the conformance suite as text and JSON.
#include "core/printable.hpp"
#include "device_command.hpp"
#include "exit_code.hpp"
#include "model/device_model.hpp"

#include <nlohmann/json.hpp>

#include <chrono>
#include <cstdio>
#include <filesystem>

namespace wholehand {
namespace {

using Json = nlohmann::ordered_json;

const char* word(Outcome outcome) {
  switch (outcome) {
    case Outcome::kPassed:
      return "passed";
    case Outcome::kFailed:
      return "failed";
    case Outcome::kSkipped:
      return "not run";
  }
  return "";
}

struct Counts {
  int passed = 0, failed = 0, not_run = 0;
};
Counts count(const std::vector<CheckResult>& results) {
  Counts out;
  for (const CheckResult& r : results) {
    if (r.finding.outcome == Outcome::kPassed) ++out.passed;
    if (r.finding.outcome == Outcome::kFailed) ++out.failed;
    if (r.finding.outcome == Outcome::kSkipped) ++out.not_run;
  }
  return out;
}

// Checks that need the person's permission and did not get it; reported once for all.
bool isLeftOut(const Check& check, const ConformanceOptions& asked) {
  return (check.effect != Effect::kLooks && !asked.allow_effort) ||
         (check.effect == Effect::kOverreaches && !asked.allow_beyond_limit);
}

void print(const CheckResult& r) {
  const char* const mark = r.finding.outcome == Outcome::kPassed   ? "ok  "
                           : r.finding.outcome == Outcome::kFailed ? "FAIL"
                                                                   : "-   ";
  std::printf("%s %-31s %s\n", mark, r.check->id, r.check->asks);
  if (r.finding.outcome == Outcome::kPassed) return;
  std::printf("     %s\n", printable(r.finding.text, 1000).c_str());
  if (r.finding.outcome == Outcome::kFailed) std::printf("     → %s\n", r.check->remedy);
}

Json jsonOf(const DeviceOptions& options, const std::vector<CheckResult>& results) {
  const Counts counts = count(results);
  Json json{{"driver", options.driver.path},
            {"allow_effort", options.conformance.allow_effort},
            {"allow_beyond_limit", options.conformance.allow_beyond_limit},
            {"passed", counts.passed},
            {"failed", counts.failed},
            {"not_run", counts.not_run},
            {"checks", Json::array()}};
  for (const CheckResult& r : results) {
    Json check{{"id", r.check->id},
               {"asks", r.check->asks},
               {"outcome", word(r.finding.outcome)},
               {"finding", r.finding.text}};
    if (r.finding.outcome == Outcome::kFailed) check["remedy"] = r.check->remedy;
    json["checks"].push_back(check);
  }
  return json;
}

}  // namespace

int deviceConformCommand(const DeviceOptions& options) {
  const auto no = [](const char* key, const std::string& value, const char* why,
                     const char* remedy) {
    return refuse({Diagnostic{"", 0, key, value, why, remedy}});
  };
  std::error_code error;
  if (!std::filesystem::is_regular_file(options.driver.path, error)) {
    return no("--driver", options.driver.path, "is no file",
              "give the path of a driver's shared object");
  }
  ConformanceOptions asked = options.conformance;
  asked.driver = options.driver;
  if (!options.device.empty()) {
    const auto model = loadDeviceFile(options.device);
    if (!model) return refuse(model.errors());
    for (const DeviceAxis& axis : model->axes) {
      asked.known.push_back({std::string(axis.name), axis.mass, axis.neutral_effort});
    }
  }
  const auto began = std::chrono::steady_clock::now();
  const std::vector<CheckResult> results = conform(asked);
  if (results.empty()) {
    return no("--only", asked.only, "is the beginning of no check",
              "run without it to see their names");
  }
  std::size_t left_out = 0;
  for (const CheckResult& r : results) {
    if (isLeftOut(*r.check, asked)) {
      ++left_out;
    } else {
      print(r);
    }
  }
  if (left_out > 0) {
    std::printf(
        "-    %zu checks that move the device were left out: %s\n", left_out,
        asked.allow_effort ? "--allow-beyond-limit" : "--allow-effort, with nobody attached");
  }
  const Counts counts = count(results);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - began;
  std::printf("%zu checks in %.0f s: %d passed, %d failed, %d not run\n", results.size(),
              took.count(), counts.passed, counts.failed, counts.not_run);
  if (const int code = writeJson(options.json, jsonOf(options, results)); code != kExitDone) {
    return code;
  }
  return counts.failed == 0 ? kExitDone : kExitNotFit;
}

}  // namespace wholehand
