#pragma once

#include "core/expected.hpp"
#include "exercise/exercise.hpp"
#include "exercise/exercise_wall.hpp"
#include "model/device_model.hpp"
#include "model/exercise_panel.hpp"
#include "model/hand_model.hpp"
#include "model/patient_config.hpp"
#include "model/rendering_config.hpp"
#include "model/scene_model.hpp"
#include "patient/motion.hpp"

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace wholehand {

/// Which files a run is made of. An empty motion means that the patient rests.
struct ModelFiles {
  std::string scene = "config/scenes/four-shapes.toml";
  std::string hand = "config/hands/adult-median-right.toml";
  std::string device = "config/devices/lambda-pride.toml";
  std::string rendering = "config/rendering/lambda-pride.toml";
  std::string patient = "config/patients/relaxed-adult.toml";
  std::string motion;
  std::string exercise;  ///< names its scene itself; empty: just the scene
  int level = 1;         ///< of the exercise

  /// All paths; those that name nothing are empty.
  [[nodiscard]] std::vector<std::string> all() const {
    return {scene, hand, device, rendering, patient, motion, exercise};
  }
};

/// Everything the files say, checked against each other.
struct Models {
  ModelFiles files;
  DeviceModel device;
  HandModel hand;
  std::string mirrored_hand;  ///< file of which the hand's is the mirror image; empty: of none
  RenderingConfig rendering;
  PatientConfig patient;
  SceneModel scene;
  std::optional<MotionFile> motion;
  /// Null where none was asked for. It has a state: copies of these models share it, so that only
  /// one rig at a time may use them.
  std::shared_ptr<Exercise> exercise;
  std::vector<std::string> exercise_files;   ///< exercise and scene
  std::vector<ExerciseWall> exercise_walls;  ///< what the certificate has to bear
  ExercisePanel exercise_panel;              ///< what is shown of it
};

/// Loads all files; every fault of every file is reported at once.
[[nodiscard]] Expected<Models> loadModels(const ModelFiles& files);

/// Name and text of each file, of the meshes and URDFs of the scene too, so that a recording stands
/// alone. Names are relative to the deepest folder that holds them all.
[[nodiscard]] Expected<std::vector<std::pair<std::string, std::string>>> readFileTexts(
    const Models& models);

}  // namespace wholehand
