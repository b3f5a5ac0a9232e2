// The judge of the response: honest drives, which it must never stop, and drives that lie.
#include "devices/plugin/response_judge.hpp"

#include "devices/response_world.hpp"
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

struct Verdict {
  int astray_after = -1;  ///< ticks; -1: never
  int contradictions = 0, excesses = 0;
};

/// The judge beside a world, as PluginDevice calls it.
Verdict judge(ResponseWorld& world, const RenderedAxis& axis, int ticks,
              const std::function<void(int tick)>& before = {}) {
  ResponseJudge judge = judgeOf(axis);
  Verdict out;
  for (int k = 0; k < ticks; ++k) {
    if (before) before(k);
    const bool astray = judge.isAstray(AxisPosition(1, world.read()));
    out.contradictions = std::max(out.contradictions, judge.contradictions(0));
    out.excesses = std::max(out.excesses, judge.excesses(0));
    if (astray && out.astray_after < 0) out.astray_after = k;
    if (astray) break;
    world.pass();
    judge.send(AxisEffort(1, world.sent()));
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

/// Knocks, a therapist, held bodies, pulses of an exercise: everything at once.
ResponseWorld honestWorld(const RenderedAxis& axis, std::mt19937_64& random) {
  ResponseWorld world(axis, anyLimb(random, axis.limit), random);
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

// People switch off a supervisor that stops without reason. WHOLEHAND_FULL judges 10^9 ticks.
TEST(ResponseJudge, HonestDrivesWithKnocksAndTherapists_AreNeverStopped) {
  auto random = seededRandom(5803);
  const double most = fullCounts() ? 1e9 : kReducedCounts ? 5e4 : 1e6;
  double ticks = 0.0;
  int contradictions = 0, excesses = 0;
  while (ticks < most) {
    const RenderedAxis axis = random() % 2 == 0 ? kDesktop : kLambda;
    ResponseWorld world = honestWorld(axis, random);
    const Verdict verdict = judge(world, axis, 20'000, [&](int tick) {
      if (tick % 1000 == 0) {
        world.therapist_mass = random() % 4 == 0 ? uniform(random, 0.0, 3.0) : 0.0;
      }
    });
    ASSERT_EQ(verdict.astray_after, -1) << "after " << ticks << " ticks";
    contradictions = std::max(contradictions, verdict.contradictions);
    excesses = std::max(excesses, verdict.excesses);
    ticks += 20'000;
  }
  figure("ticks of honest drives judged by their response", ticks, "");
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
