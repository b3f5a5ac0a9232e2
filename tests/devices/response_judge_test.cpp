// The judge of the response: honest drives, which it must never stop, and drives that lie.
#include "devices/plugin/response_judge.hpp"

#include "devices/plugin/effort_judge.hpp"
#include "devices/response_world.hpp"
#include "files/patient/patient_file.hpp"
#include "loop/renderer/safety_tools.hpp"
#include "support/figure.hpp"
#include "support/rig_tools.hpp"
#include "support/seed.hpp"
#include "support/shipped.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace wholehand::test {
namespace {

ResponseJudge judgeOf(const RenderedAxis& axis) {
  ResponseJudge::Models models{};
  models[0] = modelOf(axis);
  return {models, 1, ResponseWorld::kPeriod_s};
}

/// What the drive says that it gives, beside the judge of measured efforts, as in PluginDevice.
class MeasuredEffort {
 public:
  MeasuredEffort(const RenderedAxis& axis, std::mt19937_64& random)
      : random_(random), offset_(uniform(random, -0.02, 0.02) * axis.limit), limit_(axis.limit) {
    judge_.begin(0.0, 0.0, 0, {0.1135 * axis.limit, 0.25});
  }
  [[nodiscard]] bool isAstray(const ResponseWorld& world, int tick) {
    constexpr std::int64_t kWindow_ns = 2 * kPeriod_ns + 5 * 2'000'000;
    const double noise = uniform(random_, -0.03, 0.03) * limit_;
    return judge_.isAstray(world.acting() + offset_ + noise, tick * kPeriod_ns - kWindow_ns, false);
  }
  void send(double effort, int tick) { judge_.send(effort, tick * kPeriod_ns); }

 private:
  static constexpr std::int64_t kPeriod_ns = 1'000'000;
  std::mt19937_64& random_;
  double offset_, limit_;
  EffortJudge judge_;
};

struct Verdict {
  int astray_after = -1;  ///< ticks; -1: never
  int contradictions = 0, excesses = 0;
};

/// The judge beside a world, as PluginDevice calls it; with `measured` both judges.
Verdict judge(ResponseWorld& world, const RenderedAxis& axis, int ticks,
              const std::function<void(int tick)>& before = {},
              MeasuredEffort* measured = nullptr) {
  ResponseJudge judge = judgeOf(axis);
  Verdict out;
  for (int k = 0; k < ticks; ++k) {
    if (before) before(k);
    bool astray = judge.isAstray(AxisPosition(1, world.read()));
    if (measured != nullptr) astray |= measured->isAstray(world, k);
    out.contradictions = std::max(out.contradictions, judge.contradictions(0));
    out.excesses = std::max(out.excesses, judge.excesses(0));
    if (astray && out.astray_after < 0) out.astray_after = k;
    if (astray) break;
    world.pass();
    judge.send(AxisEffort(1, world.sent()));
    if (measured != nullptr) measured->send(world.sent(), k);
  }
  return out;
}

Limb anyLimb(std::mt19937_64& random, double limit) {
  Limb limb;
  if (random() % 5 != 0) {
    limb = {uniform(random, 0.3, 2.5), uniform(random, 5.0, 25.0), uniform(random, 0.0, 700.0)};
  }
  limb.moves = true;
  if (random() % 3 == 0) {
    limb.tremor = uniform(random, 0.0, 0.4 * limit);
    limb.tremor_hz = uniform(random, 3.0, 12.0);
  }
  return limb;
}

/// A person of a shipped patient file on one axis that moves a hand about.
struct ShippedPatient {
  RenderedAxis axis;
  Limb limb;
  std::shared_ptr<ActivePatient> acts;
};

std::vector<ShippedPatient> everyPatient() {
  std::vector<ShippedPatient> all;
  for (const auto& [device, axis] :
       {std::pair{"desktop-3axis", kDesktop}, {"lambda-pride", kLambda}}) {
    for (const std::string& patient : shipped("patients")) {
      for (const char* name : {"x", "y", "z"}) {
        const ModelFiles files = shippedFiles(device, "empty", "adult-median-right", patient);
        DeviceModel one = load(files).device;
        std::erase_if(one.axes, [&](const DeviceAxis& of) { return of.name != name; });
        const PatientConfig config = orThrow(loadPatientFile(files.patient, one));
        const PatientAxis& person = config.axes.at(0);
        all.push_back({axis,
                       {.mass = person.mass,
                        .damping = person.damping,
                        .stiffness = person.stiffness,
                        .moves = true},
                       std::make_shared<ActivePatient>(config, one, ResponseWorld::kPeriod_s)});
      }
    }
  }
  return all;
}

/// Knocks, a therapist, held bodies, pulses of an exercise: everything at once.
ResponseWorld honestWorld(const RenderedAxis& axis, const Limb& limb, std::mt19937_64& random) {
  ResponseWorld world(axis, limb, random);
  if (random() % 2 == 0) world.knocks_per_s = uniform(random, 0.0, 6.0);
  if (random() % 3 == 0) world.held_body = uniform(random, 0.02, 1.5);
  if (random() % 4 == 0) {
    world.pulses = uniform(random, 0.0, 1.0);
    world.pulses_hz = uniform(random, 0.3, 12.0);
  }
  const double gain = uniform(random, 0.95, 1.05);
  world.drive = [gain](double effort) { return gain * effort; };
  return world;
}

// People switch off a supervisor that stops without reason. Half of the worlds have a person of a
// shipped patient file, in turn, the others any limb. WHOLEHAND_FULL judges 10^9 ticks.
TEST(BothJudges, HonestDrivesWithEveryPatientKnocksAndTherapists_AreNeverStopped) {
  auto random = seededRandom(5803);
  const std::vector<ShippedPatient> patients = everyPatient();
  const int first = static_cast<int>(random() % patients.size());
  const int lives = fullCounts() ? 50'000 : 100;
  const int ticks = kReducedCounts ? 1'000 : 20'000;
  int stopped = 0, contradictions = 0, excesses = 0;
  for (int life = 0; life < lives; ++life) {
    const ShippedPatient& patient =
        patients[static_cast<std::size_t>(first + life / 2) % patients.size()];
    const bool from_file = life % 2 == 0;
    const RenderedAxis axis = from_file ? patient.axis : random() % 2 == 0 ? kDesktop : kLambda;
    ResponseWorld world =
        honestWorld(axis, from_file ? patient.limb : anyLimb(random, axis.limit), random);
    if (from_file) {
      patient.acts->reset();
      world.person = patient.acts;
    }
    MeasuredEffort measured(axis, random);
    const auto holdAndLetGo = [&](int tick) {
      if (tick % 1000 != 0) return;
      world.therapist_mass = random() % 4 == 0 ? uniform(random, 0.0, 3.0) : 0.0;
    };
    const Verdict verdict = judge(world, axis, ticks, holdAndLetGo, &measured);
    stopped += verdict.astray_after >= 0 ? 1 : 0;
    EXPECT_EQ(verdict.astray_after, -1) << "life " << life;
    contradictions = std::max(contradictions, verdict.contradictions);
    excesses = std::max(excesses, verdict.excesses);
  }
  figure("ticks of honest drives judged by both judges", static_cast<double>(lives) * ticks, "");
  figure("lives that a judge ended", stopped, "");
  figure("most contradictions of one of them", contradictions, "of 6");
  figure("most excesses of one of them", excesses, "of 20");
}

// A sign that is wrong from a moment on. Where the effort then stays at its limit, nothing changes
// that could be judged: such a run is not seen.
TEST(ResponseJudge, TurnedSignBeneathALimb_IsAstrayAndTheTrueOneIsNot) {
  auto random = seededRandom(5804);
  constexpr int runs = 60;
  int seen = 0;
  double most_j = 0.0, unseen_j = 0.0;
  for (int i = 0; i < runs; ++i) {
    const RenderedAxis axis = i % 2 == 0 ? kDesktop : kLambda;
    Limb limb{1.0, 15.0, 300.0};  // relaxed-adult
    ResponseWorld world(axis, limb, random);
    world.pulses = 0.4;  // an exercise with clicks
    world.pulses_hz = 1.5;
    double before_j = 0.0;
    const Verdict verdict = judge(world, axis, 12'000, [&](int tick) {
      if (tick != 5000) return;
      world.drive = [](double effort) { return -effort; };
      before_j = world.work_j();
    });
    ASSERT_TRUE(verdict.astray_after == -1 || verdict.astray_after > 5000);
    if (verdict.astray_after > 5000) {
      ++seen;
      most_j = std::max(most_j, world.work_j() - before_j);
    } else {
      unseen_j = std::max(unseen_j, world.work_j() - before_j);
    }
  }
  figure("turned sign: seen", seen, "runs of 60");
  figure("turned sign: most work before it is seen", most_j, "J");
  figure("turned sign: most work in 7 s of a run that is not seen", unseen_j, "J");
  EXPECT_GE(seen, runs / 2);
  EXPECT_LE(most_j, 1.0);
}

/// A person of a shipped patient file moves a device about, fast and at random, against bodies.
TEST(ResponseJudge, EveryShippedPatientInARenderedScene_IsNeverStopped) {
  auto random = seededRandom(5805);
  double ticks = 0.0;
  for (const std::string& patient : shipped("patients")) {
    Models models =
        load(shippedFiles("lambda-pride", "four-shapes", "adult-median-right", patient));
    const DeviceModel device = models.device;
    const Intention moves = slamming(device, random, clear(device));
    const auto rig = orThrow(buildRig(std::move(models), moves, {}));
    orThrow(rig->renderer->arm());
    ResponseJudge::Models all{};
    for (int a = 0; a < device.axisCount(); ++a) {
      const DeviceAxis& axis = device.axes[static_cast<std::size_t>(a)];
      all[static_cast<std::size_t>(a)] = {axis.mass, axis.damping, 1e-3 * device.output_delay_ticks,
                                          axis.effort_limit};
    }
    ResponseJudge judge(all, device.axisCount(), 1e-3);
    int most = 0;
    runTicks(*rig->renderer, kReducedCounts ? 500 : 2500, [&](const TickRecord& r) {
      ASSERT_FALSE(judge.isAstray(r.q_m)) << patient << " at tick " << r.tick;
      judge.send(r.sent);
      for (int a = 0; a < device.axisCount(); ++a) most = std::max(most, judge.contradictions(a));
      ticks += 1.0;
    });
    std::printf("%s: contradictions count %d at most\n", patient.c_str(), most);
  }
  figure("ticks of rendered patients judged by their response", ticks, "");
}

}  // namespace
}  // namespace wholehand::test
