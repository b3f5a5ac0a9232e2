#include "moteus/settings.hpp"

#include "hand_settings.hpp"
#include "support/says.hpp"

#include <gtest/gtest.h>

namespace wholehand::moteus {
namespace {

struct Mistake {
  const char* name;
  const char* was;
  const char* is;
  const char* says;
};

class MoteusSettings : public testing::TestWithParam<Mistake> {};

TEST_P(MoteusSettings, Mistake_IsRefusedByName) {
  const test::Folder folder;
  const auto settings =
      loadSettings(test::settingsFile(folder, test::kHandSettings, GetParam().was, GetParam().is));
  EXPECT_TRUE(test::refusedWith(settings, GetParam().says));
}
INSTANTIATE_TEST_SUITE_P(
    Kinds, MoteusSettings,
    testing::Values(
        Mistake{"no_delay", "delay_s = 0.001\n", "", "delay_s"},
        Mistake{"unknown_key", "gear_ratio = 1.5", "gear_ratio = 1.5\ngear = 2", "gear"},
        Mistake{"sign_zero", "sign = -1", "sign = 0", "must be 1 or -1"},
        Mistake{"same_drive", "id = 3", "id = 1", "is that of fingers"},
        Mistake{"no_such_motor", "motor = \"thumb tip\"", "motor = \"toe\"", "is no motor"},
        Mistake{"motor_twice", "motor = \"thumb tip\"", "motor = \"fingers\"",
                "moves finger_flexion already"},
        Mistake{"later_axis", "thumb_circumduction = 0.4", "thumb_flexion = 0.4",
                "is no axis before thumb_flexion"},
        Mistake{"weak_motor", "max_torque_nm = 0.8", "max_torque_nm = 0.5",
                "asks 0.8 N·m of the motor fingers"},
        // 3.14 rad of the fingers on a gear of 2.2 are more than one turn of the motor.
        Mistake{"wraps", "gear_ratio = 1.0", "gear_ratio = 2.2", "within half a turn"}),
    [](const auto& tested) { return tested.param.name; });

TEST(MoteusSettings, ShippedExample_IsRead) {
  const auto settings = loadSettings(WHOLEHAND_SOURCE_DIR "/drivers/moteus/hand.toml");
  ASSERT_TRUE(settings) << format(settings.errors());
  EXPECT_EQ(settings->axes.size(), 3U);
}

}  // namespace
}  // namespace wholehand::moteus
