// The same inputs give the same bits, whatever else happened in the process.
#include "loop/core/tick_digest.hpp"
#include "support/rig_tools.hpp"

namespace wholehand::test {
namespace {

constexpr int kTicks = 4000;

/// A hand that sweeps over the table: a mesh, a URDF body and bodies that touch each other.
std::unique_ptr<Rig> sweepingHand() {
  Models m = load(shippedFiles("lambda-pride", "table"));
  AxisPosition above(6), along(6), beyond(6);
  above[0] = along[0] = -0.08;
  above[2] = 0.11;
  along[2] = beyond[2] = -0.03;
  beyond[0] = 0.08;
  along[1] = -0.1;
  beyond[1] = 0.1;
  along[3] = beyond[3] = 1.0;
  Intention sweep = Intention::throughWaypoints(
      {{0.0, above}, {1.0, along}, {2.0, beyond}, {3.0, along}, {4.0, beyond}});
  return orThrow(buildRig(std::move(m), std::move(sweep), {}));
}

struct Played {
  std::vector<std::uint64_t> digests;
  int touching_ticks = 0;
};

std::unique_ptr<Rig> recordedHand() {
  ModelFiles files = shippedFiles("lambda-pride", "four-shapes");
  files.motion = std::string(WHOLEHAND_SOURCE_DIR) + "/data/human-motion/reach-grasp-00.csv";
  Models m = load(files);
  Intention intention =
      Intention::fromMotion(*m.motion, m.patient.motion, m.device, m.hand.reference, nullptr);
  return orThrow(buildRig(std::move(m), std::move(intention), {}));
}

Played play(Rig& rig, const std::function<void()>& between = {}) {
  Played run;
  if (!rig.renderer->arm()) throw std::runtime_error("not armed");
  runTicks(*rig.renderer, kTicks, [&](const TickRecord& r) {
    run.digests.push_back(digestOf(r));
    run.touching_ticks += r.contact_count > 0 ? 1 : 0;
    if (between && r.tick % 100 == 0) between();
  });
  return run;
}

void expectSame(const Played& a, const Played& b) {
  ASSERT_EQ(a.digests.size(), b.digests.size());
  for (std::size_t k = 0; k < a.digests.size(); ++k) {
    ASSERT_EQ(a.digests[k], b.digests[k]) << "first difference in tick " << k;
  }
}

class SameInputs : public testing::TestWithParam<std::unique_ptr<Rig> (*)()> {};

TEST_P(SameInputs, TwoRigsInOneProcess_GiveTheSameBits) {
  const Played first = play(*GetParam()());
  EXPECT_GT(first.touching_ticks,
            100);  // objects are touched: free motion alone would prove little
  // Another world is built, stepped and destroyed meanwhile, so that memory and addresses differ.
  const Models other_models = load(shippedFiles("wrist-9axis", "table"));
  const auto other = buildScripted(other_models, [&](int) {
    AxisPosition q(other_models.device.axisCount());
    q[2] = 0.11;
    return q;
  });
  ASSERT_TRUE(other->renderer->arm());
  const Played second = play(*GetParam()(), [&] { runTicks(*other->renderer, 1); });
  expectSame(first, second);
}

INSTANTIATE_TEST_SUITE_P(Scenes, SameInputs, testing::Values(&recordedHand, &sweepingHand));

}  // namespace
}  // namespace wholehand::test
