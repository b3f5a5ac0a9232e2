// What the person feels of every liquid, device included: a slow and a fast squeeze of the shipped
// dispenser by a device that follows a script, through the whole renderer.
#include "exercise/finger_walls.hpp"
#include "patient/scripted_player.hpp"
#include "support/constants.hpp"
#include "support/file_bytes.hpp"
#include "support/folder.hpp"
#include "support/rig_tools.hpp"
#include "support/tolerance.hpp"

#include <nlohmann/json.hpp>

#include <cmath>
#include <iterator>

namespace wholehand::test {
namespace {

constexpr int kFingerAxis = 3, kTurnAxis = 4,
              kThumbAxis = 5;  // axes of lambda-pride, after x, y, z

struct Liquid {
  std::string name;
  double stiffness = 1.0, viscosity = 1.0;
};

std::vector<Liquid> shippedLiquids() {
  const Models models = load(exerciseFiles("cocktail-bar"));
  std::vector<Liquid> out;
  const auto json = nlohmann::json::parse(models.exercise->description().json);
  for (const auto& l : json["liquids"]) {
    out.push_back({l["name"], l["stiffness"], l["viscosity"]});
  }
  return out;
}

/// Level 1 with this liquid's stiffness and viscosity in its one dispenser.
Models barWith(const Liquid& liquid, const Folder& folder) {
  const std::string text = replaced(bytesOfFile(kConfig + "exercises/cocktail-bar.toml"),
                                    "viscosity = 1.0\nstiffness = 1.0",
                                    "viscosity = " + std::to_string(liquid.viscosity) +
                                        "\nstiffness = " + std::to_string(liquid.stiffness));
  folder.write("scenes/cocktail-bar.toml", bytesOfFile(kConfig + "scenes/cocktail-bar.toml"));
  ModelFiles files = shippedFiles();
  files.scene.clear();
  files.exercise = folder.write("exercises/bar.toml", text);
  return load(files);
}

/// One tick of a squeeze: how far an axis has gone, and what the person feels there.
struct Sample {
  double path_m = 0.0, felt_n = 0.0;
};
struct Squeeze {
  std::vector<Sample> samples;  ///< from where the wall begins to where the core is met
  double core_m = 0.0;          ///< path at which it is met
};

/// The hand about the dispenser, palm against it, closes one axis at a speed of the fingertip.
Squeeze squeeze(Models models, int axis, double speed_m_s) {
  const int body = models.scene.bodyIndex("dispenser_lemon");
  const Eigen::Vector3d at_m = models.scene.bodies[body].pose.translation_m;
  const DeviceAxis device = models.device.axes[axis];
  const double lever_m = device.lever_arm_m;
  const auto pose = [&](double x, double y, double fingers, double turn, double thumb) {
    AxisPosition q(6);
    q[0] = x, q[1] = y, q[2] = 0.0, q[kFingerAxis] = fingers, q[kTurnAxis] = turn,
    q[kThumbAxis] = thumb;
    return q;
  };
  // A power grasp of an upright cylinder: its axis 49 mm before, 41 mm beside the hand's base.
  const double x = at_m.x() - 0.049, y = at_m.y() - 0.041;
  const AxisPosition back = pose(-0.08, y - 0.024, 0.2, 0.1, 0.0);
  const AxisPosition beside = pose(x, y - 0.024, 0.2, 0.1, 0.0);
  const AxisPosition open = pose(x, y, 50.0 * kDeg, 20.0 * kDeg, 0.0);
  const double most = axis == kFingerAxis ? 170.0 * kDeg : 70.0 * kDeg;
  const double from_s = 4.0;
  auto player = std::make_shared<ScriptedPlayer>(
      Intention::throughWaypoints({{0.0, back}, {0.8, beside}, {1.6, open}, {from_s, open}}));
  AxisPosition q = back;
  AxisVelocity qd(6);
  const auto rig = buildScripted(std::move(models), [=](int read) mutable {
    if (read == 0) {
      player->reset();
      return back;
    }
    player->advance(1e-3, q, qd);
    AxisPosition at = q;
    const double closing_s = 1e-3 * read - from_s;
    if (closing_s > 0.0) at[axis] = std::min(open[axis] + closing_s * speed_m_s / lever_m, most);
    return at;
  });
  Squeeze out;
  if (auto armed = rig->renderer->arm(); !armed) {
    ADD_FAILURE() << format(armed.errors());
    return out;
  }
  const auto capsules = axesOfCapsules(rig->models.hand);
  double wall = 0.0;
  const int ticks = static_cast<int>(1e3 * (from_s + (most - open[axis]) * lever_m / speed_m_s));
  runTicks(*rig->renderer, ticks, [&](const TickRecord& r) {
    if (r.time_s < from_s || out.core_m > 0.0) return;
    EXPECT_EQ(r.exercise.alpha, 1.0) << r.time_s;
    if (!(r.exercise.effort[axis] < 0.0)) return;
    if (out.samples.empty()) wall = r.exercise.wall[axis];
    const double path_m = lever_m * (r.q_m[axis] - wall);
    const double own_n = (device.damping * speed_m_s / lever_m + device.coulomb) / lever_m;
    out.samples.push_back({path_m, -r.sent[axis] / lever_m + own_n});
    if ((touchingAxes(r, body, capsules) >> axis & 1U) != 0U) out.core_m = path_m;
  });
  return out;
}

/// Least squares over a stretch of path: felt = a + k path.
struct Line {
  double at_middle_n = 0.0, slope_n_m = 0.0;
};
Line fit(const Squeeze& s, double from_m, double to_m) {
  double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (const Sample& p : s.samples) {
    if (p.path_m < from_m || p.path_m > to_m) continue;
    n += 1, sx += p.path_m, sy += p.felt_n, sxx += p.path_m * p.path_m, sxy += p.path_m * p.felt_n;
  }
  EXPECT_GT(n, 50);
  const double slope = (n * sxy - sx * sy) / (n * sxx - sx * sx);
  return {(sy + slope * (n * 0.5 * (from_m + to_m) - sx)) / n, slope};
}

constexpr double kSlow_m_s = 0.01, kFast_m_s = 0.08;
constexpr double kFrom_m = 0.001, kTo_m = 0.0095;  // 8.5 mm of the squeeze

/// What is felt in total on an axis: stiffness [N/m] and damping [N·s/m] at the tip.
struct Total {
  double stiffness = 0.0, damping = 0.0;
};

Total feel(const Liquid& liquid, int axis, const Folder& folder) {
  const Squeeze slow = squeeze(barWith(liquid, folder), axis, kSlow_m_s);
  const Squeeze fast = squeeze(barWith(liquid, folder), axis, kFast_m_s);
  figure("path before the core, " + liquid.name + ", axis " + std::to_string(axis),
         1e3 * slow.core_m, "mm");
  EXPECT_GE(slow.core_m, 0.010);
  const Line at_rest = fit(slow, kFrom_m, kTo_m), moving = fit(fast, kFrom_m, kTo_m);
  return {at_rest.slope_n_m, (moving.at_middle_n - at_rest.at_middle_n) / (kFast_m_s - kSlow_m_s)};
}

/// The figure: neighbours differ by 1.25 in stiffness, device included (threshold 1.22, Tan 1995).
/// Their damping does not differ by 1.35 (1.34, Jones 1997), and nothing claims that it does.
TEST(Liquids, FeltInTotal_NeighboursDifferInStiffness) {
  const Folder folder;
  for (const int axis : {kFingerAxis, kThumbAxis}) {
    Total before;
    for (const Liquid& liquid : shippedLiquids()) {
      const Total now = feel(liquid, axis, folder);
      const std::string of = ", " + liquid.name + ", axis " + std::to_string(axis);
      figure("stiffness felt in total" + of, now.stiffness, "N/m");
      figure("damping felt in total" + of, now.damping, "N·s/m");
      // 100 N/m times the liquid's ratio; the device has no spring of its own.
      EXPECT_NEAR(now.stiffness, 100.0 * liquid.stiffness, 0.02 * 100.0 * liquid.stiffness);
      if (before.stiffness > 0.0) {
        EXPECT_GE(now.stiffness / before.stiffness, 1.25);
        figure("ratio of stiffness to the one before" + of, now.stiffness / before.stiffness, "");
        figure("ratio of damping to the one before" + of, now.damping / before.damping, "");
      }
      before = now;
    }
  }
}

}  // namespace
}  // namespace wholehand::test
