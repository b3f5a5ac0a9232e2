#include "exercises/load_exercise.hpp"

#include <cmath>
#include <utility>

/// Holding the hand still for a while: the smallest exercise that shows that it runs.
namespace wholehand::hold_still {
namespace {

class HoldStill final : public Exercise {
 public:
  HoldStill(const ExerciseSource& source, double hold_s, double slow_m_s)
      : axes_(source.device->axisCount()), hold_s_(hold_s), slow_m_s_(slow_m_s) {
    description_.name = source.name;
    description_.value_names = {"held_s"};
    description_.event_names = {"held"};
    description_.json = R"({"kind":"hold_still"})";
  }
  void reset() override { held_s_ = 0.0; }
  [[nodiscard]] WorldQuery query() const noexcept override { return {}; }

  void tick(const ExerciseInput& input, ExerciseRecord& out,
            BodyPlacements& placements) noexcept override {
    clear(out, placements, axes_);
    const bool was_held = held_s_ >= hold_s_;
    const bool slow = std::abs(input.observed->qd_mf[0]) < slow_m_s_;
    held_s_ = slow ? held_s_ + input.observed->elapsed_periods * input.period_s : 0.0;
    out.value_count = 1;
    out.values[0] = held_s_;
    if (held_s_ >= hold_s_ && !was_held) {
      out.event_count = 1;
      out.events[0] = {0, -1, held_s_};
    }
  }

  [[nodiscard]] std::unique_ptr<Player> makePlayer(const PlayerTraits&) const override {
    return nullptr;
  }

 private:
  int axes_;
  double hold_s_, slow_m_s_;
  double held_s_ = 0.0;
};

}  // namespace

Expected<LoadedExercise> load(TomlFile& file, const ExerciseSource& source) {
  const double hold_s = file.root().number("hold_s", between(0.1, 60.0, "s"));
  const double slow_m_s = file.root().number("slow_m_s", between(0.001, 1.0, "m/s"));
  Diagnostics faults = file.finish();
  if (!faults.empty() || source.scene == nullptr) return faults;
  LoadedExercise out;
  out.exercise = std::make_unique<HoldStill>(source, hold_s, slow_m_s);
  return out;
}

}  // namespace wholehand::hold_still
