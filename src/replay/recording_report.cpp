#include "replay/recording_report.hpp"

#include "files/page/chart_page.hpp"
#include "record/black_box_reader.hpp"
#include "record/recording.hpp"
#include "replay/recorded_scene.hpp"
#include "replay/recording_series.hpp"
#include "replay/replayed_recording.hpp"
#include "replay/therapy_facts.hpp"
#include "station/server/wire.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <utility>
#include <vector>

namespace wholehand {
namespace {

using Json = nlohmann::json;

/// Bin width of the histogram as a fraction of the period: three periods and one overflow bin.
constexpr double kStep = 0.01;
constexpr std::size_t kSteps = 301;

Json percentilesJson(const Percentiles& p) {
  return {{"p50_s", 1e-9 * p.p50_ns},
          {"p99_s", 1e-9 * p.p99_ns},
          {"p999_s", 1e-9 * p.p999_ns},
          {"max_s", 1e-9 * p.max_ns}};
}

/// Faults that occurred, each with its most frequent axis.
Json faultsJson(const TickSummary& summary, const RecordingMeta& meta) {
  Json faults = Json::array();
  for (std::size_t bit = 0; bit < kFaultTable.size(); ++bit) {
    if (summary.faults[bit] == 0) continue;
    const auto& counts = summary.fault_axes[bit];
    const auto most = std::max_element(counts.begin(), counts.end());
    const std::size_t axis = most - counts.begin();
    const bool has_axis = *most > 0 && axis < meta.axis_names.size();
    faults.push_back({{"name", kFaultTable[bit].name},
                      {"ticks", summary.faults[bit]},
                      {"stops", kFaultTable[bit].reaction == FaultReaction::kStops},
                      {"axis", has_axis ? meta.axis_names[axis] : std::string()}});
  }
  return faults;
}

Json settingsJson(const RecordingMeta& meta) {
  return {{"scene", embeddedName(meta, "scene")},
          {"rendering", embeddedName(meta, "rendering")},
          {"engine", meta.engine},
          {"simulated_clock", meta.simulated_clock},
          {"paper", meta.paper},
          {"uncertified", meta.uncertified},
          {"passport", meta.passport},
          {"seed", std::to_string(meta.seed)}};  // as text: JavaScript numbers cannot hold 64 bits
}

}  // namespace

EngineeringFacts::EngineeringFacts(const RecordingMeta& meta)
    : meta_(meta), wall_(kSteps, 0), cpu_(kSteps, 0) {}

void EngineeringFacts::add(const TickRecord& record) {
  statistics_.add(record);
  const auto step = [this](std::int64_t ns) {
    const double steps = static_cast<double>(ns) * 1e-9 / meta_.period_s / kStep;
    return static_cast<std::size_t>(std::clamp(steps, 0.0, static_cast<double>(kSteps - 1)));
  };
  ++wall_[step(record.wall_ns)];
  ++cpu_[step(record.cpu_ns)];
  ++records_;
  if (std::any_of(record.phi.begin(), record.phi.end(), [](double v) { return v > 0.5; })) {
    ++damped_;
  }
}

Json EngineeringFacts::timesJson(const TickSummary& summary) const {
  const bool is_cpu = meta_.simulated_clock || summary.wall.max_ns <= 0.0;
  Json stages = Json::array();
  for (int i = 0; i < kStages; ++i) {
    Json stage = percentilesJson(summary.stage_cpu[i]);
    stage["name"] = stageName(static_cast<Stage>(i));
    stages.push_back(std::move(stage));
  }
  return {{"is_cpu", is_cpu},
          {"tick", percentilesJson(is_cpu ? summary.cpu : summary.wall)},
          {"tick_cpu", percentilesJson(summary.cpu)},
          {"stages", stages},
          {"step_s", kStep * meta_.period_s},
          {"counts", is_cpu ? cpu_ : wall_}};
}

Json EngineeringFacts::json() const {
  const TickSummary summary = statistics_.snapshot();
  const double records = std::max<double>(1.0, static_cast<double>(records_));
  return {
      {"records", summary.records},
      {"missed_deadlines", summary.missed_deadlines},
      {"stopping_faults", summary.stopping_faults},
      {"faults", faultsJson(summary, meta_)},
      {"largest_effort", std::vector<double>(summary.max_effort.begin(), summary.max_effort.end())},
      {"work_j", summary.work_j},
      {"contacts_max", summary.contacts_max},
      {"coupling_error_rad", summary.max_coupling_error_rad},
      {"damped_share", static_cast<double>(damped_) / records},
      {"times", timesJson(summary)},
      {"settings", settingsJson(meta_)}};
}

namespace {

/// Version of the data; counts incompatible changes.
constexpr int kVersion = 1;
constexpr std::uint64_t kTicksBetweenProgress = 10'000;
/// Limits that keep a page below 2 MB: number and bytes of states before compression, and
/// compressed sizes.
constexpr std::uint64_t kMostShownStates = 1'500;
constexpr std::size_t kMostStates_bytes = 1'500'000, kMostPacked_bytes = 500'000;
constexpr std::size_t kMostSeries_bytes = 360'000, kMostBodies_bytes = 300'000;
constexpr int kMostShownColumns = 800, kFewestColumns = 100;

/// Datasets that a report does not need.
const LeftOut kLeftOut = {{"digest", "patient_effort", "tank"}, {}};
/// Datasets that a report needs only for the states that it shows, one tick in hundreds.
const LeftOut kLeftOutBetweenStates = {
    {"digest", "patient_effort", "tank", "theta", "parameters", "palm_distance_m"},
    {"link", "point_m", "normal", "torque_nm", "distance_m"}};

/// All data of a page, or only the figures for comparison with another session.
enum class Detail { kAll, kFigures };

Expected<ViewedRecording> openAny(const std::string& path) {
  if (!BlackBoxReader::isBox(path)) return viewRecording(path, kLeftOut);
  auto box = BlackBoxReader::openBox(path);
  if (!box) return box.errors();
  ViewedRecording viewed;
  viewed.reader = std::move(*box);
  if (viewed.reader->size() > 0) viewed.last_tick = viewed.reader->outline().numbers.back();
  return viewed;
}

/// Samples every n-th state of a recording and its last one, as the viewer expects.
class StateSample {
 public:
  StateSample(std::shared_ptr<const SceneFacts> facts, std::uint64_t size, Detail detail)
      : encoder_(std::move(facts)),
        last_(size - 1),
        inserted_(last_),
        step_(detail == Detail::kAll ? 1 + (size - 1) / kMostShownStates : size) {}

  [[nodiscard]] const std::vector<std::uint64_t>& rows() const { return rows_; }
  [[nodiscard]] bool wants(std::uint64_t row) const { return row % step_ == 0 || row == last_; }
  /// Adds a state, unless the page has enough. @pre wants(row)
  void add(std::uint64_t row, const TickRecord& record) {
    const auto message =
        encoder_.encode(record, recordedStatus(record), wire::Detail::kRecorded, 0);
    const auto bytes = static_cast<std::uint32_t>(message.size());
    std::string& added = messages_.emplace_back();
    added.append(reinterpret_cast<const char*>(&bytes), sizeof bytes);
    added.append(reinterpret_cast<const char*>(message.data()), message.size());
    rows_.push_back(row);
    bytes_ += added.size();
    if (bytes_ > kMostStates_bytes) dropEverySecond();
  }
  /// Adds a state out of order; it is never dropped. @pre all other states were added
  void insert(std::uint64_t row, const TickRecord& record) {
    inserted_ = row;
    const auto at = std::lower_bound(rows_.begin(), rows_.end(), row) - rows_.begin();
    if (std::cmp_less(at, rows_.size()) && rows_[at] == row) return;
    add(row, record);
    std::rotate(messages_.begin() + at, messages_.end() - 1, messages_.end());
    std::rotate(rows_.begin() + at, rows_.end() - 1, rows_.end());
  }
  [[nodiscard]] Json json() {
    std::string packed = pack();
    for (; packed.size() > kMostPacked_bytes && rows_.size() > 2; packed = pack()) {
      dropEverySecond();
    }
    return {{"rows", rows_}, {"messages", packed}};
  }

 private:
  [[nodiscard]] std::string pack() const {
    std::string all;
    for (const std::string& message : messages_) all += message;
    return packBytes(all);
  }
  void dropEverySecond() {
    step_ *= 2;
    std::vector<std::string> messages;
    std::vector<std::uint64_t> rows;
    bytes_ = 0;
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      if (rows_[i] % step_ != 0 && rows_[i] != last_ && rows_[i] != inserted_) continue;
      bytes_ += messages_[i].size();
      messages.push_back(std::move(messages_[i]));
      rows.push_back(rows_[i]);
    }
    messages_ = std::move(messages);
    rows_ = std::move(rows);
  }

  wire::StateEncoder encoder_;
  const std::uint64_t last_;
  std::uint64_t inserted_;
  std::uint64_t step_;
  std::vector<std::uint64_t> rows_;
  std::vector<std::string> messages_;
  std::size_t bytes_ = 0;
};

/// Plot question for the whole recording. The interval's edges lie between two ticks.
SeriesQuestion wholeOf(const ViewedRecording& viewed, Detail detail) {
  const RecordingMeta& meta = viewed.reader->meta();
  const auto time_s = [&](std::uint64_t tick) {
    return (static_cast<double>(tick) - 0.5) * meta.period_s;
  };
  const std::size_t channel_bytes = 2 * sizeof(float) * seriesChannels(meta).size();
  const auto fitting = static_cast<int>(kMostSeries_bytes / channel_bytes);
  SeriesQuestion whole;
  whole.from_s = time_s(viewed.reader->outline().numbers.front());
  whole.to_s = time_s(viewed.last_tick + 1);
  const double ticks = (whole.to_s - whole.from_s) / meta.period_s;
  whole.columns = std::clamp(fitting, kFewestColumns, kMostShownColumns);
  if (detail == Detail::kFigures) whole.columns = 1;
  if (ticks < whole.columns) whole.columns = std::max(1, static_cast<int>(std::lround(ticks)));
  return whole;
}

/// Collects the ticks of a recording in order.
class ReportCollector {
 public:
  ReportCollector(const ViewedRecording& viewed, std::shared_ptr<const SceneFacts> facts,
                  Detail detail)
      : meta_(viewed.reader->meta()),
        series_(meta_, wholeOf(viewed, detail)),
        states_(std::move(facts), viewed.reader->size(), detail),
        bodies_(meta_),
        therapy_(meta_),
        engineering_(meta_) {}

  /// Adds a tick.
  /// @param before the previous tick; null when unknown
  void add(std::uint64_t row, const TickRecord& record, const TickRecord* before) {
    series_.add(record, before);
    const bool follows =
        before != nullptr && missingBetween(before->tick, record.tick, record.elapsed_periods) == 0;
    therapy_.add(record, follows, row);
    engineering_.add(record);
    bodies_.onRecord(record);
  }
  [[nodiscard]] bool wantsState(std::uint64_t row) const { return states_.wants(row); }
  /// Adds the state of a tick. @pre wantsState(row)
  void addState(std::uint64_t row, const TickRecord& record) {
    states_.add(row, record);
    bodies_.keep(row);
  }
  [[nodiscard]] const StrongestContact& strongest() const { return therapy_.strongest(); }
  /// Adds the state of the strongest contact, which the page shows as a picture.
  void insertState(std::uint64_t row, const TickRecord& record) { states_.insert(row, record); }
  void skipUnreadable(std::uint64_t tick) {
    series_.skipUnreadable(static_cast<double>(tick) * meta_.period_s);
  }
  [[nodiscard]] Json json(bool has_scene) {
    Json data = {{"page", "report"},
                 {"version", kVersion},
                 {"series", packBytes(series_.message(0))},
                 {"therapy", therapy_.json()},
                 {"engineering", engineering_.json()}};
    if (!has_scene) return data;
    data["states"] = states_.json();
    if (meta_.game_slots > 0) data["bodies"] = packedBodies();
    return data;
  }

 private:
  /// Bodies at the shown states; at fewer states if the data would be too large.
  [[nodiscard]] std::string packedBodies() const {
    std::string packed;
    for (std::size_t step = 1; step <= states_.rows().size(); step *= 2) {
      packed = packBytes(bodies_.at(states_.rows(), step));
      if (packed.size() <= kMostBodies_bytes) return packed;
    }
    return packBytes("");
  }

  const RecordingMeta& meta_;
  SeriesCollector series_;
  StateSample states_;
  SampledBodies bodies_;
  TherapyFacts therapy_;
  EngineeringFacts engineering_;
};

/// Reads a recording into the collector.
/// @param reader the recording
/// @param states the same recording with all datasets that a state needs; null: no states
/// @param size number of ticks to collect: a recording in progress may have grown since
UnreadTicks collect(RecordingReader& reader, RecordingReader* states, std::uint64_t size,
                    ReportCollector& collector, const std::function<void(double)>& progress) {
  TickRecord state;
  std::array<TickRecord, 2> records;
  TickRecord *record = &records[0], *before = &records[1];
  bool known = false;
  UnreadTicks unread;
  for (std::uint64_t i = 0; i < std::min(size, reader.size()); ++i) {
    if (progress && i % kTicksBetweenProgress == 0) {
      progress(static_cast<double>(i) / static_cast<double>(size));
    }
    if (!reader.read(i, *record)) {
      collector.skipUnreadable(reader.outline().numbers[i]);
      if (unread.count++ == 0) unread.first = i;
      known = false;
      continue;
    }
    collector.add(i, *record, known ? before : nullptr);
    if (states == &reader && collector.wantsState(i)) collector.addState(i, *record);
    if (states != nullptr && states != &reader && collector.wantsState(i) &&
        states->read(i, state)) {
      collector.addState(i, state);
    }
    std::swap(record, before);
    known = true;
  }
  const StrongestContact& strongest = collector.strongest();
  if (states != nullptr && strongest.force_n > 0.0 && states->read(strongest.row, state)) {
    collector.insertState(strongest.row, state);
  }
  return unread;
}

Expected<Json> dataOf(const std::string& recording_path, Detail detail,
                      const std::function<void(double)>& progress, std::uint64_t long_from,
                      Diagnostics* not_shown = nullptr) {
  const auto viewed = openAny(recording_path);
  if (!viewed) return viewed.errors();
  RecordingReader& reader = *viewed->reader;
  // In a long recording, whole ticks are read only for the shown states. In a short one, each chunk
  // contains such a state anyway.
  Expected<ViewedRecording> between = ViewedRecording{}, whole = ViewedRecording{};
  const bool is_long = detail == Detail::kAll && reader.size() >= long_from &&
                       !BlackBoxReader::isBox(recording_path);
  if (is_long) {
    between = viewRecording(recording_path, kLeftOutBetweenStates);
    whole = viewRecording(recording_path, kLeftOut);
    if (!between) return between.errors();
    if (!whole) return whole.errors();
  }
  if (reader.size() == 0) {
    return fileFault(recording_path, "holds no ticks", "record a run that lasts a while");
  }
  const auto scene = recordedScene(reader.meta(), recording_path);
  const auto facts = std::make_shared<const SceneFacts>(scene ? *scene : SceneFacts{});
  ReportCollector collector(*viewed, facts, detail);
  RecordingReader* states = is_long ? whole->reader.get() : &reader;
  const UnreadTicks unread = collect(is_long ? *between->reader : reader, scene ? states : nullptr,
                                     reader.size(), collector, progress);
  Json data = collector.json(scene.ok());
  if (not_shown != nullptr) *not_shown = notShown(*viewed, unread, recording_path);
  const std::string name = std::filesystem::path(recording_path).filename().string();
  data["about"] =
      Json::parse(replayAbout(*viewed, name, false, *facts, scene ? "" : format(scene.errors())));
  if (scene && detail == Detail::kAll) {
    const wire::Bytes message = wire::sceneMessage(*facts);
    data["scene"] = packBytes({reinterpret_cast<const char*>(message.data()), message.size()});
  }
  return data;
}

}  // namespace

Expected<Json> reportData(const std::string& recording_path, const std::string& before_path,
                          const std::function<void(double)>& progress, std::uint64_t long_from,
                          Diagnostics* not_shown) {
  std::error_code missing;
  if (!before_path.empty() && std::filesystem::equivalent(recording_path, before_path, missing)) {
    return keyFault(before_path, "--before", "", "is the recording of the report itself",
                    "name the recording of the session before");
  }
  // The previous session is read first: if it is refused, no time is lost on the long one.
  Json before;
  if (!before_path.empty()) {
    auto figures = dataOf(before_path, Detail::kFigures, progress, long_from);
    if (!figures) return figures.errors();
    before = std::move(*figures);
  }
  auto data = dataOf(recording_path, Detail::kAll, progress, long_from, not_shown);
  if (data && !before_path.empty()) (*data)["before"] = std::move(before);
  return data;
}

}  // namespace wholehand
