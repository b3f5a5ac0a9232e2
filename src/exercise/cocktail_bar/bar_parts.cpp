#include "exercise/cocktail_bar/bar_parts.hpp"

#include "model/axis_keys.hpp"

#include <algorithm>
#include <cctype>
#include <numbers>

namespace wholehand {
namespace {

constexpr AxisQuantity kStiffness{
    "stiffness_n_m", "stiffness_nm_rad", "stiffness_tip_n_m", 2, 0.0, 1e5};
constexpr AxisQuantity kDamping{
    "damping_n_s_m", "damping_nm_s_rad", "damping_tip_n_s_m", 2, 0.0, 1e3};
/// Of an axis's effort limit: what a wall may take of it.
constexpr double kCapShare = 0.9;

bool isColor(const std::string& text) {
  return text.size() == 7 && text[0] == '#' &&
         std::all_of(text.begin() + 1, text.end(),
                     [](unsigned char c) { return std::isxdigit(c) != 0; });
}

void readWallAxis(NamedAxis& named, const DeviceModel& device, FingerWallConfig& walls) {
  const int i = device.axisIndex(named.name);
  if (i < 0) {
    const std::optional<AxisKind> kind = knownAxisKind(named.name);
    if (kind) {  // what it takes to feel a liquid is not there; its keys are checked all the same
      named.table.fail("name", "the device " + device.path + " has no such axis",
                       "take a device that has it; without the bar any plays a motion: "
                       "--scene F --motion F");
      (void)readAxisQuantity(named.table, kStiffness, *kind, 1.0);
      (void)readAxisQuantity(named.table, kDamping, *kind, 1.0);
    } else {
      named.table.fail("name", "is no axis of the device " + device.path + " nor any known one",
                       "remove it, or write the name of a hand axis");
      named.table.skipRest();
    }
    return;
  }
  const DeviceAxis& axis = device.axes[static_cast<std::size_t>(i)];
  if (axis.group != AxisGroup::kHand) {
    named.table.fail("name", "carries the hand and closes on to nothing",
                     "write the name of an axis that moves the hand's joints");
    named.table.skipRest();
    return;
  }
  walls.stiffness[i] = readAxisQuantity(named.table, kStiffness, axis.kind, axis.lever_arm_m);
  walls.damping[i] = readAxisQuantity(named.table, kDamping, axis.kind, axis.lever_arm_m);
}

}  // namespace

void readWall(TomlTable& wall, const DeviceModel& device, Bar& bar) {
  bar.lead_in_m = wall.number("lead_in_m", between(0.0, kLargestLeadIn_m, "m"));
  TransitionConfig& t = bar.transition;
  t.engage_m = wall.number("engage_m", above(0.0, 1.0, "m"));
  t.release_m = wall.number("release_m", above(0.0, 1.0, "m"));
  if (wall.good("engage_m") && wall.good("release_m") && t.release_m < t.engage_m) {
    wall.fail("release_m", "is nearer than engage_m", "must be at least engage_m");
  }
  // In 0.3 s the largest effort of a wall, 10 N at the tip, comes and goes by 0.05 N a tick.
  t.engage_s = wall.number("engage_s", between(0.3, 10.0, "s"), t.engage_s);
  t.release_s = wall.number("release_s", between(0.3, 5.0, "s"), t.release_s);
  const int n = device.axisCount();
  bar.walls.axes = n;
  bar.walls.lever_arm_m = AxisRatio(n, 1.0);
  bar.walls.stiffness = bar.walls.damping = AxisRatio(n);
  bar.walls.effort_cap = AxisEffort(n);
  for (int i = 0; i < n; ++i) {
    const DeviceAxis& axis = device.axes[static_cast<std::size_t>(i)];
    if (axis.lever_arm_m > 0.0) bar.walls.lever_arm_m[i] = axis.lever_arm_m;
    bar.walls.effort_cap[i] = kCapShare * axis.effort_limit;
  }
  bar.walls.follow_m_s = wall.number("follow_m_s", above(0.0, 1.0, "m/s"), bar.walls.follow_m_s);
  for (NamedAxis& named : readAxisNames(wall)) readWallAxis(named, device, bar.walls);
}

void readGlass(TomlTable& table, BarGlass& glass) {
  glass.body = table.text("body");
  glass.inner_radius_m = table.number("inner_radius_m", above(0.0, 1.0, "m"));
  glass.m_per_l = table.number("m_per_l", above(0.0, 10.0, "m/l"));
  glass.capacity_l = table.number("capacity_l", above(0.0, 10.0, "l"));
  glass.slide_s = table.number("slide_s", between(0.1, 10.0, "s"));
}

void readRow(TomlTable& table, BarRow& row) {
  row.slides = true;
  row.spacing_m = table.number("spacing_m", above(0.0, 1.0, "m"));
  const std::array<double, 2> reach = table.interval("reach_y_m", between(-1.0, 1.0, "m"));
  row.reach_lower_m = reach[0];
  row.reach_upper_m = reach[1];
  row.speed_m_s = table.number("speed_m_s", between(0.01, 0.5, "m/s"));
}

void readDrawnBack(TomlTable& table, BarDrawnBack& drawn_back) {
  drawn_back.x_m = table.number("x_m", between(-1.0, 1.0, "m"));
  drawn_back.palm_m = table.number("palm_m", between(0.0, 1.0, "m"));
}

void readUpset(TomlTable& table, BarUpset& upset) {
  upset.tilt_rad = table.number("tilt_rad", between(0.1, std::numbers::pi, "rad"));
  upset.leak_l_s = table.number("leak_l_s", between(0.0, 1.0, "l/s"));
  upset.stand_up_s = table.number("stand_up_s", between(0.1, 60.0, "s"));
  upset.dropped_m = table.number("dropped_m", between(0.001, 1.0, "m"));
}

void readScoring(TomlTable& table, BarScoring& scoring) {
  scoring.spill_points_per_l = table.number("spill_points_per_l", between(0.0, 1e6, "1/l"));
  scoring.time_points = table.number("time_points", between(0.0, 100.0));
  scoring.par_s = table.number("par_s", above(0.0, 3600.0, "s"));
  scoring.two_stars = table.number("two_stars", between(0.0, 100.0));
  scoring.three_stars = table.number("three_stars", between(0.0, 100.0));
  scoring.rest_s = table.number("rest_s", between(0.0, 600.0, "s"));
  if (table.good("two_stars") && table.good("three_stars") &&
      scoring.three_stars < scoring.two_stars) {
    table.fail("three_stars", "is less than two_stars", "must be at least two_stars");
  }
}

std::vector<BarLiquid> readLiquids(TomlTable& root) {
  std::vector<BarLiquid> liquids;
  std::vector<std::string> names;
  for (TomlTable& t : root.tables("liquids", 1)) {
    BarLiquid l;
    l.name = t.text("name");
    (void)checkNewName(t, l.name, names);
    l.color = t.text("color");
    if (t.good("color") && !isColor(l.color)) {
      t.fail("color", "is not a colour", "must be \"#RRGGBB\", e.g. \"#F6C636\"");
    }
    l.pattern = t.choice("pattern", {"stripes", "dots", "waves", "rings"});
    l.symbol = t.choice("symbol", {"triangle", "circle", "square", "diamond"});
    l.viscosity = t.number("viscosity", between(0.1, 100.0));
    l.stiffness = t.number("stiffness", between(0.1, 100.0));
    names.push_back(l.name);
    liquids.push_back(l);
  }
  return liquids;
}

}  // namespace wholehand
