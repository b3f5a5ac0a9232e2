#include "loop/adversarial/arena.hpp"

#include "files/patient/patient_file.hpp"
#include "loop/patient/motion.hpp"
#include "support/constants.hpp"

#include <cmath>

namespace wholehand::test {
namespace {

std::string fileOf(const std::string& kind, const std::string& name) {
  return kConfig + kind + "/" + name + ".toml";
}

/// Duration of a minimum-jerk motion that stays below half of every speed limit, at least 0.1 s
/// [s].
double wayTime(const DeviceModel& device, const AxisPosition& from, const AxisPosition& to) {
  double time_s = 0.1;
  for (int a = 0; a < from.size(); ++a) {
    const double limit = device.axes[a].speed_limit;
    time_s = std::max(time_s, 1.875 * std::abs(to[a] - from[a]) / (0.5 * limit));
  }
  return time_s;
}

/// An open hand at the back and at the top, where no scene has a body; `aside` is the share of the
/// way to the left.
AxisPosition clearOf(const DeviceModel& device, double aside) {
  AxisPosition q(device.axisCount());
  for (int a = 0; a < q.size(); ++a) {
    const DeviceAxis& axis = device.axes[a];
    if (axis.name == "x") q[a] = 0.95 * axis.lower;
    if (axis.name == "y") q[a] = aside * axis.upper;
    if (axis.name == "z") q[a] = 0.95 * axis.upper;
  }
  return q;
}

/// Sets the position axes so that the hand holds the body: its base is (0.049, 0.041, 0.004) m from
/// it.
void reachFor(const SceneBody& body, const DeviceModel& device, AxisPosition& q) {
  const Eigen::Vector3d base_m = body.pose.translation_m - Eigen::Vector3d(0.049, 0.041, 0.004);
  for (int i = 0; i < 3; ++i) {
    const int a = device.axisIndex(std::string(1, "xyz"[i]));
    const DeviceAxis& axis = device.axes[a];
    q[a] = std::clamp(base_m[i], axis.lower, axis.upper);
  }
}

/// Eight rounds: moves to a body, closes on it, tears open and moves to a random corner.
Intention graspAndFight(const Models& m, double aside, Random& random) {
  std::vector<Waypoint> way{{0.0, clearOf(m.device, aside)}};
  const auto go = [&](const AxisPosition& q) {
    way.push_back({way.back().time_s + wayTime(m.device, way.back().q, q), q});
  };
  const auto shape = [&](AxisPosition& q, double low, double high, bool fingers) {
    for (int a = 0; a < q.size(); ++a) {
      const DeviceAxis& axis = m.device.axes[a];
      if ((axis.group == AxisGroup::kHand) != fingers) continue;
      q[a] = axis.lower + uniform(random, low, high) * (axis.upper - axis.lower);
    }
  };
  for (int i = 0; i < 8; ++i) {
    AxisPosition q = way.back().q;
    if (!m.scene.bodies.empty()) {
      reachFor(m.scene.bodies[random() % m.scene.bodies.size()], m.device, q);
    }
    go(q);
    shape(q, 0.5, 0.9, true);
    go(q);
    shape(q, 0.0, 0.2, true);
    go(q);
    shape(q, 0.0, 1.0, true);
    shape(q, 0.0, 1.0, false);
    go(q);
  }
  return Intention::throughWaypoints(std::move(way));
}

}  // namespace

/// Draws by the seed and the case alone: a case does the same among all and among few.
Random randomOf(const Case& c) {
  std::uint32_t hash = 2166136261U;  // FNV-1a
  for (const char letter : c.text()) hash = (hash ^ static_cast<unsigned char>(letter)) * 16777619U;
  std::seed_seq mixed{static_cast<std::uint32_t>(seed()), static_cast<std::uint32_t>(seed() >> 32U),
                      hash};
  return Random(mixed);
}

std::vector<std::string> Arena::enter(const Case& c, int level) {
  const std::string place = c.device + c.hand + c.exercise + std::to_string(level);
  if (place == place_) return {};
  ModelFiles files = shippedFiles(c.device, "empty", c.hand);
  files.exercise = fileOf("exercises", c.exercise);
  files.level = level;
  Expected<Models> models = loadModels(files);
  std::vector<std::string> keys;
  if (!models) {
    for (const Diagnostic& fault : models.errors()) keys.push_back(fault.key);
    return keys;
  }
  models_ = std::move(*models);
  place_ = place;
  return keys;
}

std::optional<Outcome> Arena::run(const Case& c, int ticks, Random& random,
                                  const std::function<void(Rig&)>& change) {
  auto changing = std::make_unique<ChangingDevice>();
  ChangingDevice& device = *changing;
  const auto rig = orThrow(buildRigWithoutPerson(models_, std::move(changing), {}, &device));
  if (change) change(*rig);
  Bones bones(*rig);
  for (const double aside : {0.0, 0.95, 0.0, 0.95}) {  // each start has another lateral position
    std::unique_ptr<Player> player = models_.exercise->makePlayer({random()});
    if (!player) {
      player = std::make_unique<ScriptedPlayer>(graspAndFight(models_, aside, random));
    }
    Player& seeing = *player;
    device.put(std::make_unique<SimulatedDevice>(models_.device, person(c, random),
                                                 std::move(player), kPeriod_s));
    if (auto outcome = attack(*rig, device, seeing, bones, ticks)) return outcome;
  }
  return std::nullopt;
}

PatientConfig Arena::person(const Case& c, Random& random) const {
  PatientConfig patient = orThrow(loadPatientFile(fileOf("patients", c.patient), models_.device));
  patient.tremor.phase_seed = random();
  patient.slam.after_s = uniform(random, 0.3, 1.0);
  if (std::isfinite(patient.letting_go.after_s)) {
    patient.letting_go.after_s = uniform(random, 0.5, 3.0);
  }
  return patient;
}

}  // namespace wholehand::test
