// What reaches a person's hand when something fails, through the whole tick.
#include "device/faulty_device.hpp"
#include "device/simulated/simulated_device.hpp"
#include "support/rig_tools.hpp"
#include "support/tolerance.hpp"

#include <cmath>
#include <cstring>
#include <random>

namespace wholehand::test {
namespace {

using testing::FaultyDevice;
using testing::InjectedFault;

constexpr double kPeriod_s = 1e-3;
constexpr int kNeutralWithin = 100;  // ticks; 100 ms is the longest ramp allowed

double uniform(std::mt19937_64& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random() >> 11U) * 0x1.0p-53;
}

/// A person who throws the device about: every 150 ms another random place, extremes included.
Intention slamming(const DeviceModel& device, std::mt19937_64& random, const AxisPosition& start) {
  std::vector<Waypoint> waypoints{{0.0, start}};
  for (int i = 1; i <= 15; ++i) {
    AxisPosition q(device.axisCount());
    for (int a = 0; a < q.size(); ++a) {
      const DeviceAxis& axis = device.axes[a];
      q[a] =
          std::clamp(uniform(random, -0.2, 1.2), 0.0, 1.0) * (axis.upper - axis.lower) + axis.lower;
    }
    waypoints.push_back({0.15 * i, q});
  }
  return Intention::throughWaypoints(std::move(waypoints));
}

/// A hand that stands clear of the shipped scenes' bodies: high, open, fingers away.
AxisPosition clear(const DeviceModel& device) {
  AxisPosition q(device.axisCount());
  for (int a = 0; a < q.size(); ++a) {
    const DeviceAxis& axis = device.axes[a];
    if (axis.name == "z") q[a] = 0.95 * axis.upper;
    if (axis.name == "x") q[a] = 0.95 * axis.lower;
  }
  return q;
}

/// A device whose own weight must be carried, so that neutral is not zero.
Models withWeight(Models m) {
  for (DeviceAxis& axis : m.device.axes) axis.neutral_effort = 0.05 * axis.effort_limit;
  return m;
}

struct FaultyRig {
  std::unique_ptr<SimulatedDevice> inner;
  std::unique_ptr<Rig> rig;
  FaultyDevice* device = nullptr;
};

FaultyRig faultyRig(std::vector<InjectedFault> faults, std::mt19937_64& random) {
  FaultyRig out;
  Models m = withWeight(
      load(shippedFiles("lambda-pride", "four-shapes", "adult-median-right", "stiff-adult")));
  out.inner = std::make_unique<SimulatedDevice>(
      m.device, m.patient, slamming(m.device, random, clear(m.device)), kPeriod_s);
  auto device = std::make_unique<FaultyDevice>(*out.inner, std::move(faults));
  out.device = device.get();
  out.rig = build(std::move(m), std::move(device));
  return out;
}

std::vector<TickRecord> run(FaultyRig& f, int ticks, int first_tick = 0) {
  std::vector<TickRecord> records;
  records.reserve(static_cast<std::size_t>(ticks));
  runTicks(
      *f.rig->renderer, ticks,
      [&](const TickRecord& r) {
        records.push_back(r);
        EXPECT_EQ(std::memcmp(r.sent.data(), f.device->written().data(),
                              sizeof(double) * static_cast<std::size_t>(r.sent.size())),
                  0);
      },
      first_tick);
  return records;
}

void expectWithinLimits(const Rig& rig, const TickRecord& r) {
  for (int a = 0; a < r.sent.size(); ++a) {
    ASSERT_LE(std::abs(r.sent[a]), rig.models.device.axes[a].effort_limit) << "tick " << r.tick;
  }
}

/// From `from` on: away from what was sent before to neutral, no step steeper than the smoothstep's
/// 1.5 / ramp, arrived within 100 ms and there to stay.
void expectRamp(const Rig& rig, const std::vector<TickRecord>& records, int from) {
  const RendererConfig& config = rig.renderer->config();
  const AxisEffort& neutral = config.neutral;
  const AxisEffort held = records[from - 1].sent;
  const double steepest = 1.5 / config.ramp.ramp_s * kPeriod_s;
  for (int k = from; k < static_cast<int>(records.size()); ++k) {
    for (int a = 0; a < held.size(); ++a) {
      const double before = records[k - 1].sent[a] - neutral[a];
      const double now = records[k].sent[a] - neutral[a];
      const double span = std::abs(held[a] - neutral[a]);
      ASSERT_LE(std::abs(now), std::abs(before) + 1e-15) << "tick " << k;
      ASSERT_LE(std::abs(now - before), steepest * span + 1e-12) << "tick " << k;
      if (k == from && span > 1e-6) {
        ASSERT_LT(std::abs(now), span);
      }
      if (k >= from + kNeutralWithin) {
        ASSERT_EQ(records[k].sent[a], neutral[a]) << "tick " << k;
      }
    }
    ASSERT_LT(records[k].authority, records[from - 1].authority);
  }
  EXPECT_TRUE(rig.renderer->atNeutral());
  EXPECT_EQ(records.back().authority, 0.0);
}

void expectWorldStands(const std::vector<TickRecord>& records, int from) {
  const TickRecord& still = records[from];
  for (std::size_t k = from + 1; k < records.size(); ++k) {
    const TickRecord& r = records[k];
    ASSERT_EQ(std::memcmp(r.q_s.data(), still.q_s.data(), sizeof(double) * r.q_s.size()), 0) << k;
    ASSERT_EQ(std::memcmp(r.bodies.data(), still.bodies.data(), sizeof(BodyState) * r.body_count),
              0)
        << k;
  }
}

struct Failure {
  const char* name;
  InjectedFault::Kind kind;
  Fault told;
  int delay;  ///< ticks until the ramp begins: a failed write is known only after it
};

class InjectedFailure : public ::testing::TestWithParam<Failure> {};

TEST_P(InjectedFailure, AtARandomTick_RampsToNeutralAndStaysThereUntilArmed) {
  const Failure failure = GetParam();
  const std::uint64_t seed = 20251120;
  std::printf("seed: %llu\n", static_cast<unsigned long long>(seed));
  std::mt19937_64 random(seed);
  for (int i = 0; i < cases(3); ++i) {
    const int at = static_cast<int>(uniform(random, 20, 1000));  // some while the force engages
    const int lasts = static_cast<int>(uniform(random, 0, 60));
    const int axis = static_cast<int>(uniform(random, 0, 6));
    // arm() is the device's first read.
    FaultyRig f = faultyRig({{failure.kind, at + 1, at + 1 + lasts, axis}}, random);
    ASSERT_TRUE(f.rig->renderer->arm());
    const std::vector<TickRecord> records = run(f, at + 300);
    ASSERT_EQ(records[at - 1].faults & kStopping, Fault::kNone);
    EXPECT_EQ(records[at].faults & kStopping, failure.told);
    for (const TickRecord& r : records) expectWithinLimits(*f.rig, r);
    expectRamp(*f.rig, records, at + failure.delay);
    expectWorldStands(records, at);

    // Armed again, it renders again: from neutral, without a step.
    const Expected<Done> armed = f.rig->renderer->arm();
    if (!armed) continue;  // a body has come to rest where the device starts: refused, and rightly
    const std::vector<TickRecord> again = run(f, 15);
    EXPECT_FALSE(f.rig->renderer->atNeutral());
    EXPECT_GT(again.back().authority, 0.0);
    EXPECT_LT(again.front().authority, 1e-3);
  }
}
INSTANTIATE_TEST_SUITE_P(
    Kinds, InjectedFailure,
    ::testing::Values(
        Failure{"NanPosition", InjectedFault::Kind::kNanPosition, Fault::kNonFinitePosition, 0},
        Failure{"InfinitePosition", InjectedFault::Kind::kInfinitePosition,
                Fault::kNonFinitePosition, 0},
        Failure{"ReadFails", InjectedFault::Kind::kReadFails, Fault::kDeviceRead, 0},
        Failure{"WriteFails", InjectedFault::Kind::kWriteFails, Fault::kDeviceWrite, 1}),
    [](const auto& tested) { return std::string(tested.param.name); });

TEST(StopRequest, WhileRendering_RampsToNeutralAndStays) {
  std::mt19937_64 random(5);
  FaultyRig f = faultyRig({}, random);
  ASSERT_TRUE(f.rig->renderer->arm());
  std::vector<TickRecord> records = run(f, 700);
  f.rig->renderer->requestStop();
  const std::vector<TickRecord> after = run(f, 300, 700);
  records.insert(records.end(), after.begin(), after.end());
  EXPECT_EQ(records[699].faults & Fault::kStopRequested, Fault::kNone);
  EXPECT_EQ(records[700].faults & Fault::kStopRequested, Fault::kStopRequested);
  for (const TickRecord& r : records) expectWithinLimits(*f.rig, r);
  expectRamp(*f.rig, records, 700);
}

TEST(LateTicks, AtRandom_AreToldAndStayWithinTheLimits) {
  std::mt19937_64 random(11);
  FaultyRig f = faultyRig({}, random);
  ASSERT_TRUE(f.rig->renderer->arm());
  TickRecord r;
  for (int k = 0; k < 1500; ++k) {
    // One tick in ten is late, by up to 30 ms.
    const auto late = random() % 10 == 0 ? static_cast<std::uint32_t>(random() % 30) : 0U;
    f.rig->renderer->tick(1 + late, r);
    ASSERT_EQ(any(r.faults & Fault::kLateTick), late > 0) << k;
    ASSERT_EQ(r.faults & kStopping, Fault::kNone) << k;
    expectWithinLimits(*f.rig, r);
    ASSERT_TRUE(allFinite(r.sent));
  }
}

class SlammingPatient : public ::testing::TestWithParam<std::pair<std::string, std::string>> {};

TEST_P(SlammingPatient, InAScene_NeverFeelsMoreThanTheDevicesLimits) {
  const auto [device, scene] = GetParam();
  const std::uint64_t seed = 7;
  std::printf("seed: %llu\n", static_cast<unsigned long long>(seed));
  std::mt19937_64 random(seed);
  for (int i = 0; i < cases(2); ++i) {
    Models m = withWeight(load(shippedFiles(device, scene, "adult-median-right", "stiff-adult")));
    // Limits so low that they are met, and met on both sides.
    for (DeviceAxis& axis : m.device.axes) {
      axis.effort_limit *= 0.25;
      axis.neutral_effort *= 0.25;
    }
    Intention intention = slamming(m.device, random, clear(m.device));
    const auto rig = orThrow(buildRig(std::move(m), std::move(intention), {}));
    const Expected<Done> armed = rig->renderer->arm();
    ASSERT_TRUE(armed) << format(armed.errors());
    int limited = 0;
    runTicks(*rig->renderer, 2000, [&](const TickRecord& r) {
      expectWithinLimits(*rig, r);
      ASSERT_TRUE(allFinite(r.sent));
      ASSERT_EQ(r.faults & kStopping, Fault::kNone) << "tick " << r.tick;
      // While the force engages, what is sent comes in smoothly: at most the limit's share.
      if (r.tick < 200) {
        for (int a = 0; a < r.sent.size(); ++a) {
          ASSERT_LE(std::abs(r.sent[a] - rig->renderer->config().neutral[a]),
                    2.0 * r.authority * rig->models.device.axes[a].effort_limit + 1e-12);
        }
      }
      limited += any(r.faults & Fault::kEffortLimit) ? 1 : 0;
    });
    EXPECT_GT(limited, 0);  // the limit was needed
  }
}
INSTANTIATE_TEST_SUITE_P(
    DevicesAndScenes, SlammingPatient,
    ::testing::Values(std::pair<std::string, std::string>{"lambda-pride", "four-shapes"},
                      std::pair<std::string, std::string>{"lambda-pride", "table"},
                      std::pair<std::string, std::string>{"desktop-3axis", "four-shapes"},
                      std::pair<std::string, std::string>{"wrist-9axis", "four-shapes"}),
    [](const auto& tested) {
      std::string name = tested.param.first + tested.param.second;
      std::erase_if(name, [](char c) { return c == '-'; });
      return name;
    });

}  // namespace
}  // namespace wholehand::test
