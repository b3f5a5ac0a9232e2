#include "replay/recording_measures.hpp"

#include "loop/core/sha256.hpp"
#include "record/recording.hpp"
#include "replay/compared_answers.hpp"
#include "replay/recorded_scene.hpp"
#include "replay/therapy_facts.hpp"

#include <nlohmann/json.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

namespace wholehand {
namespace {

using Json = nlohmann::json;

/// Datasets that no measure needs.
const LeftOut kNotMeasured = {
    {"digest", "patient_effort", "tank", "theta", "parameters", "palm_distance_m"},
    {"link", "point_m", "normal", "torque_nm", "distance_m"}};

Json ratio(double part, double whole) {
  return whole > 0.0 ? Json(part / whole) : Json();
}

Expected<std::string> digestOf(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  Sha256 digest;
  std::array<char, 65'536> piece{};
  while (file) {
    file.read(piece.data(), piece.size());
    digest.add({piece.data(), static_cast<std::size_t>(file.gcount())});
  }
  if (file.eof()) return digest.digits();
  return fileFault(path, "cannot be read to its end", "check the disk");
}

}  // namespace

Expected<Json> recordingMeasures(const std::string& path) {
  const auto viewed = viewRecording(path, kNotMeasured);
  if (!viewed) return viewed.errors();
  RecordingReader& reader = *viewed->reader;
  const RecordingMeta& meta = reader.meta();
  if (reader.outline().being_written) {
    return fileFault(path, "is still being written", "measure it when its session has ended");
  }
  // Reads all ticks.
  TherapyFacts facts(meta);
  auto record = std::make_unique<TickRecord>();
  std::uint64_t ticks = 0, last = 0;
  for (std::uint64_t row = 0; row < reader.size(); ++row) {
    if (!reader.read(row, *record)) continue;
    facts.add(*record,
              ticks > 0 && missingBetween(last, record->tick, record->elapsed_periods) == 0, row);
    last = record->tick;
    ++ticks;
  }
  const auto digest = digestOf(path);
  if (!digest) return digest.errors();
  // Selects the measures from the facts.
  const Json told = facts.json();
  const Json& reaches = told["reaches"];
  const ActivePeriods& active = facts.active();
  const auto seconds = [&](std::uint64_t periods) {
    return static_cast<double>(periods) * meta.period_s;
  };
  Json results = Json::array();
  for (const Json& result : told["results"]) {
    if (!std::isfinite(result["value"].get<double>())) continue;
    results.push_back(
        {{"name", result["name"]}, {"value", result["value"]}, {"unit", result["unit"]}});
  }
  // A demonstration measures nobody.
  Json compared = told["compared"];
  if (compared.is_object() && compared["persons"].get<bool>()) {
    for (const ComparedFigure& figure : comparedFigures(compared)) {
      results.push_back({{"name", figure.name}, {"value", figure.value}, {"unit", figure.unit}});
    }
  }
  const auto count = reaches["count"].get<double>();
  const std::string ended_by = ticks > 0 ? endedBy(*record) : "";
  return Json{
      {"measures", kMeasuresVersion},
      {"recording",
       {{"name", std::filesystem::path(path).filename().string()},
        {"sha256", *digest},
        {"ticks", ticks},
        {"duration_s", ticks == 0 ? 0.0 : static_cast<double>(last + 1) * meta.period_s},
        {"began_utc", meta.created_utc},
        {"complete",
         ended_by != "broken_off" && notShown(*viewed, {reader.size() - ticks, 0}, path).empty()}}},
      {"hand", embeddedName(meta, "hand")},
      {"visit", meta.clinic_visit},
      {"item", meta.clinic_item},
      {"exercise", meta.exercise},
      {"level", meta.level},
      {"results", std::move(results)},
      {"compared", std::move(compared)},
      {"active_s", seconds(active.active)},
      {"helped_s", seconds(active.helped)},
      {"led_s", seconds(active.led)},
      {"helped_share",
       ratio(seconds(active.helped + active.led), seconds(active.active + active.led))},
      {"peak_speed_m_s", reaches["peak_m_s"]},
      {"path_ratio", ratio(reaches["path_m"].get<double>(), reaches["straight_m"].get<double>())},
      {"reaches", reaches["count"]},
      {"reach_s", ratio(reaches["sum_s"].get<double>(), count)},
      {"ended_by", ended_by}};
}

}  // namespace wholehand
