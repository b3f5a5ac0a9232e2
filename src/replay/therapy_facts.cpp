#include "replay/therapy_facts.hpp"

#include "replay/compared_answers.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <iterator>
#include <limits>
#include <numeric>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace wholehand {

void MovedTime::add(Mover mover, Help help, std::uint32_t elapsed_periods) {
  const std::uint64_t periods = std::max<std::uint32_t>(elapsed_periods, 1);
  by[static_cast<std::size_t>(mover)] += periods;
  if (mover == Mover::kPerson) helped[static_cast<std::size_t>(help)] += periods;
}

std::uint64_t MovedTime::sum() const {
  return std::accumulate(by.begin(), by.end(), std::uint64_t{0});
}

double MovedTime::share() const {
  const std::uint64_t all = sum();
  return all > 0 ? static_cast<double>(persons()) / static_cast<double>(all) : 0.0;
}

Mover MovedTime::mostly() const {
  return static_cast<Mover>(std::max_element(by.begin(), by.end()) - by.begin());
}

Help MovedTime::mostHelp() const {
  for (const Help help : {Help::kFull, Help::kSome, Help::kNone}) {
    if (helped[static_cast<std::size_t>(help)] > 0) return help;
  }
  return Help::kUnspecified;
}

nlohmann::json MovedTime::json() const {
  const Mover named = isPersons() ? Mover::kPerson : mostly();
  return {{"by", static_cast<int>(named)},
          {"share", share()},
          {"help", static_cast<int>(mostHelp())},
          {"persons", isPersons()}};
}

MovedTime operator-(const MovedTime& end, const MovedTime& begin) {
  MovedTime out;
  for (std::size_t i = 0; i < out.by.size(); ++i) out.by[i] = end.by[i] - begin.by[i];
  for (std::size_t i = 0; i < out.helped.size(); ++i) {
    out.helped[i] = end.helped[i] - begin.helped[i];
  }
  return out;
}

namespace {

using Json = nlohmann::json;
using Names = std::initializer_list<std::string_view>;

/// Limit of parts in a page's list; the sums include all parts.
constexpr std::size_t kMostParts = 400;
constexpr std::array kEnds = {"drink_done", "band_held", "level_done"};
constexpr Names kBegins = {"engaged", "pour_began", "band_entered"};
/// Events after which the hand is free to reach (kFrees), and events at which it has reached
/// (kReached).
constexpr Names kFrees = {"disengaged", "step_done", "band_held", "restarted", "drink_done"};
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

constexpr double kShortestReach_s = 0.1, kRounding_s = 1e-6;
constexpr double kStep_m = 1e-3;  ///< shorter steps are sensor resolution or tremor

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

ExerciseParts::ExerciseParts(const RecordingMeta& meta)
    : meta_(meta),
      begins_(marked(meta.event_names, kBegins)),
      frees_(marked(meta.event_names, kFrees)),
      reached_(marked(meta.event_names, kReached)),
      restarts_(marked(meta.event_names, kRestarts)),
      step_done_(indexOf(meta.event_names, "step_done")),
      engaged_(indexOf(meta.event_names, "engaged")),
      stars_value_(indexOf(meta.value_names, "stars")),
      path_(meta.axis_names) {
  for (std::size_t k = 0; k < kEnds.size(); ++k) ends_[k] = indexOf(meta.event_names, kEnds[k]);
  for (const std::string& name : meta.result_names) {
    result_values_.push_back(indexOf(meta.value_names, name));
  }
  results_.assign(result_values_.size(), 0.0);
  for (PartSums& sums : sums_) sums.gained.assign(results_.size(), 0.0);
}

void ExerciseParts::add(const TickRecord& record, const MovedTime& before, const MovedTime& now,
                        bool interrupted) {
  path_.add(record);
  free_.peak_m_s = std::max(free_.peak_m_s, path_.speed_m_s());
  if (now.sum() == (now - before).sum()) {  // true at the first tick
    keepResults(record);
    free_ = {true, record.time_s, before, results_, path_.place_m(), path_.length_m()};
    after_.fill(free_);
  }
  if (interrupted) free_.known = false;
  if (record.exercise.event_count > 0) {
    Begin here{true, record.time_s, before, results_, path_.place_m(), path_.length_m()};
    for (int e = 0; e < record.exercise.event_count; ++e) {
      addEvent(record.exercise.events[e], record, here, now, interrupted);
    }
  }
  keepResults(record);
  all_ = now;
}

void ExerciseParts::keepResults(const TickRecord& record) {
  for (std::size_t i = 0; i < results_.size(); ++i)
    results_[i] = valueAt(record, result_values_[i]);
}

void ExerciseParts::addEvent(const ExerciseEvent& event, const TickRecord& record, Begin& here,
                             const MovedTime& now, bool interrupted) {
  if (event.type < 0 || std::cmp_greater_equal(event.type, begins_.size())) return;
  const auto type = static_cast<std::size_t>(event.type);
  if (reached_[type]) reach(record.time_s, now, event.type == engaged_);
  if (restarts_[type]) {
    // Parts under way are discarded, and the exercise's counts begin at 0.
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
  if (frees_[type] && !interrupted) free_ = here;
}

void ExerciseParts::reach(double time_s, const MovedTime& now, bool takes_hold) {
  if (!std::exchange(free_.known, false)) return;
  if (time_s - free_.time_s < kShortestReach_s - kRounding_s) return;
  if (takes_hold && path_.length_m() == free_.path_m) return;
  const MovedTime moved = now - free_.moved;
  if (moved.isPersons()) {
    ++reaches_.count;
    reaches_.sum_s += time_s - free_.time_s;
    reaches_.path_m += path_.length_m() - free_.path_m;
    reaches_.straight_m += (path_.place_m() - free_.place_m).norm();
    reaches_.peak_m_s = std::max(reaches_.peak_m_s, free_.peak_m_s);
  } else {
    ++(moved.isShared() ? reaches_.shared : reaches_.others);
  }
}

void ExerciseParts::finish(Kind kind, const ExerciseEvent& event, const TickRecord& record,
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

/// Results of the exercise over the session. Counts are summed over the person's finished parts;
/// the score is their mean. An exercise without parts counts as one part, from the first tick to
/// the last.
Json ExerciseParts::resultsJson() const {
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

void ExerciseParts::write(Json& out) const {
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
  out["reaches"] = {{"count", reaches_.count},
                    {"shared", reaches_.shared},
                    {"others", reaches_.others},
                    {"sum_s", reaches_.sum_s},
                    {"path_m", reaches_.path_m},
                    {"straight_m", reaches_.straight_m},
                    {"peak_m_s", reaches_.count > 0 ? Json(reaches_.peak_m_s) : Json()}};
  out["results"] = resultsJson();
}

namespace {

using Json = nlohmann::json;

/// Shortest grip, and the time in which its force rises or falls [s].
constexpr double kShortest_s = 1.0, kRise_s = 0.25;
/// Longest gap that is bridged within one touch, and the largest step of a body that counts as
/// solver jitter.
constexpr double kBridge_s = 0.2, kJitter_m = 1e-3;

constexpr double kEmptyBelow_m = -8.0;  ///< below it are empty slots of a game; a body is within 5
                                        ///< m of the origin
/// Shortest interval between recorded changes; a limit ramps over many ticks.
constexpr double kBetweenChanges_s = 0.1;
/// Limit of changes per axis in a page. If there are more, close changes are merged; the last one
/// always stays.
constexpr std::size_t kMostLimitChanges = 2'000;
/// Limit of touches and runs that a page draws; the sums include all.
constexpr std::size_t kMostTouches = 1'000, kMostRuns = 1'000;

enum GripSide : int { kFingers, kThumb, kPalm, kGripSides };

int gripSideOf(const std::string& capsule) {
  if (capsule.starts_with("thumb")) return kThumb;
  for (const char* finger : {"index", "middle", "ring", "little"}) {
    if (capsule.starts_with(finger)) return kFingers;
  }
  return kPalm;
}

/// Sum over one tick's contacts with one body.
struct Grasp {
  bool touching = false;
  double force_n = 0.0;
  std::array<bool, kGripSides> sides{};
  [[nodiscard]] bool held() const { return sides[kFingers] && (sides[kThumb] || sides[kPalm]); }
};

}  // namespace

void GripLog::add(double time_s, double force_n, const MovedTime& before, const MovedTime& now) {
  if (!(force_n >= kLeastGrip_n)) return end();
  if (!gripping_) {
    gripping_ = true;
    grip_ = Grip{};
    grip_.from_s = time_s;
    begin_ = before;
    count_ = mean_n_ = squares_n2_ = 0.0;
  }
  grip_.to_s = time_s;
  grip_.moved = now - begin_;
  grip_.largest_n = std::max(grip_.largest_n, force_n);
  if (time_s - grip_.from_s >= kRise_s) waiting_.push_back({time_s, force_n});
  while (!waiting_.empty() && time_s - waiting_.front().time_s >= kRise_s) {
    count(waiting_.front().force_n);
    waiting_.pop_front();
  }
}

void GripLog::count(double force_n) {
  count_ += 1.0;
  const double off_n = force_n - mean_n_;
  mean_n_ += off_n / count_;
  squares_n2_ += off_n * (force_n - mean_n_);
}

void GripLog::end() {
  if (!gripping_) return;
  gripping_ = false;
  waiting_.clear();
  if (grip_.to_s - grip_.from_s < kShortest_s) return;
  grip_.mean_n = mean_n_;
  grip_.deviation_n = count_ > 0.0 ? std::sqrt(squares_n2_ / count_) : 0.0;
  grips_.push_back(grip_);
}

std::vector<Touch> BodyTimeline::persons() const {
  std::vector<Touch> out;
  std::copy_if(touches.begin(), touches.end(), std::back_inserter(out),
               [](const Touch& touch) { return touch.moved.isPersons(); });
  return out;
}

void BodyContacts::contact(const BodyContact& contact, const MovedTime& before,
                           const MovedTime& now) {
  std::vector<Touch>& touches = timeline_.touches;
  if (touches.empty() || contact.time_s - touches.back().to_s > kBridge_s) {
    touches.push_back({body_, contact.time_s, contact.time_s, 0.0, 0.0, {}});
    begin_ = before;
  }
  Touch& touch = touches.back();
  touch.to_s = contact.time_s + contact.duration_s;
  touch.largest_force_n = std::max(touch.largest_force_n, contact.force_n);
  if (contact.held) touch.held_s += contact.duration_s;
  touch.moved = now - begin_;
}

void BodyContacts::position(const Eigen::Vector3d& position_m, double time_s, bool person) {
  if (!position_m.allFinite()) return;
  if (!here_) anchor_m_ = position_m;
  seen_ = here_ = true;
  const double step_m = (position_m - anchor_m_).norm();
  if (step_m < kJitter_m) return;
  // A body that nobody touches is moved by the exercise, or keeps moving by itself; that path is
  // not counted.
  const std::vector<Touch>& touches = timeline_.touches;
  const bool touched = !touches.empty() && time_s - touches.back().to_s <= kBridge_s;
  if (person && touched) timeline_.travelled_m += step_m;
  anchor_m_ = position_m;
}

TherapyFacts::TherapyFacts(const RecordingMeta& meta)
    : meta_(meta),
      active_(meta.axis_units, meta.value_names),
      parts_(meta),
      answers_(meta.value_names, meta.event_names),
      limits_(meta.axis_names.size()) {
  for (std::size_t b = 0; b < meta.body_names.size(); ++b) {
    bodies_.emplace_back(static_cast<int>(b), meta.body_names[b]);
  }
  for (const std::string& name : meta.capsule_names) grip_sides_.push_back(gripSideOf(name));
  const auto found = std::find(meta.value_names.begin(), meta.value_names.end(), kGripForceValue);
  if (found != meta.value_names.end()) {
    squeeze_value_ = static_cast<int>(found - meta.value_names.begin());
  }
  for (Limits& limits : limits_) limits.between_s = kBetweenChanges_s;
}

bool TherapyFacts::ofGame(std::size_t body) const {
  return body + static_cast<std::size_t>(meta_.game_slots) >= bodies_.size();
}

void TherapyFacts::add(const TickRecord& record, bool follows, std::uint64_t row) {
  const bool has_grip = squeeze_value_ >= 0 && squeeze_value_ < record.exercise.value_count;
  const double grip_n = has_grip ? record.exercise.values[squeeze_value_] : 0.0;
  addMover(record);
  active_.add(record);
  answers_.add(record);
  parts_.add(record, before_, now_, active_.interrupted(record));
  // An exercise's wall may keep the fingers off the body; the grip force then counts as contact.
  addContacts(record, grip_n >= kLeastGrip_n, row);
  addLimits(record);
  if (!follows) grips_.end();
  if (has_grip) grips_.add(record.time_s, grip_n, before_, now_);
}

void TherapyFacts::addMover(const TickRecord& record) {
  const Mover by = record.moved_by;
  before_ = now_;
  now_.add(by, record.help, record.elapsed_periods);
  const double end_s = record.time_s + meta_.period_s;
  if (!runs_.empty() && runs_.back().by == by) {
    runs_.back().to_s = end_s;
  } else if (runs_.size() < kMostRuns) {
    runs_.push_back({record.time_s, end_s, by});
  } else {
    ++runs_left_out_;
  }
}

void TherapyFacts::addContacts(const TickRecord& record, bool grips, std::uint64_t row) {
  std::vector<Grasp> grasps(std::min<std::size_t>(bodies_.size(), kMaxBodies));
  double sum_n = 0.0;
  for (int c = 0; c < record.contact_count; ++c) {
    const Contact& contact = record.contacts[c];
    const double force_n = contact.force_n.eigen().norm();
    sum_n += force_n;
    if (contact.body < 0 || std::cmp_greater_equal(contact.body, grasps.size())) continue;
    Grasp& grasp = grasps[contact.body];
    grasp.touching = true;
    grasp.force_n += force_n;
    const std::size_t capsule = std::max(contact.capsule, 0);
    const int side = capsule < grip_sides_.size() ? grip_sides_[capsule] : kPalm;
    grasp.sides[side] = true;
  }
  const bool person = now_.persons() > before_.persons();
  StrongestContact& strongest = person ? strongest_ : strongest_of_others_;
  if (sum_n > strongest.force_n) {
    strongest = {sum_n, record.time_s, row, record.moved_by};
  }
  const double duration_s = meta_.period_s * std::max<std::uint32_t>(record.elapsed_periods, 1);
  for (std::size_t b = 0; b < grasps.size(); ++b) {
    const Grasp& g = grasps[b];
    if (g.touching) {
      bodies_[b].contact({record.time_s, duration_s, g.force_n, g.held() || grips}, before_, now_);
    }
    const bool in_record = static_cast<int>(b) < record.body_count;
    if (ofGame(b) && (!in_record || record.bodies[b].position_m.z < kEmptyBelow_m)) {
      bodies_[b].leave();
    } else if (in_record) {
      bodies_[b].position(record.bodies[b].position_m.eigen(), record.time_s, person);
    }
  }
}

void TherapyFacts::addLimits(const TickRecord& record) {
  for (std::size_t a = 0; a < limits_.size(); ++a) {
    const int axis = static_cast<int>(a);
    if (axis >= record.effort_limit.size()) return;
    limits_[a].add(record.time_s, record.effort_limit[axis]);
  }
}

void TherapyFacts::Limits::add(double time_s, double value) {
  if (!changes.empty() && changes.back().value == value) return;
  const bool is_ramp =
      changes.size() > 1 && time_s - changes[changes.size() - 2].time_s < between_s;
  if (is_ramp) {
    changes.back() = {time_s, value};
    return;
  }
  changes.push_back({time_s, value});
  while (changes.size() > kMostLimitChanges) {
    between_s *= 2.0;
    std::vector<Change> kept;
    for (const Change& change : changes) {
      const bool close =
          kept.size() > 1 && change.time_s - kept[kept.size() - 2].time_s < between_s;
      if (close) {
        kept.back() = change;
      } else {
        kept.push_back(change);
      }
    }
    changes = std::move(kept);
  }
}

Json TherapyFacts::movedJson() const {
  Json by = Json::array(), helped = Json::array(), runs = Json::array();
  for (const std::uint64_t periods : now_.by) by.push_back(periods);
  for (const std::uint64_t periods : now_.helped) helped.push_back(periods);
  for (const Run& run : runs_) runs.push_back({run.from_s, run.to_s, static_cast<int>(run.by)});
  const ActivePeriods& active = active_.periods();
  return {{"by", by},
          {"helped", helped},
          {"active_periods", active.active},
          {"helped_periods", active.helped},
          {"led_periods", active.led},
          {"share", now_.share()},
          {"runs", runs},
          {"runs_left_out", runs_left_out_}};
}

Json TherapyFacts::bodiesJson() const {
  Json bodies = Json::array();
  for (const BodyContacts& log : bodies_) {
    const BodyTimeline& body = log.timeline();
    const std::vector<Touch> touches = body.persons();
    if (touches.empty()) continue;
    double longest_s = 0.0, held_s = 0.0, force_n = 0.0;
    for (const Touch& touch : touches) {
      longest_s = std::max(longest_s, touch.to_s - touch.from_s);
      held_s += touch.held_s;
      force_n = std::max(force_n, touch.largest_force_n);
    }
    bodies.push_back({{"name", body.name},
                      {"touches", touches.size()},
                      {"first_s", touches.front().from_s},
                      {"longest_s", longest_s},
                      {"held_s", held_s},
                      {"largest_force_n", force_n},
                      {"travelled_m", body.travelled_m}});
  }
  return bodies;
}

/// Writes the touches, whoever moved the hand: the page shades them in its plots.
void TherapyFacts::writeTouches(Json& out) const {
  Json touches = Json::array();
  std::size_t all = 0, not_persons = 0;
  for (const BodyContacts& log : bodies_) {
    for (const Touch& touch : log.timeline().touches) {
      ++all;
      if (!touch.moved.isPersons()) ++not_persons;
      if (touches.size() >= kMostTouches) continue;
      touches.push_back({{"body", log.timeline().name},
                         {"from_s", touch.from_s},
                         {"to_s", touch.to_s},
                         {"held_s", touch.held_s},
                         {"largest_force_n", touch.largest_force_n}});
    }
  }
  out["touches_left_out"] = all - touches.size();
  out["touches_not_persons"] = not_persons;
  out["touches"] = std::move(touches);
}

void TherapyFacts::writeLimits(Json& out) const {
  Json limits = Json::array();
  double between_s = kBetweenChanges_s;
  for (const Limits& axis : limits_) {
    Json changes = Json::array();
    for (const Change& change : axis.changes) changes.push_back({change.time_s, change.value});
    limits.push_back(std::move(changes));
    between_s = std::max(between_s, axis.between_s);
  }
  out["limits"] = std::move(limits);
  out["limits_between_s"] = between_s;
}

/// Mean and coefficient of variation of the person's grips, weighted by their duration.
Json TherapyFacts::gripsJson() const {
  double sum_s = 0.0, mean = 0.0, variation = 0.0;
  std::size_t count = 0, shared = 0, others = 0;
  for (const Grip& grip : grips_.grips()) {
    if (!(grip.mean_n > 0.0)) continue;
    if (!grip.moved.isPersons()) {
      ++(grip.moved.isShared() ? shared : others);
      continue;
    }
    const double lasted_s = grip.to_s - grip.from_s;
    ++count;
    sum_s += lasted_s;
    mean += grip.mean_n * lasted_s;
    variation += grip.deviation_n / grip.mean_n * lasted_s;
  }
  return {{"count", count},
          {"shared", shared},
          {"others", others},
          {"mean_n", count > 0 ? mean / sum_s : 0.0},
          {"variation", count > 0 ? variation / sum_s : 0.0}};
}

Json TherapyFacts::json() {
  grips_.end();
  std::size_t there = 0;  // slots of a game count only if they ever held a body
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    if (!ofGame(b) || bodies_[b].wasThere()) ++there;
  }
  Json out = {{"moved", movedJson()},
              {"bodies", bodiesJson()},
              {"bodies_in_scene", there},
              {"grips", gripsJson()},
              {"has_grip_force", squeeze_value_ >= 0},
              {"largest_force_n", strongest_.force_n},
              {"strongest",
               {{"force_n", strongest().force_n},
                {"time_s", strongest().time_s},
                {"row", strongest().row},
                {"by", static_cast<int>(strongest().by)}}}};
  out["compared"] = comparedJson(answers_);
  parts_.write(out);
  writeTouches(out);
  writeLimits(out);
  return out;
}

}  // namespace wholehand
