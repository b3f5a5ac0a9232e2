#include "exercises/load_exercise.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

/// Free grasping without task, walls or effort. Every body is a target of the palm.
namespace wholehand::free_grasping {
namespace {

enum Value : std::int32_t { kPalmBody, kPalmDistance, kHeldForce, kValues };

/// Sum of the hand's normal contact forces on all bodies [N].
double normalForce(const TickRecord& record) noexcept {
  double sum_n = 0.0;
  for (int i = 0; i < record.contact_count; ++i) {
    const Contact& c = record.contacts[i];
    sum_n += c.force_n.x * c.normal.x + c.force_n.y * c.normal.y + c.force_n.z * c.normal.z;
  }
  return sum_n;
}

class FreeGrasping final : public Exercise {
 public:
  FreeGrasping(const SceneModel& scene, const std::string& name, const DeviceModel& device)
      : axes_(device.axisCount()) {
    description_.name = name;
    description_.value_names = {"palm_body", "palm_distance_m", "squeeze_n"};
    description_.json = R"({"kind":"free_grasping"})";
    const std::size_t shown = std::min(scene.bodies.size(), query_.targets.size());
    for (std::size_t i = 0; i < shown; ++i) query_.targets.set(i);
  }
  void reset() override {}
  [[nodiscard]] WorldQuery query() const noexcept override { return query_; }

  void tick(const ExerciseInput& input, ExerciseRecord& out,
            BodyPlacements& placements) noexcept override {
    clear(out, placements, axes_);
    out.value_count = kValues;
    out.values[kPalmBody] = input.observed->palm_body;
    out.values[kPalmDistance] = input.observed->palm_target_distance_m;
    out.values[kHeldForce] = normalForce(*input.observed);
  }

  [[nodiscard]] std::unique_ptr<Player> makePlayer(const PlayerTraits&) const override {
    return nullptr;  // a motion file or the person steers the hand
  }

 private:
  int axes_;
  WorldQuery query_;
};

}  // namespace

Expected<LoadedExercise> load(TomlFile& file, const ExerciseSource& source) {
  Diagnostics faults = file.finish();
  if (source.level != 1) {
    faults.push_back(fileFault(source.path, "free grasping has one level", "ask for level 1"));
  }
  if (!faults.empty() || source.scene == nullptr) return faults;
  LoadedExercise out;
  out.exercise = std::make_unique<FreeGrasping>(*source.scene, source.name, *source.device);
  return out;
}

}  // namespace wholehand::free_grasping
