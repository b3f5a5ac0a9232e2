#include "experiments/liquid_trial.hpp"

#include "loop/core/geometry.hpp"
#include "loop/device/haptic_device.hpp"
#include "loop/psychometrics/threshold.hpp"

#include <Eigen/Dense>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>

namespace wholehand {
namespace {

constexpr double kHolds_m = 0.01;       // depth in the shell at which the other digit holds
constexpr double kApproach_m_s = 0.02;  // approach speed until the wall is rendered
constexpr double kPress_n = 1.25;       // resistance d times speed v in a steady squeeze
constexpr double kFrom_m = 0.0105, kTo_m = 0.0125;  // path range of the steady squeeze
constexpr double kDrift_n = 0.35;  // d v of the drift on which the oscillation is added ...
constexpr double kSwing = 0.6;     // ... whose speed is this share of the drift
constexpr double kFitted_s = 2.0;
constexpr double kOmega = 2.0 * std::numbers::pi * kLiquidHz;

/// Motion of the digit after it reached the wall.
struct Motion {
  double speed_m_s = 0.0, swing_m = 0.0;
  [[nodiscard]] double path_m(double time_s) const {
    return speed_m_s * time_s + swing_m * std::sin(kOmega * time_s);
  }
};

/// A device that follows a script independently of the effort sent: the palm is at a dispenser and
/// digits close.
class ScriptedHand final : public HapticDevice {
 public:
  static constexpr double kInPlace_s = 2.4;

  /// @param places positions after 0, 0.8, 1.6 and 2.4 s
  ScriptedHand(const std::array<AxisPosition, 4>& places, const DeviceModel& device)
      : places_(places), moved_(device.axisCount()) {
    for (const DeviceAxis& axis : device.axes) lever_m_.push_back(axis.lever_arm_m);
  }

  /// Moves this axis from its current position with `motion`; all other axes stop.
  void move(int axis, Motion motion) noexcept {
    for (int i = 0; i < moved_.size(); ++i) moved_[i] = at_[i] - places_.back()[i];
    axis_ = axis;
    motion_ = motion;
    since_s_ = time_s_;
  }
  [[nodiscard]] double sinceMove_s() const noexcept { return time_s_ - since_s_; }

  [[nodiscard]] Expected<Done> open() override { return Done{}; }
  [[nodiscard]] Expected<Done> ready() override { return Done{}; }
  [[nodiscard]] bool simulated() const noexcept override { return true; }
  [[nodiscard]] Fault read(DeviceReading& reading, int elapsed_periods) noexcept override {
    const double along = std::min(3.0 * time_s_ / kInPlace_s, 3.0 - 1e-9);
    const auto from = static_cast<std::size_t>(along);
    const double u = along - static_cast<double>(from);
    at_ = places_.at(from);
    for (int i = 0; i < at_.size(); ++i) {
      at_[i] += u * u * u * (10.0 + u * (-15.0 + 6.0 * u)) * (places_.at(from + 1)[i] - at_[i]) +
                moved_[i];
    }
    if (axis_ >= 0) at_[axis_] += motion_.path_m(sinceMove_s()) / lever_m_[axis_];
    reading.q_m = at_;
    time_s_ += 1e-3 * elapsed_periods;
    return Fault::kNone;
  }
  [[nodiscard]] Fault write(const AxisEffort&) noexcept override { return Fault::kNone; }
  void close() noexcept override {}

 private:
  std::array<AxisPosition, 4> places_;
  AxisPosition moved_, at_;
  std::vector<double> lever_m_;
  Motion motion_;
  int axis_ = -1;
  double time_s_ = 0.0, since_s_ = 0.0;
};

struct Sample {
  double time_s, path_m, felt_n;  ///< time and path since the touch, and the rendered force
};

/// A liquid of the level: its name, the dispenser that holds it, and its resistance d.
struct Dispenser {
  std::string liquid, body;
  double resistance_n_s_m = 0.0;
};

std::vector<Dispenser> dispensersOf(const Exercise& exercise) {
  const auto json = nlohmann::json::parse(exercise.description().json, nullptr, false);
  std::vector<Dispenser> out;
  if (!json.contains("dispensers") || !json.contains("liquids")) return out;
  for (const auto& d : json["dispensers"]) {
    if (d["free"]) return {};
    for (const auto& liquid : json["liquids"]) {
      if (liquid["name"] != d["liquid"]) continue;
      out.push_back({liquid["name"], d["body"], liquid["resistance_n_s_m"]});
    }
  }
  return out;
}

Diagnostics refused(const ModelFiles& files, const char* what) {
  return {keyFault(files.exercise, "exercise", files.exercise, what,
                   "name a cocktail bar, and a device with finger_flexion and thumb_flexion")};
}

/// Closes an axis on a dispenser until the path or the time is used up.
Expected<std::vector<Sample>> press(const ModelFiles& files, const Dispenser& dispenser,
                                    const char* axis_name, Motion motion, double most_m,
                                    double most_s) {
  Expected<Models> loaded = loadModels(files);
  if (!loaded) return loaded.errors();
  const DeviceModel device = loaded->device;
  const int axis = device.axisIndex(axis_name), turn = device.axisIndex("thumb_circumduction");
  const int fingers = device.axisIndex("finger_flexion"), thumb = device.axisIndex("thumb_flexion");
  const int x = device.axisIndex("x"), y = device.axisIndex("y");
  // Shifts all bodies so that the dispenser is at y = 0. The row itself slides only while the hand
  // is drawn back, which never happens here.
  std::vector<SceneBody>& bodies = loaded->scene.bodies;
  const double at_y_m = bodies[loaded->scene.bodyIndex(dispenser.body)].pose.translation_m.y();
  for (SceneBody& body : bodies) body.pose.translation_m.y() -= at_y_m;
  const double grip_x_m =
      bodies[loaded->scene.bodyIndex(dispenser.body)].pose.translation_m.x() - 0.049;
  const double side = loaded->hand.side == Side::kLeft ? -1.0 : 1.0;
  const auto place = [&](double y_m, double fingers_rad, double thumb_rad, double turn_rad) {
    AxisPosition q(device.axisCount());
    q[x] = grip_x_m, q[y] = side * y_m, q[fingers] = fingers_rad, q[thumb] = thumb_rad;
    if (turn >= 0) q[turn] = turn_rad;
    return q;
  };
  // Power grasp: the middle of the palm is 41 mm beside the hand's base.
  const AxisPosition beside = place(-0.065, 12.0 * kDeg, 0.0, 6.0 * kDeg);
  const AxisPosition open = place(-0.041, 50.0 * kDeg, 0.0, 20.0 * kDeg);
  auto hand = std::make_unique<ScriptedHand>(
      std::array<AxisPosition, 4>{beside, beside, open, open}, device);
  ScriptedHand& script = *hand;
  Expected<std::unique_ptr<Rig>> rig =
      buildRigWithoutPerson(std::move(*loaded), std::move(hand), {});
  if (!rig) return rig.errors();
  HapticRenderer& renderer = *(*rig)->renderer;
  if (Expected<Done> armed = renderer.arm(); !armed) return armed.errors();
  // The other digit holds against the closing digit, because pressure from one side alone does not
  // open the nozzle.
  enum class Phase { kPlaces, kOther, kHolds, kApproaches, kPresses };
  Phase phase = Phase::kPlaces;
  const int other = axis == fingers ? thumb : fingers;
  const double lever_m = device.axes[axis].lever_arm_m;
  std::vector<Sample> out;
  auto record = std::make_unique<TickRecord>();
  double wall = 0.0, before_m = 0.0;
  for (int k = 0; k < 100'000; ++k) {
    record->tick = static_cast<std::uint64_t>(k);
    record->time_s = 1e-3 * k;
    renderer.tick(1, *record);
    const auto felt = [&](int a) { return record->exercise.effort[a] < 0.0; };
    if (phase == Phase::kPlaces && record->time_s > ScriptedHand::kInPlace_s) {
      phase = Phase::kOther;
      script.move(other, {kApproach_m_s, 0.0});
    } else if (phase == Phase::kOther && felt(other)) {
      phase = Phase::kHolds;
      script.move(other, {kApproach_m_s, 0.0});
    } else if (phase == Phase::kHolds && script.sinceMove_s() * kApproach_m_s > kHolds_m) {
      phase = Phase::kApproaches;
      script.move(axis, {kApproach_m_s, 0.0});
    } else if (phase == Phase::kApproaches && felt(axis)) {
      phase = Phase::kPresses;
      script.move(axis, motion);
      wall = record->q_m[axis];
    }
    if (phase != Phase::kPresses) continue;
    const double path_m = lever_m * (record->q_m[axis] - wall);
    const double speed_m_s = (path_m - before_m) / 1e-3;
    const double own_n =
        (device.axes[axis].damping * speed_m_s / lever_m + device.axes[axis].coulomb) / lever_m;
    before_m = path_m;
    out.push_back({script.sinceMove_s(), path_m, -record->sent[axis] / lever_m + own_n});
    if (path_m > most_m || out.back().time_s > most_s) break;
  }
  return out;
}

double meanForce_n(const std::vector<Sample>& samples) {
  double sum_n = 0.0;
  int count = 0;
  for (const Sample& s : samples) {
    if (s.path_m < kFrom_m || s.path_m > kTo_m) continue;
    sum_n += s.felt_n;
    ++count;
  }
  return sum_n / std::max(count, 1);
}

/// Complex ratio of force to path of the oscillation, fitted by least squares together with a
/// linear trend.
std::complex<double> stiffnessOf(const std::vector<Sample>& samples, double from_s,
                                 double swing_m) {
  Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
  Eigen::Vector4d right = Eigen::Vector4d::Zero();
  for (const Sample& s : samples) {
    if (s.time_s < from_s || s.time_s > from_s + kFitted_s) continue;
    const Eigen::Vector4d row(1.0, s.time_s, std::sin(kOmega * s.time_s),
                              std::cos(kOmega * s.time_s));
    normal += row * row.transpose();
    right += s.felt_n * row;
  }
  const Eigen::Vector4d fit = normal.ldlt().solve(right);
  return {fit[2] / swing_m, fit[3] / swing_m};
}

Expected<LiquidFelt> feel(const ModelFiles& files, const Dispenser& dispenser) {
  LiquidFelt out;
  out.liquid = dispenser.liquid;
  out.resistance_n_s_m = dispenser.resistance_n_s_m;
  const double steady_m_s = kPress_n / dispenser.resistance_n_s_m;
  const char* const digits[] = {"finger_flexion", "thumb_flexion"};
  for (std::size_t i = 0; i < 2; ++i) {
    const auto steady = press(files, dispenser, digits[i], {steady_m_s, 0.0}, kTo_m, 60.0);
    if (!steady) return steady.errors();
    out.felt_n_s_m.at(i) = meanForce_n(*steady) / steady_m_s;
  }
  const double drift_m_s = kDrift_n / dispenser.resistance_n_s_m;
  const double swing_m = kSwing * drift_m_s / kOmega;
  constexpr double kSettles_n_m = 60.0;  // a fifth of k + k_s, which gives five time constants
  const double settled_s = dispenser.resistance_n_s_m / kSettles_n_m;
  const auto swung =
      press(files, dispenser, digits[0], {drift_m_s, swing_m}, 1.0, settled_s + kFitted_s);
  if (!swung) return swung.errors();
  out.stiffness_n_m = stiffnessOf(*swung, settled_s, swing_m);
  const auto equal = press(files, dispenser, digits[0], {kSqueeze_m_s, 0.0}, kTo_m, 60.0);
  if (!equal) return equal.errors();
  for (std::size_t i = 0; i < equal->size(); i += 20) {
    out.squeeze.push_back({1e3 * (*equal)[i].path_m, (*equal)[i].felt_n});
  }
  return out;
}

}  // namespace

Expected<std::vector<LiquidFelt>> feelLiquids(const ModelFiles& files) {
  ModelFiles last = files;
  Expected<Models> models = loadModels(last);
  if (!models) return models.errors();
  if (models->exercise == nullptr) return refused(files, "has no dispensers that are fixed");
  last.level = models->exercise->description().levels;
  models = loadModels(last);
  if (!models) return models.errors();
  for (const char* axis : {"x", "y", "finger_flexion", "thumb_flexion"}) {
    if (models->device.axisIndex(axis) < 0)
      return refused(files, "needs an axis that the device lacks");
  }
  const std::vector<Dispenser> dispensers = dispensersOf(*models->exercise);
  if (dispensers.empty()) return refused(files, "has no dispensers that are fixed");
  std::vector<LiquidFelt> out;
  for (const Dispenser& dispenser : dispensers) {
    Expected<LiquidFelt> felt = feel(last, dispenser);
    if (!felt) return felt.errors();
    out.push_back(std::move(*felt));
  }
  return out;
}

double impedanceChange(const LiquidFelt& thinner, const LiquidFelt& thicker) {
  return std::abs(thicker.stiffness_n_m - thinner.stiffness_n_m) / std::abs(thinner.stiffness_n_m);
}

double distinguishedShare(double ratio) {
  return Observer{0.222}.right(std::log(ratio));  // Weber fraction of viscosity, Jones 1997
}

}  // namespace wholehand
