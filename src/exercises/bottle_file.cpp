#include "exercises/bottle_file.hpp"

#include "loop/core/printable.hpp"

#include <fmt/format.h>

namespace wholehand {

Bottle readBottle(TomlTable& table) {
  Bottle out;
  out.area_m2 = table.number("area_m2", above(0.0, 0.01, "m²"));
  out.return_n_m = table.number("return_n_m", above(0.0, 1e4, "N/m"));
  out.opening_n = table.number("opening_n", between(0.0, 10.0, "N"));
  out.air_s = table.number("air_s", between(0.05, 5.0, "s"));
  out.nozzle.length_m = table.number("nozzle_length_m", above(0.0, 1.0, "m"));
  out.nozzle.radius_m = table.number("nozzle_radius_m", above(0.0, 0.1, "m"));
  return out;
}

Bottle readLiquid(TomlTable& table, Bottle bottle) {
  bottle.nozzle.viscosity_pa_s = table.number("viscosity_pa_s", above(0.0, 1e3, "Pa·s"));
  // resistance() is NaN or 0 when keys of the nozzle have faults, which are reported already.
  if (table.isGood("viscosity_pa_s") && bottle.resistance() > 0.0 &&
      bottle.resistance() < kLeastFelt_n_s_m) {
    table.fail(
        "viscosity_pa_s",
        fmt::format("gives {:.3g} N·s/m at the fingertip, which is not felt", bottle.resistance()),
        fmt::format("raise it, or make the nozzle longer or narrower: at least {:g} N·s/m",
                    kLeastFelt_n_s_m));
  }
  return bottle;
}

int uprightCylinder(TomlTable& table, const char* key, const std::string& name,
                    const SceneModel& scene, bool fixed) {
  const int index = scene.bodyIndex(name);
  const std::string in_scene = "the scene " + printable(scene.path);
  if (index < 0) {
    table.fail(key, in_scene + " has no such body", "write the name of one");
    return -1;
  }
  const SceneBody& body = scene.bodies[index];
  if (body.cylinder() != nullptr && body.pose.rotation.isIdentity(1e-9) && (body.fixed || !fixed)) {
    return index;
  }
  table.fail(
      key,
      (fixed ? "is not a fixed upright cylinder in " : "is not an upright cylinder in ") + in_scene,
      fixed ? "write shape = \"cylinder\" and fixed = true there, without a rotation"
            : "write shape = \"cylinder\" there, without a rotation");
  return -1;
}

}  // namespace wholehand
