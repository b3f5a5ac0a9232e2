#include "replay/therapy_facts.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

namespace wholehand {

namespace {

using Json = nlohmann::json;

/// Shortest grip, and the time in which its force rises and falls.
constexpr double kShortest_s = 1.0, kRise_s = 0.25;
/// Longest gap within one touch, and the length of a body's step that is solver jitter.
constexpr double kBridge_s = 0.2, kJitter_m = 1e-3;

constexpr double kEmptyBelow_m = -8.0;  ///< where empty slots of a game are; a body is within 5 m
/// Exercise value that is the grip force [N].
constexpr const char* kSqueeze = "squeeze_n";
/// Interval of recorded changes: a limit ramps over many ticks.
constexpr double kBetweenChanges_s = 0.1;
/// A page holds so many of an axis; of more, closer ones are left out, never the last.
constexpr std::size_t kMostLimitChanges = 2'000;
/// A page draws so many; its sums are over all.
constexpr std::size_t kMostTouches = 1'000, kMostRuns = 1'000;

enum GripSide : int { kFingers, kThumb, kPalm, kGripSides };

int gripSideOf(const std::string& capsule) {
  if (capsule.starts_with("thumb")) return kThumb;
  for (const char* finger : {"index", "middle", "ring", "little"}) {
    if (capsule.starts_with(finger)) return kFingers;
  }
  return kPalm;
}

/// Sum of one tick's contacts with one body.
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

std::vector<Touch> BodyStory::persons() const {
  std::vector<Touch> out;
  std::copy_if(touches.begin(), touches.end(), std::back_inserter(out),
               [](const Touch& touch) { return touch.moved.isPersons(); });
  return out;
}

void TouchLog::contact(const BodyContact& contact, const MovedTime& before, const MovedTime& now) {
  std::vector<Touch>& touches = story_.touches;
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

void TouchLog::position(const Eigen::Vector3d& position_m, bool person) {
  if (!position_m.allFinite()) return;
  if (!here_) anchor_m_ = position_m;
  seen_ = here_ = true;
  const double step_m = (position_m - anchor_m_).norm();
  if (step_m < kJitter_m) return;
  if (person) story_.travelled_m += step_m;
  anchor_m_ = position_m;
}

TherapyFacts::TherapyFacts(const RecordingMeta& meta)
    : meta_(meta), parts_(meta), limits_(meta.axis_names.size()) {
  for (std::size_t b = 0; b < meta.body_names.size(); ++b) {
    bodies_.emplace_back(static_cast<int>(b), meta.body_names[b]);
  }
  for (const std::string& name : meta.capsule_names) grip_sides_.push_back(gripSideOf(name));
  const auto found = std::find(meta.value_names.begin(), meta.value_names.end(), kSqueeze);
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
  parts_.add(record, before_, now_);
  // An exercise's wall may hold the fingers off the body: then its grip force counts as contact.
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
      bodies_[b].position(record.bodies[b].position_m.eigen(), person);
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
  return {{"by", by},
          {"helped", helped},
          {"share", now_.share()},
          {"runs", runs},
          {"runs_left_out", runs_left_out_}};
}

Json TherapyFacts::bodiesJson() const {
  Json bodies = Json::array();
  for (const TouchLog& log : bodies_) {
    const BodyStory& body = log.story();
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

/// Whosever they are: the page shades them beneath what was recorded.
void TherapyFacts::writeTouches(Json& out) const {
  Json touches = Json::array();
  std::size_t all = 0, not_persons = 0;
  for (const TouchLog& log : bodies_) {
    for (const Touch& touch : log.story().touches) {
      ++all;
      if (!touch.moved.isPersons()) ++not_persons;
      if (touches.size() >= kMostTouches) continue;
      touches.push_back({{"body", log.story().name},
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

/// Mean and coefficient of variation of the person's grips, each as it lasted.
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
  std::size_t there = 0;  // a slot of a game counts if it ever held a body
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
  parts_.write(out);
  writeTouches(out);
  writeLimits(out);
  return out;
}

}  // namespace wholehand
