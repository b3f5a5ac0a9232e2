#include "lab/engine_trial.hpp"

#include "experiments/grasp_observer.hpp"
#include "experiments/grasp_script.hpp"
#include "lab/engine_scenes.hpp"
#include "loop/realtime/monotonic_clock.hpp"
#include "loop/runtime/interrupt_scope.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

namespace wholehand {
namespace {

/// From this time on the hand, which closed at 2.8 s, is at rest.
constexpr double kPressed_s = 3.0;

/// Least force of a grip; the thumb touches with less when it swings past.
constexpr double kGrip_n = 1.0;

/// Kinetic and potential energy of all movable bodies [J].
double energyOf(const SceneModel& scene, const TickRecord& r) {
  double energy_j = 0.0;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const SceneBody& body = scene.bodies[i];
    if (body.fixed) continue;
    const BodyState& now = r.bodies[i];
    const Eigen::Vector3d turning = now.orientation_xyzw.eigen().toRotationMatrix().transpose() *
                                    now.angular_velocity_rad_s.eigen();
    energy_j += 0.5 * body.mass_kg * now.velocity_m_s.eigen().squaredNorm() +
                0.5 * turning.dot(body.inertia_kg_m2 * turning) -
                body.mass_kg * scene.gravity_m_s2.dot(now.position_m.eigen());
  }
  return energy_j;
}

/// Runs one engine in one scene, tick by tick in turn with the others, and evaluates the ticks.
class Lane {
 public:
  Lane(EngineScene scene, std::unique_ptr<Rig> rig, double hold_s, EngineFigures& figures)
      : scene_(scene),
        rig_(std::move(rig)),
        grasp_(comparedGrasp(), *rig_, hold_s),
        balance_(*rig_),
        kinematics_(rig_->models.hand),
        record_(std::make_unique<TickRecord>()),
        figures_(figures) {}

  void tick(std::uint64_t k) {
    record_->tick = k;
    record_->time_s = static_cast<double>(k) * rig_->renderer->config().period_s;
    const std::int64_t begin_ns = threadCpuNow_ns();
    rig_->renderer->tick(1, *record_);
    times_us_.push_back(static_cast<double>(threadCpuNow_ns() - begin_ns) * 1e-3);
    watch(*record_);
  }

  void finish() {
    TickCost& cost = figures_.cost.at(static_cast<std::size_t>(scene_));
    std::sort(times_us_.begin(), times_us_.end());
    const auto rank = [&](double share) {
      return times_us_.at(
          static_cast<std::size_t>(std::ceil(share * static_cast<double>(times_us_.size())) - 1.0));
    };
    if (!times_us_.empty()) cost = {rank(0.5), rank(0.999), times_us_};
    figures_.faulted |= any(rig_->renderer->latched());
    if (scene_ == EngineScene::kFixed) {
      figures_.virtual_work_error = balance_.driveError();
      figures_.felt_error = balance_.feltError();
    } else if (scene_ == EngineScene::kHeld) {
      const GraspResult grasp = grasp_.finish(*record_);
      figures_.held = !grasp.dropped;
      figures_.slip_m = grasp.slip_m;
      figures_.noise_n = grasp.force_noise_n;
    } else if (scene_ == EngineScene::kGripped && !times_us_.empty()) {
      figures_.gripped = gripped_ticks_ / static_cast<double>(times_us_.size());
    }
  }

 private:
  void watch(const TickRecord& r) {
    figures_.coupling_error_rad = std::max(figures_.coupling_error_rad, r.coupling_error_rad);
    if (scene_ == EngineScene::kHeld) {
      grasp_(r);
    } else if (scene_ == EngineScene::kFixed) {
      watchPressed(r);
    } else if (scene_ == EngineScene::kGripped) {
      double grip_n = 0.0;
      for (int i = 0; i < r.contact_count; ++i) grip_n += r.contacts.at(i).force_n.eigen().norm();
      gripped_ticks_ += grip_n > kGrip_n ? 1.0 : 0.0;
    } else if (scene_ == EngineScene::kResting) {
      const double energy_j = energyOf(rig_->models.scene, r);
      if (r.tick == 0) first_energy_j_ = energy_j;
      figures_.energy_drift_j =
          std::max(figures_.energy_drift_j, std::abs(energy_j - first_energy_j_));
    }
  }

  void watchPressed(const TickRecord& r) {
    for (int i = 0; i < r.contact_count; ++i) {
      figures_.penetration_m =
          std::max(figures_.penetration_m, -r.contacts.at(static_cast<std::size_t>(i)).distance_m);
    }
    if (r.time_s < kPressed_s) return;
    kinematics_.updateKinematics(r.theta);
    balance_.add(r, kinematics_);
  }

  EngineScene scene_;
  std::unique_ptr<Rig> rig_;
  GraspObserver grasp_;
  ContactBalance balance_;
  ArticulatedBody kinematics_;
  std::unique_ptr<TickRecord> record_;
  std::vector<double> times_us_;
  double first_energy_j_ = 0.0, gripped_ticks_ = 0.0;
  EngineFigures& figures_;
};

Expected<Done> runScene(EngineScene scene, const EnginePlan& plan, EngineComparison& all) {
  std::vector<Lane> lanes;
  for (EngineFigures& figures : all.engines) {
    auto rig = buildScene(scene, plan, figures.engine);
    if (!rig) return rig.errors();
    lanes.emplace_back(scene, std::move(*rig), plan.hold_s, figures);
  }
  const std::uint64_t ticks = ticksOf(scene, plan);
  for (std::uint64_t k = 0; k < ticks && !InterruptScope::interrupted(); ++k) {
    // The first engine changes every tick, so that no engine always inherits another's caches.
    for (std::size_t i = 0; i < lanes.size(); ++i) lanes[(k + i) % lanes.size()].tick(k);
  }
  for (Lane& lane : lanes) lane.finish();
  return Done{};
}

Expected<Done> seekStiffness(const EnginePlan& plan, EngineComparison& all) {
  for (EngineFigures& figures : all.engines) {
    if (!refuseForPersons(figures.engine).empty() || InterruptScope::interrupted()) continue;
    auto found = largestStableStiffness(plan.files, figures.engine, plan.rate_hz);
    if (!found) return found.errors();
    figures.stiffness = *found;
  }
  return Done{};
}

}  // namespace

double EngineComparison::ratioToPaper(EngineScene scene) const {
  const auto at = static_cast<std::size_t>(scene);
  for (const EngineFigures& e : engines) {
    if (e.engine != "bullet-paper" || e.cost.at(at).p50_us == 0.0) continue;
    return engines.front().cost.at(at).p50_us / e.cost.at(at).p50_us;
  }
  return 0.0;
}

Expected<EngineComparison> compareEngines(const EnginePlan& plan) {
  EngineComparison all;
  all.rate_hz = plan.rate_hz;
  for (const Engine& engine : engines()) {
    if (engine.build) all.engines.emplace_back().engine = engine.name;
  }
  for (int i = 0; i < kEngineScenes && !InterruptScope::interrupted(); ++i) {
    const auto scene = static_cast<EngineScene>(i);
    if (plan.status) plan.status(engineSceneName(scene));
    if (auto ran = runScene(scene, plan, all); !ran) return ran.errors();
  }
  if (plan.status) plan.status("stiffness");
  if (auto sought = seekStiffness(plan, all); !sought) return sought.errors();
  all.interrupted = InterruptScope::interrupted();
  return all;
}

}  // namespace wholehand
