#include "exercises/player_reach.hpp"
#include "exercises/tell_apart/comparing.hpp"
#include "support/figure.hpp"
#include "support/rig_tools.hpp"
#include "support/seed.hpp"

#include <cmath>
#include <cstdio>
#include <functional>

namespace wholehand::test {
namespace {

/// Effort at the fingertip and its path while a scripted hand closes on a bottle.
struct PressSample {
  double time_s, path_m, force_n;
};
struct Press {
  std::vector<PressSample> samples;
  std::size_t onset = 0;  ///< first sample in which the bottle resists
  double before_n = 0.0;  ///< mean force of the 0.1 s before: what moving the hand costs
  double touch_m = 0.0;   ///< path at the geometric first touch
  double stiffness_n_m = 0.0, return_n_m = 0.0, opening_n = 0.0;  ///< of the file
};

/// Presses one bottle of the exercise, through the whole renderer, at 10 mm/s; it stops where the
/// path is `deep_m` behind the onset and stays there.
Press press(const ModelFiles& files, int bottle, double place, double deep_m) {
  Models models = load(files);
  const DeviceModel device = models.device;
  const int finger = device.axisIndex("finger_flexion");
  const double lever_m = device.axes[finger].lever_arm_m;
  const SceneBody& body =
      models.scene.bodies[models.scene.bodyIndex(bottle == 0 ? "lower_bottle" : "upper_bottle")];
  const PlayerReach reach = playerReach(device, &models.hand, body.shapes[0].radius_m);
  const Eigen::Vector3d grip_m = body.pose.translation_m - reach.grip_m;
  AxisPosition beside(device.axisCount()), at(device.axisCount());
  for (AxisPosition* q : {&beside, &at}) {
    (*q)[reach.x] = grip_m.x(), (*q)[reach.y] = grip_m.y(), (*q)[reach.z] = grip_m.z();
  }
  beside[reach.y] -= 0.024 * reach.beside;
  beside[finger] = 0.14;
  at[finger] = 1.13;
  at[reach.turn] = 0.35;
  constexpr double kSpeed_m_s = 0.01;
  double path_m = lever_m * at[finger], stop_m = HUGE_VAL, closure_m = HUGE_VAL;
  const auto arrive = moveAndHold(beside, at, 1000);
  const auto script = [&](int read) {
    AxisPosition q = arrive(read);
    if (read > 2500) {
      const bool far = path_m < closure_m - 0.005;
      path_m = std::min(stop_m, path_m + 1e-3 * (far ? 4.0 * kSpeed_m_s : kSpeed_m_s));
      q[finger] = path_m / lever_m;
    }
    return q;
  };
  const auto rig = buildScripted(std::move(models), script);
  orThrow(rig->renderer->arm());
  Press out;
  auto record = std::make_unique<TickRecord>();
  for (int k = 0; k < 12'000; ++k) {
    record->tick = static_cast<std::uint64_t>(k);
    record->time_s = 1e-3 * k;
    record->command_count = k == 0 ? 1 : 0;
    record->commands[0] = {};
    record->commands[0].type = CommandType::kAction;
    record->commands[0].index = static_cast<std::int32_t>(kBeginAt);
    record->commands[0].value = place;
    rig->renderer->tick(1, *record);
    EXPECT_EQ(record->faults & kStoppingFaults, Fault::kNone) << k;
    if (k == 2400) closure_m = out.touch_m = lever_m * record->closure[finger];
    if (k < 2500) continue;
    if (out.onset == 0 && record->exercise.effort[finger] < 0.0) {
      out.onset = out.samples.size();
      stop_m = lever_m * record->q_m[finger] + deep_m;
    }
    out.samples.push_back(
        {record->time_s, lever_m * record->q_m[finger], -record->sent[finger] / lever_m});
  }
  EXPECT_GT(out.onset, 100U);
  for (std::size_t i = out.onset - 100; i < out.onset; ++i) {
    out.before_n += out.samples[i].force_n / 100.0;
  }
  return out;
}

struct Line {
  double slope = 0.0, crossing = 0.0;  ///< where it is `at`
};
/// Least squares of `y` over `x` for the samples that are `in`.
Line fitLine(const Press& press, const std::function<bool(const PressSample&)>& in,
             double PressSample::*x, double at) {
  double n = 0.0, sx = 0.0, sy = 0.0, sxx = 0.0, sxy = 0.0;
  for (const PressSample& s : press.samples) {
    if (!in(s)) continue;
    n += 1.0, sx += s.*x, sy += s.force_n, sxx += s.*x * s.*x, sxy += s.*x * s.force_n;
  }
  EXPECT_GT(n, 5.0);
  const double slope = (n * sxy - sx * sy) / (n * sxx - sx * sx);
  return {slope, sx / n + (at - sy / n) / slope};
}

/// The spring at the begin of a press: its stiffness, and the path at which it begins.
Line springOf(const Press& press) {
  const double from_m = press.samples[press.onset].path_m;
  return fitLine(
      press,
      [&](const PressSample& s) { return s.path_m > from_m + 4e-4 && s.path_m < from_m + 1.9e-3; },
      &PressSample::path_m, press.before_n);
}

/// How much of a quantity is felt, from forces and paths alone.
double amountFelt(const std::string& quantity, const Press& press) {
  const Line spring = springOf(press);
  if (quantity == "firmer") return spring.slope;
  if (quantity == "farther") return spring.crossing - press.touch_m;
  const double from_m = press.samples[press.onset].path_m;
  if (quantity == "heavier") {
    double sum_n = 0.0, n = 0.0;
    for (const PressSample& s : press.samples) {
      if (s.path_m < from_m + 6e-3) continue;
      sum_n += s.force_n - press.before_n, n += 1.0;
    }
    return sum_n / n;
  }
  if (quantity == "later") {
    double held_n = 0.0, onset_s = 0.0;
    for (const PressSample& s : press.samples) {
      held_n = std::max(held_n, s.force_n);
      if (s.path_m <= spring.crossing) onset_s = s.time_s + (spring.crossing - s.path_m) / 0.01;
    }
    return fitLine(
               press,
               [&](const PressSample& s) {
                 return s.time_s > onset_s + 0.25 && s.force_n < 0.97 * held_n &&
                        s.force_n > 0.85 * held_n;
               },
               &PressSample::time_s, held_n)
               .crossing -
           onset_s;
  }
  // Thicker: d = ∫ (f − k_s y − p₀) dt / y with y = depth − f/k, the law of loop/control/
  // viscoelastic.hpp.
  double impulse = 0.0, travel_m = 0.0;
  for (std::size_t i = press.onset; i < press.samples.size(); ++i) {
    const double f_n = press.samples[i].force_n - press.before_n;
    const double y_m = press.samples[i].path_m - from_m - f_n / press.stiffness_n_m;
    const double drive_n = f_n - press.return_n_m * y_m - press.opening_n;
    if (drive_n < 0.05 || press.samples[i].path_m > from_m + 8e-3) continue;
    if (travel_m == 0.0) travel_m = -y_m;
    impulse += 1e-3 * drive_n;
    if (press.samples[i].path_m > from_m + 7.9e-3) return impulse / (travel_m + y_m);
  }
  return 0.0;
}

/// The place in a block whose comparison under way is at this level.
double placeOfLevel(int level, double& x) {
  tell_apart::ComparingRules rules;
  rules.most_level = rules.scale.count - 1;
  tell_apart::Comparing comparing(rules);
  for (;;) {
    if (comparing.block().level() == level && !comparing.now().is_catch) break;
    const bool second = comparing.now().x > 0.0, too_high = comparing.block().level() > level;
    tell_apart::Comparing next(rules);
    double place = comparing.place();
    const double order = std::floor(place / 0x1p51) * 0x1p51;
    place = order + 2.0 * (place - order) + (second == (too_high || comparing.now().is_catch));
    comparing.beginAt(place);
  }
  x = comparing.now().x;
  return comparing.place();
}

double deepest_m(const std::string& quantity) {
  return quantity == "later" ? 0.002 : quantity == "heavier" ? 0.009 : 0.008;
}

/// Largest deviation of the felt x over its bound of 3 %, at least 0.002.
void feel(const std::string& quantity, const std::string& hand, const std::string& device) {
  const ModelFiles files = exerciseFiles("tell-apart-" + quantity, 1, hand, device);
  for (const int level : {0, 8, 16, 23}) {
    double x = 0.0;
    const double place = placeOfLevel(level, x);
    double felt[2];
    for (const int bottle : {0, 1}) {
      Press of = press(files, bottle, place, deepest_m(quantity));
      of.stiffness_n_m = 280.0, of.return_n_m = 25.0, of.opening_n = 0.1;
      felt[bottle] = amountFelt(quantity, of);
    }
    const double deviation = std::log(felt[1] / felt[0]) - x;
    std::printf("figure: %s, %s, %s, x %+.4f: felt %.5g and %.5g, deviation %+.5f (bound %.4f)\n",
                quantity.c_str(), hand.c_str(), device.c_str(), x, felt[0], felt[1], deviation,
                std::max(0.002, 0.03 * std::abs(x)));
    EXPECT_LE(std::abs(deviation), std::max(0.002, 0.03 * std::abs(x))) << quantity << " " << x;
  }
}

const std::vector<std::string> kFeltQuantities = {"firmer", "thicker", "farther", "heavier",
                                                  "later"};

TEST(TellApart, StimulusFeltThroughTheRenderer_DeviatesByAtMost3Percent) {
  for (const std::string& quantity : sampleTenth<std::string>(kFeltQuantities)) {
    feel(quantity, "adult-median-right", "lambda-pride");
  }
}

TEST(TellApart, StimulusFeltByThreeHandsWithTwoDevices_DeviatesByAtMost3Percent_slow) {
  for (const char* device : {"lambda-pride", "wrist-9axis"}) {
    for (const char* hand : {"woman-p05-right", "adult-median-left", "man-p95-right"}) {
      for (const std::string& quantity : kFeltQuantities) feel(quantity, hand, device);
    }
  }
}

}  // namespace
}  // namespace wholehand::test
