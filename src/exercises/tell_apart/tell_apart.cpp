#include "exercises/bottle_file.hpp"
#include "exercises/finger_wall_file.hpp"
#include "exercises/load_exercise.hpp"
#include "exercises/player_reach.hpp"
#include "exercises/tell_apart/tell_apart_player.hpp"
#include "exercises/tell_apart/tell_apart_task.hpp"
#include "loop/exercise/grip.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

/// Exercise in which the person squeezes two bottles one after the other and says which one was
/// more: firmer, thicker, farther, heavier, later (ADR 96).
namespace wholehand::tell_apart {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();

enum Event : std::int32_t { kAnswered, kAgain, kTooEarly, kLevelDone, kRestarted, kRight, kWrong };

/// The closure of the fingers on a bottle is queried when the palm is nearer than release_m plus
/// this.
constexpr double kApproach_m = 0.05;
/// A palmar capsule this deep in the other bottle squeezes it.
constexpr double kBoth_m = 0.002;
/// The mark is reached from 1 on and passed from here on [share of the asked depth].
constexpr double kMarkEnds = 1.3;
/// Spread of the asked depths: ln of their ratio is this times the comparison's other difference.
constexpr double kDepthSpread = 0.2;
/// Range of the asked depth over the mean one.
constexpr double kShallowest = 0.65, kDeepest = 1.5;
/// The start varies by this share of the asked depth.
constexpr double kStartSpread = 0.3;
/// Depth below which a squeeze has ended [share of the asked depth].
constexpr double kLetGo = 0.2;
/// A bottle whose start is the compared quantity is felt only while it starts where it should.
constexpr double kStartsWrong_m = 0.0003;

/// The answer of an order (choiceValue()).
GivenAnswer readAnswer(double value) noexcept {
  const bool by_therapist = value > kChoices;
  const double bottle = value - (by_therapist ? kChoices : 0) - 1.0;
  if (bottle != 0.0 && bottle != 1.0) return {};
  return {static_cast<int>(bottle), by_therapist ? SaidBy::kTherapist : SaidBy::kPlayer};
}

class TellApart final : public Exercise {
 public:
  TellApart(TellApartTask task, const DeviceModel& device, const HandModel& hand)
      : task_(std::move(task)),
        device_(device),
        hand_(hand),
        grip_m_(playerReach(device, &hand, task_.bottles[0].radius_m).grip_m),
        compares_start_(task_.with(1.0).start_m != task_.least.start_m),
        posture_(hand_),
        cushions_(cushionsOf(task_.bottle, task_.wall.walls)),
        comparing_(task_.rules) {
    const LevelScale& scale = task_.rules.scale;
    description_.name = task_.name;
    description_.fade_out_s = task_.wall.transition.release_s;
    description_.value_names.assign(std::begin(kValueNames), std::end(kValueNames));
    description_.event_names = {"answered",  "again", "too_early", "level_done",
                                "restarted", "right", "wrong"};
    description_.resume_value = kPlace;
    description_.json = fmt::format(
        R"({{"kind":"tell_apart","quantity":"{}","least_x":{:.6g},"most_x":{:.6g}}})",
        task_.law.name, scale.at(task_.rules.least_level), scale.at(task_.rules.most_level));
    TellApart::reset();
  }

  void reset() override {
    comparing_.begin(0);
    transition_ = TransitionState{};
    walls_ = FingerWallState{};
    travel_ = offset_ = AxisPosition{};
    felt_ = feltOf(0);
    at_ = near_ = -1;
    depth_m_ = depth_before_m_ = -1.0;
    squeeze_n_ = pressing_s_ = 0.0;
    retold_ = to_retell_ = 0;
    said_ = GivenAnswer{};
    paused_ = begun_ = fresh_ = swapped_ = false;
    said_second_ = 0.0;
    forgetGoal();
  }

  [[nodiscard]] WorldQuery query() const noexcept override {
    return {1U << static_cast<unsigned>(task_.bottles[0].body) |
                1U << static_cast<unsigned>(task_.bottles[1].body),
            near_ < 0 ? -1 : task_.bottles[near_].body};
  }

  void tick(const ExerciseInput& input, ExerciseRecord& out,
            BodyPlacements& placements) noexcept override {
    const TickRecord& seen = *input.observed;
    const double elapsed_s = std::max(seen.elapsed_periods, 1U) * input.period_s;
    out = ExerciseRecord{};
    placements.count = 0;
    posture_.update(input.hand);
    takeActions(seen, out);
    engage(input);
    push(seen, elapsed_s, out);
    feel(elapsed_s, out);
    const Comparison asked = comparing_.now();
    if (!paused_) compare(seen, elapsed_s, out);
    sayGoal(seen);
    show(asked, out);
  }

  [[nodiscard]] std::unique_ptr<Player> makePlayer(const PlayerTraits& traits) const override {
    return std::make_unique<TellApartPlayer>(
        playerReach(device_, &hand_, task_.bottles[0].radius_m),
        std::array{task_.bottles[0].body, task_.bottles[1].body}, task_.bottles[0].center_m,
        traits);
  }

 private:
  /// What a bottle is in the comparison under way.
  struct Felt {
    double amount = 0.0;  ///< ln of the quantity over the least
    Stimulus stimulus;
    double depth_m = 0.0;  ///< asked depth from the start on
  };

  [[nodiscard]] Felt feltOf(int bottle) const noexcept {
    Felt out;
    out.amount = comparing_.amount(bottle);
    out.stimulus = task_.with(out.amount);
    const double half = 0.5 * kDepthSpread * task_.law.deeper_means * comparing_.now().other;
    out.depth_m =
        task_.depth_m * std::clamp(std::exp(bottle == 1 ? half : -half), kShallowest, kDeepest);
    if (!compares_start_) {
      out.stimulus.start_m += kStartSpread * task_.depth_m * comparing_.varied(2 + bottle);
    }
    return out;
  }

  void takeActions(const TickRecord& seen, ExerciseRecord& out) noexcept {
    for (int i = 0; i < seen.command_count; ++i) {
      const Command& c = seen.commands[i];
      if (c.type != CommandType::kAction) continue;
      const auto action = static_cast<Act>(c.index);
      if (action == Act::kNext && c.value > 0.0 && !comparing_.done()) {
        said_ = readAnswer(c.value);
        continue;
      }
      if (action == kBeginAt) {
        comparing_.beginAt(c.value);
        begun_ = true;
        retold_ = 0;
        to_retell_ = comparing_.answers();
      } else if (action == Act::kPause || action == Act::kResume) {
        paused_ = action == Act::kPause;
      } else if (action == Act::kRestart || comparing_.done()) {
        comparing_.begin(seen.tick);
        paused_ = false;
        addEvent(out, kRestarted, -1, 0.0);
      }
    }
  }

  /// Fades the walls of one bottle at a time in and out with the distance of the palm, Eq. (16).
  void engage(const ExerciseInput& input) noexcept {
    const TickRecord& seen = *input.observed;
    int nearest = -1;
    for (int b = 0; b < kBottles; ++b) {
      if (seen.palm_body == task_.bottles[b].body && seen.palm_target_distance_m >= 0.0)
        nearest = b;
    }
    if (!(transition_.u > 0.0) && at_ != nearest) {
      at_ = nearest;
      travel_ = offset_ = AxisPosition{};
      pressing_s_ = 0.0;
      depth_m_ = -1.0;
      // The first reach begins the block; its instant decides the order of the comparisons.
      if (at_ >= 0 && !begun_) comparing_.begin(seen.tick), begun_ = true;
      if (at_ >= 0) felt_ = feltOf(at_);
    }
    const double distance_m = at_ >= 0 && nearest == at_ ? seen.palm_target_distance_m : kInfinite;
    transition_ = advanceTransition(transition_, distance_m, input.may_push && !paused_,
                                    task_.wall.transition, static_cast<int>(seen.elapsed_periods),
                                    input.period_s);
    closed_on_to_ = near_;
    const bool close = seen.palm_target_distance_m < task_.wall.transition.release_m + kApproach_m;
    near_ = transition_.u > 0.0 ? at_ : close ? nearest : -1;
  }

  /// Computes f_e, Eq. (15) to (17).
  void push(const TickRecord& seen, double elapsed_s, ExerciseRecord& out) noexcept {
    const FingerWallConfig& walls = task_.wall.walls;
    FingerWallInput sight{{}, seen.q_m, seen.q_s, 0, 0};
    std::uint32_t palmar = 0;
    touches_ = SoftTouches{};
    if (at_ >= 0 && closed_on_to_ == at_) {  // the closure is valid for this bottle
      const BottleBody& b = task_.bottles[at_];
      sight.closure = seen.closure;
      sight.touching = posture_.touchingAxes(seen, b.body);
      touches_ = posture_.softTouches(seen.bodies[b.body], b.radius_m, b.height_m);
      for (int a = 0; a < walls.axes; ++a) {
        const std::uint32_t bit = 1U << static_cast<unsigned>(a);
        if (touches_[a].presses) sight.inside |= bit;
        if (touches_[a].palmar_depth_m > 0.0) palmar |= bit;
      }
    }
    out.alpha = transitionAlpha(transition_);
    walls_ = followClosure(walls_, sight, task_.wall.lead_in_m, out.alpha, walls, elapsed_s);
    FingerWallState started = startWalls(seen);
    for (int a = 0; a < walls.axes; ++a) {
      if (walls.stiffness[a] > 0.0) {
        cushions_.effort_cap[a] =
            std::min(walls.effort_cap[a], felt_.stimulus.most_n * walls.lever_arm_m[a]);
      }
    }
    pressing_s_ = depth_m_ > 0.0 ? pressing_s_ + sincePressed(elapsed_s) : 0.0;
    // In the tick in which the nozzle opens, it is open for the rest of the tick.
    const double slit = std::clamp((pressing_s_ - felt_.stimulus.opens_s) / elapsed_s, 0.0, 1.0);
    const BottlePress press =
        pressBottle(travel_,
                    {.walls = started,
                     .q_m = seen.q_m,
                     .alpha = out.alpha,
                     .open = slit > 0.0 ? palmar : 0U,
                     .slit = slit > 0.0 ? slit : 1.0,
                     .ratios = {felt_.stimulus.stiffness, felt_.stimulus.viscosity},
                     .elapsed_s = elapsed_s},
                    cushions_);
    travel_ = press.travel;
    out.effort = press.effort;
    out.wall_active = started.known;
    out.wall = started.position;
  }

  /// The part of a tick in which the bottle was pressed: the rest after its start was crossed.
  [[nodiscard]] double sincePressed(double elapsed_s) const noexcept {
    const bool crossed = depth_before_m_ <= 0.0 && depth_before_m_ > -1.0;
    return crossed ? elapsed_s * depth_m_ / (depth_m_ - depth_before_m_) : elapsed_s;
  }

  /// The walls, moved into the shell by the start. A wall never begins behind the finger: where the
  /// finger is past the start, it begins at the finger, and follows it to the start.
  [[nodiscard]] FingerWallState startWalls(const TickRecord& seen) noexcept {
    FingerWallState out = walls_;
    if (offset_.size() != out.position.size()) offset_ = AxisPosition(out.position.size());
    depth_before_m_ = std::exchange(depth_m_, -1.0);
    starts_late_m_ = 0.0;
    for (int a = 0; a < out.position.size(); ++a) {
      const double lever_m = task_.wall.walls.lever_arm_m[a];
      const double start = felt_.stimulus.start_m / lever_m;
      if (!walls_.known[a]) {
        offset_[a] = start;
        continue;
      }
      const double inside = seen.q_m[a] - walls_.position[a];
      if (swapped_) offset_[a] = std::max(start, inside);
      offset_[a] = std::max(start, std::min(offset_[a], inside));
      out.position[a] += offset_[a];
      depth_m_ = std::max(depth_m_, lever_m * (inside - offset_[a]));
      starts_late_m_ = std::max(starts_late_m_, lever_m * (offset_[a] - start));
    }
    if (swapped_) travel_ = AxisPosition{};
    swapped_ = false;
    return out;
  }

  /// Updates the low-passed force of the walls at the fingertips. It needs no opposing side: a
  /// person who cannot oppose the thumb compares, too.
  void feel(double elapsed_s, const ExerciseRecord& out) noexcept {
    double now_n = 0.0;
    for (int a = 0; a < out.effort.size(); ++a) {
      now_n -= out.effort[a] / task_.wall.walls.lever_arm_m[a];
    }
    squeeze_n_ += (now_n - squeeze_n_) *
                  (1.0 - std::exp(-2.0 * std::numbers::pi * task_.filter_hz * elapsed_s));
    // A squeeze that began before the bottle was felt completely does not count.
    if (!(transition_.u >= 1.0)) {
      fresh_ = false;
    } else if (released()) {
      fresh_ = true;
    }
  }

  /// A bottle that gave way presses little, but is still squeezed.
  [[nodiscard]] bool released() const noexcept {
    return squeeze_n_ < task_.let_go_n && depth_m_ <= kLetGo * felt_.depth_m;
  }

  /// True when a digit is deep in the bottle where the hand is not.
  [[nodiscard]] bool squeezesOther(const TickRecord& seen) const noexcept {
    if (at_ < 0 || released()) return false;
    const BottleBody& other = task_.bottles[1 - at_];
    const SoftTouches touches =
        posture_.softTouches(seen.bodies[other.body], other.radius_m, other.height_m);
    return std::any_of(touches.begin(), touches.end(),
                       [](const SoftTouch& touch) { return touch.palmar_depth_m > kBoth_m; });
  }

  void compare(const TickRecord& seen, double elapsed_s, ExerciseRecord& out) noexcept {
    HandNow hand;
    const bool starts_wrong = compares_start_ && starts_late_m_ > kStartsWrong_m;
    hand.at = fresh_ && !starts_wrong ? at_ : -1;
    hand.pressed = pressed();
    hand.released = released();
    hand.both = squeezesOther(seen);
    const ComparingChange news =
        comparing_.tick(hand, std::exchange(said_, GivenAnswer{}), elapsed_s);
    if (news.answered) {
      const Comparison& answer = comparing_.block().answers().back();
      said_second_ = answer.said_second ? 1.0 : 0.0;
      addEvent(out, kAnswered, comparing_.answers() - 1, answer.x);
      if (task_.says_right) {
        addEvent(out, answer.right() ? kRight : kWrong, comparing_.answers() - 1, answer.x);
      }
    }
    if (news.again >= 0) addEvent(out, kAgain, news.again, 0.0);
    if (news.too_early) addEvent(out, kTooEarly, -1, 0.0);
    if (news.done) addEvent(out, kLevelDone, -1, comparing_.answers());
    // Another stimulus begins while nothing is squeezed.
    if (at_ >= 0 && hand.released) {
      const Felt next = feltOf(at_);
      swapped_ = next.amount != felt_.amount || next.depth_m != felt_.depth_m;
      if (swapped_) felt_ = next;
    }
  }

  /// The grip of the bottle to be squeezed is the goal.
  void sayGoal(const TickRecord& seen) noexcept {
    const int bottle = paused_ ? -1 : comparing_.wanted();
    if (bottle < 0) return goFor(-1, {});
    const Eigen::Vector3d center_m = seen.bodies[task_.bottles[bottle].body].position_m.eigen();
    goFor(kBottles * comparing_.answers() + bottle, center_m - grip_m_);
  }

  [[nodiscard]] double pressed() const noexcept {
    return fresh_ && felt_.depth_m > 0.0 ? std::max(0.0, depth_m_ / felt_.depth_m) : 0.0;
  }

  void show(const Comparison& asked, ExerciseRecord& out) noexcept {
    const auto answers = comparing_.block().answers();
    out.values[kInstruction] = static_cast<double>(comparing_.instruction());
    out.values[kDone] = comparing_.done() ? 1.0 : 0.0;
    out.values[kPaused] = paused_ ? 1.0 : 0.0;
    out.values[kAnswers] = comparing_.answers();
    out.values[kAsked] = task_.rules.answers;
    out.values[kTime] = comparing_.time_s();
    out.values[kWanted] = comparing_.wanted();
    out.values[kAnswering] = comparing_.answering() ? 1.0 : 0.0;
    out.values[kAt] = fresh_ ? at_ : -1;
    out.values[kPressed] = pressed();
    out.values[kPressedLow] = 1.0;
    out.values[kPressedHigh] = kMarkEnds;
    out.values[kSqueeze] = squeeze_n_;
    out.values[kX] = asked.x;
    out.values[kOther] = asked.other;
    out.values[kIsCatch] = asked.is_catch ? 1.0 : 0.0;
    out.values[kSaidSecond] = said_second_;
    out.values[kSaidBy] = static_cast<double>(comparing_.saidBy());
    out.values[kAmount] = felt_.amount;
    out.values[kStart] = felt_.stimulus.start_m;
    out.values[kDepth] = felt_.depth_m;
    out.values[kLeastX] = task_.rules.scale.at(task_.rules.least_level);
    out.values[kMostX] = task_.rules.scale.at(task_.rules.most_level);
    out.values[kPlace] = comparing_.place();
    // A session after a rest repeats the answers before it, one a tick: its recording holds all.
    if (retold_ < to_retell_ && out.event_count == 0) {
      const Comparison& told = answers[retold_];
      out.values[kX] = told.x;
      out.values[kOther] = told.other;
      out.values[kIsCatch] = told.is_catch ? 1.0 : 0.0;
      out.values[kSaidSecond] = told.said_second ? 1.0 : 0.0;
      out.values[kSaidBy] = static_cast<double>(SaidBy::kEarlier);
      addEvent(out, kAnswered, retold_++, told.x);
    }
    out.value_count = kValues;
  }

  const TellApartTask task_;
  const DeviceModel device_;  ///< device and hand are inputs of makePlayer()
  const HandModel hand_;
  const Eigen::Vector3d grip_m_;  ///< from the hand's base to the centre of a held bottle
  const bool compares_start_;
  HandPosture posture_;
  Cushions cushions_;  ///< its effort_cap is the felt bottle's
  Comparing comparing_;
  TransitionState transition_;
  FingerWallState walls_;
  AxisPosition travel_;  ///< travel of the cushions
  AxisPosition offset_;  ///< start of each wall, from the first touch on
  SoftTouches touches_{};
  Felt felt_;                                      ///< the bottle at the hand
  bool swapped_ = false;                           ///< felt_ is new
  double depth_m_ = -1.0, depth_before_m_ = -1.0;  ///< behind the start; -1: without a wall
  double starts_late_m_ = 0.0;
  double squeeze_n_ = 0.0, pressing_s_ = 0.0, said_second_ = 0.0;
  GivenAnswer said_;                ///< answer by an order, until the comparison takes it
  int at_ = -1;                     ///< bottle with the walls; changes only at α = 0
  int near_ = -1;                   ///< bottle for the next closure query
  int closed_on_to_ = -1;           ///< bottle of the present closure
  int retold_ = 0, to_retell_ = 0;  ///< answers that were repeated, and are to be
  bool fresh_ = false;              ///< felt completely since it was released
  bool begun_ = false, paused_ = false;
};

// Reading the file.

BottleBody findBottle(TomlTable& root, const char* key, const SceneModel& scene) {
  BottleBody out;
  const std::string name = root.text(key);
  if (!root.isGood(key)) return out;
  out.body = uprightCylinder(root, key, name, scene, true);
  if (out.body < 0) return out;
  const SceneBody& body = scene.bodies[out.body];
  out.radius_m = body.shapes[0].radius_m;
  out.height_m = body.shapes[0].length_m;
  out.soft_m = body.soft_m;
  return out;
}

void readStimulus(TomlTable& root, TellApartTask& task) {
  TomlTable table = root.table("stimulus");
  task.least.start_m = table.number("start_m", between(0.0, 0.02, "m"));
  task.least.most_n = table.number("most_n", above(0.0, 40.0, "N"), kInfinite);
  task.least.opens_s = table.number("opens_s", between(0.0, 10.0, "s"), kInfinite);
  task.depth_m = table.number("depth_m", between(0.002, 0.02, "m"));
}

void readRules(TomlTable& root, ComparingRules& rules) {
  rules.answers = static_cast<int>(
      root.integer("answers", 1, ComparingRules::kMostAnswers, ComparingRules::kMostAnswers));
  rules.most_s = root.number("most_s", between(10.0, 3600.0, "s"), 600.0);
  rules.hold_s = root.number("hold_s", between(0.1, 5.0, "s"));
  rules.rest_every = static_cast<int>(root.integer("rest_every", 1, 1000, 10));
  rules.rest_s = root.number("rest_s", between(0.0, 120.0, "s"));
  rules.seed = static_cast<std::uint64_t>(root.integer("seed", 0, 1'000'000, 1));
  const double most = root.number("most_ratio", between(1.1, 3.0));
  rules.most_level = rules.scale.nearest(std::log(most) + 1e-9);
}

/// ln of the smallest ratio that the device resolves: of the asked depth by the encoder, and of a
/// delay by the period.
double resolved(const TellApartTask& task, const DeviceModel& device) {
  double step_m = 0.0;
  for (int a = 0; a < task.wall.walls.axes; ++a) {
    if (!(task.wall.walls.stiffness[a] > 0.0)) continue;
    step_m = std::max(step_m, device.axes[a].encoder_step * task.wall.walls.lever_arm_m[a]);
  }
  return std::log1p(step_m / task.depth_m);
}

/// The stiffest walls that the exercise may use.
std::vector<ExerciseWall> stiffestWalls(const TellApartTask& task) {
  const double most = task.rules.scale.at(task.rules.most_level);
  std::vector<ExerciseWall> walls = stiffestCushions(task.bottle, task.wall.walls);
  for (ExerciseWall& wall : walls) {
    wall.stiffness *= task.with(most).stiffness / kLargestWallRatio;
  }
  return walls;
}

/// Lowers the largest level to one whose walls are borne. Leaves it where not even the least one
/// is: the certificate then refuses the file with the axis.
void offerWhatIsBorne(TellApartTask& task, const BearsWalls& bears) {
  ComparingRules& rules = task.rules;
  const bool stiffer = task.with(1.0).stiffness != task.least.stiffness;
  if (!bears || !stiffer || bears(stiffestWalls(task))) return;
  const int asked = rules.most_level;
  int borne = rules.least_level, refused = asked;
  const auto bears_level = [&](int level) {
    rules.most_level = level;
    return bears(stiffestWalls(task));
  };
  if (!bears_level(borne)) {
    rules.most_level = asked;
    return;
  }
  while (refused - borne > 1) {
    const int middle = (borne + refused) / 2;
    (bears_level(middle) ? borne : refused) = middle;
  }
  rules.most_level = borne;
}

/// Refuses a file whose bottles cannot be what it says.
void checkTask(TomlTable& root, const TellApartTask& task) {
  const Stimulus most = task.with(task.rules.scale.at(task.rules.most_level));
  const double deepest_m = most.start_m + kDeepest * task.depth_m;
  for (const BottleBody& bottle : task.bottles) {
    if (bottle.body < 0 || deepest_m <= bottle.soft_m) continue;
    root.fail(
        "most_ratio",
        fmt::format("needs {:.1f} mm of soft shell, and the scene's bottles have {:.1f} mm",
                    1e3 * deepest_m, 1e3 * bottle.soft_m),
        "lower most_ratio, stimulus.depth_m or stimulus.start_m, or raise soft_m in the scene");
    return;
  }
  Stimulus changed = task.with(1.0);
  const bool without = changed.start_m == task.least.start_m &&
                       changed.stiffness == task.least.stiffness &&
                       changed.viscosity == task.least.viscosity &&
                       changed.most_n == task.least.most_n && changed.opens_s == task.least.opens_s;
  if (without) {
    root.fail("quantity", "is not part of [stimulus]",
              "farther needs start_m > 0, heavier most_n, later opens_s > 0");
  }
  if (changed.viscosity != task.least.viscosity && std::isinf(task.least.opens_s)) {
    root.fail("quantity", "is of a liquid that never flows", "write stimulus.opens_s = 0.0");
  }
}

}  // namespace

Expected<LoadedExercise> load(TomlFile& file, const ExerciseSource& source) {
  TomlTable& root = file.root();
  TellApartTask task;
  task.name = source.name;
  std::vector<std::string> names;
  for (const QuantityLaw& law : kLaws) names.emplace_back(law.name);
  const std::string quantity = root.choice("quantity", names);
  for (const QuantityLaw& law : kLaws) {
    if (law.name == quantity) task.law = law;
  }
  task.filter_hz = root.number("filter_hz", above(0.0, 100.0, "Hz"));
  task.let_go_n = root.number("let_go_n", above(0.0, 10.0, "N"));
  readRules(root, task.rules);
  task.says_right = root.flag("says_right", false);
  readStimulus(root, task);
  TomlTable wall = root.table("wall");
  task.wall = readFingerWalls(wall, *source.device);
  TomlTable bottle = root.table("bottle");
  task.bottle = readLiquid(bottle, readBottle(bottle));
  if (source.scene != nullptr) {
    task.bottles = {findBottle(root, "first", *source.scene),
                    findBottle(root, "second", *source.scene)};
    task.wall.walls.soft_m = task.bottles[0].soft_m;
    if (source.hand->side == Side::kLeft) {
      for (SceneBody& body : source.scene->bodies) body.pose.translation_m.y() *= -1.0;
    }
    for (BottleBody& one : task.bottles) {
      if (one.body >= 0) one.center_m = source.scene->bodies[one.body].pose.translation_m;
    }
  } else {
    (void)root.text("first"), (void)root.text("second");
  }
  if (source.level != 1) root.fail("exercise", "has one level", "ask for level 1");
  if (root.isGood("quantity") && root.isGood("most_ratio")) checkTask(root, task);
  const Diagnostics faults = file.finish();
  if (!faults.empty() || source.scene == nullptr) return faults;
  // A level that the device does not resolve is not offered.
  ComparingRules& rules = task.rules;
  const double least_x = resolved(task, *source.device);
  while (rules.least_level < rules.most_level && rules.scale.at(rules.least_level) < least_x) {
    ++rules.least_level;
  }
  offerWhatIsBorne(task, source.bears);
  LoadedExercise out;
  out.walls = stiffestWalls(task);
  for (const BottleBody& one : task.bottles) {
    const PlayerReach reach = playerReach(*source.device, source.hand, one.radius_m);
    out.needs.addBase(reach, one.center_m - reach.grip_m);
    out.needs.addGrasp(reach, *source.hand, one.radius_m);
  }
  out.exercise = std::make_unique<TellApart>(std::move(task), *source.device, *source.hand);
  return out;
}

}  // namespace wholehand::tell_apart
