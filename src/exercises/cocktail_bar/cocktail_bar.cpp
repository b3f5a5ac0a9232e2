#include "exercises/cocktail_bar/bar.hpp"
#include "exercises/cocktail_bar/bar_player.hpp"
#include "exercises/cocktail_bar/bar_record.hpp"
#include "exercises/cocktail_bar/pouring.hpp"
#include "exercises/cocktail_bar/recipe.hpp"
#include "exercises/cocktail_bar/serving.hpp"
#include "exercises/load_exercise.hpp"
#include "loop/exercise/finger_cushions.hpp"
#include "loop/exercise/finger_walls.hpp"
#include "loop/exercise/grip.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <utility>

/// The paper's game (§II-F). The person reaches for the dispenser of the recipe's liquid, grasps it
/// and squeezes until the glass is filled to the line. Rules: docs/exercises.md.
namespace wholehand::cocktail_bar {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
/// Margin added to the engage and release distances: the closure is queried and the approach is
/// reported within it.
constexpr double kApproach_m = 0.05;
/// The nozzle's slit is fully open when the squeeze exceeds its threshold by this share.
constexpr double kOpens = 0.07;

class CocktailBar final : public Exercise {
 public:
  /// @param whole the device with its own ranges
  CocktailBar(Bar bar, const DeviceModel& device, const DeviceModel& whole, const HandModel& hand)
      : bar_(std::move(bar)),
        device_(device),
        hand_(hand),
        parameters_(bar_, makeBarLayout(bar_, device_, &hand_), whole),
        posture_(hand_),
        serving_(bar_),
        pouring_(bar_),
        recipe_(bar_) {
    description_.name = bar_.name;
    description_.level = bar_.level;
    description_.levels = static_cast<int>(bar_.level_names.size());
    description_.fade_out_s = bar_.transition.release_s;
    description_.parameters = parameters_.all();
    description_.value_names = barValueNames(bar_);
    description_.event_names.assign(kBarEventNames.begin(), kBarEventNames.end());
    description_.resume_value = static_cast<int>(BarValue::kResumeDrink);
    description_.json = barJson(bar_);
    for (std::size_t i = 0; i < bar_.dispensers.size(); ++i) {
      const BarDispenser& d = bar_.dispensers[i];
      targets_.set(d.body_index);
      grips_m_[i] = playerReach(device_, &hand_, d.radius_m).grip_m;
      const double viscosity_pa_s = bar_.liquids[d.liquid].viscosity_pa_s;
      cushions_.push_back(cushionsOf(filledWith(bar_.bottle, viscosity_pa_s), bar_.walls));
    }
    reset();
  }

  void reset() override {
    serving_.reset();
    pouring_.reset();
    recipe_.reset();
    transition_ = TransitionState{};
    walls_ = FingerWallState{};
    travel_ = AxisPosition{};
    stroke_ = Stroke{};
    soft_touches_ = SoftTouches{};
    at_ = near_ = -1;
    approached_ = -1;
    untouched_s_ = {};
    untouched_s_.fill(kInfinite);
    paused_ = false;
    forgetGoal();
  }

  [[nodiscard]] WorldQuery query() const noexcept override {
    return {targets_, near_ < 0 ? -1 : bar_.dispensers[near_].body_index};
  }

  void tick(const ExerciseInput& input, ExerciseRecord& out,
            BodyPlacements& placements) noexcept override {
    const TickRecord& seen = *input.observed;
    const int closed_on_to = near_;
    out = ExerciseRecord{};
    posture_.update(input.hand);
    BarObservation senses = observeBar(bar_, seen, posture_, input.period_s);
    recipe_.setTolerance(parameters_.tolerance_l(input.parameters));
    takeActions(seen, out);
    addTouchEvents(senses, out);
    engage(senses, input, out);
    push(senses, input, closed_on_to, out);
    feelSqueeze(seen, out.effort, senses);
    serving_.tick(senses, posture_, recipe_.order().dispenser, parameters_.reach(input.parameters),
                  !paused_, placements);
    addUpsetEvents(out);
    pouring_.tick(senses, recipe_.order(), held(), stroke_, serving_.leaking(),
                  parameters_.threshold(input.parameters), !paused_, out);
    if (!paused_) {
      recipe_.tick(senses.elapsed_s, held(), serving_.pending(), pouring_, out);
    }
    sayGoal(seen);
    show(senses, input, out);
  }

  [[nodiscard]] std::unique_ptr<Player> makePlayer(const PlayerTraits& traits) const override {
    return makeBarPlayer(bar_, device_, &hand_, traits);
  }

 private:
  /// Index of the dispenser whose walls are engaged; -1: none.
  [[nodiscard]] int held() const noexcept { return transition_.engaged ? at_ : -1; }

  void takeActions(const TickRecord& seen, ExerciseRecord& out) noexcept {
    for (int i = 0; i < seen.command_count; ++i) {
      const Command& c = seen.commands[i];
      if (c.type == CommandType::kAction) act(c, out);
    }
  }

  void act(const Command& command, ExerciseRecord& out) noexcept {
    const auto action = static_cast<Act>(command.index);
    if (action == Act::kNext && recipe_.stage() != BarStage::kLevelDone) {
      recipe_.endRest();
    } else if (action == Act::kRestart || action == Act::kNext) {
      pouring_.reset();
      recipe_.reset();
      serving_.bringHome();
      paused_ = false;
      addEvent(out, BarEvent::kRestarted);
    } else if (action == Act::kPause && !paused_) {
      paused_ = true;
      addEvent(out, BarEvent::kPaused);
    } else if (action == Act::kResume && paused_) {
      paused_ = false;
      addEvent(out, BarEvent::kResumed);
    } else if (action == kBeginAt) {
      recipe_.beginAt(command.value);
    }
  }

  void addTouchEvents(const BarObservation& senses, ExerciseRecord& out) noexcept {
    constexpr double kAgain_s = 0.2;  // debounce: contacts flicker for some ticks
    for (std::size_t i = 0; i < bar_.dispensers.size(); ++i) {
      if (senses.touched[i] && untouched_s_[i] > kAgain_s) {
        addEvent(out, BarEvent::kTouched, static_cast<int>(i), senses.force_n[i]);
      }
      untouched_s_[i] = senses.touched[i] ? 0.0 : untouched_s_[i] + senses.elapsed_s;
    }
    const bool close = senses.palm_m < bar_.transition.engage_m + kApproach_m;
    const int approached = close ? senses.nearest : -1;
    if (approached >= 0 && approached != approached_) {
      addEvent(out, BarEvent::kApproached, approached, senses.palm_m);
    }
    if (close || senses.palm_m > bar_.transition.release_m + kApproach_m) approached_ = approached;
  }

  /// Advances the transition, Eq. (16), of one dispenser at a time. The dispenser and thereby the
  /// walls' gains change only at α = 0.
  void engage(const BarObservation& senses, const ExerciseInput& input,
              ExerciseRecord& out) noexcept {
    if (!(transition_.u > 0.0) && at_ != senses.nearest) {
      at_ = senses.nearest;
      travel_ = AxisPosition{};
    }
    const bool was_engaged = transition_.engaged;
    const double distance_m = at_ >= 0 && senses.nearest == at_ ? senses.palm_m : kInfinite;
    TransitionConfig fading = bar_.transition;
    fading.engage_s = parameters_.fade_s(input.parameters);
    transition_ =
        advanceTransition(transition_, distance_m, input.may_push && !paused_, fading,
                          static_cast<int>(input.observed->elapsed_periods), input.period_s);
    if (!(transition_.u > 0.0)) {
      near_ = senses.palm_m < bar_.transition.release_m + kApproach_m ? senses.nearest : -1;
    } else {
      near_ = at_;
    }
    if (transition_.engaged == was_engaged) return;
    addEvent(out, was_engaged ? BarEvent::kDisengaged : BarEvent::kEngaged, at_, senses.palm_m);
    const int wanted = recipe_.order().dispenser;
    if (!was_engaged && wanted >= 0 && at_ != wanted) {
      addEvent(out, BarEvent::kWrongDispenser, at_);
    }
  }

  /// Computes f_e, Eq. (15) to (17). @param closed_on_to dispenser for which the closure was
  /// queried
  void push(const BarObservation& senses, const ExerciseInput& input, int closed_on_to,
            ExerciseRecord& out) noexcept {
    const TickRecord& seen = *input.observed;
    const double alpha = transitionAlpha(transition_);
    FingerWallInput sight{{}, seen.q_m, seen.q_s, 0, 0};
    soft_touches_ = SoftTouches{};
    if (at_ >= 0 && closed_on_to == at_) {
      const BarDispenser& d = bar_.dispensers[at_];
      sight.closure = seen.closure;
      sight.touching = posture_.touchingAxes(seen, d.body_index);
      if (d.soft_m > 0.0) {
        const BodyState& body = seen.bodies[d.body_index];
        soft_touches_ = posture_.softTouches(body, d.radius_m, d.height_m);
      }
      for (int a = 0; a < bar_.walls.axes; ++a) {
        if (soft_touches_[a].presses) sight.inside |= 1U << a;
      }
    }
    walls_ = followClosure(walls_, sight, parameters_.leadIn_m(input.parameters), alpha, bar_.walls,
                           senses.elapsed_s);
    out.effort = AxisEffort(bar_.walls.axes);
    out.alpha = alpha;
    out.wall = walls_.position;
    out.wall_active = walls_.known;
    if (at_ >= 0) press(senses, input, alpha, out);
  }

  /// Advances the cushions of the dispenser with the walls. Its nozzle is open for digits that
  /// press with their palmar side, while the hand holds the dispenser and the squeeze exceeds the
  /// threshold.
  void press(const BarObservation& senses, const ExerciseInput& input, double alpha,
             ExerciseRecord& out) noexcept {
    const double threshold = parameters_.threshold(input.parameters);
    const double from_n = threshold * bar_.squeeze.threshold_n;
    const double over_n = pouring_.squeeze_n(at_) - from_n;
    const bool squeezed = over_n > 0.0 && held() == at_ && !paused_;
    const double slit = squeezed ? std::min(over_n / (kOpens * from_n), 1.0) : 1.0;
    std::uint32_t open = posture_.palmarAxes(*input.observed, bar_.dispensers[at_].body_index);
    for (int a = 0; a < bar_.walls.axes; ++a) {
      if (soft_touches_[a].palmar_depth_m > 0.0) open |= 1U << a;
    }
    if (!squeezed) open = 0;
    const CushionRatios ratios{parameters_.stiffness(input.parameters),
                               parameters_.viscosity(input.parameters), threshold};
    const BottleInput bottle{.walls = walls_,
                             .q_m = input.observed->q_m,
                             .alpha = alpha,
                             .open = open,
                             .slit = slit,
                             .empty = pouring_.empty(at_),
                             .ratios = ratios,
                             .elapsed_s = senses.elapsed_s};
    const BottlePress pressed = pressBottle(travel_, bottle, cushions_[at_]);
    constexpr double kPerM3 = 1e3;
    travel_ = pressed.travel;
    stroke_ = {kPerM3 * pressed.out_m3, kPerM3 * pressed.pressed_m3};
    out.effort = pressed.effort;
    for (int a = 0; a < bar_.walls.axes; ++a) {
      if (walls_.known[a])
        out.wall[a] += travel_[a];  // adds the shell's travel, because liquid has left
    }
  }

  /// Computes the squeeze on every dispenser at the fingertips [N], from contacts and from the
  /// walls of dispenser at_.
  void feelSqueeze(const TickRecord& seen, const AxisEffort& wall,
                   BarObservation& senses) const noexcept {
    for (std::size_t i = 0; i < bar_.dispensers.size(); ++i) {
      FeltBody felt;
      felt.body = bar_.dispensers[i].body_index;
      if (static_cast<int>(i) == at_) {
        felt.wall = wall;
        felt.touches = soft_touches_;
      } else if (!senses.touched[i]) {
        continue;
      }
      senses.squeeze_n[i] = feltSqueeze_n(seen, felt, posture_, bar_.walls, bar_.effort_limit);
    }
  }

  /// The grip of the wanted dispenser is the goal until the hand is near it.
  void sayGoal(const TickRecord& seen) noexcept {
    const int wanted = recipe_.order().dispenser;
    const bool goes = recipe_.stage() == BarStage::kReach && !paused_ && wanted >= 0 &&
                      near_ != wanted && !serving_.pending();
    if (!goes) return goFor(-1, {});
    const BarDispenser& d = bar_.dispensers[wanted];
    goFor(wanted, worldPoint(seen.bodies[d.body_index], d.grip_m) - grips_m_[wanted]);
  }

  void addUpsetEvents(ExerciseRecord& out) const noexcept {
    for (std::size_t i = 0; i < bar_.dispensers.size(); ++i) {
      const int index = static_cast<int>(i);
      if ((serving_.knockedOver() >> i & 1U) != 0U) addEvent(out, BarEvent::kKnockedOver, index);
      if ((serving_.stoodUp() >> i & 1U) != 0U) addEvent(out, BarEvent::kStoodUp, index);
    }
  }

  void show(const BarObservation& senses, const ExerciseInput& input,
            ExerciseRecord& out) const noexcept;

  const Bar bar_;
  const DeviceModel device_;  ///< device and hand are inputs of makePlayer()
  const HandModel hand_;
  const BarParameters parameters_;
  HandPosture posture_;
  BodySet targets_;
  Serving serving_;
  Pouring pouring_;
  Recipe recipe_;
  TransitionState transition_;
  std::vector<Cushions> cushions_;  ///< one for each dispenser
  FingerWallState walls_;
  AxisPosition travel_;  ///< travel of the cushions of dispenser at_
  Stroke stroke_;
  SoftTouches soft_touches_;  ///< soft contacts with dispenser at_
  int at_ = -1;               ///< dispenser with the walls; changes only at α = 0
  int near_ = -1;             ///< dispenser for the next closure query
  int approached_ = -1;       ///< last approach reported
  std::array<double, kMaxDispensers> untouched_s_{};
  /// From the hand's base to the grip of each dispenser.
  std::array<Eigen::Vector3d, kMaxDispensers> grips_m_{};
  bool paused_ = false;
};

void CocktailBar::show(const BarObservation& senses, const ExerciseInput& input,
                       ExerciseRecord& out) const noexcept {
  const auto set = [&out](BarValue value, double number) noexcept {
    out.values[static_cast<std::size_t>(value)] = number;
  };
  const PourOrder order = recipe_.order();
  const Ledger& ledger = pouring_.ledger();
  const int meter = held() >= 0 ? held() : order.dispenser;
  const double ratio = parameters_.threshold(input.parameters);
  set(BarValue::kStage, static_cast<double>(recipe_.stage()));
  set(BarValue::kDrink, recipe_.drink());
  set(BarValue::kDrinks, static_cast<double>(bar_.drinks.size()));
  set(BarValue::kStep, recipe_.step());
  set(BarValue::kSteps, recipe_.steps());
  set(BarValue::kTargetDispenser, order.dispenser);
  set(BarValue::kEngagedDispenser, held());
  set(BarValue::kSqueeze, pouring_.squeeze_n(meter));
  set(BarValue::kSqueezeLow, ratio * bar_.squeeze.low_n);
  set(BarValue::kSqueezeHigh, ratio * bar_.squeeze.high_n);
  set(BarValue::kSqueezeFull, ratio * bar_.squeeze.full_n);
  set(BarValue::kSqueezeThreshold, ratio * bar_.squeeze.threshold_n);
  set(BarValue::kFlow, pouring_.flow_l_s());
  set(BarValue::kOverGlass, meter >= 0 && senses.overGlass(meter, bar_.glass) ? 1.0 : 0.0);
  set(BarValue::kPoured, ledger.layer_l(order.step));
  set(BarValue::kAsked, order.amount_l);
  set(BarValue::kTolerance, order.tolerance_l);
  set(BarValue::kGlass, ledger.glass_l());
  set(BarValue::kSpilt, ledger.spilt_l());
  set(BarValue::kScore, recipe_.score());
  set(BarValue::kStars, recipe_.stars());
  set(BarValue::kDrinkTime, recipe_.drinkTime_s());
  set(BarValue::kRowY, serving_.rowY_m());
  set(BarValue::kPouredTotal, ledger.poured_l());
  set(BarValue::kStartTotal, ledger.start_l());
  set(BarValue::kRestLeft, recipe_.restLeft_s());
  set(BarValue::kPaused, paused_ ? 1.0 : 0.0);
  set(BarValue::kPalmDispenser, senses.nearest);
  set(BarValue::kResumeDrink, recipe_.resumeDrink());
  set(BarValue::kPressed, held() >= 0 ? stroke_.pressed_l : 0.0);
  auto next = static_cast<std::size_t>(BarValue::kCount);
  for (std::size_t i = 0; i < bar_.dispensers.size(); ++i) {
    out.values[next++] = ledger.left_l(static_cast<int>(i));
  }
  for (int i = 0; i < kMaxSteps; ++i) out.values[next++] = ledger.layer_l(i);
  out.value_count = static_cast<std::int32_t>(next);
}

}  // namespace

namespace {

/// Height of the nozzle above the glass while a carried dispenser pours.
constexpr double kPours_m = 0.02;
/// Least way back from a dispenser: the half-bent fingers are clear of it.
constexpr double kWithdraws_m = 0.115;
constexpr double kAtEnd_m = 0.006;  // a hand at the end of its range is drawn back

/// Places of the hand: at the dispensers, drawn back, and where a carried one pours. A row that
/// slides comes to the hand (BarParameters::reach()).
TaskNeeds needsOf(const Bar& bar, const ExerciseSource& source) {
  TaskNeeds needs;
  const Eigen::Vector3d glass_m = source.scene->bodies[bar.glass.body_index].pose.translation_m;
  for (const BarDispenser& d : bar.dispensers) {
    const PlayerReach reach = playerReach(*source.device, source.hand, d.radius_m);
    needs.addGrasp(reach, *source.hand, d.radius_m);
    const Eigen::Vector3d base_m = d.home_m + d.grip_m - reach.grip_m;
    needs.add(reach.x, std::max(bar.drawn_back.x_m, base_m.x() - kWithdraws_m));
    needs.add(reach.x, base_m.x());
    needs.add(reach.z, base_m.z());
    if (!bar.row.slides) needs.add(reach.y, base_m.y());
    if (!d.free) continue;
    Eigen::Vector3d pours_m = glass_m - d.nozzle_m;
    pours_m.z() += 0.5 * bar.glass.height_m + kPours_m;
    needs.addBase(reach, pours_m + d.grip_m - reach.grip_m);
  }
  return needs;
}

}  // namespace

Expected<LoadedExercise> load(TomlFile& file, const ExerciseSource& source) {
  Expected<Bar> bar = loadBar(file, source);
  if (!bar) return bar.errors();
  LoadedExercise out;
  out.needs = needsOf(*bar, source);
  if (bar->x_axis >= 0) {
    const double back_m = source.device->axes[bar->x_axis].lower + kAtEnd_m;
    bar->drawn_back.x_m = std::max(bar->drawn_back.x_m + source.moved_m.x(), back_m);
  }
  out.walls = stiffestCushions(filledWith(bar->bottle, thinnest_pa_s(bar->liquids)), bar->walls);
  bar->reach = reachOf(makeBarLayout(*bar, *source.device, source.hand), bar->transition.engage_m);
  out.exercise =
      std::make_unique<CocktailBar>(std::move(*bar), *source.device, *source.whole, *source.hand);
  return out;
}

}  // namespace wholehand::cocktail_bar
