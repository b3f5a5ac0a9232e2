#include "exercises/approach.hpp"
#include "exercises/load_exercise.hpp"
#include "exercises/own_range/measuring.hpp"
#include "exercises/player_reach.hpp"
#include "loop/psychometrics/comparison.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <string>
#include <utility>

/// Assessment of a person's own movement: each direction of the file some times, without any effort
/// of ours (ADR 103).
namespace wholehand::own_range {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

enum Value : std::int32_t {
  kInstruction,
  kDone,
  kPaused,
  kDirection,  ///< index of the direction under way
  kTries,      ///< tries made in it
  kAskedTries,
  kAt,        ///< position of its axis [m or rad]
  kMeasured,  ///< number of directions measured
  kPlace,
  kValues  ///< from here one for each direction: its own end; NaN before it is known
};
constexpr const char* kValueNames[] = {"instruction", "done", "paused",   "direction", "tries",
                                       "asked_tries", "at",   "measured", "place"};
static_assert(std::size(kValueNames) == kValues);
static_assert(kValues + kMostDirections <= kMaxExerciseValues);

enum Event : std::int32_t {
  kHeld,
  kNoMovement,
  kJerk,
  kDrift,
  kDirectionDone,
  kNotSteady,
  kAllMeasured,
  kRestarted
};

struct OwnRangeTask {
  std::string name;
  MeasuringRules rules;
  std::vector<std::string> names;  ///< of the directions: "finger_flexion_upper"
};

/// A virtual patient who moves as asked: to 55 to 90 % of the way from the start to the device's
/// end, drawn by the seed for each direction.
class OwnRangePlayer final : public approach::ReachingPlayer {
 public:
  OwnRangePlayer(const PlayerReach& hand, const std::vector<Direction>& directions,
                 const PlayerTraits& traits)
      : ReachingPlayer(hand), directions_(directions), traits_(traits) {
    start_ = approach::start(hand);
    OwnRangePlayer::reset();
  }

  void reset() override {
    toStart();
    moveTo(-1);
  }

  void advance(double period_s, AxisPosition& q, AxisVelocity& qd) noexcept override {
    if (takesOver()) moveTo(direction_);
    reach_.advance(period_s, q_, qd_);
    q = q_;
    qd = qd_;
  }

  void onRecord(const TickRecord& record) noexcept override {
    steeredByOthers(record);
    if (record.exercise.value_count < kValues) return;  // none during the ramp to neutral
    const int asked = static_cast<int>(record.exercise.values[kInstruction]);
    const bool goes = asked == kHold || asked >= kFirstDirection;
    const int to = goes ? static_cast<int>(record.exercise.values[kDirection]) : -1;
    if (to != direction_ && !lost_) moveTo(to);
  }

 private:
  void moveTo(int direction) noexcept {
    direction_ = direction;
    AxisPosition goal = start_;
    if (direction >= 0) {
      const Direction& to = directions_[direction];
      const double end = to.sign > 0 ? hand_.upper[to.axis] : hand_.lower[to.axis];
      const std::uint64_t drawn = splitMix64(traits_.seed + static_cast<std::uint64_t>(direction));
      const double share = 0.55 + 0.35 * static_cast<double>(drawn >> 11) * 0x1p-53;
      goal[to.axis] += share * (end - start_[to.axis]);
    }
    reachFor(goal, 1.0, false, traits_.opening_rad_s);
  }

  const std::vector<Direction>& directions_;  ///< of the exercise, which outlives its player
  const PlayerTraits traits_;
  int direction_ = -1;  ///< under way; -1: back to the start
};

class OwnRange final : public Exercise {
 public:
  OwnRange(OwnRangeTask task, const DeviceModel& device, const HandModel& hand)
      : task_(std::move(task)), device_(device), hand_(hand), measuring_(task_.rules) {
    description_.name = task_.name;
    description_.value_names.assign(std::begin(kValueNames), std::end(kValueNames));
    for (const std::string& name : task_.names) {
      description_.value_names.push_back("own/" + name);
    }
    description_.event_names = {"held",           "no_movement", "jerk",         "drift",
                                "direction_done", "not_steady",  "all_measured", "restarted"};
    description_.resume_value = kPlace;
    description_.measures_own_movement = true;
    description_.json = R"({"kind":"own_range"})";
    OwnRange::reset();
  }

  void reset() override {
    measuring_.beginAt(0);
    paused_ = false;
  }

  [[nodiscard]] WorldQuery query() const noexcept override { return {}; }

  void tick(const ExerciseInput& input, ExerciseRecord& out,
            BodyPlacements& placements) noexcept override {
    const TickRecord& seen = *input.observed;
    clear(out, placements, device_.axisCount());
    takeOrders(seen, out);
    if (!paused_) {
      const double elapsed_s = std::max(seen.elapsed_periods, 1U) * input.period_s;
      report(measuring_.tick(seen.q_m, elapsed_s), out);
    }
    show(seen, out);
  }

  [[nodiscard]] std::unique_ptr<Player> makePlayer(const PlayerTraits& traits) const override {
    return std::make_unique<OwnRangePlayer>(playerReach(device_, &hand_, 0.0),
                                            task_.rules.directions, traits);
  }

 private:
  void takeOrders(const TickRecord& seen, ExerciseRecord& out) noexcept {
    for (int i = 0; i < seen.command_count; ++i) {
      const Command& c = seen.commands[i];
      if (c.type != CommandType::kAction) continue;
      const auto action = static_cast<Act>(c.index);
      if (action == kBeginAt) {
        const double last = static_cast<double>(task_.rules.directions.size());
        if (c.value >= 0.0 && c.value <= last) measuring_.beginAt(static_cast<int>(c.value));
      } else if (action == Act::kPause || action == Act::kResume) {
        paused_ = action == Act::kPause;
        measuring_.dropTry();
      } else if (action == Act::kRestart || measuring_.done()) {
        measuring_.beginAt(0);
        paused_ = false;
        addEvent(out, kRestarted, -1, 0.0);
      } else if (action == Act::kNext) {
        measuring_.skip();
      }
    }
  }

  void report(const MeasuringChange& news, ExerciseRecord& out) const noexcept {
    if (news.tried >= 0) {
      addEvent(out, kHeld + static_cast<int>(news.result.kind), news.tried, news.result.value);
    }
    if (news.direction_done >= 0) {
      const OwnEnd& end = measuring_.measured(news.direction_done).end;
      addEvent(out, end.steady ? kDirectionDone : kNotSteady, news.direction_done, end.value);
    }
    if (news.done) addEvent(out, kAllMeasured, -1, 0.0);
  }

  void show(const TickRecord& seen, ExerciseRecord& out) const noexcept {
    const int direction = measuring_.direction(), directions = static_cast<int>(task_.names.size());
    out.values[kInstruction] = measuring_.instruction();
    out.values[kDone] = measuring_.done() ? 1.0 : 0.0;
    out.values[kPaused] = paused_ ? 1.0 : 0.0;
    out.values[kDirection] = direction;
    out.values[kTries] = measuring_.tries();
    out.values[kAskedTries] = task_.rules.tries;
    out.values[kAt] = measuring_.done() ? 0.0 : seen.q_m[task_.rules.directions[direction].axis];
    out.values[kPlace] = direction;
    int measured = 0;
    for (int d = 0; d < directions; ++d) {
      const Measured& one = measuring_.measured(d);
      measured += one.asked ? 1 : 0;
      out.values[kValues + d] = one.end.steady ? one.end.value : kUnknown;
    }
    out.values[kMeasured] = measured;
    out.value_count = kValues + directions;
  }

  const OwnRangeTask task_;
  const DeviceModel device_;  ///< device and hand are inputs of makePlayer()
  const HandModel hand_;
  Measuring measuring_;
  bool paused_ = false;
};

}  // namespace

Expected<LoadedExercise> load(TomlFile& file, const ExerciseSource& source) {
  TomlTable& root = file.root();
  OwnRangeTask task;
  task.name = source.name;
  MeasuringRules& rules = task.rules;
  rules.tries = static_cast<int>(root.integer("tries", 2, kMostTries));
  rules.rest_s = root.number("rest_s", between(0.2, 30.0, "s"));
  rules.try_s =
      root.number("try_s", between(2.0, RangeMeter::kSample_s * RangeMeter::kMostSamples, "s"));
  for (TomlTable& table : root.tables("directions", 1)) {
    Direction direction;
    const std::string axis = table.text("axis"),
                      toward = table.choice("toward", {"lower", "upper"});
    direction.axis = source.device->axisIndex(axis);
    direction.sign = toward == "lower" ? -1 : 1;
    if (direction.axis >= 0) {
      direction.rules =
          rangeRulesOf(source.device->axes[direction.axis].kind == AxisKind::kTranslation);
    }
    const std::string name = axis + "_" + toward;
    if (table.isGood("toward") &&
        std::find(task.names.begin(), task.names.end(), name) != task.names.end()) {
      table.fail("toward", "this direction stands twice", "write each direction once");
    }
    task.names.push_back(name);
    rules.directions.push_back(direction);
  }
  if (rules.directions.size() > kMostDirections) {
    root.fail("directions", fmt::format("are {}", rules.directions.size()),
              fmt::format("write at most {}", kMostDirections));
  }
  if (source.level != 1) root.fail("exercise", "has one level", "ask for level 1");
  Diagnostics faults = file.finish();
  if (!faults.empty() || source.scene == nullptr) return faults;
  LoadedExercise out;
  out.exercise = std::make_unique<OwnRange>(std::move(task), *source.device, *source.hand);
  return out;
}

}  // namespace wholehand::own_range
