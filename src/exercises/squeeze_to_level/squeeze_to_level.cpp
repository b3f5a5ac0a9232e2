#include "exercises/approach.hpp"
#include "exercises/bottle_file.hpp"
#include "exercises/finger_wall_file.hpp"
#include "exercises/load_exercise.hpp"
#include "exercises/player_reach.hpp"
#include "exercises/squeeze_to_level/squeeze_task.hpp"
#include "loop/exercise/grip.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

/// Exercise in which the person squeezes one object into bands of force, holds each band for a time
/// and releases in between. Template for new exercises (docs/exercises.md).
namespace wholehand::squeeze_to_level {
namespace {

using namespace approach;

// Speeds of the fingers' target while pressing.
constexpr double kClosing_rad_s = 1.0, kPressing_rad_s = 0.5;

/// A virtual patient who follows the instructions of the page. It approaches the object from the
/// side, closes until the force is in the goal band, releases when instructed, and draws back at
/// the end. The seed sets the pace and the target position within a band. Deterministic.
class SqueezePlayer final : public approach::ClosingPlayer {
 public:
  /// @param center_m centre of the object at the start
  SqueezePlayer(const PlayerReach& hand, int body, const Eigen::Vector3d& center_m,
                const PlayerTraits& traits);

  void reset() override;
  WHOLEHAND_RT void advance(double period_s, AxisPosition& q, AxisVelocity& qd) noexcept override;
  WHOLEHAND_RT void onRecord(const TickRecord& record) noexcept override;

 private:
  /// Phases, in order; kSqueeze lasts until the exercise is done.
  enum class Phase { kDrawBack, kAlign, kEnter, kTouch, kSqueeze, kOpen, kLeave, kRest };

  void go(Phase phase) noexcept;
  [[nodiscard]] double pressingRate() const noexcept;
  [[nodiscard]] AxisPosition goalOf(Phase phase) const noexcept;

  int body_;      ///< index of the object in the scene
  double share_;  ///< target position within a band, 0 .. 1
  Phase phase_ = Phase::kDrawBack;
  Eigen::Vector3d grip_m_ = Eigen::Vector3d::Zero();  ///< target of the hand's base
  bool near_ = false;                   ///< someone else steered the hand to the object
  bool done_ = false, let_go_ = false;  ///< from the last record
  double squeeze_n_ = 0.0, wanted_n_ = 0.0;
};

SqueezePlayer::SqueezePlayer(const PlayerReach& hand, int body, const Eigen::Vector3d& center_m,
                             const PlayerTraits& traits)
    : ClosingPlayer(hand, traits.opening_rad_s, 0.8 + 0.1 * static_cast<double>(traits.seed % 5)),
      body_(body),
      share_(0.35 + 0.1 * static_cast<double>(traits.seed / 5 % 4)) {
  start_ = approach::startAt(hand, center_m - hand.grip_m);
  SqueezePlayer::reset();
}

void SqueezePlayer::reset() {
  toStart();
  near_ = done_ = let_go_ = false;
  squeeze_n_ = wanted_n_ = 0.0;
  go(Phase::kDrawBack);
}

AxisPosition SqueezePlayer::goalOf(Phase phase) const noexcept {
  Goal goal(hand_, q_);
  const double beside_m = grip_m_.y() - hand_.beside * kBeside_m;
  switch (phase) {
    case Phase::kDrawBack:
    case Phase::kRest:
      return goal.drawBack();
    case Phase::kAlign:
      return goal.pose({back_m(hand_), beside_m, grip_m_.z()}, kStretched, kTurnedAside);
    case Phase::kEnter:
    case Phase::kLeave:
      return goal.pose({grip_m_.x(), beside_m, grip_m_.z()}, kStretched, kTurnedAside);
    case Phase::kTouch:
      return goal.pose(grip_m_, kHalfBent, kOpposed);
    case Phase::kOpen:
      return goal.hand(kHalfBent, kTurnedAside);
    case Phase::kSqueeze:
      break;
  }
  return goal.at();
}

void SqueezePlayer::go(Phase phase) noexcept {
  phase_ = phase;
  moveTo(goalOf(phase), phase == Phase::kTouch);
}

void SqueezePlayer::advance(double period_s, AxisPosition& q, AxisVelocity& qd) noexcept {
  if (takesOver()) go(near_ ? Phase::kOpen : Phase::kDrawBack);
  moveOn(phase_ == Phase::kSqueeze ? std::optional(pressingRate()) : std::nullopt, period_s, q, qd);
}

double SqueezePlayer::pressingRate() const noexcept {
  if (let_go_) return -kClosing_rad_s;
  if (squeeze_n_ <= 0.15 * wanted_n_) return kClosing_rad_s;
  return std::clamp(kPressing_rad_s * (wanted_n_ - squeeze_n_) / wanted_n_, -kPressing_rad_s,
                    kPressing_rad_s);
}

void SqueezePlayer::onRecord(const TickRecord& record) noexcept {
  if (steeredByOthers(record)) near_ = record.exercise.alpha > 0.0;
  const ExerciseRecord& reported = record.exercise;
  if (reported.value_count != kValues) return;  // records have no values during the ramp to neutral
  done_ = reported.values[kDone] > 0.5;
  let_go_ = static_cast<Instruction>(reported.values[kInstruction]) == Instruction::kLetGo || done_;
  squeeze_n_ = reported.values[kSqueeze];
  wanted_n_ = std::max(
      reported.values[kGoalLow] + share_ * (reported.values[kGoalHigh] - reported.values[kGoalLow]),
      0.1);
  const BodyState& body = record.bodies[body_];
  if (phase_ == Phase::kDrawBack || phase_ == Phase::kAlign) {
    grip_m_ = body.position_m.eigen() - hand_.grip_m;
  }
  if (lost_ || (phase_ == Phase::kSqueeze ? !done_ : !reach_.done())) return;
  if (phase_ == Phase::kRest && done_) return;
  go(phase_ == Phase::kRest ? Phase::kDrawBack : static_cast<Phase>(static_cast<int>(phase_) + 1));
}

enum Parameter : std::int32_t { kWallStiffness, kViscosity, kLeadIn, kLevelRatio };
enum Event : std::int32_t { kEntered, kBandHeld, kLevelDone, kRestarted };

/// The closure of the fingers on the object is queried when the palm is nearer than release_m plus
/// this.
constexpr double kApproach_m = 0.05;

class SqueezeToLevel final : public Exercise {
 public:
  SqueezeToLevel(SqueezeTask task, const DeviceModel& device, const HandModel& hand)
      : task_(std::move(task)),
        device_(device),
        hand_(hand),
        grip_m_(playerReach(device, &hand, task_.radius_m).grip_m),
        posture_(hand_),
        cushions_(cushionsOf(task_.bottle, task_.wall.walls)),
        steps_(task_.rules) {
    description_.name = task_.name;
    description_.fade_out_s = task_.wall.transition.release_s;
    description_.parameters = {
        {"wall_stiffness_ratio", "1", 0.0, kLargestWallRatio, 1.0, 0.5},
        {"viscosity_ratio", "1", kThinnestRatio, kThickestRatio, 1.0, 0.5},
        {"lead_in_m", "m", 0.0, kLargestLeadIn_m, task_.wall.lead_in_m, 0.005},
        {"level_ratio", "1", 0.25, 1.5, 1.0, 0.5}};
    description_.value_names.assign(std::begin(kValueNames), std::end(kValueNames));
    description_.event_names = {"band_entered", "band_held", "level_done", "restarted"};
    description_.json = R"({"kind":"squeeze_to_level"})";
    SqueezeToLevel::reset();
  }

  void reset() override {
    steps_.reset();
    transition_ = TransitionState{};
    walls_ = FingerWallState{};
    travel_ = AxisPosition{};
    squeeze_n_ = flow_ml_s_ = 0.0;
    near_ = paused_ = false;
    forgetGoal();
  }

  [[nodiscard]] WorldQuery query() const noexcept override {
    return {1U << static_cast<unsigned>(task_.body), near_ ? task_.body : -1};
  }

  void tick(const ExerciseInput& input, ExerciseRecord& out,
            BodyPlacements& placements) noexcept override {
    const TickRecord& seen = *input.observed;
    const double elapsed_s = std::max(seen.elapsed_periods, 1U) * input.period_s;
    out = ExerciseRecord{};
    placements.count = 0;
    posture_.update(input.hand);
    (void)takeActions(seen, steps_, paused_, kRestarted, out);
    push(input, elapsed_s, out);
    feel(seen, out, elapsed_s);
    if (!paused_) advanceSteps(input.parameters[kLevelRatio], elapsed_s, out);
    // The grip of the object is the goal until the hand is near it.
    goFor(near_ || steps_.done() ? -1 : 0, seen.bodies[task_.body].position_m.eigen() - grip_m_);
    show(input.parameters[kLevelRatio], out);
  }

  [[nodiscard]] std::unique_ptr<Player> makePlayer(const PlayerTraits& traits) const override {
    return std::make_unique<SqueezePlayer>(playerReach(device_, &hand_, task_.radius_m), task_.body,
                                           task_.center_m, traits);
  }

 private:
  /// Computes f_e, Eq. (15) to (17): a wall on every axis of the file, faded in near the object.
  void push(const ExerciseInput& input, double elapsed_s, ExerciseRecord& out) noexcept {
    const TickRecord& seen = *input.observed;
    const double to_palm_m = seen.palm_target_distance_m;
    const double distance_m = seen.palm_body == task_.body && to_palm_m >= 0.0
                                  ? to_palm_m
                                  : std::numeric_limits<double>::infinity();
    // Fades the walls in and out with the distance of the palm.
    transition_ = advanceTransition(transition_, distance_m, input.may_push && !paused_,
                                    task_.wall.transition, static_cast<int>(seen.elapsed_periods),
                                    input.period_s);
    // Finds the digits that touch the object.
    FingerWallInput sight{{}, seen.q_m, seen.q_s, 0, 0};
    std::uint32_t open = 0;  // only digits that press from the palmar side squeeze
    touches_ = SoftTouches{};
    if (near_) {  // the closure is valid for this object
      sight.closure = seen.closure;
      sight.touching = posture_.touchingAxes(seen, task_.body);
      touches_ = posture_.softTouches(seen.bodies[task_.body], task_.radius_m, task_.height_m);
      for (int a = 0; a < task_.wall.walls.axes; ++a) {
        const std::uint32_t bit = 1U << static_cast<unsigned>(a);
        if (task_.soft_m > 0.0 && touches_[a].presses) sight.inside |= bit;
        if (touches_[a].palmar_depth_m > 0.0) open |= bit;
      }
    }
    near_ = transition_.u > 0.0 || distance_m < task_.wall.transition.release_m + kApproach_m;
    out.alpha = transitionAlpha(transition_);
    // Moves the walls with the closure and presses the cushions behind them.
    walls_ = followClosure(walls_, sight, input.parameters[kLeadIn], out.alpha, task_.wall.walls,
                           elapsed_s);
    const CushionRatios ratios{input.parameters[kWallStiffness], input.parameters[kViscosity]};
    const BottlePress press = pressBottle(travel_,
                                          {.walls = walls_,
                                           .q_m = seen.q_m,
                                           .alpha = out.alpha,
                                           .open = open,
                                           .ratios = ratios,
                                           .elapsed_s = elapsed_s},
                                          cushions_);
    travel_ = press.travel;
    flow_ml_s_ = 1e6 * press.out_m3 / elapsed_s;
    out.effort = press.effort;
    out.wall_active = walls_.known;
    out.wall = walls_.position;  // includes the shell's travel, because liquid has left
    for (int a = 0; a < out.wall.size(); ++a) {
      if (walls_.known[a]) out.wall[a] += travel_[a];
    }
  }

  /// Updates the low-passed squeeze at the fingertips (docs/exercises.md).
  void feel(const TickRecord& seen, const ExerciseRecord& out, double elapsed_s) noexcept {
    const FeltBody felt{task_.body, out.effort, touches_};
    const double now_n =
        feltSqueeze_n(seen, felt, posture_, task_.wall.walls, task_.wall.effort_limit);
    squeeze_n_ += (now_n - squeeze_n_) *
                  (1.0 - std::exp(-2.0 * std::numbers::pi * task_.filter_hz * elapsed_s));
  }

  void advanceSteps(double ratio, double elapsed_s, ExerciseRecord& out) noexcept {
    const int band = steps_.band();
    const BandChange news = steps_.tick(squeeze_n_, transition_.engaged, ratio, elapsed_s);
    if (news.entered) addEvent(out, kEntered, band, squeeze_n_);
    if (news.held >= 0) addEvent(out, kBandHeld, news.held, steps_.score());
    if (news.done) addEvent(out, kLevelDone, -1, steps_.score());
  }

  void show(double ratio, ExerciseRecord& out) const noexcept {
    const Band goal = steps_.goal(ratio);
    out.values[kInstruction] = static_cast<double>(steps_.instruction());
    out.values[kScore] = steps_.score();
    out.values[kDone] = steps_.done() ? 1.0 : 0.0;
    out.values[kBandsDone] = steps_.bandsDone();
    out.values[kBands] = static_cast<double>(task_.rules.bands.size());
    out.values[kSqueeze] = squeeze_n_;
    out.values[kGoalLow] = goal.low_n;
    out.values[kGoalHigh] = goal.high_n;
    out.values[kHeld] = std::min(steps_.held_s(), task_.rules.hold_s);
    out.values[kFlow] = flow_ml_s_;
    out.values[kPaused] = paused_ ? 1.0 : 0.0;
    out.value_count = kValues;
  }

  const SqueezeTask task_;
  const DeviceModel device_;  ///< device and hand are inputs of makePlayer()
  const HandModel hand_;
  const Eigen::Vector3d grip_m_;  ///< from the hand's base to the centre of the held object
  HandPosture posture_;
  const Cushions cushions_;
  BandSteps steps_;
  TransitionState transition_;
  FingerWallState walls_;
  AxisPosition travel_;  ///< travel of the cushions
  SoftTouches touches_{};
  double squeeze_n_ = 0.0, flow_ml_s_ = 0.0;
  bool near_ = false;  ///< the next observation includes the closure on the object
  bool paused_ = false;
};

void readBands(TomlTable& root, BandRules& rules) {
  rules.hold_s = root.number("hold_s", between(0.1, 60.0, "s"));
  rules.let_go_n = root.number("let_go_n", above(0.0, 10.0, "N"));
  for (TomlTable& table : root.tables("bands", 1)) {
    Band band;
    band.low_n = table.number("low_n", above(0.0, 40.0, "N"));
    band.high_n = table.number("high_n", above(0.0, 40.0, "N"));
    if (table.isGood("low_n") && table.isGood("high_n") && band.high_n <= band.low_n) {
      table.fail("high_n", "is not above low_n", "must be more than low_n");
    }
    if (table.isGood("low_n") && root.isGood("let_go_n") && band.low_n <= rules.let_go_n) {
      table.fail("low_n", "is not above let_go_n", "must be more than let_go_n");
    }
    rules.bands.push_back(band);
  }
}

/// Finds the object in the scene and places it for the hand's side.
void findObject(TomlTable& root, const std::string& name, Side side, SceneModel& scene,
                SqueezeTask& task) {
  task.body = uprightCylinder(root, "object", name, scene, true);
  if (task.body < 0) return;
  const SceneBody& body = scene.bodies[task.body];
  task.radius_m = body.shapes[0].radius_m;
  task.height_m = body.shapes[0].length_m;
  task.soft_m = task.wall.walls.soft_m = body.soft_m;
  if (side == Side::kLeft) {
    for (SceneBody& other : scene.bodies) other.pose.translation_m.y() *= -1.0;
  }
  task.center_m = body.pose.translation_m;
}

}  // namespace

Expected<LoadedExercise> load(TomlFile& file, const ExerciseSource& source) {
  TomlTable& root = file.root();
  SqueezeTask task;
  task.name = source.name;
  task.filter_hz = root.number("filter_hz", above(0.0, 100.0, "Hz"));
  const std::string object = root.text("object");
  readBands(root, task.rules);
  TomlTable wall = root.table("wall");
  task.wall = readFingerWalls(wall, *source.device);
  TomlTable bottle = root.table("bottle");
  task.bottle = readLiquid(bottle, readBottle(bottle));

  if (source.scene != nullptr && root.isGood("object")) {
    findObject(root, object, source.hand->side, *source.scene, task);
  }
  if (source.level != 1) root.fail("exercise", "has one level", "ask for level 1");
  const Diagnostics faults = file.finish();
  if (!faults.empty() || source.scene == nullptr) return faults;
  LoadedExercise out;
  out.walls = stiffestCushions(task.bottle, task.wall.walls);
  const PlayerReach reach = playerReach(*source.device, source.hand, task.radius_m);
  out.needs.addBase(reach, task.center_m - reach.grip_m);
  out.needs.add(reach.y, task.center_m.y() - reach.grip_m.y() - reach.beside * approach::kBeside_m);
  out.needs.addGrasp(reach, *source.hand, task.radius_m);
  out.exercise = std::make_unique<SqueezeToLevel>(std::move(task), *source.device, *source.hand);
  return out;
}

}  // namespace wholehand::squeeze_to_level
