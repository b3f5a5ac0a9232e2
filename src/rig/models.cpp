#include "rig/models.hpp"

#include "certify/certificate_refusal.hpp"
#include "exercises/load_exercise.hpp"
#include "files/device/device_file.hpp"
#include "files/device/rendering_file.hpp"
#include "files/hand/hand_file.hpp"
#include "files/patient/motion_file.hpp"
#include "files/patient/patient_file.hpp"
#include "files/patient/prescription_file.hpp"
#include "files/scene/scene_file.hpp"
#include "loop/dynamics/articulated_body.hpp"
#include "loop/dynamics/synergy.hpp"
#include "loop/patient/motion.hpp"
#include "rig/prescribed_guides.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <mutex>
#include <random>
#include <set>
#include <utility>
#include <vector>

namespace wholehand {

namespace fs = std::filesystem;
namespace {

// Moves the value into `into`, or the errors into the common list. Returns true for a value.
template <class T>
bool take(Expected<T> from, T& into, Diagnostics& errors) {
  if (from) {
    into = std::move(from).value();
    return true;
  }
  errors.insert(errors.end(), from.errors().begin(), from.errors().end());
  return false;
}

void takeExercise(Expected<LoadedExercise> from, Models& models, Diagnostics& errors) {
  LoadedExercise loaded;
  if (!take(std::move(from), loaded, errors)) return;
  models.exercise = std::move(loaded.exercise);
  models.scene = std::move(loaded.scene);
  models.exercise_files = std::move(loaded.files);
  models.exercise_walls = std::move(loaded.walls);
  models.exercise_panel = std::move(loaded.panel);
  models.exercise_moved_m = loaded.moved_m;
}

void takePrescription(const std::string& path, Models& models, Diagnostics& errors) {
  Prescription prescription;
  if (take(loadPrescriptionFile(path, models.device), prescription, errors)) {
    models.prescription = std::move(prescription);
  }
}

std::vector<std::string> pathsOf(const Models& models) {
  std::vector<std::string> paths{models.files.hand, models.files.device, models.files.rendering,
                                 models.files.patient};
  if (!models.mirrored_hand.empty()) paths.push_back(models.mirrored_hand);
  if (models.files.exercise.empty()) paths.push_back(models.files.scene);
  paths.insert(paths.end(), models.exercise_files.begin(), models.exercise_files.end());
  if (!models.files.motion.empty()) paths.push_back(models.files.motion);
  if (models.prescription) paths.push_back(models.prescription->path);
  paths.insert(paths.end(), models.scene.assets.begin(), models.scene.assets.end());
  return paths;
}

fs::path commonFolder(const std::vector<fs::path>& paths) {
  fs::path common = paths.front().parent_path();
  const auto outside = [&common](const fs::path& path) {
    const fs::path relative = path.lexically_relative(common);
    return relative.empty() || *relative.begin() == "..";
  };
  for (const fs::path& path : paths) {
    while (outside(path)) common = common.parent_path();
  }
  return common;
}

}  // namespace

Models::Models() = default;
Models::Models(const Models&) = default;
Models::Models(Models&&) noexcept = default;
Models& Models::operator=(const Models&) = default;
Models& Models::operator=(Models&&) noexcept = default;
Models::~Models() = default;

Expected<Models> loadModels(const ModelFiles& files) {
  Models models;
  models.files = files;
  Diagnostics errors;
  const bool have_device = take(loadDeviceFile(files.device), models.device, errors);
  HandFile hand_file;
  const bool have_hand = take(loadHandFile(files.hand), hand_file, errors);
  models.mirrored_hand = hand_file.mirrored_path;
  if (files.exercise.empty()) take(loadSceneFile(files.scene), models.scene, errors);
  if (!files.motion.empty()) {
    MotionFile motion;
    if (take(loadMotionFile(files.motion, have_device ? &models.device : nullptr), motion,
             errors)) {
      models.motion = std::move(motion);
    }
  }
  if (have_device) {
    const bool have_gains =
        take(loadRenderingFile(files.rendering, models.device), models.rendering, errors);
    take(loadPatientFile(files.patient, models.device), models.patient, errors);
    if (!files.prescription.empty()) takePrescription(files.prescription, models, errors);
    if (have_hand && take(assembleHand(hand_file, models.device), models.hand, errors) &&
        !files.exercise.empty()) {
      takeExercise(loadExercise(files.exercise, files.level, models.device, models.hand,
                                have_gains ? bearsWalls(models, files.period_s) : BearsWalls{},
                                models.prescription ? &*models.prescription : nullptr),
                   models, errors);
    }
  }
  if (errors.empty() && models.prescription) {
    errors = refuseOtherSide(*models.prescription, models.hand);
  }
  if (!errors.empty()) return errors;
  // The file stays named for the next exercise.
  if (models.exercise && models.exercise->description().measures_own_movement) {
    models.prescription.reset();
  }
  return models;
}

Expected<std::vector<std::pair<std::string, std::string>>> readFileTexts(const Models& models) {
  std::vector<fs::path> absolute;
  for (const std::string& path : pathsOf(models)) {
    absolute.push_back(fs::weakly_canonical(path));
  }
  const fs::path common = commonFolder(absolute);
  std::set<fs::path> seen;
  std::vector<std::pair<std::string, std::string>> texts;
  for (const fs::path& path : absolute) {
    if (!seen.insert(path).second) continue;
    std::ifstream in(path, std::ios::binary);
    if (!in) return fileFault(path.string(), "cannot be read", "check the path");
    texts.emplace_back(path.lexically_relative(common).string(),
                       std::string(std::istreambuf_iterator<char>(in), {}));
  }
  if (const SceneModel& scene = models.scene; !scene.made_text.empty()) {
    const fs::path path = fs::weakly_canonical(scene.path).lexically_relative(common);
    texts.emplace_back(madeScenePath(path.string()), scene.made_text);
  }
  return texts;
}

AxisPosition restPose(const Models& models) {
  AxisPosition rest(models.device.axisCount());
  for (int a = 0; a < rest.size(); ++a) {
    const DeviceAxis& axis = models.device.axes[a];
    const bool centered = axis.kind == AxisKind::kTranslation || axis.lower < 0.0;
    rest[a] = centered ? 0.5 * (axis.lower + axis.upper) : models.hand.reference[a];
  }
  return rest;
}

Intention intentionOf(const Models& models, std::vector<std::string>* sentences) {
  const AxisPosition rest = restPose(models);
  if (!models.motion) return Intention::throughWaypoints({{0.0, rest}});
  if (sentences != nullptr) {
    for (const Diagnostic& notice : models.motion->notices) sentences->push_back(format(notice));
  }
  return Intention::fromMotion(*models.motion, models.patient.motion, models.device, rest,
                               sentences);
}

std::unique_ptr<Player> makeExercisePlayer(const Models& models, std::uint64_t seed) {
  if (!models.exercise) return nullptr;
  return models.exercise->makePlayer({seed, reflexFreeOpeningSpeed(models.patient)});
}

std::unique_ptr<Player> makeMotionPlayer(const Models& models) {
  return std::make_unique<ScriptedPlayer>(intentionOf(models, nullptr),
                                          models.motion ? Mover::kMotion : Mover::kNobody);
}

namespace {

AxisMatrix reducedInertiaAt(const HandModel& hand, ArticulatedBody& body, const AxisPosition& q_s) {
  JointPosition theta;
  Synergy(hand).expand(q_s, theta);
  [[maybe_unused]] const bool definite =
      body.update(theta, JointVelocity(hand.joint_count), Eigen::Vector3d::Zero());
  return body.reducedInertia();
}

// A posture: lower end, middle or upper end on every axis.
using Places = std::vector<int>;

// All combinations for up to six axes. For more axes, as many as for six, drawn from a fixed random
// sequence.
std::vector<Places> choosePlaces(std::size_t axes) {
  constexpr std::size_t kFewAxes = 6;
  constexpr int kMost = 729;  // 3^6
  std::vector<Places> chosen;
  if (axes <= kFewAxes) {
    int count = 1;
    for (std::size_t i = 0; i < axes; ++i) count *= 3;
    for (int index = 0; index < count; ++index) {
      Places places;
      for (int digits = index; places.size() < axes; digits /= 3) places.push_back(digits % 3);
      chosen.push_back(places);
    }
    return chosen;
  }
  for (int place = 0; place < 3; ++place) chosen.emplace_back(axes, place);
  std::mt19937_64 random(1);  // fixed seed: the same postures in every run
  while (chosen.size() < kMost) {
    Places places;
    while (places.size() < axes) places.push_back(static_cast<int>(random() % 3));
    chosen.push_back(places);
  }
  return chosen;
}

}  // namespace

SampledInertia sampleInertia(const HandModel& hand, const DeviceModel& device) {
  ArticulatedBody body(hand);
  SampledInertia out;
  out.at_reference = reducedInertiaAt(hand, body, hand.reference);
  std::vector<int> moving;
  for (int a = 0; a < device.axisCount(); ++a) {
    if (device.axes[a].kind == AxisKind::kRotation) moving.push_back(a);
  }
  for (const Places& places : choosePlaces(moving.size())) {
    AxisPosition q_s(device.axisCount());
    for (std::size_t i = 0; i < moving.size(); ++i) {
      const DeviceAxis& axis = device.axes[moving[i]];
      q_s[moving[i]] = axis.lower + 0.5 * places[i] * (axis.upper - axis.lower);
    }
    out.samples.push_back(reducedInertiaAt(hand, body, q_s));
  }
  return out;
}

namespace {

void addWalls(CertificateInput& input, const std::vector<ExerciseWall>& walls) {
  for (const ExerciseWall& wall : walls) {
    input.walls.push_back({wall.axis, {wall.stiffness, wall.damping, wall.resistance}});
  }
}

}  // namespace

CertificateInput certificateInputWithoutGuides(const Models& models, double period_s) {
  SampledInertia inertia = sampleInertia(models.hand, models.device);
  CertificateInput input;
  input.device = models.device;
  input.rendering = models.rendering;
  input.inertia_at_reference = inertia.at_reference;
  input.inertias = std::move(inertia.samples);
  input.period_s = period_s;
  addWalls(input, models.exercise_walls);
  input.hand = models.hand.name;
  if (models.exercise) {
    const ExerciseDescription& exercise = models.exercise->description();
    input.exercise = exercise.name;
    input.level = exercise.levels > 1 ? exercise.level : 0;
  }
  return input;
}

CertificateInput certificateInput(const Models& models, double period_s) {
  CertificateInput input = certificateInputWithoutGuides(models, period_s);
  addGuideWalls(input, guideStiffnesses(models, input));
  return input;
}

bool passesCertificate(const CertificateInput& input) {
  constexpr std::size_t kMost = 1000;
  static std::mutex mutex;
  static std::set<std::string> passed;
  std::string key = fmt::format("{:.17g} {}", input.period_s, static_cast<int>(input.persons));
  for (const FingerprintPart& part : fingerprintOf(input).parts) key += " " + part.hash;
  {
    const std::lock_guard lock(mutex);
    if (passed.contains(key)) return true;
  }
  if (!isCertified(input)) return false;
  const std::lock_guard lock(mutex);
  if (passed.size() < kMost) passed.insert(key);
  return true;
}

std::function<bool(const std::vector<ExerciseWall>&)> bearsWalls(const Models& models,
                                                                 double period_s) {
  return [&models, period_s](const std::vector<ExerciseWall>& walls) {
    CertificateInput input = certificateInput(models, period_s);
    addWalls(input, walls);
    return passesCertificate(input);
  };
}

}  // namespace wholehand
