#include "force_settings.hpp"

#include "files/toml/toml_file.hpp"

namespace wholehand::force_dimension {
namespace {

GripperSettings readGripper(TomlTable& table) {
  GripperSettings gripper;
  gripper.axis = table.text("axis");
  if (gripper.axis.size() > 31) table.fail("axis", "is too long", "must have at most 31 bytes");
  gripper.open_rad = table.number("open_rad", between(0.0, 3.2, "rad"));
  gripper.closed_rad = table.number("closed_rad", between(0.0, 3.2, "rad"));
  gripper.flexion_rad = table.number("flexion_rad", above(0.0, 3.2, "rad"));
  gripper.lever_m = table.number("lever_m", above(0.0, 0.5, "m"));
  gripper.force_limit_n = table.number("force_limit_n", above(0.0, 50.0, "N"));
  gripper.step_rad = table.number("step_rad", above(0.0, 0.1, "rad"));
  if (table.isGood("open_rad") && table.isGood("closed_rad") &&
      gripper.closed_rad >= gripper.open_rad) {
    table.fail("closed_rad", "is not below open_rad", "a gripper's angle falls as it closes");
  }
  return gripper;
}

void readSettings(TomlTable& root, ForceSettings& settings) {
  settings.delay_s = root.number("delay_s", between(0.0, 0.1, "s"));
  settings.watchdog_s = root.number("watchdog_s", above(0.0, 0.1, "s"));
  settings.yaw_rad = root.number("yaw_rad", between(-3.2, 3.2, "rad"));
  settings.force_limit_n = root.number("force_limit_n", above(0.0, 100.0, "N"));
  settings.half_travel_m = root.number("half_travel_m", above(0.0, 1.0, "m"));
  settings.step_m = root.number("step_m", above(0.0, 0.01, "m"));
  if (auto table = root.optionalTable("gripper")) settings.gripper = readGripper(*table);
}

}  // namespace

Expected<ForceSettings> loadForceSettings(const std::string& path) {
  return readTomlFile<ForceSettings>(path, "force-dimension", readSettings);
}

}  // namespace wholehand::force_dimension
