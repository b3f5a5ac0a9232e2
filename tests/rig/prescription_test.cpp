// A prescription through the whole loop: its file, its share of the certificate, its efforts, and
// its recording.
#include "certify/certificate.hpp"
#include "files/patient/prescription_file.hpp"
#include "replay/resimulation/resimulation.hpp"
#include "rig/prescribed_guides.hpp"
#include "support/contains.hpp"
#include "support/file_bytes.hpp"
#include "support/folder.hpp"
#include "support/recorded_run.hpp"
#include "support/seed.hpp"

#include <algorithm>
#include <cmath>

namespace wholehand::test {
namespace {

const std::string kExample =
    std::string(WHOLEHAND_SOURCE_DIR) + "/config/prescriptions/right-arm.toml";

constexpr const char* kHead = "kind = \"prescription\"\nversion = 1\nname = \"a\"\n";
constexpr const char* kLimitX = "[[limits]]\naxis = \"x\"\nwithin_m = [-0.05, 0.06]\n";

/// Faults of a file with these lines after its head; empty: none.
std::string faultsOf(const std::string& lines, const std::string& device = "lambda-pride") {
  const Folder folder;
  ModelFiles files = shippedFiles(device);
  files.prescription = folder.write("a.toml", kHead + lines);
  const auto models = loadModels(files);
  return models ? "" : format(models.errors());
}

TEST(PrescriptionFile, FaultyFiles_AreRefusedWithKeyValueAndRemedy) {
  const std::string right = "side = \"right\"\n";
  EXPECT_EQ(faultsOf(right), "");
  EXPECT_EQ(faultsOf(right + kLimitX), "");
  // The device's own end in single precision, as a page knows it.
  EXPECT_EQ(faultsOf(right + "[[limits]]\naxis = \"x\"\nwithin_m = [-0.08500000089406967, 0.05]\n"),
            "");
  struct Case {
    std::string lines, key, expected;
  };
  for (const Case& c : std::initializer_list<Case>{
           {"side = \"left\"\n", "side", "choose the other hand"},
           {"side = \"up\"\n", "side", "right"},
           {right + "[[limits]]\naxis = \"w\"\nwithin_m = [0, 1]\n", "axis", "is not an axis"},
           {right + "[[limits]]\naxis = \"finger_flex\"\nwithin_m = [0, 1]\n", "axis",
            "did you mean finger_flexion?"},
           {right + kLimitX + kLimitX, "axis", "has a limit already"},
           {right + "[[limits]]\naxis = \"x\"\nwithin_m = [0.06, -0.05]\n", "within_m",
            "lower < upper"},
           {right + "[[limits]]\naxis = \"x\"\nwithin_m = [-0.05, 0.2]\n", "within_m",
            "[-0.085, 0.085] m"},
           {right + "[[limits]]\naxis = \"x\"\nwithin_m = [-0.05, nan]\n", "within_m", "nan"},
           {right + "[[limits]]\naxis = \"x\"\nwithin_m = [0.0, 0.015]\n", "within_m",
            "at least 0.02 m wide"},
           {right + "[[limits]]\naxis = \"x\"\nwithin_rad = [0.0, 0.05]\n", "within_rad",
            "within_m"},
           {right + "[[limits]]\naxis = \"finger_flexion\"\nwithin_rad = [0.1, 0.2]\n",
            "within_rad", "at least 0.1745 rad wide"},
           {right + "[corridor]\nradius_m = 0.001\nstiffness_n_m = 100.0\n", "radius_m",
            "[0.005, 0.2]"},
           {right + "[corridor]\nradius_m = 0.01\nstiffness_n_m = 1e4\n", "stiffness_n_m",
            "[10, 1000]"},
           {right + "[difficulty]\naim = 1.0\n", "aim", "[0.5, 0.9]"},
           {right + "[difficulty]\nbounds = [0.9, 0.1]\n", "bounds", "lower < upper"},
           {right + "[help]\nforce_n = 3.0\n", "help", ""},
       }) {
    const std::string said = faultsOf(c.lines);
    EXPECT_TRUE(contains(said, c.key)) << c.lines << "\n" << said;
    EXPECT_TRUE(contains(said, c.expected)) << c.lines << "\n" << said;
  }
}

TEST(PrescriptionFile, LeftHand_TakesALeftPrescription) {
  const Folder folder;
  ModelFiles files = shippedFiles("lambda-pride", "empty", "adult-median-left");
  files.prescription = folder.write("a.toml", std::string(kHead) + "side = \"left\"\n" + kLimitX);
  const Models models = load(files);
  ASSERT_EQ(models.prescription->limits.size(), 1U);
  EXPECT_EQ(models.prescription->limits[0].upper, 0.06);
}

/// Half of the stiffness up to which the axis alone, with one spring to the ground, is certified.
TEST(PrescribedGuides, WallAndCorridor_GetAtMostHalfOfWhatAnAxisBears) {
  for (const std::string& device : {std::string("lambda-pride"), std::string("desktop-3axis")}) {
    SCOPED_TRACE(device);
    const Folder folder;
    ModelFiles files = shippedFiles(device);
    files.prescription = folder.write(
        "a.toml", std::string(kHead) + "side = \"right\"\n[[limits]]\naxis = \"x\"\nwithin_m = " +
                      "[-0.04, 0.04]\n[corridor]\nradius_m = 0.02\nstiffness_n_m = 300.0\n");
    const Models models = load(files);
    const CertificateInput without = certificateInputWithoutGuides(models, 1e-3);
    const std::vector<GuideStiffness> guides = guideStiffnesses(models, without);
    const int x = models.device.axisIndex("x");
    EXPECT_GT(guides[x].wall, 10.0);
    EXPECT_GT(guides[x].corridor, 10.0);
    EXPECT_LE(guides[x].wall, 300.0);
    EXPECT_LE(guides[x].corridor, 300.0);
    const auto bears = [&](double stiffness) {
      AxisCase c = axisCase(without, x);
      c.walls = {{stiffness, 0.0}};
      return certifyAxis(c).passes;
    };
    EXPECT_TRUE(bears(2.0 * guides[x].wall));
    EXPECT_TRUE(bears(2.0 * guides[x].corridor));
    EXPECT_TRUE(certify(certificateInput(models, 1e-3)).certified);
    for (std::size_t a = 0; a < guides.size(); ++a) {
      if (models.device.axes[a].name != "x") {
        EXPECT_EQ(guides[a].wall, 0.0);
      }
    }
    std::printf("figure: %s, x: limit %.0f N/m, corridor %.0f N/m\n", device.c_str(),
                guides[x].wall, guides[x].corridor);
  }
}

/// What is left of `rendered` is the prescription's.
AxisEffort prescribed(const TickRecord& record) {
  return difference(
      record.rendered,
      sum(sum(sum(record.coupling, record.exercise.effort), record.damping), record.tank_effort));
}

Models withLimits() {
  ModelFiles files = shippedFiles();
  files.prescription = kExample;
  return load(files);
}

TEST(PrescribedGuides, HandAtRest_FeelsNothingAnywhereInItsRange) {
  auto random = seededRandom(6606);
  const Models models = withLimits();
  for (int pose = 0; pose < (kReducedCounts ? 3 : 30); ++pose) {
    AxisPosition q(models.device.axisCount());
    for (int a = 0; a < q.size(); ++a) {
      q[a] = uniform(random, models.device.axes[a].lower, models.device.axes[a].upper);
    }
    const auto rig = buildScripted(models, [q](int) { return q; });
    if (!rig->renderer->arm()) continue;  // the hand would touch itself
    runTicks(*rig->renderer, 50, [](const TickRecord& record) {
      for (const double effort : prescribed(record)) ASSERT_NEAR(effort, 0.0, 1e-12);
    });
  }
}

TEST(PrescribedGuides, HandThatGoesBeyondItsLimit_IsResistedAndNotStopped) {
  const Models models = withLimits();
  const int x = models.device.axisIndex("x");
  const double stiffness =
      guideStiffnesses(models, certificateInputWithoutGuides(models, 1e-3))[x].wall;
  const AxisPosition from = restPose(models);
  AxisPosition to = from;
  to[x] = 0.075;  // the limit is 70 mm, its wall begins at 60 mm
  const auto rig = buildScripted(models, moveAndHold(from, to, 600));
  ASSERT_TRUE(rig->renderer->arm());
  double most_stored_j = 0.0;
  const auto last = runTicks(*rig->renderer, 900, [&](const TickRecord& record) {
    const double depth_m = std::max(0.0, record.q_m[x] - 0.06);
    ASSERT_NEAR(prescribed(record)[x], -stiffness * depth_m, 1e-9);
    most_stored_j = std::max(most_stored_j, 0.5 * stiffness * depth_m * depth_m);
    ASSERT_EQ(record.faults & kStoppingFaults, Fault::kNone);
  });
  EXPECT_NEAR(last->q_m[x], 0.075, 1e-12);
  EXPECT_EQ(last->safety_state, SafetyState::kRendering);
  EXPECT_GT(most_stored_j, 0.0);
}

TEST(Prescription, RecordedRun_IsRunAgainWithTheSameBits) {
  const Folder folder;
  ModelFiles files = exerciseFiles("squeeze-to-level");
  files.prescription = kExample;
  double most_n = 0.0;
  for (const bool without : {false, true}) {
    SCOPED_TRACE(without);
    ModelFiles chosen = files;
    if (without) chosen.prescription.clear();
    Models models = load(chosen);
    std::unique_ptr<Player> player = models.exercise->makePlayer({3});
    const auto rig = orThrow(buildRig(std::move(models), std::move(player), RigOptions{}));
    const std::string path = recordTicks(*rig, 6000, folder.file("run.h5"));
    const auto reader = orThrow(RecordingReader::open(path));
    EXPECT_EQ(reader->meta().schema, without ? kRecordingSchema : kPrescribedSchema);
    EXPECT_FALSE(reader->meta().models_changed);
    TickRecord record;
    for (std::uint64_t i = 0; i < reader->size(); ++i) {
      ASSERT_TRUE(reader->read(i, record));
      for (const double effort : prescribed(record)) {
        if (!without) most_n = std::max(most_n, std::abs(effort));
      }
    }
    const auto again = resimulate(*reader, path);
    ASSERT_TRUE(again) << format(again.errors());
    EXPECT_TRUE(again->same());
    EXPECT_EQ(again->ticks, reader->size());
  }
  EXPECT_GT(most_n, 0.05);  // the player left the straight way
}

TEST(Prescription, ChangedInMemory_IsSaidInTheRecording) {
  const Folder folder;
  Models models = withLimits();
  models.prescription->limits[0].upper -= 0.01;
  const std::string path = recordRest(std::move(models), folder.file("run.h5"));
  EXPECT_TRUE(orThrow(RecordingReader::open(path))->meta().models_changed);
}

/// A narrower limit is rendered by what was rehearsed before; another stiffness is not.
TEST(Prescription, NarrowerLimit_NeedsNoNewRehearsal) {
  const Models models = withLimits();
  const auto fingerprint = [](const Models& m) {
    return rehearsalFingerprint(m, RigOptions{}, fingerprintOf(certificateInput(m, 1e-3)));
  };
  Models narrower = models;
  narrower.prescription->limits[0].upper -= 0.01;
  EXPECT_EQ(fingerprint(models), fingerprint(narrower));
  Models stiffer = models;
  stiffer.prescription->corridor->stiffness_n_m *= 0.5;
  EXPECT_NE(fingerprint(models), fingerprint(stiffer));
  Models without = models;
  without.prescription.reset();
  EXPECT_NE(fingerprint(models), fingerprint(without));
}

}  // namespace
}  // namespace wholehand::test
