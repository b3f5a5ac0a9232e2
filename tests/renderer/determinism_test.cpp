// The same inputs give the same bits, whatever else happened in the process.
#include "device/replay/replay_device.hpp"
#include "support/rig_tools.hpp"

#include <cmath>
#include <cstring>

namespace wholehand::test {
namespace {

constexpr int kTicks = 4000;

/// FNV-1a over every field of a record that is re-simulated; times of the machine are not.
class RecordHash {
 public:
  std::uint64_t operator()(const TickRecord& r) {
    hash_ = 14695981039346656037ULL;
    add(r.tick), add(r.time_s), add(r.elapsed_periods), add(r.faults);
    arrays(r.q_m, r.qd_mf, r.q_s, r.qd_s, r.theta, r.f_s, r.coupling, r.phi, r.damping, r.rendered,
           r.sent);
    add(r.coupling_error_rad), add(r.palm_distance_m), add(r.authority);
    for (int i = 0; i < r.body_count; ++i) add(r.bodies[i]);
    add(r.contacts_dropped);
    for (int i = 0; i < r.contact_count; ++i) add(r.contacts[i]);
    return hash_;
  }

 private:
  void bytes(const void* data, std::size_t count) {
    const auto* p = static_cast<const unsigned char*>(data);
    for (std::size_t i = 0; i < count; ++i) hash_ = (hash_ ^ p[i]) * 1099511628211ULL;
  }
  template <class T>
  void add(const T& value) {
    bytes(&value, sizeof value);
  }
  template <class... Array>
  void arrays(const Array&... a) {
    (bytes(a.data(), sizeof(double) * static_cast<std::size_t>(a.size())), ...);
  }
  std::uint64_t hash_ = 0;
};

/// Sweeps over the table: a mesh, a URDF and bodies that touch each other.
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
  std::vector<std::uint64_t> hashes;
  std::vector<RecordedReading> readings;
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
  RecordHash hash;
  // What arm() reads is the recording's first reading.
  if (!rig.renderer->arm()) throw std::runtime_error("not armed");
  DeviceReading armed;
  armed.q_m = rig.renderer->armedPosition();
  run.readings.push_back({armed, {}});
  runTicks(*rig.renderer, kTicks, [&](const TickRecord& r) {
    run.hashes.push_back(hash(r));
    run.readings.push_back({{r.q_m}, {r.intention, r.patient_effort}, r.elapsed_periods, r.faults});
    run.touching_ticks += r.contact_count > 0 ? 1 : 0;
    if (between && r.tick % 100 == 0) between();
  });
  return run;
}

void expectSame(const Played& a, const Played& b) {
  ASSERT_EQ(a.hashes.size(), b.hashes.size());
  for (std::size_t k = 0; k < a.hashes.size(); ++k) {
    ASSERT_EQ(a.hashes[k], b.hashes[k]) << "first difference in tick " << k;
  }
}

class SameInputs : public testing::TestWithParam<std::unique_ptr<Rig> (*)()> {};

TEST_P(SameInputs, TwoRigsInOneProcess_GiveTheSameBits) {
  const Played first = play(*GetParam()());
  EXPECT_GT(first.touching_ticks, 100);  // objects are met: free motion alone would prove little
  // Another world lives, steps and dies meanwhile, so that memory and addresses differ.
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

TEST_P(SameInputs, ReplayedReadings_GiveTheSameBits) {
  const Played recorded = play(*GetParam()());
  auto device = std::make_unique<ReplayDevice>(recorded.readings);
  const KnownPerson& person = *device;
  const Played replayed =
      play(*orThrow(buildRigWithoutPerson(GetParam()()->models, std::move(device), {}, &person)));
  expectSame(recorded, replayed);
}
INSTANTIATE_TEST_SUITE_P(Scenes, SameInputs, testing::Values(&recordedHand, &sweepingHand));

TEST(RecordHash, OneLastBitOfOneReading_ChangesTheHash) {
  // The hash can fail.
  TickRecord a{}, b{};
  a.q_m = b.q_m = AxisPosition(6, 0.1);
  RecordHash hash;
  ASSERT_EQ(hash(a), hash(b));
  b.q_m[5] = std::nextafter(0.1, 1.0);
  EXPECT_NE(hash(a), hash(b));
}

}  // namespace
}  // namespace wholehand::test
