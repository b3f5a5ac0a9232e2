#include "exercises/load_exercise.hpp"
#include "loop/core/body_order.hpp"

#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <utility>

/// A world for the bodies of a game, without task, walls or effort. The file's [budget] limits the
/// number and size of the bodies; events report their state changes.
namespace wholehand::game_scene {
namespace {

enum Value : std::int32_t { kBodies, kGhosts, kMoving, kValues };
// Events. Index: the slot, −1 for shapes. Value: the body's generation, the BodyRefusal for
// kRefused, the impulse [N·s] for kTouched.
enum Event : std::int32_t {
  kAppeared,
  kSolid,
  kLettingGo,
  kLeft,
  kQuarantined,
  kRefused,
  kTouched
};

constexpr double kFree_s = 0.1;     ///< time without contact after which a contact is a new touch
constexpr double kStrike_s = 0.01;  ///< time over which the impulse of a touch is summed

class GameScene final : public Exercise {
 public:
  GameScene(const std::string& name, const DeviceModel& device) : axes_(device.axisCount()) {
    description_.name = name;
    description_.value_names = {"bodies", "ghosts", "moving"};
    description_.event_names = {"appeared",    "solid",   "letting_go", "left",
                                "quarantined", "refused", "touched"};
    description_.json = R"({"kind":"game_scene"})";
  }
  void reset() override {
    reported_ = {};
    touches_ = {};
  }
  [[nodiscard]] WorldQuery query() const noexcept override { return {}; }

  void tick(const ExerciseInput& input, ExerciseRecord& out,
            BodyPlacements& placements) noexcept override {
    clear(out, placements, axes_);
    out.value_count = kValues;
    if (input.pool == nullptr) return;
    for (int i = 0; i < input.pool->refused_count; ++i) {
      const RefusedOrder& refused = input.pool->refused[i];
      addEvent(out, kRefused, refused.slot, static_cast<double>(refused.refusal));
    }
    const int quarantined = input.pool->quarantined;
    if (quarantined >= 0)
      addEvent(out, kQuarantined, quarantined, reported_[quarantined].generation);
    watchTouches(input, out);
    for (int slot = 0; slot < input.pool->count; ++slot) follow(slot, *input.pool, out);
    out.values[kMoving] = input.pool->moving;
  }

  [[nodiscard]] std::unique_ptr<Player> makePlayer(const PlayerTraits&) const override {
    return nullptr;  // a motion file or the person steers the hand
  }

 private:
  /// Contact of one body with the hand.
  struct Touch {
    std::int32_t generation = 0;
    double free_s = kFree_s;  ///< time since the last contact
    double strikes_s = -1.0;  ///< time since the touch began; −1: reported, or no touch
    Vec3 impulse_ns;          ///< impulse on the hand since the touch began
  };

  /// Reports the impulse of a touch after kStrike_s, or earlier if the body leaves the scene.
  void watchTouches(const ExerciseInput& input, ExerciseRecord& out) noexcept {
    const PoolReport& pool = *input.pool;
    std::array<Vec3, kMaxSlots> force_n{};
    std::array<bool, kMaxSlots> touching{};
    // Sums the contact forces of each slot.
    for (int i = 0; i < input.observed->contact_count; ++i) {
      const Contact& contact = input.observed->contacts[i];
      const int slot = contact.body - pool.first_body;
      const Eigen::Vector3d force = contact.force_n.eigen();
      if (slot < 0 || slot >= pool.count || !(force.squaredNorm() > 0.0)) continue;
      touching[slot] = true;
      force_n[slot] = Vec3::from(force_n[slot].eigen() + force);
    }
    for (int slot = 0; slot < pool.count; ++slot) {
      Touch& touch = touches_[slot];
      // A new body in the slot ends the touch of the old one.
      const bool same = touch.generation == pool.slots[slot].generation;
      if (!same && touch.strikes_s >= 0.0 && !addTouchEvent(slot, out)) continue;
      if (!same) touch = Touch{};
      touch.generation = pool.slots[slot].generation;
      // A contact after kFree_s without contact begins a touch.
      if (touching[slot] && touch.strikes_s < 0.0 && touch.free_s >= kFree_s) {
        touch.strikes_s = 0.0;
        touch.impulse_ns = Vec3{};
      }
      touch.free_s = touching[slot] ? 0.0 : touch.free_s + input.period_s;
      if (touch.strikes_s < 0.0) continue;
      const auto over = [&] { return touch.strikes_s >= kStrike_s - 0.5 * input.period_s; };
      if (!over()) {
        touch.impulse_ns =
            Vec3::from(touch.impulse_ns.eigen() + input.period_s * force_n[slot].eigen());
        touch.strikes_s += input.period_s;
      }
      if (over()) addTouchEvent(slot, out);
    }
  }

  bool addTouchEvent(int slot, ExerciseRecord& out) noexcept {
    Touch& touch = touches_[slot];
    if (!addEvent(out, kTouched, slot, touch.impulse_ns.eigen().norm())) return false;
    touch.strikes_s = -1.0;
    return true;
  }

  void follow(int slot, const PoolReport& pool, ExerciseRecord& out) noexcept {
    const SlotReport& now = pool.slots[slot];
    SlotReport& reported = reported_[slot];
    if (now.state != SlotState::kParked) out.values[kBodies] += 1.0;
    if (now.state == SlotState::kGhost) out.values[kGhosts] += 1.0;
    if (reported.generation != 0 && reported.generation != now.generation) {
      if (!addEvent(out, kLeft, slot, reported.generation)) return;
      reported = SlotReport{};
    }
    if (now.state == SlotState::kParked) return;
    if (reported.generation != now.generation) {
      if (!addEvent(out, kAppeared, slot, now.generation)) return;
      reported = now;
      reported.state = SlotState::kGhost;
    }
    const bool solid_again =
        now.state == SlotState::kSolid && reported.solid_count != now.solid_count;
    if (reported.state == now.state && !solid_again) return;
    const bool ghost = now.state == SlotState::kGhost;
    const Event event = ghost ? kAppeared : now.state == SlotState::kSolid ? kSolid : kLettingGo;
    if (!addEvent(out, event, slot, now.generation)) return;
    reported.state = now.state;
    reported.solid_count = now.solid_count;
  }

  int axes_;
  std::array<SlotReport, kMaxSlots>
      reported_{};  ///< last state of every slot that events have reported
  std::array<Touch, kMaxSlots> touches_{};
};

GameBudget readBudget(TomlTable table, std::size_t scene_bodies) {
  GameBudget budget;
  budget.slots = static_cast<int>(table.integer("slots", 1, kMaxSlots));
  budget.awake = static_cast<int>(table.integer("awake", 1, kMaxSlots));
  budget.shape_sets = static_cast<int>(table.integer("shape_sets", 1, kMaxShapeSets));
  budget.pieces = static_cast<int>(table.integer("pieces", 1, kMaxSlotPieces));
  budget.vertices = static_cast<int>(table.integer("vertices", 4, kMaxPieceVertices));
  const auto mass = table.interval("mass_kg", between(0.01, 5.0, "kg"));
  const auto size = table.interval("size_m", between(0.005, 0.5, "m"));
  budget.least_kg = mass[0], budget.most_kg = mass[1];
  budget.least_m = size[0], budget.most_m = size[1];
  if (table.isGood("awake") && table.isGood("slots") && budget.awake > budget.slots) {
    table.fail("awake", "is more than budget.slots", "must be at most budget.slots");
  }
  if (std::cmp_greater(scene_bodies + budget.slots, kMaxBodies)) {
    table.fail(
        "slots",
        fmt::format("and the {} bodies of the scene are more than a record holds", scene_bodies),
        fmt::format("together at most {}", kMaxBodies));
  }
  return budget;
}

}  // namespace

Expected<LoadedExercise> load(TomlFile& file, const ExerciseSource& source) {
  const std::size_t bodies = source.scene != nullptr ? source.scene->bodies.size() : 0;
  const GameBudget budget = readBudget(file.root().table("budget"), bodies);
  Diagnostics faults = file.finish();
  if (source.level != 1) {
    faults.push_back(fileFault(source.path, "a game scene has one level", "ask for level 1"));
  }
  if (!faults.empty() || source.scene == nullptr) return faults;
  source.scene->game = budget;
  LoadedExercise out;
  out.exercise = std::make_unique<GameScene>(source.name, *source.device);
  return out;
}

}  // namespace wholehand::game_scene
