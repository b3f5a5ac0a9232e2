#pragma once

#include "exercises/load_exercise.hpp"
#include "exercises/player_reach.hpp"
#include "loop/control/transition.hpp"
#include "loop/core/geometry.hpp"
#include "loop/core/real_time.hpp"
#include "loop/core/tick_record.hpp"
#include "loop/exercise/finger_cushions.hpp"
#include "loop/exercise/finger_walls.hpp"
#include "loop/model/device_model.hpp"
#include "loop/model/hand_model.hpp"
#include "loop/model/scene_model.hpp"

#include <Eigen/Core>

#include <array>
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

/// Lowest viscosity of the liquids [Pa·s].
[[nodiscard]] double thinnest_pa_s(const std::vector<BarLiquid>& liquids);

struct BarDispenser {
  std::string body;
  int body_index = -1;                    ///< index in the level's scene
  int liquid = 0;                         ///< index into Bar::liquids
  bool free = false;                      ///< may be carried
  double radius_m = 0.0, height_m = 0.0;  ///< size of the drawn body
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
  double x_m = 0.0;     ///< withdrawn: the hand's x is below this ...
  double palm_m = 0.0;  ///< ... and the palm is at least this far from every dispenser
};

/// Squeeze: low-passed force on the digits that grip a dispenser [N at the fingertips].
struct BarSqueeze {
  double filter_hz = 5.0;
  double threshold_n = 0.0;  ///< a smaller squeeze leaves the nozzle closed
  double low_n = 0.0, high_n = 0.0, full_n = 0.0;
  double let_go_n = 0.0;
};

/// A free dispenser that was knocked over or pushed out of reach.
struct BarTipOver {
  double tilt_rad = 0.9;    ///< knocked over: tilted by more than this and not held
  double leak_l_s = 0.0;    ///< leak of a lying dispenser with the thinnest liquid
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
  FingerWallConfig walls;   ///< walls with the stiffness of the shells
  Bottle bottle;            ///< common to all dispensers, without liquid
  AxisEffort effort_limit;  ///< limit of the device
  BarSqueeze squeeze;
  BarGlass glass;
  BarRow row;
  BarDrawnBack drawn_back;
  BarTipOver upset;
  BarReach reach;
  BarScoring scoring;
  double counter_z_m = 0.0, rail_z_m = 0.0;  ///< top of the counter, underside of the rail
  int rail_index = -1;                       ///< index in the level's scene
  Eigen::Vector3d rail_home_m;               ///< centre of mass of the rail
  int x_axis = -1;                           ///< x axis of the device; -1: none
  std::vector<BarLiquid> liquids;
  std::vector<BarDispenser> dispensers;  ///< dispensers of the level, in row order
  std::vector<BarDrink> drinks;          ///< drinks of the level
};

/// Reads the rest of a bar's file, checks it against the scene, and reduces the scene to the
/// level's dispensers in their row with the glass under the first nozzle. Reports every fault at
/// once. Not real-time safe.
[[nodiscard]] Expected<Bar> loadBar(TomlFile& file, const ExerciseSource& source);

/// Geometry that a player of the bar needs: the hand's reach, bodies of dispensers and glass.
struct BarLayout : PlayerReach {
  struct Dispenser {
    int body = -1;                     ///< index into the scene's bodies
    Eigen::Vector3d grip_m, nozzle_m;  ///< body frame
    bool free = false;
  };

  int dispenser_count = 0;
  std::array<Dispenser, kMaxDispensers> dispensers{};
  int glass_body = -1;
  double glass_top_m = 0.0;  ///< height of its top above its centre
};

/// Makes the layout. @param hand null: the adult median right hand. Not real-time safe.
[[nodiscard]] BarLayout makeBarLayout(const Bar& bar, const DeviceModel& device,
                                      const HandModel* hand);

/// Region to which the device can bring the palm, extended by `slack_m`.
[[nodiscard]] BarReach reachOf(const BarLayout& layout, double slack_m) noexcept;

/// Range of the row for the reach of an arm.
struct RowReach {
  double lower_m = 0.0, upper_m = 0.0;  ///< y range of the target dispenser
  double nearer_m = 0.0;  ///< distance by which the row is nearer than in the scene, >= 0
};

/// Live parameters of the bar, set by a therapist. Parameters of axes that the device lacks do not
/// exist.
///
///   wall_stiffness_ratio, viscosity_ratio   factors on the values of the file
///   lead_in_m                the value of the file
///   squeeze_threshold_ratio  factor on the thresholds of the level
///   line_tolerance_l         tolerance of every step, at most nine tenths of the step's amount
///   wall_fade_s              T_on: time in which a wall fades in
///   reach_left_m, reach_right_m, reach_forward_m   reach of the person's hand from the device's
///                            middle. The row stays within it; pages keep their aim within it
///   fingers_open_rad, fingers_close_rad   range of the fingers; pages require no more
class BarParameters {
 public:
  /// @param layout within the person's limits @param whole the device with its own ranges: a larger
  /// reach can be set, but the row stays within the limits
  BarParameters(const Bar& bar, const BarLayout& layout, const DeviceModel& whole);

  [[nodiscard]] const std::vector<LiveParameter>& all() const noexcept { return all_; }

  // Accessors of the current values, in the order of all(). Real-time safe.
  [[nodiscard]] WHOLEHAND_RT double stiffness(const double* v) const noexcept { return v[0]; }
  [[nodiscard]] WHOLEHAND_RT double viscosity(const double* v) const noexcept { return v[1]; }
  [[nodiscard]] WHOLEHAND_RT double leadIn_m(const double* v) const noexcept { return v[2]; }
  [[nodiscard]] WHOLEHAND_RT double threshold(const double* v) const noexcept { return v[3]; }
  [[nodiscard]] WHOLEHAND_RT double tolerance_l(const double* v) const noexcept { return v[4]; }
  [[nodiscard]] WHOLEHAND_RT double fade_s(const double* v) const noexcept { return v[5]; }
  [[nodiscard]] WHOLEHAND_RT RowReach reach(const double* v) const noexcept;

 private:
  int add(LiveParameter parameter);

  const BarRow row_;
  const double beside_;                     ///< BarLayout::beside of the hand
  double grip_x_m_ = 0.0, grip_y_m_ = 0.0;  ///< y: of the hand at a dispenser at y = 0
  int left_ = -1, right_ = -1, forward_ = -1;
  double most_left_m_ = 0.0, most_right_m_ = 0.0, most_forward_m_ = 0.0;  ///< within the limits
  std::vector<LiveParameter> all_;
};

}  // namespace wholehand
