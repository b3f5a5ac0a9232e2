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

/// How long a minimum-jerk way may take so as to stay below half of every speed limit [s].
double wayTime(const DeviceModel& device, const AxisPosition& from, const AxisPosition& to) {
  double time_s = 0.1;
  for (int a = 0; a < from.size(); ++a) {
    const double limit = device.axes[a].speed_limit;
    time_s = std::max(time_s, 1.875 * std::abs(to[a] - from[a]) / (0.5 * limit));
  }
  return time_s;
}

/// Back and above, `aside` of the way to the left, where no scene has a body; open.
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

/// Where the base of a hand is that holds a body: its axis 0.049, 0.041, 0.004 m from there.
void reachFor(const SceneBody& body, const DeviceModel& device, AxisPosition& q) {
  const Eigen::Vector3d base_m = body.pose.translation_m - Eigen::Vector3d(0.049, 0.041, 0.004);
  for (int i = 0; i < 3; ++i) {
    const int a = device.axisIndex(std::string(1, "xyz"[i]));
    const DeviceAxis& axis = device.axes[a];
    q[a] = std::clamp(base_m[i], axis.lower, axis.upper);
  }
}

/// Grasps and fights: to a body, closing; tearing open; off to some corner; and again.
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
  for (const double aside : {0.0, 0.95, 0.0, 0.95}) {  // who plays begins elsewhere each time
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
