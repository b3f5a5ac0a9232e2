#pragma once

#include "control/transition.hpp"
#include "exercise/finger_wall_file.hpp"
#include "exercise/finger_walls.hpp"
#include "model/scene_model.hpp"

#include <Eigen/Core>

#include <string>
#include <vector>

/// The cocktail bar as its file and scene say it, for one level. Plain data, immutable while
/// played.
namespace wholehand {

inline constexpr int kMaxDispensers = 6;  ///< of a level
inline constexpr int kMaxSteps = 8;       ///< of a drink

struct BarLiquid {
  std::string name, color, pattern, symbol;
  double viscosity = 1.0;  ///< times the thinnest
  double stiffness = 1.0;  ///< times the softest
};

struct BarDispenser {
  std::string body;
  int body_index = -1;                    ///< in the level's scene
  int liquid = 0;                         ///< index into Bar::liquids
  bool free = false;                      ///< may be carried
  double radius_m = 0.0, height_m = 0.0;  ///< as drawn
  double soft_m = 0.0;                    ///< how far digits sink in before they meet the core
  double start_l = 0.0;                   ///< what is in it
  Eigen::Vector3d nozzle_m, grip_m;       ///< from the centre of mass, body axes
  Eigen::Vector3d home_m;                 ///< its centre of mass at the start
};

struct BarStep {
  int dispenser = 0;  ///< index into Bar::dispensers
  double amount_l = 0.0, tolerance_l = 0.0;
};

struct BarDrink {
  std::string name;
  std::vector<BarStep> steps;
};

struct BarGlass {
  std::string body;
  int body_index = -1;
  double radius_m = 0.0, height_m = 0.0;  ///< outside
  double inner_radius_m = 0.0;
  double m_per_l = 0.0;  ///< height of a litre
  double capacity_l = 0.0;
  double slide_s = 0.0;
};

/// How the row of dispensers comes within reach.
struct BarRow {
  bool slides = false;
  double spacing_m = 0.0;
  double reach_lower_m = 0.0, reach_upper_m = 0.0;  ///< y of dispensers that can be reached
  double speed_m_s = 0.0;
};

/// Where a dispenser's centre of mass must be for the palm to come to it.
struct BarReach {
  Eigen::Vector3d lower_m = Eigen::Vector3d::Constant(-1e3);
  Eigen::Vector3d upper_m = Eigen::Vector3d::Constant(1e3);

  [[nodiscard]] bool contains(const Eigen::Vector3d& at_m) const noexcept {
    return (at_m.array() >= lower_m.array() && at_m.array() <= upper_m.array()).all();
  }
};

/// When the hand is drawn back: bodies may slide, and be stood up.
struct BarDrawnBack {
  double x_m = 0.0;     ///< the hand's x is less ...
  double palm_m = 0.0;  ///< ... and the palm at least this far from every dispenser
};

/// Squeeze: what the digits that grip a dispenser feel of it, low-passed [N at the fingertips].
struct BarSqueeze {
  double filter_hz = 5.0;
  double threshold_n = 0.0, low_n = 0.0, high_n = 0.0, full_n = 0.0;
  double let_go_n = 0.0;
};

struct BarFlow {
  double l_per_s_n = 0.0;  ///< of the thinnest, over the threshold
  double max_l_s = 0.0;    ///< of the thinnest
};

/// A free dispenser that was knocked over, or pushed out of reach.
struct BarUpset {
  double tilt_rad = 0.9;    ///< leaning more than this, held by nobody
  double leak_l_s = 0.0;    ///< what then runs out, of the thinnest
  double stand_up_s = 3.0;  ///< lying this long with the hand away: stood up again
  double dropped_m = 0.05;  ///< this much lower than at the start: stood up again too
};

struct BarScoring {
  double spill_points_per_l = 0.0, time_points = 0.0, par_s = 0.0;
  double two_stars = 0.0, three_stars = 0.0;
  double rest_s = 0.0;
};

struct Bar {
  std::string name;
  int level = 1;
  std::vector<std::string> level_names;
  double lead_in_m = 0.0;
  TransitionConfig transition;
  FingerWallConfig walls;   ///< of the softest and thinnest liquid
  AxisEffort effort_limit;  ///< the device's
  BarSqueeze squeeze;
  BarFlow flow;
  BarGlass glass;
  BarRow row;
  BarDrawnBack drawn_back;
  BarUpset upset;
  BarReach reach;
  BarScoring scoring;
  double counter_z_m = 0.0, rail_z_m = 0.0;  ///< top of the counter, lower side of the rail
  int rail_index = -1;                       ///< in the level's scene
  Eigen::Vector3d rail_home_m;               ///< its centre of mass
  int x_axis = -1;                           ///< of the device; -1: it has none
  std::vector<BarLiquid> liquids;
  std::vector<BarDispenser> dispensers;  ///< of the level, in a row
  std::vector<BarDrink> drinks;          ///< of the level
};

}  // namespace wholehand
