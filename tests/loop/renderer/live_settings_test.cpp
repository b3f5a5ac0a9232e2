// Settings that a therapist may change during rendering: limits and damping that follow from one
// number. Expected values are computed from the device's files.
#include "loop/renderer/live_settings.hpp"

#include "support/rig_tools.hpp"
#include "support/seed.hpp"

#include <cmath>

namespace wholehand::test {
namespace {

DeviceAxis axisOf(const char* name, AxisKind kind, AxisGroup group, double limit, double lever_m) {
  return {
      .name = name, .kind = kind, .group = group, .effort_limit = limit, .lever_arm_m = lever_m};
}

/// A device with its LiveSettings, and the settings at given values.
struct Therapy {
  DeviceModel device;
  AdaptiveDampingConfig damping;
  LiveSettings live;
  AxisEffort device_limit;

  explicit Therapy(DeviceModel model, AdaptiveDampingConfig start)
      : device(std::move(model)),
        damping(std::move(start)),
        live(device, damping),
        device_limit(device.axisCount()) {
    for (int i = 0; i < device.axisCount(); ++i) {
      device_limit[i] = device.axes[i].effort_limit;
    }
  }

  struct Present {
    AxisEffort limit;
    AdaptiveDampingConfig damping;
  };
  /// Settings with every parameter at its start except those named.
  Present at(const std::vector<std::pair<std::string, double>>& changes) const {
    std::vector<double> values;
    for (const LiveParameter& p : live.parameters()) values.push_back(p.value);
    for (const auto& [name, value] : changes) values.at(index(name)) = value;
    Present now{AxisEffort(device.axisCount()), damping};
    live.apply(values.data(), device_limit, damping, now.limit, now.damping);
    return now;
  }
  std::size_t index(const std::string& name) const {
    const auto& all = live.parameters();
    const auto found = std::find_if(all.begin(), all.end(),
                                    [&](const LiveParameter& p) { return p.name == name; });
    if (found == all.end()) throw std::runtime_error("there is no " + name);
    return static_cast<std::size_t>(found - all.begin());
  }
  int axis(const char* name) const { return device.axisIndex(name); }
};

Therapy therapyOn(const std::string& device) {
  const Models m = load(shippedFiles(device));
  return Therapy(m.device, makeAdaptiveDamping(m.device, m.rendering));
}

/// Axes with equal damping: f₀ 0.3, f_d 0.03, τ 0.3 s.
Therapy madeOf(std::vector<DeviceAxis> axes) {
  const int n = static_cast<int>(axes.size());
  DeviceModel device;
  device.axes = std::move(axes);
  return Therapy(std::move(device), {n, AxisEffort(n, 0.03), AxisEffort(n, 0.3), AxisTime(n, 0.3),
                                     AxisFlag(n), AxisFlag(n)});
}

std::vector<std::string> namesOf(const LiveSettings& live) {
  std::vector<std::string> names;
  for (const LiveParameter& p : live.parameters()) names.push_back(p.name);
  return names;
}

void expectParameter(const LiveParameter& p, const char* unit, double lower, double upper,
                     double value) {
  EXPECT_EQ(p.unit, unit) << p.name;
  EXPECT_NEAR(p.lower, lower, tolerance(1e-12)) << p.name;
  EXPECT_NEAR(p.upper, upper, tolerance(1e-12)) << p.name;
  EXPECT_NEAR(p.value, value, tolerance(1e-12)) << p.name;
  EXPECT_NEAR(p.rate_per_s, upper - lower, tolerance(1e-12))
      << p.name;  // the whole range in a second
}

TEST(LiveSettings, SixAxes_HaveFourParametersWithTheDevicesLimitsAsUpperEnds) {
  const Therapy t = therapyOn("lambda-pride");
  ASSERT_EQ(namesOf(t.live),
            (std::vector<std::string>{"effort_limit_hand_tip_n", "effort_limit_arm_n",
                                      "damping_full_n", "damping_decay_s"}));
  const auto& p = t.live.parameters();
  expectParameter(p[0], "N", 1.0, 10.0, 10.0);  // of the fingers; the minimum is a tenth of it
  expectParameter(p[1], "N", 2.0, 20.0, 20.0);
  expectParameter(p[2], "N", 1.0, 10.0, 5.0);  // f₀ of x; from a fifth of it to twice it
  expectParameter(p[3], "s", 0.05, 1.0, 0.3);
}

TEST(LiveSettings, DeviceWithoutHandAxes_HasNoTipLimit) {
  const Therapy t = therapyOn("desktop-3axis");
  ASSERT_EQ(namesOf(t.live),
            (std::vector<std::string>{"effort_limit_arm_n", "damping_full_n", "damping_decay_s"}));
  expectParameter(t.live.parameters()[0], "N", 0.8, 8.0, 8.0);
  expectParameter(t.live.parameters()[1], "N", 0.6, 6.0, 3.0);
  const auto now = t.at({{"effort_limit_arm_n", 5.0}});
  for (int i = 0; i < 3; ++i) EXPECT_EQ(now.limit[i], 5.0);
}

TEST(LiveSettings, HandAxesWithoutLeverArm_HaveNoTipLimitAndKeepTheirOwnLimits) {
  const Therapy t = madeOf({axisOf("x", AxisKind::kTranslation, AxisGroup::kBase, 20.0, 0.0),
                            axisOf("flexion", AxisKind::kRotation, AxisGroup::kHand, 0.8, 0.0)});
  ASSERT_EQ(namesOf(t.live),
            (std::vector<std::string>{"effort_limit_arm_n", "damping_full_n", "damping_decay_s"}));
  const auto now = t.at({{"effort_limit_arm_n", 2.0}});
  EXPECT_EQ(now.limit[0], 2.0);
  EXPECT_EQ(now.limit[1], 0.8);
}

TEST(LiveSettings, OnlyRotationsWithoutLeverArm_OfferTheDecayOnly) {
  const Therapy t = madeOf({axisOf("flexion", AxisKind::kRotation, AxisGroup::kHand, 0.8, 0.0)});
  EXPECT_EQ(namesOf(t.live), std::vector<std::string>{"damping_decay_s"});
}

TEST(LiveSettings, AxisWithoutLeverArmBesideOneWithIt_IsScaledByTheSameRatio) {
  const Therapy t = madeOf({axisOf("finger", AxisKind::kRotation, AxisGroup::kHand, 0.8, 0.08),
                            axisOf("thumb", AxisKind::kRotation, AxisGroup::kHand, 0.6, 0.0)});
  const auto now = t.at({{"effort_limit_hand_tip_n", 2.5}});  // a quarter of 0.8 N·m / 0.08 m
  EXPECT_NEAR(now.limit[0], 0.2, tolerance(1e-15));
  EXPECT_NEAR(now.limit[1], 0.15, tolerance(1e-15));
}

TEST(LiveSettings, UpperEnd_IsTheDevicesLimitToTheBit) {
  for (const char* device : {"lambda-pride", "desktop-3axis", "wrist-9axis"}) {
    const Therapy t = therapyOn(device);
    // Nothing changed, then every parameter at its upper end.
    std::vector<std::pair<std::string, double>> top;
    for (const LiveParameter& p : t.live.parameters()) top.emplace_back(p.name, p.upper);
    for (const auto& values : {std::vector<std::pair<std::string, double>>{}, top}) {
      const auto now = t.at(values);
      for (int i = 0; i < t.device.axisCount(); ++i) {
        EXPECT_EQ(now.limit[i], t.device_limit[i]) << device << ", axis " << i;
      }
    }
  }
}

TEST(LiveSettings, UpperEndWithRoundedQuotients_IsTheDevicesLimitToTheBit) {
  // (limit / lever arm) · lever arm is often slightly less than the limit.
  std::mt19937_64 random = seededRandom(33);
  std::uniform_real_distribution limit(0.1, 20.0), lever_m(0.01, 0.2);
  for (int k = 0; k < cases(100); ++k) {
    const Therapy t =
        madeOf({axisOf("x", AxisKind::kTranslation, AxisGroup::kBase, limit(random), 0.0),
                axisOf("roll", AxisKind::kRotation, AxisGroup::kBase, limit(random), 0.0),
                axisOf("f", AxisKind::kRotation, AxisGroup::kHand, limit(random), lever_m(random)),
                axisOf("g", AxisKind::kRotation, AxisGroup::kHand, limit(random), 0.0)});
    const auto now = t.at({});
    for (int i = 0; i < 4; ++i) ASSERT_EQ(now.limit[i], t.device_limit[i]) << "axis " << i;
  }
}

TEST(LiveSettings, NothingChanged_DampsAsAtTheStartToTheBit) {
  for (const char* device : {"lambda-pride", "desktop-3axis", "wrist-9axis"}) {
    const Therapy t = therapyOn(device);
    const auto now = t.at({});
    for (int i = 0; i < t.device.axisCount(); ++i) {
      EXPECT_EQ(now.damping.effort_full[i], t.damping.effort_full[i]);
      EXPECT_EQ(now.damping.effort_dead[i], t.damping.effort_dead[i]);
      EXPECT_EQ(now.damping.decay_s[i], t.damping.decay_s[i]);
    }
  }
}

TEST(LiveSettings, TipLimit_TimesLeverArmLimitsTheJointsAndNotTheArm) {
  const Therapy t = therapyOn("lambda-pride");
  for (const double tip_n : {1.0, 4.0, 7.0}) {
    const auto now = t.at({{"effort_limit_hand_tip_n", tip_n}});
    for (const char* finger : {"finger_flexion", "thumb_circumduction", "thumb_flexion"}) {
      EXPECT_NEAR(now.limit[t.axis(finger)], tip_n * 0.08, tolerance(1e-15)) << finger;
    }
    for (const char* arm : {"x", "y", "z"}) EXPECT_EQ(now.limit[t.axis(arm)], 20.0);
  }
}

TEST(LiveSettings, TipLimitAboveAWeakerAxis_KeepsThatAxissOwnLimit) {
  // The thumb's circumduction is limited to 0.6 N·m, 7.5 N at the tip; the others to 10 N.
  const Therapy t = therapyOn("lambda-pride");
  const auto now = t.at({{"effort_limit_hand_tip_n", 9.0}});
  EXPECT_EQ(now.limit[t.axis("thumb_circumduction")], 0.6);
  EXPECT_NEAR(now.limit[t.axis("finger_flexion")], 0.72, tolerance(1e-15));
}

TEST(LiveSettings, ArmLimit_AppliesToTranslationsAndByRatioToTheWrist) {
  const Therapy t = therapyOn("wrist-9axis");
  const auto now = t.at({{"effort_limit_arm_n", 5.0}});  // a quarter of 20 N
  for (const char* arm : {"x", "y", "z"}) EXPECT_EQ(now.limit[t.axis(arm)], 5.0);
  for (const char* wrist : {"roll", "pitch", "yaw"}) {
    EXPECT_NEAR(now.limit[t.axis(wrist)], 0.25, tolerance(1e-15)) << wrist;  // of 1 N·m
  }
  EXPECT_EQ(now.limit[t.axis("finger_flexion")], t.device_limit[t.axis("finger_flexion")]);
}

TEST(LiveSettings, AnyValues_NeverExceedTheDeviceAndNeverFallBelowATenth) {
  std::mt19937_64 random = seededRandom(31);
  for (const char* device : {"lambda-pride", "desktop-3axis", "wrist-9axis"}) {
    const Therapy t = therapyOn(device);
    for (int k = 0; k < cases(200); ++k) {
      std::vector<std::pair<std::string, double>> values;
      for (const LiveParameter& p : t.live.parameters()) {
        values.emplace_back(p.name, std::uniform_real_distribution(p.lower, p.upper)(random));
      }
      const auto now = t.at(values);
      for (int i = 0; i < t.device.axisCount(); ++i) {
        EXPECT_LE(now.limit[i], t.device_limit[i]);
        EXPECT_GE(now.limit[i], 0.1 * t.device_limit[i] * (1.0 - 1e-12));
      }
    }
  }
}

TEST(LiveSettings, DampingFull_ScalesFullAndDeadEffortOfEveryAxisByTheSameFactor) {
  const Therapy t = therapyOn("lambda-pride");
  const auto now = t.at({{"damping_full_n", 2.0}});  // of 5 N: times 0.4
  for (const char* arm : {"x", "y", "z"}) {
    EXPECT_NEAR(now.damping.effort_full[t.axis(arm)], 2.0, tolerance(1e-15));
    EXPECT_NEAR(now.damping.effort_dead[t.axis(arm)], 0.2, tolerance(1e-15));
  }
  // 5 N and 0.5 N at a tip 0.08 m away; 0.3 and 0.03 N·m, which need no lever arm.
  EXPECT_NEAR(now.damping.effort_full[t.axis("finger_flexion")], 0.16, tolerance(1e-15));
  EXPECT_NEAR(now.damping.effort_dead[t.axis("finger_flexion")], 0.016, tolerance(1e-15));
  EXPECT_NEAR(now.damping.effort_full[t.axis("thumb_circumduction")], 0.12, tolerance(1e-15));
  EXPECT_NEAR(now.damping.effort_dead[t.axis("thumb_circumduction")], 0.012, tolerance(1e-15));
  for (int i = 0; i < 6; ++i) {
    EXPECT_EQ(now.damping.decay_s[i], t.damping.decay_s[i]);
    EXPECT_EQ(now.limit[i], t.device_limit[i]);
  }
}

TEST(LiveSettings, DampingFullOfAFingerDevice_IsAForceAtTheTip) {
  // f₀ 0.3 N·m at a lever arm of 0.08 m: 3.75 N. The first axis has no tip and is skipped.
  const Therapy t = madeOf({axisOf("roll", AxisKind::kRotation, AxisGroup::kBase, 1.0, 0.0),
                            axisOf("finger", AxisKind::kRotation, AxisGroup::kHand, 0.8, 0.08)});
  expectParameter(t.live.parameters().at(t.index("damping_full_n")), "N", 0.75, 7.5, 3.75);
  const auto now = t.at({{"damping_full_n", 7.5}});  // twice as much, on both
  EXPECT_NEAR(now.damping.effort_full[0], 0.6, tolerance(1e-15));
  EXPECT_NEAR(now.damping.effort_full[1], 0.6, tolerance(1e-15));
}

TEST(LiveSettings, DampingDecay_IsTheTimeConstantOfPhi) {
  const Therapy t = therapyOn("lambda-pride");
  const auto now = t.at({{"damping_decay_s", 0.6}});
  for (int i = 0; i < 6; ++i) {
    EXPECT_NEAR(now.damping.decay_s[i], 0.6, tolerance(1e-15));
    EXPECT_EQ(now.damping.effort_full[i], t.damping.effort_full[i]);
    EXPECT_EQ(now.damping.effort_dead[i], t.damping.effort_dead[i]);
  }
  // After that time Algorithm 1 leaves 1/e, on the fingers and, through them, on the arm.
  AdaptiveDampingState state{AxisRatio(6, 1.0), AxisRatio(6, 1.0)};
  for (int tick = 0; tick < 600; ++tick) {
    state = adaptDamping(state, AxisEffort(6), now.damping, 1, 1e-3);
  }
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(state.phi[i], std::exp(-1.0), tolerance(1e-12));
}

TEST(LiveSettings, DecayOfTheFileOutsideTheUsualRange_CanBeRestored) {
  for (const double decay_s : {0.01, 4.0}) {
    DeviceModel device;
    device.axes = {axisOf("x", AxisKind::kTranslation, AxisGroup::kBase, 20.0, 0.0)};
    const Therapy t(device, {1, AxisEffort(1, 0.5), AxisEffort(1, 5.0), AxisTime(1, decay_s),
                             AxisFlag(1), AxisFlag(1)});
    const LiveParameter& p = t.live.parameters().at(t.index("damping_decay_s"));
    EXPECT_LE(p.lower, decay_s);
    EXPECT_GE(p.upper, decay_s);
    EXPECT_EQ(p.value, decay_s);
  }
}

TEST(LiveSettings, LimitLoweredAndRaisedByRamps_IsTheDevicesLimitToTheBit) {
  // Tests settings and ramps together: at 1 kHz, where sums are rounded, from a random value back
  // to the top.
  const Therapy t = therapyOn("lambda-pride");
  ParameterRamps ramps(t.live.parameters());
  std::mt19937_64 random = seededRandom(32);
  for (int k = 0; k < cases(20); ++k) {
    const double low_n = std::uniform_real_distribution(1.0, 10.0)(random);
    ramps.ask(0, low_n);
    for (int tick = 0; tick < 1002; ++tick) ramps.advance(1, 1e-3);  // the range takes a second
    ASSERT_EQ(ramps.values()[0], low_n);
    ramps.ask(0, 10.0);
    for (int tick = 0; tick < 1002; ++tick) ramps.advance(1, 1e-3);
    AxisEffort limit(6);
    AdaptiveDampingConfig damping = t.damping;
    t.live.apply(ramps.values(), t.device_limit, t.damping, limit, damping);
    for (int i = 0; i < 6; ++i) ASSERT_EQ(limit[i], t.device_limit[i]) << low_n << " N";
  }
}

}  // namespace
}  // namespace wholehand::test
