#include "experiments/sweep/cell.hpp"

#include "experiments/cocktail_trial.hpp"
#include "experiments/grasp_trial.hpp"
#include "experiments/sweep/cell_values.hpp"
#include "experiments/sweep/contact_trial.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

namespace wholehand {
namespace {

RigOptions rigFor(const CellValues& values) {
  RigOptions options;
  options.engine = values.text("engine", defaultEngine());
  options.period_s = 1.0 / values.number("rate_hz", 1000.0);
  options.uncertified = true;  // no person is moved
  return options;
}

// Changes gains and device to the cell's values.
void adjust(Models& models, const CellValues& values) {
  for (AxisRendering& axis : models.rendering.axes) {
    axis.k_pm *= values.number("stiffness", 1.0);
    axis.k_dm *= values.number("adaptive_damping", 1.0);
  }
  for (DeviceAxis& axis : models.device.axes) axis.damping *= values.number("device_damping", 1.0);
  models.device.output_delay_ticks =
      static_cast<int>(values.number("delay_ticks", models.device.output_delay_ticks));
}

/// @pre `values` outlives it
TrialSetup setupFor(const CellValues& values, const std::string& scratch) {
  return {scratch, rigFor(values), [&values](Models& models) { adjust(models, values); }};
}

Expected<GraspTrial> graspFor(const CellValues& values) {
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

Expected<std::vector<double>> runGraspCell(const SweepGrid& grid, const CellValues& values,
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

Expected<std::vector<double>> runContactCell(const SweepGrid& grid, const CellValues& values,
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

Expected<std::vector<double>> runPlayCell(const SweepGrid& grid, const CellValues& values,
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
  const CellValues values(grid, grid.places(cell));
  if (grid.trial == SweepTrial::kContact) return runContactCell(grid, values, find, scratch);
  if (grid.trial == SweepTrial::kPlay) return runPlayCell(grid, values, find);
  return runGraspCell(grid, values, find, scratch);
}

}  // namespace wholehand
