// Every shipped rendering file on its device with every shipped hand and exercise, unchanged.
#include "certify/certificate_refusal.hpp"
#include "loop/device/arming_delay.hpp"
#include "loop/device/simulated/simulated_device.hpp"
#include "rig/models.hpp"
#include "support/contains.hpp"
#include "support/rig_tools.hpp"
#include "support/seed.hpp"
#include "support/shipped.hpp"
#include "support/test_names.hpp"

namespace wholehand::test {
namespace {

class ShippedCertificate : public testing::TestWithParam<std::string> {};

TEST_P(ShippedCertificate, WithEveryHand_IsCertifiedAsShipped) {
  const std::vector<std::string> hands = shipped("hands");
  ASSERT_GE(hands.size(), 8U);
  ASSERT_EQ(shipped("devices"), shipped("rendering"));  // each device has its own gains
  double least = 100.0;
  std::size_t index = 0;
  for (const std::string& hand : hands) {
    if (leftOutUnderASanitizer(index++)) continue;
    const Models m = load(shippedFiles(GetParam(), "empty", hand));
    const Certificate c = certify(certificateInput(m, 1e-3));
    EXPECT_TRUE(c.certified) << hand << ": " << c.binding();
    EXPECT_GE(c.any_person.margin, 1.0) << hand;
    ASSERT_EQ(static_cast<int>(c.axes.size()), m.device.axisCount());
    for (const AxisCertificate& a : c.axes)
      EXPECT_TRUE(a.passes) << hand << " " << a.axis_case.axis.name;
    least = std::min(least, c.margin());
  }
  EXPECT_GE(least, 1.0);
  figure("least margin of " + GetParam(), least, "");
}
INSTANTIATE_TEST_SUITE_P(Devices, ShippedCertificate, testing::ValuesIn(shipped("rendering")),
                         [](const auto& tested) { return withoutHyphens(tested.param); });

/// Checks the last playable level of each exercise (its walls are the stiffest) with each hand, and
/// every level with one random hand. Full counts check all of them, a sanitizer a tenth of the
/// exercises.
TEST_P(ShippedCertificate, WithEveryHandAndExercise_IsCertifiedAsShipped) {
  double least = 100.0, least_any = 100.0;
  int judged = 0, walls = 0;
  const std::vector<std::string> hands = shipped("hands");
  const std::string drawn = hands[seed() % hands.size()];
  std::string tightest;
  for (const std::string& exercise : sampleTenth(shipped("exercises"))) {
    for (const std::string& hand : hands) {
      const bool thorough = hand == drawn || fullCounts();
      if (kReducedCounts && !thorough) continue;
      ModelFiles files = shippedFiles(GetParam(), "empty", hand);
      files.exercise =
          std::string(WHOLEHAND_SOURCE_DIR) + "/config/exercises/" + exercise + ".toml";
      int levels = 1;
      for (files.level = 1; files.level <= levels; ++files.level) {
        const Expected<Models> m = loadModels(files);
        if (!m) {  // without finger axes the exercise refuses the device
          ASSERT_EQ(m.errors().front().file, files.exercise) << format(m.errors());
          break;
        }
        levels = m->exercise->description().levels;
        if (files.level < levels && (!thorough || kReducedCounts)) continue;
        const CertificateInput input = certificateInput(*m, 1e-3);
        EXPECT_EQ(input.exercise, m->exercise->description().name);
        EXPECT_EQ(input.walls.size(), m->exercise_walls.size());
        EXPECT_TRUE(refuseUncertified(input).empty()) << exercise << " " << hand;
        ++judged;
        if (files.level < levels || !thorough) continue;
        const Certificate c = certify(input);
        EXPECT_TRUE(c.certified) << exercise << " " << hand << ": " << c.binding();
        EXPECT_GE(c.any_person.margin, 1.0) << exercise << " " << hand;
        least_any = std::min(least_any, c.any_person.margin);
        for (const AxisCertificate& a : c.axes) walls += a.wall.wall.stiffness > 0.0 ? 1 : 0;
        if (c.margin() < least) {
          least = c.margin();
          tightest = exercise + " with " + hand + ": " + c.binding();
        }
      }
    }
  }
  EXPECT_GE(least, 1.0);
  if (kStatisticsMeaningful) {
    EXPECT_GE(judged, 8);
    EXPECT_EQ(walls > 0, GetParam() != "desktop-3axis");
  }
  std::printf("tightest of %s: %s\n", GetParam().c_str(), tightest.c_str());
  figure("least margin of " + GetParam() + " with every hand and exercise", least, "");
  figure("the same for any passive person", least_any, "");
  figure("hands, exercises and levels of " + GetParam(), judged, "");
}

/// Faster loops also hold for any passive person wherever they are certified.
TEST_P(ShippedCertificate, AtHigherRates_HoldsForAnyPerson) {
  const std::vector<std::string> hands = shipped("hands");
  for (const double rate_hz : sampleTenth<double>({2e3, 4e3, 8e3, 16e3})) {
    std::size_t index = static_cast<std::size_t>(rate_hz);
    for (const std::string& hand : hands) {
      if (!fullCounts() && (index++ + seed()) % hands.size() != 0) continue;
      CertificateInput input =
          certificateInput(load(shippedFiles(GetParam(), "empty", hand)), 1.0 / rate_hz);
      EXPECT_TRUE(refuseUncertified(input).empty()) << hand << " at " << rate_hz;
      input.persons = Persons::kAny;
      EXPECT_TRUE(refuseUncertified(input).empty()) << hand << " at " << rate_hz;
    }
  }
}

/// The certificate and the check before a run must use the same gains.
TEST(Certificate, CertifiedLoops_UseTheGainsThatRun) {
  for (const std::string& device : shipped("devices")) {
    const Models m = load(shippedFiles(device));
    const CheckedGains checked = orThrow(checkGains(m, 1e-3));
    const CertificateInput input = certificateInput(m, 1e-3);
    for (int a = 0; a < checked.gains.axes; ++a) {
      const AxisLoop judged = axisCase(input, a).loop(1.0);
      const AxisLoop run = axisLoop(m.device, checked.gains, a, 1e-3);
      EXPECT_EQ(judged.mass, run.mass);
      EXPECT_EQ(judged.damping, run.damping);
      EXPECT_EQ(judged.delay_ticks, run.delay_ticks);
      EXPECT_EQ(judged.k_pm, run.k_pm);
      EXPECT_EQ(judged.phi_k_dm, run.phi_k_dm);
      EXPECT_EQ(judged.gamma, run.gamma);
      EXPECT_EQ(judged.k_ps_per_s2, run.k_ps_per_s2);
      EXPECT_EQ(judged.k_ds_per_s, run.k_ds_per_s);
      EXPECT_EQ(judged.filter_tau_s, run.filter_tau_s);
    }
  }
}

/// Gains that pass with the file's damping are refused where less damping was measured.
TEST(Certificate, MeasuredDevice_IsAlsoCheckedAtItsWorstCorners) {
  const Models m = load(shippedFiles("desktop-3axis"));
  RigOptions options;
  options.measured = {m.device, m.device};
  EXPECT_TRUE(orThrow(checkGains(m, 1e-3, options.measured)).refused.empty());
  EXPECT_TRUE(buildRig(m, Intention{}, options).ok());
  options.measured[1].axes[1].damping *= 0.5;
  const auto refused = buildRig(m, Intention{}, options);
  ASSERT_FALSE(refused.ok());
  ASSERT_EQ(refused.errors().size(), 1U) << format(refused.errors());
  EXPECT_TRUE(contains(refused.errors()[0].problem, "at the worst corner of the passport"));
  EXPECT_TRUE(contains(format(refused.errors()[0]), "y"));
}

/// A device that moves nobody and has measured its delay.
class LateDevice final : public HapticDevice, public DelayedDevice {
 public:
  LateDevice(const Models& models, int periods)
      : device_(models.device, models.patient, Intention{}, 1e-3),
        delay_{periods, "the delay is 5.45 ms now, the passport's 3.45 ms"} {}
  [[nodiscard]] Expected<Done> open() override { return device_.open(); }
  [[nodiscard]] Expected<Done> ready() override { return device_.ready(); }
  [[nodiscard]] bool simulated() const noexcept override { return true; }
  [[nodiscard]] Fault read(DeviceReading& reading, int elapsed_periods) noexcept override {
    return device_.read(reading, elapsed_periods);
  }
  [[nodiscard]] Fault write(const AxisEffort& effort) noexcept override {
    return device_.write(effort);
  }
  void close() noexcept override { device_.close(); }
  [[nodiscard]] const ArmingDelay& armingDelay() const noexcept override { return delay_; }

 private:
  SimulatedDevice device_;
  ArmingDelay delay_;
};

/// The delay that was measured at arming counts for the certificate, which refuses only if it fails
/// with that delay.
TEST(Certificate, LongerDelayAtArming_IsCertifiedOrRefusedWithBothDelays) {
  Models m = load(shippedFiles("desktop-3axis"));
  RigOptions options;
  options.measured = {m.device, m.device};
  const int stated = m.device.output_delay_ticks;
  const auto build = [&](int periods) {
    return buildRigWithoutPerson(m, std::make_unique<LateDevice>(m, periods), options);
  };
  EXPECT_TRUE(build(stated).ok());
  EXPECT_TRUE(build(0).ok()) << "not measured";
  const auto refused = build(stated + 2);
  ASSERT_FALSE(refused.ok());
  const std::string said = format(refused.errors());
  EXPECT_TRUE(contains(said, "the delay is 5.45 ms now, the passport's 3.45 ms; with it,")) << said;
  EXPECT_TRUE(contains(said, "--rate-hz")) << said;
  EXPECT_TRUE(contains(said, "largest allowed k_pm_n_m")) << said;
  for (AxisRendering& axis : m.rendering.axes) axis.k_pm *= 0.25;
  const auto softer = build(stated + 2);
  ASSERT_TRUE(softer.ok()) << format(softer.errors());
  EXPECT_EQ((*softer)->renderer->config().safety.tank.delay_ticks, stated + 2);
  EXPECT_EQ((*softer)->models.device.output_delay_ticks, stated) << "the file is as it was";
  const auto hopeless = build(1000);
  ASSERT_FALSE(hopeless.ok());
  EXPECT_TRUE(contains(format(hopeless.errors()), "more than 8 periods"));
}

/// These gains are certified for any linear passive person at 700 Hz but not for others. That is
/// enough for a simulated device, not for one that moves a person.
TEST(Certificate, MeasuredDevice_IsCheckedForNonlinearPersons) {
  const Models m = load(shippedFiles("wrist-9axis", "empty", "man-p95-right"));
  constexpr double kSlow_s = 1.0 / 700.0;
  EXPECT_TRUE(orThrow(checkGains(m, kSlow_s)).refused.empty());
  const CheckedGains measured = orThrow(checkGains(m, kSlow_s, {m.device}));
  ASSERT_EQ(measured.refused.size(), 1U);
  EXPECT_TRUE(contains(measured.refused[0].problem, "nonlinear and time-varying ones, too"));
  EXPECT_TRUE(orThrow(checkGains(m, 1e-3, {m.device})).refused.empty());
}

/// A certificate for other numbers is refused and one for these numbers accepted; the same for the
/// rig.
TEST(Certificate, CertificateInOptions_MustMatchTheModels) {
  const Models m = load(shippedFiles("lambda-pride"));
  const CheckedGains checked = orThrow(checkGains(m, 1e-3));
  RigOptions options;
  options.certificate = {"c.json", checked.fingerprint};
  EXPECT_TRUE(refuseToRender(checked, options).empty());
  EXPECT_TRUE(buildRig(m, Intention{}, options).ok());

  const Models other = load(shippedFiles("wrist-9axis"));
  const auto refused = buildRig(other, Intention{}, options);
  ASSERT_FALSE(refused.ok());
  ASSERT_EQ(refused.errors().size(), 1U);
  EXPECT_EQ(refused.errors()[0].file, "c.json");
  EXPECT_EQ(refused.errors()[0].problem.rfind(
                "is for the device lambda-pride, this run uses wrist-9axis", 0),
            0U)
      << refused.errors()[0].problem;

  const Models hand = load(shippedFiles("lambda-pride", "empty", "woman-p05-right"));
  EXPECT_EQ(refuseToRender(orThrow(checkGains(hand, 1e-3)), options)[0].problem,
            "is for the hand adult-median-right, this run uses woman-p05-right");
}

/// Gains that passed once in a process are not checked again; any other number is.
TEST(CheckedGains, GainsThatPassedOnce_AreStillRefusedWithAnyOtherNumber) {
  const ModelFiles files = shippedFiles("desktop-3axis", "empty", "adult-median-right");
  const auto passes = [](const Models& m, double period_s = 1e-3) {
    const Expected<CheckedGains> checked = checkGains(m, period_s);
    return checked && checked->refused.empty();
  };
  const Models shipped = load(files);
  EXPECT_TRUE(passes(shipped));
  const auto refused = [&](const auto& change) {
    Models changed = load(files);
    change(changed);
    return !passes(changed);
  };
  // Each of them violates K < b / (T (1/2 + n)): stiffer, less damped, slower.
  EXPECT_TRUE(refused([](Models& m) { m.rendering.axes[0].k_pm *= 50.0; }));
  EXPECT_TRUE(refused([](Models& m) { m.device.axes[1].damping *= 0.01; }));
  EXPECT_FALSE(passes(shipped, 50e-3));
  EXPECT_TRUE(passes(shipped));
}

}  // namespace
}  // namespace wholehand::test
