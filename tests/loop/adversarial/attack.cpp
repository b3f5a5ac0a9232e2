#include "loop/adversarial/attack.hpp"

#include "loop/core/tick_digest.hpp"
#include "support/constants.hpp"

#include <algorithm>
#include <cmath>

namespace wholehand::test {
namespace {

constexpr int kAfterStop = 150;
constexpr int kLookEvery =
    5;  // ticks between two checks of the bones: 7 mm at 1.5 m/s, less than a bone's depth

/// Names the fields of a record that are not finite; empty: none. An infinite distance means that
/// there is no body, a closure of NaN that nothing is touched, and an exercise's value of NaN that
/// it is not known yet; these are allowed.
std::string notFinite(const TickRecord& r) {
  std::string out;
  const auto check = [&out](const std::string& name, bool good) {
    if (!good) out += (out.empty() ? "" : ", ") + name;
  };
  visitComputed(r, [&](const std::string& name, const double* numbers, int count) {
    if (name == "closure" || name.ends_with("distance_m")) return;
    const bool may_be_unknown = name == "exercise_values";
    check(name, std::all_of(numbers, numbers + count, [&](double x) {
            return std::isfinite(x) || (may_be_unknown && std::isnan(x));
          }));
  });
  check("intention", allFinite(r.intention));
  check("patient_effort", allFinite(r.patient_effort));
  return out;
}

bool isNeutral(const AxisEffort& sent, const AxisEffort& neutral) {
  return std::equal(sent.begin(), sent.end(), neutral.begin(), neutral.end());
}

/// Names the effort that is beyond a limit; empty: none. `hardest` becomes the largest share of a
/// limit.
std::string beyondLimit(const TickRecord& r, const AxisEffort& before, const DeviceModel& device,
                        double& hardest) {
  for (int a = 0; a < r.sent.size(); ++a) {
    const DeviceAxis& axis = device.axes[a];
    hardest = std::max(hardest, std::abs(r.sent[a]) / axis.effort_limit);
    if (std::abs(r.sent[a]) > axis.effort_limit + 1e-9) return axis.name + " beyond its limit";
    if (std::abs(r.sent[a] - before[a]) > axis.effort_slew_limit * kPeriod_s + 1e-9) {
      return axis.name + " changes faster than its limit";
    }
  }
  return {};
}

Eigen::Vector3d inBody(const BodyState& state, const SceneBody& body, const Eigen::Vector3d& p) {
  return state.orientation_xyzw.eigen().conjugate() * (p - state.position_m.eigen()) + body.com_m;
}

}  // namespace

double Bones::deepest(const TickRecord& record) {
  for (int i = 0; i < record.placements.count; ++i) {
    placed_ |= 1U << record.placements.items[i].body;
  }
  hand_.updateKinematics(record.theta);
  double deepest_m = -1.0;
  // The slots of a game follow the scene's bodies and are empty here.
  const int bodies = static_cast<int>(rig_.models.scene.bodies.size());
  for (int b = 0; b < std::min(record.body_count, bodies); ++b) {
    if ((placed_ >> b & 1U) != 0) continue;
    const BodyState& state = record.bodies[b];
    const SceneBody& body = rig_.models.scene.bodies[b];
    for (const Capsule& c : rig_.models.hand.capsules) {
      const Pose& at = hand_.linkPose(c.link);
      for (const Eigen::Vector3d& point : {c.a_m, Eigen::Vector3d(0.5 * (c.a_m + c.b_m)), c.b_m}) {
        const Eigen::Vector3d p = inBody(state, body, at * point);
        for (const Shape& shape : body.shapes) {
          // Digits touch the core of a soft body, not its surface.
          const Shape met = c.part == HandPart::kPalm ? shape : coreOf(body, shape);
          deepest_m = std::max(deepest_m, -signedDistance(met, p));
        }
      }
    }
  }
  return deepest_m;
}

namespace {

/// Says what is wrong with a tick; empty: nothing.
std::string violationOf(const TickRecord& r, const AxisEffort& before, const Rig& rig, Bones& bones,
                        Outcome& out) {
  if (std::string bad = notFinite(r); !bad.empty()) return "not finite: " + bad;
  if (std::string bad = beyondLimit(r, before, rig.models.device, out.hardest); !bad.empty()) {
    return bad;
  }
  if (r.tick % kLookEvery != 0) return {};
  out.deepest_m = std::max(out.deepest_m, bones.deepest(r));
  return out.deepest_m > 0.0 ? "a bone of the hand is within a body" : "";
}

}  // namespace

std::optional<Outcome> attack(Rig& rig, ChangingDevice& device, Player& player, Bones& bones,
                              int ticks) {
  HapticRenderer& renderer = *rig.renderer;
  if (!renderer.arm()) return std::nullopt;
  bones.reset();
  Outcome out;
  AxisEffort before = renderer.config().safety.neutral;
  auto record = std::make_unique<TickRecord>();
  int stop_tick = -1;
  for (int k = 0; (stop_tick < 0 || k < stop_tick + kAfterStop) && out.broken.empty(); ++k) {
    if (k == ticks && stop_tick < 0) {
      renderer.requestStop();
      stop_tick = k;
    }
    record->tick = static_cast<std::uint64_t>(k);
    record->time_s = k * kPeriod_s;
    renderer.tick(1, *record);
    player.onRecord(*record);
    if (stop_tick < 0 && any(record->faults & kStoppingFaults)) {
      stop_tick = k;
      out.stopped_by = record->faults & kStoppingFaults;
    }
    out.broken = violationOf(*record, before, rig, bones, out);
    out.touched_ticks += record->contact_count > 0 ? 1 : 0;
    before = record->sent;
    if (stop_tick >= 0) {
      const bool neutral = isNeutral(record->sent, renderer.config().safety.neutral);
      if (neutral && out.neutral_after_ticks < 0) out.neutral_after_ticks = k - stop_tick;
      if (!neutral && k >= stop_tick + kNeutralWithin) out.broken = "not at neutral after 100 ms";
    }
    if (!out.broken.empty()) out.broken += " in tick " + std::to_string(k);
  }
  out.ticks = stop_tick;
  out.let_go = device.now().person().hasLetGo();
  return out;
}

}  // namespace wholehand::test
