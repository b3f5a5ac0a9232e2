// Every kind of stop at every moment only reduces the effort, measured at the device.
#include "loop/fault_injection/fault_bench.hpp"
#include "support/tolerance.hpp"

namespace wholehand::test {
namespace {

enum class StopKind { kPlain, kEmergency, kGentle };
constexpr int kLastTick = 400;

/// Share that is left according to docs/safety.md: 1 − (3u² − 2u³) with u = time / duration.
double shareLeft(double time_s, double duration_s) {
  const double u = std::min(time_s / duration_s, 1.0);
  return 1.0 - u * u * (3.0 - 2.0 * u);
}

struct Stop {
  StopKind kind = StopKind::kPlain;
  int seen_in = 0;          ///< tick that sees it; it is requested before
  double fade_out_s = 0.0;  ///< fade-out time of the exercise
  int plain_in = -1;        ///< tick that also sees a plain stop; -1: none
  double period_s = kPeriod_s;

  [[nodiscard]] double duration_s() const {
    return 0.08 + (kind == StopKind::kGentle ? fade_out_s : 0.0);
  }
};

void ask(HapticRenderer& renderer, StopKind kind) {
  if (kind == StopKind::kPlain) renderer.requestStop();
  if (kind == StopKind::kEmergency) renderer.requestEmergencyStop();
  if (kind == StopKind::kGentle) renderer.requestGentleStop();
}

/// Effort that the device held after each tick until the end, and its time.
struct HeldEfforts {
  std::vector<AxisEffort> held;
  std::vector<double> time_s;  ///< elapsed time, including skipped periods
};

HeldEfforts runToTheEnd(Bench& bench, const Stop& stop, std::mt19937_64& random) {
  HeldEfforts run;
  EXPECT_TRUE(bench.renderer.arm());
  double now_s = 0.0;
  while (!bench.renderer.finished() && run.held.size() < 5000) {
    const int tick = static_cast<int>(run.held.size());
    if (tick == stop.seen_in) ask(bench.renderer, stop.kind);
    if (tick == stop.plain_in) bench.renderer.requestStop();
    const std::uint32_t periods = tick > 0 && random() % 32 == 0 ? 2 : 1;
    bench.renderer.tick(periods, bench.record);
    bench.record.command_count = 0;
    now_s += periods * stop.period_s;
    run.held.push_back(bench.accepting.held());
    run.time_s.push_back(now_s);
  }
  return run;
}

/// Empty if the rule holds; otherwise the first violation.
std::string faultOf(const HeldEfforts& run, const Stop& stop, const AxisEffort& neutral) {
  const auto seen = static_cast<std::size_t>(stop.seen_in);
  const AxisEffort before = seen == 0 ? neutral : run.held[seen - 1];
  for (std::size_t k = seen; k < run.held.size(); ++k) {
    // The tick that sees the stop counts as one period.
    const double most =
        shareLeft(run.time_s[k] - run.time_s[seen] + stop.period_s, stop.duration_s());
    for (int a = 0; a < neutral.size(); ++a) {
      const double was = before[a] - neutral[a];
      const double is = run.held[k][a] - neutral[a];
      if (is * was >= 0.0 && std::abs(is) <= most * std::abs(was) + 1e-9) continue;
      return "tick " + std::to_string(k) + ", axis " + std::to_string(a) + ": " +
             std::to_string(is) + " of " + std::to_string(was) +
             " N at the stop; at most a share of " + std::to_string(most);
    }
  }
  if (!same(run.held.back(), neutral)) return "it ended beside neutral";
  const double took_s = run.time_s.back() - run.time_s[seen] + stop.period_s;
  if (took_s > stop.duration_s() + 0.03) return "it took " + std::to_string(took_s) + " s";
  return {};
}

const Workbench& drawnBench(std::mt19937_64& random) {
  static const std::array<Workbench, 6> all{Workbench("lambda-pride"),
                                            Workbench("desktop-3axis"),
                                            Workbench("wrist-9axis"),
                                            Workbench("lambda-pride", "woman-p05-left", 5e-4),
                                            Workbench("desktop-3axis", "man-p95-right", 2.5e-4),
                                            Workbench("wrist-9axis", "man-p05-left", 8e-4)};
  return all[random() % all.size()];
}

// Rule: from the tick that sees a stop, the effort of each axis stays between neutral and a share
// of its earlier value. The share only falls: in 80 ms, after a gentle stop in fade_out_s + 80 ms.
TEST(StopAtAnyTick, EveryKind_OnlyReducesTheEffort) {
  auto random = seededRandom(3401);
  int pushed = 0;
  const int count = cases(3000);
  for (int i = 0; i < count; ++i) {
    const Workbench& bench = drawnBench(random);
    Stop stop;
    stop.period_s = bench.period_s;
    stop.kind = static_cast<StopKind>(random() % 3);
    stop.seen_in = static_cast<int>(random() % kLastTick);
    stop.fade_out_s = uniform(random, 0.0, 0.6);
    if (random() % 4 == 0) stop.plain_in = stop.seen_in + static_cast<int>(random() % 600);
    RendererConfig config = bench.config();
    config.moves_nobody = true;
    config.safety.ramp.fade_out_s = stop.fade_out_s;
    Bench run(bench, {}, random, config);
    const HeldEfforts ran = runToTheEnd(run, stop, random);
    const std::string where =
        "case " + std::to_string(i) + ": kind " + std::to_string(static_cast<int>(stop.kind)) +
        ", seen in tick " + std::to_string(stop.seen_in) + ", fade-out " +
        std::to_string(stop.fade_out_s) + " s, " + bench.models().device.name + ", " +
        std::to_string(1e3 * stop.period_s) + " ms, faults " + faultNames(run.renderer.latched());
    if (static_cast<int>(ran.held.size()) <= stop.seen_in) continue;  // a fault came first
    ASSERT_EQ(faultOf(ran, stop, config.safety.neutral), "") << where;
    const AxisEffort& last = ran.held[static_cast<std::size_t>(std::max(stop.seen_in - 1, 0))];
    const double effort = std::abs(last[0] - config.safety.neutral[0]);
    pushed += effort > 0.3 * config.safety.effort_limit[0] ? 1 : 0;
  }
  EXPECT_GT(pushed, count / 30) << "hardly a stop came while it pushed";
}

}  // namespace
}  // namespace wholehand::test
