#include "moteus/settings.hpp"

#include "hand_settings.hpp"
#include "support/contains.hpp"

#include <gtest/gtest.h>

namespace wholehand::moteus {
namespace {

TEST(MoteusSettings, MistakeInTheSettings_IsRefusedByName) {
  struct Mistake {
    const char* was;
    const char* is;
    const char* expected;
  };
  const Mistake mistakes[] = {
      {"delay_s = 0.001\n", "", "delay_s"},
      {"gear_ratio = 1.5", "gear_ratio = 1.5\ngear = 2", "gear"},
      {"sign = -1", "sign = 0", "must be 1 or -1"},
      {"id = 3", "id = 1", "is that of fingers"},
      {"motor = \"thumb tip\"", "motor = \"toe\"", "is no motor"},
      {"motor = \"thumb tip\"", "motor = \"fingers\"", "moves finger_flexion already"},
      {"thumb_circumduction = 0.4", "thumb_flexion = 0.4", "is no axis before thumb_flexion"},
      {"max_torque_nm = 0.8", "max_torque_nm = 0.5", "asks 0.8 N·m of the motor fingers"},
      // 3.14 rad of the fingers with a gear ratio of 2.2 are more than one turn of the motor.
      {"gear_ratio = 1.0", "gear_ratio = 2.2", "within half a turn"}};
  const test::Folder folder;
  for (const auto& [was, is, why] : mistakes) {
    EXPECT_TRUE(test::refusedWith(
        loadSettings(test::settingsFile(folder, test::kHandSettings, was, is)), why));
  }
}

TEST(MoteusSettings, ShippedExample_IsAccepted) {
  const auto settings = loadSettings(WHOLEHAND_SOURCE_DIR "/drivers/moteus/hand.toml");
  ASSERT_TRUE(settings) << format(settings.errors());
  EXPECT_EQ(settings->axes.size(), 3U);
}

}  // namespace
}  // namespace wholehand::moteus
