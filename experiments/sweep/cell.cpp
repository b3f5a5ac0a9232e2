#include "experiments/sweep/cell.hpp"

#include "experiments/cocktail_trial.hpp"
#include "experiments/grasp_trial.hpp"
#include "experiments/sweep/contact_trial.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

namespace wholehand {
namespace {

/// The values of one cell by axis. Axes that the grid lacks have default values.
class Values {
 public:
  Values(const SweepGrid& grid, std::vector<int> places)
      : grid_(grid), places_(std::move(places)) {}

  [[nodiscard]] std::string text(const std::string& axis, const std::string& fallback) const {
    for (std::size_t i = 0; i < places_.size(); ++i) {
      if (grid_.axes[i].name == axis) return grid_.axes[i].names.at(places_[i]);
    }
    return fallback;
  }
  [[nodiscard]] double number(const std::string& axis, double fallback) const {
    for (std::size_t i = 0; i < places_.size(); ++i) {
      if (grid_.axes[i].name == axis) return grid_.axes[i].numbers.at(places_[i]);
    }
    return fallback;
  }

 private:
  const SweepGrid& grid_;
  std::vector<int> places_;
};

ModelFiles filesFor(const SweepGrid& grid, const Values& values, const FindFile& find) {
  ModelFiles files;
  files.scene = find("scenes", "four-shapes");
  files.hand = find("hands", values.text("hand", "adult-median-right"));
  const std::string device = values.text("device", "lambda-pride");
  files.device = find("devices", device);
  files.rendering = find("rendering", values.text("rendering", device));
  files.patient = find("patients", values.text("patient", "relaxed-adult"));
  if (grid.trial == SweepTrial::kPlay) {
    files.exercise = find("exercises", values.text("exercise", "cocktail-bar"));
    files.level = static_cast<int>(values.number("level", 1));
  }
  return files;
}

RigOptions rigFor(const Values& values) {
  RigOptions options;
  options.engine = values.text("engine", defaultEngine());
  options.period_s = 1.0 / values.number("rate_hz", 1000.0);
  options.uncertified = true;  // no person is moved
  return options;
}

// Changes gains and device to the cell's values.
void adjust(Models& models, const Values& values) {
  for (AxisRendering& axis : models.rendering.axes) {
    axis.k_pm *= values.number("stiffness", 1.0);
    axis.k_dm *= values.number("adaptive_damping", 1.0);
  }
  for (DeviceAxis& axis : models.device.axes) axis.damping *= values.number("device_damping", 1.0);
  models.device.output_delay_ticks =
      static_cast<int>(values.number("delay_ticks", models.device.output_delay_ticks));
}

/// @pre `values` outlives it
TrialSetup setupFor(const Values& values, const std::string& scratch) {
  return {scratch, rigFor(values), [&values](Models& models) { adjust(models, values); }};
}

Expected<GraspTrial> graspFor(const Values& values) {
  const std::string object = values.text("object", "cylinder");
  const std::string posture = values.text("posture", "power");
  const bool gravity = values.number("gravity", 0.0) != 0.0;
  const std::vector<GraspTrial> tuned = tunedTrials();
  const auto wanted = [&](const GraspTrial& trial) {
    return trial.shape == object && trial.grasp == posture && trial.gravity == gravity;
  };
  const auto found = std::find_if(tuned.begin(), tuned.end(), wanted);
  if (found == tuned.end()) {
    return keyFault("", "posture", posture, "is not known for the object " + object,
                    "pinch takes sphere or cube");
  }
  GraspTrial trial = *found;
  const auto seed = static_cast<std::uint64_t>(values.number("jitter", 0.0));
  if (seed > 0) {
    const auto jittered = jitteredTrials(static_cast<int>(tuned.size()), seed);
    trial = *std::find_if(jittered.begin(), jittered.end(), wanted);
  }
  trial.friction = values.number("friction", trial.friction);
  trial.size = values.number("size", trial.size);
  return trial;
}

double oneIf(bool yes) {
  return yes ? 1.0 : 0.0;
}

Expected<std::vector<double>> runGraspCell(const SweepGrid& grid, const Values& values,
                                           const FindFile& find, const std::string& scratch) {
  auto trial = graspFor(values);
  if (!trial) return trial.errors();
  GraspPlan plan;
  plan.setup = setupFor(values, scratch);
  plan.hold_s = grid.hold_s;
  auto r = runGrasp(*trial, filesFor(grid, values, find), plan);
  if (!r) return r.errors();
  return std::vector<double>{oneIf(!r->dropped),   oneIf(r->faulted),  r->slip_m,
                             r->carry_shift_m,     r->rotation_rad,    r->force_noise_n,
                             r->contact_force_n,   r->tip_force_max_n, r->felt_error,
                             r->coupling_error_rad};
}

Expected<std::vector<double>> runContactCell(const SweepGrid& grid, const Values& values,
                                             const FindFile& find, const std::string& scratch) {
  auto trial = graspFor(values);
  if (!trial) return trial.errors();
  auto r = runContact(*trial, filesFor(grid, values, find), setupFor(values, scratch));
  if (!r) return r.errors();
  return std::vector<double>{
      oneIf(r->stable), oneIf(r->certified), oneIf(r->certified && !r->stable),
      r->margin,        r->noise_n,          r->penetration_m,
      oneIf(r->faulted)};
}

Expected<std::vector<double>> runPlayCell(const SweepGrid& grid, const Values& values,
                                          const FindFile& find) {
  CocktailPlan plan;
  plan.files = filesFor(grid, values, find);
  plan.seed = static_cast<std::uint64_t>(values.number("seed", 1.0));
  plan.rig = rigFor(values);
  auto r = runCocktail(plan);
  if (!r) return r.errors();
  return std::vector<double>{
      oneIf(r->completed), oneIf(r->ended),       oneIf(r->faulted), r->score,
      r->spilt_l,          r->amount_error_max_l, r->time_s};
}

}  // namespace

Expected<std::vector<double>> runCell(const SweepGrid& grid, int cell, const FindFile& find,
                                      const std::string& scratch) {
  const Values values(grid, grid.places(cell));
  if (grid.trial == SweepTrial::kContact) return runContactCell(grid, values, find, scratch);
  if (grid.trial == SweepTrial::kPlay) return runPlayCell(grid, values, find);
  return runGraspCell(grid, values, find, scratch);
}

std::vector<std::string> filesOf(const SweepGrid& grid, const FindFile& find) {
  std::vector<std::string> files;
  // Each axis is varied alone, because a file depends on one axis only (the gains depend on the
  // device's axis).
  for (std::size_t axis = 0; axis < grid.axes.size(); ++axis) {
    std::vector<int> places(grid.axes.size(), 0);
    for (places[axis] = 0; places[axis] < grid.axes[axis].size(); ++places[axis]) {
      for (const std::string& file : filesFor(grid, Values(grid, places), find).all()) {
        if (!file.empty()) files.push_back(file);
      }
    }
  }
  std::sort(files.begin(), files.end());
  files.erase(std::unique(files.begin(), files.end()), files.end());
  return files;
}

}  // namespace wholehand
