// Measures the cost of each of MuJoCo's settings. One rig for each setting squeezes the bar's
// dispenser as in `wholehand experiment timing`. The rigs take turns of some ticks, so that other
// load affects all equally and each has warm caches.
//
//   mujoco_cost [TICKS]
//
// Prints for each rig the CPU time of a tick and the work of MuJoCo's solver. The first rig has the
// default engine: its ticks contain everything except MuJoCo.
#include "bench/rig_files.hpp"
#include "experiments/exercise_script.hpp"
#include "experiments/grip_target.hpp"
#include "lab/mujoco/mujoco_engine.hpp"
#include "lab/mujoco/mujoco_world.hpp"
#include "loop/realtime/monotonic_clock.hpp"
#include "loop/realtime/thread_setup.hpp"
#include "rig/rig.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <vector>

namespace wholehand {
namespace {

constexpr int kSqueezed = 4000;  // ticks until the grip is firm
constexpr int kTurn = 50;        // consecutive ticks of a rig
constexpr int kNumbersOfImpedance = 2;

struct Setting {
  const char* name;
  const char* engine;
  void (*put)(mjModel& model);
};

void setImpedance(mjtNum* solimp, int count, double impedance) {
  for (int i = 0; i < count; ++i) std::fill_n(solimp + mjNIMP * i, kNumbersOfImpedance, impedance);
}

void stopForeseeing(mjModel& m) {
  std::fill_n(m.geom_margin, m.ngeom, 0.0);
  std::fill_n(m.pair_margin, m.npair, 0.0);
}

void soften(mjModel& m) {
  constexpr double kStock = 0.95;
  setImpedance(m.geom_solimp, m.ngeom, kStock);
  setImpedance(m.pair_solimp, m.npair, kStock);
  setImpedance(m.jnt_solimp, m.njnt, kStock);
}

constexpr std::array kSettings{
    Setting{"engine bullet", "bullet", nullptr},
    Setting{"engine mujoco", "mujoco", nullptr},
    Setting{"nothing collides", "mujoco", [](mjModel& m) { m.opt.disableflags |= mjDSBL_CONTACT; }},
    Setting{"one iteration of Newton's method", "mujoco", [](mjModel& m) { m.opt.iterations = 1; }},
    Setting{"several points of hand and body", "mujoco",
            [](mjModel& m) { m.opt.enableflags |= mjENBL_MULTICCD; }},
    Setting{"contacts no 2 mm in advance", "mujoco", stopForeseeing},
    Setting{"tolerance 1e-8, as stock", "mujoco", [](mjModel& m) { m.opt.tolerance = 1e-8; }},
    Setting{"friction as stiff as the normal", "mujoco", [](mjModel& m) { m.opt.impratio = 1.0; }},
    Setting{"impedance 0.95, as stock", "mujoco", soften},
    Setting{"these four together", "mujoco",
            [](mjModel& m) {
              stopForeseeing(m);
              soften(m);
              m.opt.tolerance = 1e-8;
              m.opt.impratio = 1.0;
            }},
    Setting{"collisions to 1e-4 in place of 1e-6", "mujoco",
            [](mjModel& m) { m.opt.mpr_tolerance = 1e-4; }},
    Setting{"solver CG", "mujoco", [](mjModel& m) { m.opt.solver = mjSOL_CG; }},
    Setting{"solver PGS", "mujoco", [](mjModel& m) { m.opt.solver = mjSOL_PGS; }}};

std::unique_ptr<Rig> buildSqueeze(const char* engine) {
  ModelFiles files = filesOf("cocktail-bar.toml");
  files.exercise = WHOLEHAND_SOURCE_DIR "/config/exercises/cocktail-bar.toml";
  Models models = orThrow(loadModels(files));
  const GripTarget target = firstDispenser(models);
  constexpr double kLong_s = 3600.0;
  Intention aim = squeezeAgainAndAgain(models.device, target.grip_m, kLong_s);
  RigOptions options;
  options.engine = engine;
  return orThrow(buildRig(std::move(models), std::move(aim), options));
}

class Lane {
 public:
  explicit Lane(const Setting& setting)
      : name_(setting.name),
        rig_(buildSqueeze(setting.engine)),
        record_(std::make_unique<TickRecord>()) {
    if (auto* world = dynamic_cast<MujocoWorld*>(rig_->world.get()); world != nullptr) {
      engine_ = &world->engine();
      if (setting.put != nullptr) setting.put(engine_->model());
    }
    orThrow(rig_->renderer->arm());
  }

  void tick(bool measured) {
    const std::int64_t began_ns = threadCpuNow_ns();
    rig_->renderer->tick(1, *record_);
    if (!measured) return;
    cpu_ns_.push_back(threadCpuNow_ns() - began_ns);
    gripped_ += record_->contact_count > 0 ? 1 : 0;
    if (engine_ == nullptr) return;
    points_ += engine_->data().ncon;
    rows_ += engine_->data().nefc;
    iterations_ += engine_->data().solver_iter;
  }

  void print() {
    const auto middle = cpu_ns_.begin() + static_cast<std::ptrdiff_t>(cpu_ns_.size() / 2);
    std::nth_element(cpu_ns_.begin(), middle, cpu_ns_.end());
    const auto ticks = static_cast<double>(cpu_ns_.size());
    std::printf("%-36s %7.1f %8.0f %% %7.1f %6.1f %10.2f%s\n", name_,
                static_cast<double>(*middle) * 1e-3, 100.0 * gripped_ / ticks, points_ / ticks,
                rows_ / ticks, iterations_ / ticks,
                any(rig_->renderer->latched()) ? "  stopped by a fault" : "");
  }

 private:
  const char* name_;
  std::unique_ptr<Rig> rig_;
  std::unique_ptr<TickRecord> record_;
  mujoco::MujocoEngine* engine_ = nullptr;
  std::vector<std::int64_t> cpu_ns_;
  double gripped_ = 0.0, points_ = 0.0, rows_ = 0.0, iterations_ = 0.0;
};

void compare(int ticks) {
  flushDenormals();
  std::vector<Lane> lanes;
  for (const Setting& setting : kSettings) lanes.emplace_back(setting);
  for (int first = 0; first < kSqueezed + ticks; first += kTurn) {
    for (Lane& lane : lanes) {
      for (int k = 0; k < kTurn; ++k) lane.tick(first >= kSqueezed);
    }
  }
  std::printf("%-36s %7s %10s %7s %6s %10s\n", "a tick with", "p50 us", "touching", "points",
              "rows", "iterations");
  for (Lane& lane : lanes) lane.print();
}

}  // namespace
}  // namespace wholehand

int main(int argc, char** argv) {
  try {
    const int ticks = argc > 1 ? std::atoi(argv[1]) : 1000;
    if (argc > 2 || ticks < 1) throw std::runtime_error("usage: mujoco_cost [TICKS], 1 or more");
    wholehand::compare(ticks);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "mujoco_cost: %s\n", error.what());
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
