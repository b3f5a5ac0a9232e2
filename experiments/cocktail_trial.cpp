#include "experiments/cocktail_trial.hpp"

#include "experiments/bar_figures.hpp"
#include "loop/realtime/monotonic_clock.hpp"
#include "loop/runtime/interrupt_scope.hpp"
#include "rig/run/run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace wholehand {
namespace {

constexpr double kAfterwards_s = 0.5;

class BarObserver {
 public:
  BarObserver(const BarFigures& figures, CocktailResult& result)
      : figures_(figures),
        result_(result),
        step_done_(figures.event("step_done")),
        wrong_(figures.event("wrong_dispenser")),
        knocked_over_(figures.event("knocked_over")) {}

  void operator()(const TickRecord& r) {
    const ExerciseRecord& e = r.exercise;
    now_s_ = r.time_s;
    for (int i = 0; i < e.event_count; ++i) take(e.events[i]);
    if (figures_(BarFigures::kStage, e) == BarFigures::kDrinkDone) began_s_ = now_s_;
    asked_l_ = figures_(BarFigures::kAsked, e);
    tolerance_l_ = figures_(BarFigures::kTolerance, e);
    result_.score = figures_(BarFigures::kScore, e);
    result_.spilt_l = figures_(BarFigures::kSpilt, e);
    result_.volume_error_l = std::max(result_.volume_error_l, figures_.volumeError_l(e));
    result_.time_s = r.time_s;
    done_ = figures_(BarFigures::kStage, e) == BarFigures::kLevelDone;
  }
  [[nodiscard]] bool done() const { return done_; }

 private:
  void take(const ExerciseEvent& event) {
    if (event.type == wrong_) ++result_.wrong_dispenser;
    if (event.type == knocked_over_) ++result_.knocked_over;
    if (event.type != step_done_) return;
    // asked_l_ still holds the amount requested in the previous tick.
    const double error_l = std::abs(event.value - asked_l_);
    ++result_.steps;
    result_.step_max_s = std::max(result_.step_max_s, now_s_ - began_s_);
    began_s_ = now_s_;
    result_.amount_error_max_l = std::max(result_.amount_error_max_l, error_l);
    if (error_l <= tolerance_l_) ++result_.steps_in_tolerance;
  }

  const BarFigures& figures_;
  CocktailResult& result_;
  int step_done_, wrong_, knocked_over_;
  double asked_l_ = 0.0, tolerance_l_ = 0.0;
  double now_s_ = 0.0, began_s_ = 0.0;  ///< current time and start time of this step
  bool done_ = false;
};

Diagnostic notPlayable(const std::string& file, const char* why) {
  return fileFault(file, why, "give the file of a cocktail bar");
}

std::optional<Diagnostic> startParameters(const CocktailPlan& plan, HapticRenderer& renderer) {
  const std::vector<LiveParameter> all = renderer.liveParameters();
  std::vector<double> values = renderer.parametersAtStart();
  for (const auto& [name, value] : plan.parameters) {
    const auto found =
        std::find_if(all.begin(), all.end(),
                     [wanted = name](const LiveParameter& p) { return p.name == wanted; });
    if (found == all.end()) {
      std::string names;
      for (const LiveParameter& p : all) names += (names.empty() ? "" : ", ") + p.name;
      return keyFault(plan.files.exercise, name, "", "is no live parameter here",
                      "one of " + names);
    }
    if (!(value >= found->lower && value <= found->upper)) {
      return keyFault(plan.files.exercise, name, fmt::format("{:g}", value), "is out of range",
                      fmt::format("{:g} to {:g}", found->lower, found->upper));
    }
    values[found - all.begin()] = value;
  }
  renderer.startParametersAt(values);
  return std::nullopt;
}

}  // namespace

Expected<CocktailResult> runCocktail(const CocktailPlan& plan) {
  auto models = loadModels(plan.files);
  if (!models) return models.errors();
  if (!models->exercise) return notPlayable(plan.files.exercise, "no exercise was named");
  const Exercise& exercise = *models->exercise;
  const BarFigures figures(exercise.description());
  std::unique_ptr<Player> player = makeExercisePlayer(*models, plan.seed);
  if (!figures.known() || !player) {
    return notPlayable(plan.files.exercise, "is not an exercise that a virtual patient can win");
  }
  auto rig = buildRig(std::move(*models), std::move(player), plan.rig);
  if (!rig) return rig.errors();
  if (auto wrong = startParameters(plan, *(*rig)->renderer)) return *wrong;

  CocktailResult result;
  result.level = plan.files.level;
  result.seed = plan.seed;
  BarObserver observe(figures, result);
  double done_s = 0.0;
  Run* running = nullptr;
  // Plays until the level is done, plus kAfterwards_s.
  RunPlan run;
  run.title = "Cocktail bar, level " + std::to_string(result.level);
  run.seed = plan.seed;
  run.record = plan.record;
  run.duration_ticks = static_cast<std::uint64_t>(plan.most_s / plan.rig.period_s);
  run.simulated_clock = true;
  run.interrupts = &InterruptScope::shared();
  run.sinks.emplace_back([&](const TickRecord& record) {
    observe(record);
    done_s = observe.done() ? done_s + plan.rig.period_s : 0.0;
    if (done_s > kAfterwards_s) running->requestStop();
  });
  auto prepared = Run::prepare(std::move(*rig), std::move(run));
  if (!prepared) return prepared.errors();
  running = prepared->get();
  const std::int64_t began_ns = monotonicNow_ns();
  if (auto ran = running->simulate(); !ran) return ran.errors();
  result.wall_s = static_cast<double>(monotonicNow_ns() - began_ns) * 1e-9;
  running->finish();
  result.faulted = running->outcome().faulted;
  result.interrupted = running->outcome().interrupted;
  result.ended = observe.done();
  result.completed = result.ended && result.steps_in_tolerance == result.steps && !result.faulted;
  return result;
}

}  // namespace wholehand
