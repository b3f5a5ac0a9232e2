#pragma once

#include "control/transition.hpp"
#include "exercise/finger_cushions.hpp"
#include "exercise/finger_walls.hpp"
#include "exercise/load_exercise.hpp"
#include "model/scene/scene_model.hpp"

#include <Eigen/Core>

#include <string>
#include <vector>

/// Cocktail bar of one level, from its file and scene. Plain data, immutable during play.
namespace wholehand {

inline constexpr int kMaxDispensers = 6;  ///< most dispensers of a level
inline constexpr int kMaxSteps = 8;       ///< most steps of a drink

struct BarLiquid {
  std::string name, color, pattern, symbol;
  double viscosity_pa_s = 1.0;
};

/// The least viscosity of them.
[[nodiscard]] double thinnest_pa_s(const std::vector<BarLiquid>& liquids);

struct BarDispenser {
  std::string body;
  int body_index = -1;                    ///< in the level's scene
  int liquid = 0;                         ///< index into Bar::liquids
  bool free = false;                      ///< may be carried
  double radius_m = 0.0, height_m = 0.0;  ///< of the drawn body
  double soft_m = 0.0;                    ///< thickness of the soft shell around the core
  double start_l = 0.0;                   ///< initial volume
  Eigen::Vector3d nozzle_m, grip_m;       ///< from the centre of mass, body frame
  Eigen::Vector3d home_m;                 ///< initial centre of mass
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
  double radius_m = 0.0, height_m = 0.0;  ///< outer dimensions
  double inner_radius_m = 0.0;
  double m_per_l = 0.0;  ///< height per litre
  double capacity_l = 0.0;
  double slide_s = 0.0;
};

/// Placement of the row of dispensers.
struct BarRow {
  bool slides = false;
  double spacing_m = 0.0;
  double reach_lower_m = 0.0, reach_upper_m = 0.0;  ///< y range of reachable dispensers
  double speed_m_s = 0.0;
};

/// Range of a dispenser's centre of mass within reach of the palm.
struct BarReach {
  Eigen::Vector3d lower_m = Eigen::Vector3d::Constant(-1e3);
  Eigen::Vector3d upper_m = Eigen::Vector3d::Constant(1e3);

  [[nodiscard]] bool contains(const Eigen::Vector3d& at_m) const noexcept {
    return (at_m.array() >= lower_m.array() && at_m.array() <= upper_m.array()).all();
  }
};

/// Condition for a withdrawn hand. Bodies may then slide or be put upright.
struct BarDrawnBack {
  double x_m = 0.0;     ///< the hand's x is less ...
  double palm_m = 0.0;  ///< ... and the palm at least this far from every dispenser
};

/// Squeeze: force on the digits that grip a dispenser, low-passed [N at the fingertips].
struct BarSqueeze {
  double filter_hz = 5.0;
  double threshold_n = 0.0;  ///< less leaves the nozzle closed
  double low_n = 0.0, high_n = 0.0, full_n = 0.0;
  double let_go_n = 0.0;
};

/// A free dispenser that was knocked over or pushed out of reach.
struct BarTipOver {
  double tilt_rad = 0.9;    ///< knocked over: tilt beyond this, held by nobody
  double leak_l_s = 0.0;    ///< leak of a lying dispenser, thinnest liquid
  double stand_up_s = 3.0;  ///< put upright after lying this long with the hand withdrawn
  double dropped_m = 0.05;  ///< also put upright this far below its start
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
  FingerWallConfig walls;   ///< the shells' stiffness
  Bottle bottle;            ///< of every dispenser, without its liquid
  AxisEffort effort_limit;  ///< limit of the device
  BarSqueeze squeeze;
  BarGlass glass;
  BarRow row;
  BarDrawnBack drawn_back;
  BarTipOver upset;
  BarReach reach;
  BarScoring scoring;
  double counter_z_m = 0.0, rail_z_m = 0.0;  ///< top of the counter, underside of the rail
  int rail_index = -1;                       ///< in the level's scene
  Eigen::Vector3d rail_home_m;               ///< centre of mass of the rail
  int x_axis = -1;                           ///< x axis of the device; -1: none
  std::vector<BarLiquid> liquids;
  std::vector<BarDispenser> dispensers;  ///< dispensers of the level, in row order
  std::vector<BarDrink> drinks;          ///< drinks of the level
};

/// Reads the rest of a bar's file against its scene, and reduces the scene to the level's
/// dispensers in their row, with the glass under the first nozzle. Reports every fault at once. Not
/// real-time safe.
[[nodiscard]] Expected<Bar> loadBar(TomlFile& file, const ExerciseSource& source);

}  // namespace wholehand
