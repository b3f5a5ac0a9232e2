// Every shipped hand on every shipped device in every shipped scene.
#include "support/rig_tools.hpp"
#include "support/seed.hpp"
#include "support/shipped.hpp"

#include <cmath>

namespace wholehand::test {
namespace {

/// From back and above, `aside` of the way to the left, into the middle, closing.
Intention reachIn(const DeviceModel& device, double aside) {
  AxisPosition start(device.axisCount()), end(device.axisCount());
  for (int a = 0; a < start.size(); ++a) {
    const DeviceAxis& axis = device.axes[a];
    if (axis.name == "x") start[a] = 0.95 * axis.lower;
    if (axis.name == "y") start[a] = aside * axis.upper;
    if (axis.name == "z") start[a] = 0.95 * axis.upper;
    if (axis.group == AxisGroup::kHand) end[a] = 0.6 * axis.upper;
    if (axis.kind == AxisKind::kRotation && axis.group == AxisGroup::kBase) end[a] = 0.2;
  }
  return Intention::throughWaypoints({{0.0, start}, {0.8, end}});
}

/// Built and armed, or null where the hand would start inside a body.
std::shared_ptr<Rig> armed(const std::string& device, const std::string& scene,
                           const std::string& hand, double aside) {
  Models m = load(shippedFiles(device, scene, hand));
  Intention intention = reachIn(m.device, aside);
  // Certified, too: `uncertified` is not set.
  std::shared_ptr<Rig> rig = orThrow(buildRig(std::move(m), std::move(intention), {}));
  return rig->renderer->arm() ? rig : nullptr;
}

class EveryFile : public testing::TestWithParam<std::string> {};

TEST_P(EveryFile, OnThisDevice_BuildsArmsAndRunsASecond) {
  const std::string& device = GetParam();
  const std::vector<std::string> hands = shippedHands(seed(), cases(1) > 1);
  const std::vector<std::string> scenes = shipped("scenes");
  ASSERT_GE(hands.size(), 7U);
  ASSERT_GE(scenes.size(), 3U);
  int touching = 0;
  std::size_t index = 0;
  for (const std::string& hand : hands) {
    for (const std::string& scene : scenes) {
      // Sampled: every hand, and every scene with some hand; which with which, by the seed.
      const std::size_t pair = index++;
      const std::size_t due = (pair / scenes.size() + seed()) % scenes.size();
      if (cases(1) == 1 && pair % scenes.size() != due) continue;
      if (leftOutUnderASanitizer(pair / scenes.size())) continue;
      SCOPED_TRACE(hand + " in " + scene);
      // Small devices must begin beside what stands in the middle.
      std::shared_ptr<Rig> rig = armed(device, scene, hand, 0.0);
      if (!rig) rig = armed(device, scene, hand, 0.95);
      ASSERT_NE(rig, nullptr) << "starts inside a body wherever it starts";
      double coupling_error = 0.0;
      int touched = 0;
      runTicks(*rig->renderer, 1000, [&](const TickRecord& r) {
        ASSERT_EQ(r.faults & kStopping, Fault::kNone) << "tick " << r.tick;
        ASSERT_EQ(r.contacts_dropped, 0);
        for (int i = 0; i < r.body_count; ++i) {
          ASSERT_LT(r.bodies[i].velocity_m_s.eigen().norm(), 10.0) << "tick " << r.tick;
        }
        coupling_error = std::max(coupling_error, r.coupling_error_rad);
        touched += r.contact_count > 0 ? 1 : 0;
      });
      EXPECT_LE(coupling_error, tolerance(1e-5));
      touching += touched > 0 ? 1 : 0;
    }
  }
  if (kCountsTell) {
    EXPECT_GT(touching, 0);
  }
}
INSTANTIATE_TEST_SUITE_P(Devices, EveryFile, testing::ValuesIn(shipped("devices")),
                         [](const auto& tested) {
                           std::string name = tested.param;
                           std::erase_if(name, [](char c) { return c == '-'; });
                           return name;
                         });

}  // namespace
}  // namespace wholehand::test
