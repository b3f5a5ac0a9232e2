#include "replay/therapy_facts.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace wholehand {
namespace {

using Json = nlohmann::json;

constexpr double kEmptyBelow_m = -8.0;  ///< where empty slots of a game are; a body is within 5 m
/// Exercise value that is the grip force [N].
constexpr const char* kSqueeze = "squeeze_n";
/// Interval of recorded changes: a limit ramps over many ticks.
constexpr double kBetweenChanges_s = 0.1;
constexpr std::size_t kMostChanges = 2'000, kMostTouches = 1'000;

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

TherapyFacts::TherapyFacts(const RecordingMeta& meta)
    : meta_(meta), limits_(meta.axis_names.size()) {
  for (std::size_t b = 0; b < meta.body_names.size(); ++b) {
    bodies_.emplace_back(static_cast<int>(b), meta.body_names[b]);
  }
  for (const std::string& name : meta.capsule_names) grip_sides_.push_back(gripSideOf(name));
  const auto found = std::find(meta.value_names.begin(), meta.value_names.end(), kSqueeze);
  if (found != meta.value_names.end()) {
    squeeze_value_ = static_cast<int>(found - meta.value_names.begin());
  }
}

bool TherapyFacts::ofGame(std::size_t body) const {
  return body + static_cast<std::size_t>(meta_.game_slots) >= bodies_.size();
}

void TherapyFacts::add(const TickRecord& record, bool follows) {
  const bool has_grip = squeeze_value_ >= 0 && squeeze_value_ < record.exercise.value_count;
  const double grip_n = has_grip ? record.exercise.values[squeeze_value_] : 0.0;
  // An exercise's wall may hold the fingers off the body: then its grip force counts as contact.
  addContacts(record, grip_n >= kLeastGrip_n);
  addLimits(record);
  if (!follows) grips_.end();
  if (has_grip) grips_.add(record.time_s, grip_n);
}

void TherapyFacts::addContacts(const TickRecord& record, bool grips) {
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
  if (sum_n > largest_force_n_) {
    largest_force_n_ = sum_n;
    largest_force_s_ = record.time_s;
  }
  const double duration_s = meta_.period_s * std::max<std::uint32_t>(record.elapsed_periods, 1);
  for (std::size_t b = 0; b < grasps.size(); ++b) {
    const Grasp& g = grasps[b];
    bodies_[b].contact(record.time_s, duration_s, g.touching, g.force_n, g.held() || grips);
    const bool in_record = static_cast<int>(b) < record.body_count;
    if (ofGame(b) && (!in_record || record.bodies[b].position_m.z < kEmptyBelow_m)) {
      bodies_[b].leave();
    } else if (in_record) {
      bodies_[b].position(record.bodies[b].position_m.eigen());
    }
  }
}

void TherapyFacts::addLimits(const TickRecord& record) {
  for (std::size_t a = 0; a < limits_.size(); ++a) {
    const int axis = static_cast<int>(a);
    if (axis >= record.effort_limit.size()) return;
    std::vector<Change>& changes = limits_[a];
    const double value = record.effort_limit[axis];
    if (!changes.empty() && changes.back().value == value) continue;
    const bool is_ramp = changes.size() > 1 &&
                         record.time_s - changes[changes.size() - 2].time_s < kBetweenChanges_s;
    if (is_ramp) {
      changes.back() = {record.time_s, value};
    } else if (changes.size() < kMostChanges) {
      changes.push_back({record.time_s, value});
    }
  }
}

Json TherapyFacts::bodiesJson() const {
  Json bodies = Json::array();
  for (const TouchLog& log : bodies_) {
    const BodyStory& body = log.story();
    if (body.touches.empty()) continue;
    bodies.push_back({{"name", body.name},
                      {"touches", body.touches.size()},
                      {"first_s", body.touches.front().from_s},
                      {"longest_s", body.longest_s()},
                      {"held_s", body.held_s()},
                      {"largest_force_n", body.largestForce_n()},
                      {"travelled_m", body.travelled_m}});
  }
  return bodies;
}

Json TherapyFacts::touchesJson() const {
  Json touches = Json::array();
  for (const TouchLog& log : bodies_) {
    for (const Touch& touch : log.story().touches) {
      if (touches.size() >= kMostTouches) return touches;
      touches.push_back({{"body", log.story().name},
                         {"from_s", touch.from_s},
                         {"to_s", touch.to_s},
                         {"held_s", touch.held_s},
                         {"largest_force_n", touch.largest_force_n}});
    }
  }
  return touches;
}

Json TherapyFacts::limitsJson() const {
  Json limits = Json::array();
  for (const std::vector<Change>& changes : limits_) {
    Json axis = Json::array();
    for (const Change& change : changes) axis.push_back({change.time_s, change.value});
    limits.push_back(std::move(axis));
  }
  return limits;
}

Json TherapyFacts::json() {
  grips_.end();
  Json grips = Json::array();
  for (const Grip& grip : grips_.grips()) {
    grips.push_back({{"from_s", grip.from_s},
                     {"to_s", grip.to_s},
                     {"mean_n", grip.mean_n},
                     {"deviation_n", grip.deviation_n},
                     {"largest_n", grip.largest_n}});
  }
  std::size_t there = 0;  // a slot of a game counts if it ever held a body
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    if (!ofGame(b) || bodies_[b].wasThere()) ++there;
  }
  return {{"bodies", bodiesJson()},
          {"bodies_in_scene", there},
          {"touches", touchesJson()},
          {"grips", grips},
          {"has_grip_force", squeeze_value_ >= 0},
          {"limits", limitsJson()},
          {"largest_force_n", largest_force_n_},
          {"largest_force_s", largest_force_s_}};
}

}  // namespace wholehand
