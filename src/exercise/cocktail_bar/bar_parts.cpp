#include "exercise/cocktail_bar/bar_parts.hpp"

#include "model/axis_keys.hpp"

#include <algorithm>
#include <cctype>
#include <numbers>

namespace wholehand {
namespace {

bool isColor(const std::string& text) {
  return text.size() == 7 && text[0] == '#' &&
         std::all_of(text.begin() + 1, text.end(),
                     [](unsigned char c) { return std::isxdigit(c) != 0; });
}

}  // namespace

void readWall(TomlTable& wall, const DeviceModel& device, Bar& bar) {
  FingerWallFile file = readFingerWalls(wall, device);
  bar.lead_in_m = file.lead_in_m;
  bar.transition = file.transition;
  bar.walls = file.walls;
  bar.effort_limit = file.effort_limit;
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

void readUpset(TomlTable& table, BarTipOver& upset) {
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
  if (table.isGood("two_stars") && table.isGood("three_stars") &&
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
    if (t.isGood("color") && !isColor(l.color)) {
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
