#include "exercise/cocktail_bar/bar_scene.hpp"

#include "core/printable.hpp"

#include <algorithm>
#include <utility>

namespace wholehand {
namespace {

/// The named body if it is one upright cylinder; otherwise reports it and returns null.
const SceneBody* cylinderOf(TomlTable& table, const std::string& name, const SceneModel& scene) {
  const int i = scene.bodyIndex(name);
  if (i < 0) {
    table.fail("body", "the scene " + printable(scene.path) + " has no such body",
               "write the name of one");
    return nullptr;
  }
  const SceneBody& body = scene.bodies[i];
  const bool cylinder = body.shapes.size() == 1 && body.shapes[0].type == ShapeType::kCylinder;
  if (!cylinder || !body.pose.rotation.isIdentity(1e-9)) {
    table.fail("body", "is not an upright cylinder in the scene " + printable(scene.path),
               "write shape = \"cylinder\" there, without a rotation");
    return nullptr;
  }
  return &body;
}

/// z of the upper (+1) or lower (-1) side of a box.
double sideOf(TomlTable& root, const std::string& name, double side, const SceneModel& scene) {
  const int i = scene.bodyIndex(name);
  if (i >= 0) {
    const SceneBody& body = scene.bodies[i];
    if (body.shapes.size() == 1 && body.shapes[0].type == ShapeType::kBox) {
      return body.pose.translation_m.z() + side * body.shapes[0].half_extents_m.z();
    }
  }
  root.fail("scene", "has no box named " + name, "add it: the page draws the bar from it");
  return 0.0;
}

}  // namespace

void readBodies(TomlTable& root, const SceneModel& scene, BarParts& parts, Bar& bar) {
  bar.counter_z_m = sideOf(root, "counter", 1.0, scene);
  bar.rail_z_m = sideOf(root, "rail", -1.0, scene);
  if (!root.isGood("glass") || !root.isGood("dispensers")) return;
  TomlTable glass = root.table("glass");
  if (glass.isGood("body")) {
    if (const SceneBody* body = cylinderOf(glass, bar.glass.body, scene)) {
      bar.glass.radius_m = body->shapes[0].radius_m;
      bar.glass.height_m = body->shapes[0].length_m;
      if (!body->fixed)
        glass.fail("body", "is not fixed", "write fixed = true: the exercise moves it");
      if (bar.glass.inner_radius_m > bar.glass.radius_m) {
        glass.fail("inner_radius_m", "is more than the body's radius", "must be less");
      }
      if (bar.glass.capacity_l * bar.glass.m_per_l > bar.glass.height_m) {
        glass.fail(
            "capacity_l", "stands higher than the glass, at m_per_l",
            "must be " + formatNumber(bar.glass.height_m / bar.glass.m_per_l) + " l at most");
      }
    }
  }
  std::vector<TomlTable> tables = root.tables("dispensers", 1);
  for (std::size_t i = 0; i < tables.size() && i < parts.dispensers.size(); ++i) {
    if (!tables[i].isGood("body")) continue;
    BarDispenser& d = parts.dispensers[i];
    const SceneBody* body = cylinderOf(tables[i], d.body, scene);
    if (body == nullptr) continue;
    d.radius_m = body->shapes[0].radius_m;
    d.height_m = body->shapes[0].length_m;
    d.soft_m = body->soft_m;
    bar.walls.soft_m = std::max(bar.walls.soft_m, d.soft_m);
    d.free = !body->fixed;
    const bool narrow = bar.row.slides && bar.row.spacing_m < 2.0 * d.radius_m;
    if (narrow && root.table("row").isGood("spacing_m")) {  // reported once
      root.table("row").fail("spacing_m", "is less than the width of " + d.body, "must be more");
    }
    if (d.free && bar.row.slides) {
      tables[i].fail("body", "is not fixed: it cannot slide in a row",
                     "set fixed = true in the scene, or take the table [row] out");
    }
  }
}

void keepBodies(const BarParts& parts, Side side, Bar& bar, SceneModel& scene) {
  const double mirror = side == Side::kLeft ? -1.0 : 1.0;
  if (side == Side::kLeft) {
    bar.row.reach_lower_m = -std::exchange(bar.row.reach_upper_m, -bar.row.reach_lower_m);
  }
  std::vector<SceneBody> kept;
  for (SceneBody& body : scene.bodies) {
    const auto is = [&body](const BarDispenser& d) { return d.body == body.name; };
    const bool any = std::any_of(parts.dispensers.begin(), parts.dispensers.end(), is);
    const bool wanted = std::any_of(bar.dispensers.begin(), bar.dispensers.end(), is);
    if (wanted || !any) kept.push_back(std::move(body));
  }
  scene.bodies = std::move(kept);
  // A single dispenser hangs in the middle of the reach; several start at its lower end.
  const BarRow& row = bar.row;
  const double first_y_m = bar.dispensers.size() == 1
                               ? 0.5 * (row.reach_lower_m + row.reach_upper_m)
                               : row.reach_lower_m;
  for (std::size_t i = 0; i < bar.dispensers.size(); ++i) {
    BarDispenser& d = bar.dispensers[i];
    d.body_index = scene.bodyIndex(d.body);
    SceneBody& body = scene.bodies[d.body_index];
    double& y_m = body.pose.translation_m.y();
    y_m = row.slides ? first_y_m + static_cast<double>(i) * row.spacing_m : mirror * y_m;
    d.home_m = body.pose.translation_m;
  }
  bar.rail_index = scene.bodyIndex("rail");
  bar.rail_home_m = scene.bodies[bar.rail_index].pose.translation_m;
  bar.glass.body_index = scene.bodyIndex(bar.glass.body);
  const BarDispenser& first = bar.dispensers[bar.drinks[0].steps[0].dispenser];
  Eigen::Vector3d& glass_m = scene.bodies[bar.glass.body_index].pose.translation_m;
  glass_m.y() *= mirror;
  if (!first.free) glass_m.head<2>() = (first.home_m + first.nozzle_m).head<2>();
}

}  // namespace wholehand
