#pragma once

#include "certify/certificate.hpp"
#include "loop/core/expected.hpp"
#include "loop/exercise/exercise.hpp"
#include "loop/model/device_model.hpp"
#include "loop/model/exercise_panel.hpp"
#include "loop/model/hand_model.hpp"
#include "loop/model/patient_config.hpp"
#include "loop/model/prescription.hpp"
#include "loop/model/rendering_config.hpp"
#include "loop/model/scene_model.hpp"
#include "loop/patient/motion.hpp"

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace wholehand {

/// Files of a run. Without a motion file the patient rests.
struct ModelFiles {
  std::string scene = "config/scenes/four-shapes.toml";
  std::string hand = "config/hands/adult-median-right.toml";
  std::string device = "config/devices/lambda-pride.toml";
  std::string rendering = "config/rendering/lambda-pride.toml";
  std::string patient = "config/patients/relaxed-adult.toml";
  // Each member has an initializer, so that a caller names only the files of their own.
  std::string motion = {};
  std::string exercise = {};  ///< exercise file, which names its own scene; empty: the scene above
  int level = 1;              ///< level of the exercise
  std::string prescription = {};  ///< file of kind "prescription"; empty: none
  double period_s = 1e-3;         ///< an exercise offers at most what is certified at this period

  /// All paths; unused ones are empty.
  [[nodiscard]] std::vector<std::string> all() const {
    return {scene, hand, device, rendering, patient, motion, exercise, prescription};
  }
};

/// Contents of all files, checked against each other.
struct Models {
  // Defined in the source file, because each is 3 KB of code in every source that copies models.
  Models();
  Models(const Models&);
  Models(Models&&) noexcept;
  Models& operator=(const Models&);
  Models& operator=(Models&&) noexcept;
  ~Models();

  ModelFiles files;
  DeviceModel device;
  HandModel hand;
  std::string mirrored_hand;  ///< file that the hand file mirrors; empty: none
  RenderingConfig rendering;
  PatientConfig patient;
  SceneModel scene;
  std::optional<MotionFile> motion;
  std::optional<Prescription> prescription;
  /// Null without an exercise. It is stateful and shared by copies of these models, so only one rig
  /// at a time may use them.
  std::shared_ptr<Exercise> exercise;
  std::vector<std::string> exercise_files;   ///< exercise and scene
  std::vector<ExerciseWall> exercise_walls;  ///< walls that the certificate must cover
  ExercisePanel exercise_panel;              ///< panel of the exercise
  /// How far its scene was moved to be within the prescription's limits [m].
  Eigen::Vector3d exercise_moved_m = Eigen::Vector3d::Zero();
};

/// Loads all files; every fault of every file is reported at once.
[[nodiscard]] Expected<Models> loadModels(const ModelFiles& files);

/// Name and text of each file, including meshes and URDFs of the scene, so that a recording is
/// self-contained. Names are relative to the deepest common folder.
[[nodiscard]] Expected<std::vector<std::pair<std::string, std::string>>> readFileTexts(
    const Models& models);

/// Rest pose of the hand: the middle of the arm's ranges and the reference posture.
[[nodiscard]] AxisPosition restPose(const Models& models);

/// The motion of the models, or rest without one. `sentences` (may be null) receives a description
/// of the changes made to the motion.
[[nodiscard]] Intention intentionOf(const Models& models, std::vector<std::string>* sentences);

/// The virtual patient who plays the exercise; null without an exercise or if the exercise has no
/// player.
[[nodiscard]] std::unique_ptr<Player> makeExercisePlayer(const Models& models, std::uint64_t seed);

/// A player that follows intentionOf(), for exercises without a player of their own.
[[nodiscard]] std::unique_ptr<Player> makeMotionPlayer(const Models& models);

/// Reduced inertia of the hand at its reference and in sampled postures, with each rotation of the
/// device at its lower end, middle or upper end. Up to six rotations give every combination, more
/// give 729 random ones. Translations stay at rest, because the inertia does not depend on them.
struct SampledInertia {
  AxisMatrix at_reference;
  std::vector<AxisMatrix> samples;
};
[[nodiscard]] SampledInertia sampleInertia(const HandModel& hand, const DeviceModel& device);

/// Input of certify(): device, hand, rendering, the walls of the exercise and, behind them, those
/// of the prescription.
[[nodiscard]] CertificateInput certificateInput(const Models& models, double period_s);
[[nodiscard]] CertificateInput certificateInputWithoutGuides(const Models& models, double period_s);

/// isCertified(), computed once in this process. Sessions, rehearsals and levels need the same
/// certificate, which takes most of the time of building a rig. Any thread.
[[nodiscard]] bool passesCertificate(const CertificateInput& input);

/// Tells whether device, gains and hand bear walls (BearsWalls). @pre models outlive the result
[[nodiscard]] std::function<bool(const std::vector<ExerciseWall>& walls)> bearsWalls(
    const Models& models, double period_s);

}  // namespace wholehand
