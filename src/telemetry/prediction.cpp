#include "telemetry/prediction.hpp"

#include "telemetry/effort_rules.hpp"
#include "telemetry/learning_rules.hpp"
#include "telemetry/motion_rules.hpp"
#include "telemetry/prediction_rules.hpp"

#include <cmath>
#include <memory>

namespace wholehand::recording {
namespace {

bool knowsInertia(const RecordingMeta& meta) {
  return meta.schema >= kStepSchema && !meta.law.inertia.coefficients.empty();
}

/// @param inertia null: unknown
void addMotion(Rules& rules, const RecordingMeta& meta,
               const std::shared_ptr<PostureInertia>& inertia) {
  const double period_s = meta.period_s;
  const std::size_t q_s = rules.column("q_s"), qd_s = rules.column("qd_s");
  const std::size_t tick = rules.column("tick");
  rules.add("time_s", [=](const RowWindow& w, std::size_t) {
    return static_cast<double>(w.number<std::uint64_t>(tick, 0)) * period_s;
  });
  if (meta.schema >= kStepSchema && !meta.law.encoder_step.empty()) {
    addSteps<2>(rules, "q_m", meta.law.encoder_step);
  }
  if (inertia != nullptr) {
    rules.add("qd_s", SteppedVelocity(rules, meta, inertia), {}, SteppedVelocity::later(meta));
  } else {
    addExtrapolated<5>(rules, "qd_s");
  }
  rules.add("q_s", [=](const RowWindow& w, std::size_t i) {  // symplectic Euler
    if (w.past() == 0) return 0.0;
    return w.number(q_s, i, 1) + period_s * w.number(qd_s, i);
  });
}

// The velocity filter, and θ = θ₀ + G q_s.
void addKinematics(Rules& rules, const RecordingMeta& meta) {
  const double period_s = meta.period_s;
  const RecordedLaw& law = meta.law;
  const std::size_t q_m = rules.column("q_m"), qd_mf = rules.column("qd_mf");
  const std::size_t q_s = rules.column("q_s"), elapsed = rules.column("elapsed_periods");
  rules.add("qd_mf", [=, tau = law.filter_tau_s](const RowWindow& w, std::size_t i) {
    if (w.past() == 0) return 0.0;
    const double elapsed_s = w.number<std::uint32_t>(elapsed, 0) * period_s;
    const double moved = w.number(q_m, i) - w.number(q_m, i, 1);
    return (tau[i] * w.number(qd_mf, i, 1) + moved) / (tau[i] + elapsed_s);
  });
  const std::size_t axes = meta.axis_names.size();
  rules.add("theta", [=, theta0 = law.theta0, g = law.synergy](const RowWindow& w, std::size_t j) {
    double theta = theta0[j];
    for (std::size_t a = 0; a < axes; ++a) {
      const double share = g[j * axes + a];
      if (share != 0.0) theta += share * w.number(q_s, a);
    }
    return theta;
  });
}

// Eq. (2), before kRowElementSchema with the previous row's damping D; then Eq. (3) with this row's
// D.
void addCoupling(Rules& rules, const RecordingMeta& meta,
                 const std::shared_ptr<PostureInertia>& inertia) {
  const std::size_t q_m = rules.column("q_m"), q_s = rules.column("q_s");
  const std::size_t qd_mf = rules.column("qd_mf"), qd_s = rules.column("qd_s");
  const std::size_t f_s = rules.column("f_s");
  const auto stretch = [=](const RowWindow& w, std::size_t i, std::uint64_t back) {
    return w.number(q_m, i, back) - w.number(q_s, i, back);
  };
  const auto rate = [=](const RowWindow& w, std::size_t i, std::uint64_t back) {
    return w.number(qd_mf, i, back) - w.number(qd_s, i, back);
  };
  if (inertia != nullptr) {
    rules.add("f_s", InertialEffort(rules, meta, inertia));
  } else if (meta.schema >= kRowElementSchema) {
    rules.add("f_s", CriticallyDampedEffort(rules, meta));
  } else {
    rules.add("f_s", [=, k = meta.law.k_pm](const RowWindow& w, std::size_t i) {
      double damping = 0.0;
      if (w.past() > 0 && rate(w, i, 1) != 0.0) {
        damping = (w.number(f_s, i, 1) - k[i] * stretch(w, i, 1)) / rate(w, i, 1);
      }
      return k[i] * stretch(w, i, 0) + damping * rate(w, i, 0);
    });
  }
  rules.add("coupling",
            [=, k = meta.law.k_pm, gamma = meta.law.gamma](const RowWindow& w, std::size_t i) {
              const double spring = k[i] * stretch(w, i, 0);
              return gamma[i] * (spring - w.number(f_s, i)) - spring;
            });
}

void addEfforts(Rules& rules, const RecordingMeta& meta) {
  const std::size_t phi = rules.column("phi"), qd_mf = rules.column("qd_mf");
  const std::size_t coupling = rules.column("coupling"), damping = rules.column("damping");
  const std::size_t exercise = rules.column("exercise_effort");
  const std::size_t tank_effort = rules.column("tank_effort"), rendered = rules.column("rendered");
  if (meta.law.effort_dead.empty() || meta.schema < kStepSchema) {
    rules.add("phi", [=](const RowWindow& w, std::size_t i) {  // decays by a constant factor
      if (w.past() == 0) return 0.0;
      const double last = w.number(phi, i, 1);
      if (w.past() == 1 || last == 0.0 || w.number(phi, i, 2) == 0.0) return last;
      return last * (last / w.number(phi, i, 2));
    });
  } else {
    rules.add("phi", ActivatedDamping(rules, meta));
  }
  rules.add("damping", [=, k = meta.law.k_dm](const RowWindow& w, std::size_t i) {
    return k.empty() ? 0.0 : -w.number(phi, i) * k[i] * w.number(qd_mf, i);
  });
  rules.add("rendered", [=](const RowWindow& w, std::size_t i) {
    return ((w.number(coupling, i) + w.number(exercise, i)) + w.number(damping, i)) +
           w.number(tank_effort, i);
  });
  rules.add("sent", [=](const RowWindow& w, std::size_t i) { return w.number(rendered, i); });
}

// Where the exercise's wall stands, and what it does.
void addWall(Rules& rules) {
  addSteps<3>(rules, "closure", {1.0 / kProbeSteps});
  rules.add("wall", WallPosition(rules));
  addExtrapolated<4>(rules, "alpha");
  rules.add("exercise_effort", WallEffort(rules));
}

// What the virtual patient is told and the palm is near to.
void addPatient(Rules& rules, const RecordingMeta& meta) {
  if (meta.schema >= kStepSchema) {
    addSteps<3>(rules, "intention", {1.0 / kIntentionSteps});
    addSteps<4>(rules, "patient_effort", {1.0 / kEffortSteps});
    addSteps<3>(rules, "palm_distance_m", {1.0 / kProbeSteps});
  } else if (meta.schema >= kGridSchema) {
    addOnGrid<3>(rules, "intention", kIntentionSteps);
    addOnGrid<3>(rules, "patient_effort", kEffortSteps);
    addExtrapolated<7>(rules, "palm_distance_m");
  } else if (meta.schema >= kRowElementSchema) {
    rules.add("intention", Oscillation(rules.column("intention"), meta.axis_names.size()));
    addExtrapolated<9>(rules, "patient_effort");
    addExtrapolated<7>(rules, "palm_distance_m");
  } else {
    addExtrapolated<6>(rules, "intention");
    for (const char* name : {"patient_effort", "palm_distance_m"}) addExtrapolated<5>(rules, name);
  }
}

}  // namespace

std::vector<Prediction> predictions(const std::vector<ColumnShape>& columns,
                                    const RecordingMeta& meta) {
  if (meta.schema < kPackedSchema) return {};
  Rules rules(columns, meta.schema);
  std::shared_ptr<PostureInertia> inertia;
  if (knowsInertia(meta)) {
    inertia = std::make_shared<PostureInertia>(meta.law.inertia, meta.axis_names.size());
  }
  addMotion(rules, meta, inertia);
  if (!meta.law.k_pm.empty()) {
    addKinematics(rules, meta);
    addCoupling(rules, meta, inertia);
  }
  if (meta.schema >= kStepSchema) addWall(rules);
  addEfforts(rules, meta);
  if (meta.law.k_pm.empty()) {
    addExtrapolated<2>(rules, "tank");
  } else {
    rules.add("tank", TankEnergy(rules, meta));
  }
  addPatient(rules, meta);
  addExtrapolated<1>(rules, "parameters");
  if (meta.schema >= kStepSchema) {
    rules.add("bodies", BodyMotion(rules, meta), {}, BodyMotion::later(meta));
    std::vector<double> steps = meta.value_steps;
    steps.resize(meta.value_names.size(), 0.0);
    addSteps<3>(rules, "exercise_values", steps);
  } else {
    addExtrapolated<1>(rules, "bodies");
    addExtrapolated<1>(rules, "exercise_values");
  }
  const std::size_t palm = rules.column("palm_distance_m");
  rules.add("palm_target_distance_m",
            [palm](const RowWindow& w, std::size_t) { return w.number(palm, 0); });
  return rules.take();
}

}  // namespace wholehand::recording
