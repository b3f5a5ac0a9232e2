// Every kind of stop at every moment only lets go. The effort is judged at the device.
#include "fault_injection/fault_bench.hpp"
#include "runtime/session.hpp"
#include "support/tolerance.hpp"

namespace wholehand::test {
namespace {

enum class StopKind { kPlain, kEmergency, kGentle };
constexpr int kLastTick = 400;

/// What docs/safety.md says of the share that is left: 1 − (3u² − 2u³) of u = time / duration.
double shareLeft(double time_s, double duration_s) {
  const double u = std::min(time_s / duration_s, 1.0);
  return 1.0 - u * u * (3.0 - 2.0 * u);
}

struct Stop {
  StopKind kind = StopKind::kPlain;
  int asked_after = -1;     ///< tick; -1: before the first
  double fade_out_s = 0.0;  ///< of the exercise

  [[nodiscard]] double duration_s() const {
    return 0.08 + (kind == StopKind::kGentle ? fade_out_s : 0.0);
  }
};

void ask(Session& session, StopKind kind) {
  if (kind == StopKind::kPlain) session.requestStop();
  if (kind == StopKind::kEmergency) session.requestEmergencyStop();
  if (kind == StopKind::kGentle) session.requestGentleStop();
}

/// Runs a bench until it has ended: the efforts that the device held, tick by tick.
std::vector<AxisEffort> heldEfforts(Bench& bench, const Stop& stop) {
  SessionConfig config;
  config.fade_out_s = stop.fade_out_s;
  Session session(bench.renderer, config);
  EXPECT_TRUE(bench.renderer.arm());
  if (stop.asked_after < 0) ask(session, stop.kind);
  std::vector<AxisEffort> held;
  session.runSimulated([&](const TickRecord& record) {
    held.push_back(bench.accepting.held());
    if (static_cast<int>(record.tick) == stop.asked_after) ask(session, stop.kind);
  });
  return held;
}

/// Empty where the law holds; else what broke it first.
std::string faultOf(const std::vector<AxisEffort>& held, const Stop& stop,
                    const AxisEffort& neutral) {
  const int seen = stop.asked_after + 1;
  const AxisEffort before = seen == 0 ? neutral : held[static_cast<std::size_t>(seen) - 1];
  for (int k = seen; k < static_cast<int>(held.size()); ++k) {
    const double most = shareLeft((k - seen + 1) * kPeriod_s, stop.duration_s());
    for (int a = 0; a < neutral.size(); ++a) {
      const double was = before[a] - neutral[a];
      const double is = held[static_cast<std::size_t>(k)][a] - neutral[a];
      const bool between = is * was >= 0.0 && std::abs(is) <= most * std::abs(was) + 1e-12;
      if (!between) {
        return "tick " + std::to_string(k) + ", axis " + std::to_string(a) + ": " +
               std::to_string(is) + " of " + std::to_string(was) +
               " N at the stop; at most a share of " + std::to_string(most);
      }
    }
  }
  const int ticks = static_cast<int>(held.size()) - seen;
  if (!same(held.back(), neutral)) return "it ended beside neutral";
  if (ticks * kPeriod_s > stop.duration_s() + 0.03)
    return std::to_string(ticks) + " ticks to neutral";
  return {};
}

const Workbench& benchOf(std::size_t device) {
  static const std::array<Workbench, 3> all{Workbench("lambda-pride"), Workbench("desktop-3axis"),
                                            Workbench("wrist-9axis")};
  return all[device];
}

// Law: from the tick that sees a stop on, the effort of each axis stays between neutral and a share
// of what it was, which only falls: in 80 ms, after a gentle stop in fade_out_s + 80 ms.
TEST(StopAtAnyTick, OfEveryKind_OnlyLetsGo) {
  auto random = seededRandom(3401);
  int pushed = 0;
  for (int i = 0; i < cases(3000); ++i) {
    const Workbench& bench = benchOf(random() % 3);
    RendererConfig config = bench.config();
    config.moves_nobody = true;
    Bench run(bench, {}, random, config);
    Stop stop{static_cast<StopKind>(random() % 3), static_cast<int>(random() % (kLastTick + 1)) - 1,
              uniform(random, 0.0, 0.6)};
    const std::vector<AxisEffort> held = heldEfforts(run, stop);
    ASSERT_GT(static_cast<int>(held.size()), stop.asked_after + 1);
    ASSERT_EQ(faultOf(held, stop, config.safety.neutral), "")
        << "case " << i << ": kind " << static_cast<int>(stop.kind) << ", asked after tick "
        << stop.asked_after << ", fade-out " << stop.fade_out_s << " s, "
        << bench.models().device.name;
    const AxisEffort& last = held[static_cast<std::size_t>(std::max(stop.asked_after, 0))];
    pushed +=
        std::abs(last[0] - config.safety.neutral[0]) > 0.3 * config.safety.effort_limit[0] ? 1 : 0;
  }
  if (kCountsTell) {
    EXPECT_GT(pushed, 100) << "hardly a stop came while it pushed";
  }
}

}  // namespace
}  // namespace wholehand::test
