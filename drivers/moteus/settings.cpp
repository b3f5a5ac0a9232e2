#include "settings.hpp"

#include "files/toml/toml_file.hpp"

#include <algorithm>
#include <numbers>

namespace wholehand::moteus {
namespace {

Motor readMotor(TomlTable& table) {
  Motor motor;
  motor.name = table.text("name");
  motor.id = static_cast<int>(table.integer("id", 1, 126));
  motor.sign = static_cast<double>(table.integer("sign", -1, 1));
  if (table.isGood("sign") && motor.sign == 0.0) table.fail("sign", "is 0", "must be 1 or -1");
  motor.gear_ratio = table.number("gear_ratio", between(0.01, 1000.0));
  motor.offset_rad = table.number("offset_rad", between(-100.0, 100.0, "rad"));
  motor.max_torque_nm = table.number("max_torque_nm", above(0.0, 100.0, "N·m"));
  motor.encoder_step_rad = table.number("encoder_step_rad", above(0.0, 0.1, "rad"));
  return motor;
}

template <class Named>
std::size_t placeOf(const std::vector<Named>& all, const std::string& name) {
  return static_cast<std::size_t>(
      std::find_if(all.begin(), all.end(), [&](const Named& one) { return one.name == name; }) -
      all.begin());
}

template <class Named>
std::vector<std::string> namesOf(const std::vector<Named>& all) {
  std::vector<std::string> names;
  for (const Named& one : all) names.push_back(one.name);
  return names;
}

std::string listed(const std::vector<std::string>& names) {
  std::string out;
  for (const std::string& name : names) out += (out.empty() ? "" : ", ") + name;
  return out.empty() ? "none" : out;
}

void readCouplings(TomlTable& table, const std::vector<MotorAxis>& before, MotorAxis& axis) {
  std::optional<TomlTable> couplings = table.optionalTable("coupling");
  if (!couplings) return;
  for (const std::string& name : couplings->keys()) {
    const double ratio = couplings->number(name, between(-10.0, 10.0));
    const std::size_t place = placeOf(before, name);
    if (place == before.size()) {
      couplings->fail(name, "is no axis before " + axis.name,
                      "must be one of: " + listed(namesOf(before)));
      continue;
    }
    axis.couplings.push_back({place, ratio});
  }
}

MotorAxis readAxis(TomlTable& table, const Settings& settings) {
  MotorAxis axis;
  axis.name = table.text("name");
  if (axis.name.size() > 31) table.fail("name", "is too long", "must have at most 31 bytes");
  if (placeOf(settings.axes, axis.name) < settings.axes.size()) {
    table.fail("name", "is there twice", "give each axis one name");
  }
  const std::string motor = table.text("motor");
  const std::size_t place = placeOf(settings.motors, motor);
  const bool known = place < settings.motors.size();
  if (table.isGood("motor") && !known) {
    table.fail("motor", "is no motor", "must be one of: " + listed(namesOf(settings.motors)));
  }
  axis.motor = known ? place : 0;
  for (const MotorAxis& other : settings.axes) {
    if (known && other.motor == axis.motor) {
      table.fail("motor", "moves " + other.name + " already", "give each axis a motor of its own");
    }
  }
  const auto range = table.interval("range_rad", between(-100.0, 100.0, "rad"));
  axis.lower_rad = range[0];
  axis.upper_rad = range[1];
  axis.effort_limit_nm = table.number("effort_limit_nm", above(0.0, 1000.0, "N·m"));
  readCouplings(table, settings.axes, axis);
  return axis;
}

void checkMotors(std::vector<TomlTable>& tables, const std::vector<Motor>& motors) {
  for (std::size_t i = 0; i < motors.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (motors[i].name == motors[j].name) {
        tables[i].fail("name", "is there twice", "give each motor one name");
      }
      if (motors[i].id == motors[j].id) {
        tables[i].fail("id", "is that of " + motors[j].name, "give each drive an identifier");
      }
    }
  }
}

// Checks that the motors can give the travel and the efforts of the axes.
void checkMap(std::vector<TomlTable>& tables, const Settings& settings) {
  const MotorMap map(settings.motors, settings.axes);
  for (std::size_t a = 0; a < map.size(); ++a) {
    const Motor& motor = settings.motors[settings.axes[a].motor];
    const auto travel = map.motorTravel(a);
    if (travel.lower < -std::numbers::pi || travel.upper > std::numbers::pi) {
      tables[a].fail("range_rad",
                     "takes the motor " + motor.name + " from " + formatNumber(travel.lower) +
                         " to " + formatNumber(travel.upper) + " rad",
                     "must stay within half a turn of the motor to both sides: beyond it the drive "
                     "cannot distinguish one turn from the next when it is switched on");
    }
    if (map.worstTorque(a) > motor.max_torque_nm * (1.0 + 1e-9)) {
      tables[a].fail("effort_limit_nm",
                     "asks " + formatNumber(map.worstTorque(a)) + " N·m of the motor " +
                         motor.name + ", whose max_torque_nm is " +
                         formatNumber(motor.max_torque_nm),
                     "lower it");
    }
  }
}

}  // namespace

Expected<Settings> loadSettings(const std::string& path) {
  TomlFile file(path, "moteus");
  if (!file.readable()) return file.finish();
  TomlTable& root = file.root();
  Settings settings;
  settings.path = path;
  settings.delay_s = root.number("delay_s", between(0.0, 0.1, "s"));
  std::vector<TomlTable> motors = root.tables("motors", 1), axes = root.tables("axes", 1);
  for (TomlTable& table : motors) settings.motors.push_back(readMotor(table));
  for (TomlTable& table : axes) settings.axes.push_back(readAxis(table, settings));
  checkMotors(motors, settings.motors);
  if (settings.motors.size() > kMostMotors) {
    root.fail("motors", "are more than " + std::to_string(kMostMotors), "take some out");
  } else if (settings.axes.size() != settings.motors.size()) {
    root.fail("axes", "are not as many as the motors", "give each motor an axis");
  }
  if (Diagnostics faults = file.finish(); !faults.empty()) return faults;
  checkMap(axes, settings);
  if (Diagnostics faults = file.finish(); !faults.empty()) return faults;
  return settings;
}

}  // namespace wholehand::moteus
