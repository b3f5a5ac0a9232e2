#include "replay/part_log.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <limits>
#include <string_view>

namespace wholehand {
namespace {

using Json = nlohmann::json;
using Names = std::initializer_list<std::string_view>;

/// A page lists so many parts; its sums are over all.
constexpr std::size_t kMostParts = 400;
constexpr std::array kEnds = {"drink_done", "band_held", "level_done"};
constexpr Names kBegins = {"engaged", "pour_began", "band_entered"};
/// After these the hand is free to reach, and with these it has reached.
constexpr Names kFrees = {"disengaged", "step_done", "band_held",
                          "resumed",    "restarted", "drink_done"};
constexpr Names kReached = {"engaged", "band_entered"};
constexpr Names kRestarts = {"restarted"};

int indexOf(const std::vector<std::string>& names, std::string_view name) {
  const auto found = std::find(names.begin(), names.end(), name);
  return found == names.end() ? -1 : static_cast<int>(found - names.begin());
}

std::vector<bool> marked(const std::vector<std::string>& names, Names among) {
  std::vector<bool> out;
  for (const std::string& name : names) {
    out.push_back(std::find(among.begin(), among.end(), name) != among.end());
  }
  return out;
}

constexpr double kStep_m = 1e-3;  ///< shorter ones are resolution or tremor

double valueAt(const TickRecord& record, int index) {
  return index >= 0 && index < record.exercise.value_count ? record.exercise.values[index] : 0.0;
}

}  // namespace

HandPath::HandPath(const std::vector<std::string>& axis_names) {
  constexpr std::array kAxes = {"x", "y", "z"};
  for (std::size_t i = 0; i < axes_.size(); ++i) axes_[i] = indexOf(axis_names, kAxes[i]);
}

void HandPath::add(const TickRecord& record) {
  Eigen::Vector3d place_m = Eigen::Vector3d::Zero(), speed_m_s = Eigen::Vector3d::Zero();
  for (Eigen::Index i = 0; i < 3; ++i) {
    const int axis = axes_[static_cast<std::size_t>(i)];
    if (axis >= 0 && axis < record.q_m.size()) place_m[i] = record.q_m[axis];
    if (axis >= 0 && axis < record.qd_mf.size()) speed_m_s[i] = record.qd_mf[axis];
  }
  if (!place_m.allFinite() || !speed_m_s.allFinite()) return;
  if (!std::exchange(begun_, true)) anchor_m_ = place_m;
  place_m_ = place_m;
  speed_m_s_ = speed_m_s.norm();
  if (const double step_m = (place_m - anchor_m_).norm(); step_m >= kStep_m) {
    length_m_ += step_m;
    anchor_m_ = place_m;
  }
}

PartLog::PartLog(const RecordingMeta& meta)
    : meta_(meta),
      begins_(marked(meta.event_names, kBegins)),
      frees_(marked(meta.event_names, kFrees)),
      reached_(marked(meta.event_names, kReached)),
      restarts_(marked(meta.event_names, kRestarts)),
      step_done_(indexOf(meta.event_names, "step_done")),
      stars_value_(indexOf(meta.value_names, "stars")),
      path_(meta.axis_names) {
  for (std::size_t k = 0; k < kEnds.size(); ++k) ends_[k] = indexOf(meta.event_names, kEnds[k]);
  for (const std::string& name : meta.result_names) {
    result_values_.push_back(indexOf(meta.value_names, name));
  }
  results_.assign(result_values_.size(), 0.0);
  for (PartSums& sums : sums_) sums.gained.assign(results_.size(), 0.0);
}

void PartLog::add(const TickRecord& record, const MovedTime& before, const MovedTime& now) {
  path_.add(record);
  if (now.persons() > before.persons()) peak_m_s_ = std::max(peak_m_s_, path_.speed_m_s());
  if (now.sum() == (now - before).sum()) {  // the first tick
    keepResults(record);
    free_ = {true, record.time_s, before, results_, path_.place_m(), path_.length_m()};
    after_.fill(free_);
  }
  if (record.exercise.event_count > 0) {
    Begin here{true, record.time_s, before, results_, path_.place_m(), path_.length_m()};
    for (int e = 0; e < record.exercise.event_count; ++e) {
      addEvent(record.exercise.events[e], record, here, now);
    }
  }
  keepResults(record);
  all_ = now;
}

void PartLog::keepResults(const TickRecord& record) {
  for (std::size_t i = 0; i < results_.size(); ++i)
    results_[i] = valueAt(record, result_values_[i]);
}

void PartLog::addEvent(const ExerciseEvent& event, const TickRecord& record, Begin& here,
                       const MovedTime& now) {
  if (event.type < 0 || std::cmp_greater_equal(event.type, begins_.size())) return;
  const auto type = static_cast<std::size_t>(event.type);
  if (reached_[type]) reach(record.time_s, now);
  if (restarts_[type]) {
    // What was begun is not finished; what the exercise counts begins at 0.
    steps_.clear();
    std::fill(here.results.begin(), here.results.end(), 0.0);
    began_.fill({});
    after_.fill(here);
  }
  if (begins_[type]) {
    for (Begin& began : began_) {
      if (!began.known) began = here;
    }
  }
  if (event.type == step_done_ && steps_.size() < kMostParts) {
    steps_.emplace_back(event.index, event.value);
  }
  for (int k = 0; k < kKinds; ++k) {
    if (event.type == ends_[k]) finish(static_cast<Kind>(k), event, record, now);
  }
  if (frees_[type]) free_ = here;
}

void PartLog::reach(double time_s, const MovedTime& now) {
  if (!free_.known) return;
  const MovedTime moved = now - free_.moved;
  if (moved.isPersons()) {
    ++reaches_.count;
    reaches_.sum_s += time_s - free_.time_s;
    reaches_.path_m += path_.length_m() - free_.path_m;
    reaches_.straight_m += (path_.place_m() - free_.place_m).norm();
  } else {
    ++(moved.isShared() ? reaches_.shared : reaches_.others);
  }
  free_.known = false;
}

void PartLog::finish(Kind kind, const ExerciseEvent& event, const TickRecord& record,
                     const MovedTime& now) {
  const Begin& began = began_[kind].known ? began_[kind] : after_[kind];
  FinishedPart part{meta_.event_names[event.type],
                    event.index,
                    event.value,
                    began.time_s,
                    record.time_s,
                    now - began.moved,
                    {}};
  part.stars = valueAt(record, stars_value_);
  if (kind == kDrink) std::swap(part.steps, steps_);
  PartSums& sums = sums_[kind];
  if (part.moved.isPersons()) {
    ++sums.count;
    ++sums.helps[static_cast<std::size_t>(part.moved.mostHelp())];
    if (std::isfinite(part.value)) sums.values += part.value;
    if (std::isfinite(part.stars)) sums.stars += part.stars;
    for (std::size_t i = 0; i < sums.gained.size(); ++i) {
      const double gained = valueAt(record, result_values_[i]) - began.results[i];
      if (std::isfinite(gained)) sums.gained[i] += gained;
    }
  } else {
    ++(part.moved.isShared() ? sums.shared : sums.others);
  }
  if (parts_.size() < kMostParts) {
    parts_.push_back(std::move(part));
  } else {
    ++left_out_;
  }
  began_[kind] = {};
  after_[kind] = {true, record.time_s, now, {}, path_.place_m(), path_.length_m()};
  for (const int value : result_values_) after_[kind].results.push_back(valueAt(record, value));
}

/// The results of the exercise over the session: what it counts, added over the person's finished
/// parts; its score, their mean. An exercise without parts is one, from the first tick to the last.
Json PartLog::resultsJson() const {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  Json results = Json::array();
  for (std::size_t i = 0; i < meta_.result_names.size(); ++i) {
    if (result_values_[i] < 0) continue;
    const std::string& name = meta_.result_names[i];
    const int kind = ends_[kDrink] >= 0                     ? kDrink
                     : ends_[kBand] >= 0 && name != "score" ? kBand
                                                            : kLevel;
    const PartSums& sums = sums_[kind];
    double value = sums.gained[i];
    if (ends_[kind] < 0) {
      value = all_.isPersons() ? results_[i] : kNone;
    } else if (name == "score") {
      value = sums.count > 0 ? sums.values / static_cast<double>(sums.count) : kNone;
    } else if (name == "bands_done") {
      value = static_cast<double>(sums.count);
    }
    const double shown = value * meta_.result_factors[i];
    results.push_back({{"name", name},
                       {"label", meta_.result_labels[i]},
                       {"unit", meta_.result_units[i]},
                       {"value", shown},
                       {"decimals", std::clamp(meta_.result_decimals[i], 0.0, 6.0)}});
  }
  return results;
}

void PartLog::write(Json& out) const {
  Json parts = Json::array(), sums = Json::object();
  for (const FinishedPart& part : parts_) {
    Json reported = part.moved.json();
    reported.update({{"event", part.event},
                     {"index", part.index},
                     {"value", part.value},
                     {"from_s", part.from_s},
                     {"to_s", part.to_s},
                     {"stars", part.stars},
                     {"steps", part.steps}});
    parts.push_back(std::move(reported));
  }
  for (std::size_t k = 0; k < sums_.size(); ++k) {
    if (ends_[k] < 0) continue;
    const PartSums& s = sums_[k];
    sums[kEnds[k]] = {{"count", s.count}, {"shared", s.shared}, {"others", s.others},
                      {"helps", s.helps}, {"value", s.values},  {"stars", s.stars}};
  }
  out["parts"] = std::move(parts);
  out["parts_left_out"] = left_out_;
  out["sums"] = std::move(sums);
  out["reaches"] = {{"count", reaches_.count},   {"shared", reaches_.shared},
                    {"others", reaches_.others}, {"sum_s", reaches_.sum_s},
                    {"path_m", reaches_.path_m}, {"straight_m", reaches_.straight_m},
                    {"peak_m_s", peak_m_s_}};
  out["results"] = resultsJson();
}

}  // namespace wholehand
