// A hand that slides over flush pieces must feel one plate.
#include "loop/physics/body_yard.hpp"
#include "support/cpu_time.hpp"
#include "support/rig_tools.hpp"
#include "support/seed.hpp"

#include <algorithm>
#include <cmath>

namespace wholehand::test {
namespace {

/// A hand that presses on a floor and slides along it.
struct Slide {
  Models models;
  AxisPosition from, pressed, slid;
  double slide_s = 1.5, period_s = 1e-3;

  /// Draws a motion 8 mm into a face and 50 mm across it in either direction, at 1, 2 or 4 kHz.
  void draw(int face, double along, int across, std::mt19937_64& random) {
    pressed = from;
    pressed[face] += 0.008 * along;
    slid = pressed;
    slid[across] += random() % 2U == 0 ? 0.05 : -0.05;
    period_s = 1e-3 / std::pow(2.0, static_cast<double>(random() % 3U));
  }
};

struct FeltSlide {
  std::vector<AxisEffort> sent;
  double largest_jolt = 0.0;  ///< largest change of the contact force within 4 ms while sliding, as
                              ///< a share of the force
};

FeltSlide slideOver(const Slide& slide, const std::vector<SceneBody>& floor) {
  Models m = slide.models;
  m.scene.bodies = floor;
  RigOptions options;
  options.period_s = slide.period_s;
  const auto ticks = [&](double seconds) { return static_cast<int>(seconds / slide.period_s); };
  const int press = ticks(0.5), jolt = ticks(4e-3);
  const auto down = moveAndHold(slide.from, slide.pressed, press);
  const auto along = moveAndHold(slide.pressed, slide.slid, ticks(slide.slide_s));
  const auto rig = buildScripted(
      std::move(m), [=](int read) { return read < press ? down(read) : along(read - press); },
      options);
  EXPECT_TRUE(rig->renderer->arm());
  FeltSlide out;
  std::vector<Eigen::Vector3d> force_n;
  runTicks(*rig->renderer, press + ticks(slide.slide_s), [&](const TickRecord& r) {
    out.sent.push_back(r.sent);
    force_n.emplace_back(Eigen::Vector3d::Zero());
    for (int i = 0; i < r.contact_count; ++i) force_n.back() += r.contacts[i].force_n.eigen();
    const auto now = force_n.size() - 1;
    if (now < static_cast<std::size_t>(press + jolt)) return;
    const double changed_n = (force_n[now] - force_n[now - jolt]).norm();
    out.largest_jolt = std::max(out.largest_jolt, changed_n / force_n[now - jolt].norm());
  });
  return out;
}

/// Division of a plate into flush pieces.
struct Cut {
  int axis = 0;  ///< axis of the world
  double width_m = 0.0;
  bool meshes = false, one_body = false;
};

std::vector<SceneBody> cut(const SceneBody& plate, const Cut& how) {
  Eigen::Vector3d size_m = 2.0 * plate.shapes[0].half_extents_m;
  size_m[how.axis] = how.width_m;
  const Shape piece = how.meshes ? meshShape(size_m) : boxShape(size_m);
  SceneBody whole = plate;
  whole.shapes.clear();
  std::vector<SceneBody> planks;
  for (double at_m = -0.3; at_m < 0.3; at_m += how.width_m) {
    whole.shapes.push_back(piece);
    whole.shapes.back().in_body.translation_m[how.axis] = at_m;
    SceneBody& plank = planks.emplace_back(plate);
    plank.name = "plank" + std::to_string(planks.size());
    plank.pose.translation_m[how.axis] = at_m;
    plank.shapes = {piece};
  }
  if (how.one_body) planks = {whole};
  return planks;
}

/// Digits at random in the lower 0.7 of their range, the arm at 0.
AxisPosition drawnClosure(const DeviceModel& device, std::mt19937_64& random) {
  AxisPosition drawn(device.axisCount());
  for (int a = 0; a < device.axisCount(); ++a) {
    if (device.axes[a].group != AxisGroup::kHand) continue;
    drawn[a] = uniform(random, 0.0, 0.7) * device.axes[a].upper;
  }
  return drawn;
}

/// Largest difference of the rendered efforts of any axis in any tick, as a force at its lever arm
/// [N].
double mostApart_n(const DeviceModel& device, const FeltSlide& one, const FeltSlide& other) {
  double most_n = 0.0;
  for (std::size_t k = 0; k < one.sent.size(); ++k) {
    for (int a = 0; a < device.axisCount(); ++a) {
      const double lever_m = device.axes[a].lever_arm_m;
      const double apart = std::abs(one.sent[k][a] - other.sent[k][a]);
      most_n = std::max(most_n, lever_m > 0.0 ? apart / lever_m : apart);
    }
  }
  return most_n;
}

/// Compares the same slides over one plate and over its pieces.
struct Compared {
  double most_n = 0.0;
  int judged = 0;

  void slide(const Slide& slide, const std::vector<SceneBody>& plate,
             const std::vector<SceneBody>& pieces) {
    const FeltSlide one = slideOver(slide, plate);
    if (one.largest_jolt > 0.2) return;  // it sticks and slips, so that no two runs are alike
    ++judged;
    most_n = std::max(most_n, mostApart_n(slide.models.device, one, slideOver(slide, pieces)));
  }

  void check(const char* name) const {
    figure(name, most_n, "N");
    EXPECT_LE(most_n, 0.02);
    EXPECT_GT(judged, 0);
  }
};

TEST(Seams, FlushPlanks_FeelAsOnePlate) {
  auto random = seededRandom(3620);
  Compared compared;
  const int draws = fullCounts() ? 100 : 4;
  for (int i = 0; i < draws; ++i) {
    Slide slide;
    slide.models = load(shippedFiles("lambda-pride", "empty",
                                     i % 2 == 0 ? "adult-median-right" : "adult-median-left"));
    const DeviceModel& device = slide.models.device;
    const int face = static_cast<int>(random() % 3U);
    const int across = (face + 1 + static_cast<int>(random() % 2U)) % 3;
    const Eigen::Vector3d along = (random() % 2U == 0 ? 1.0 : -1.0) * Eigen::Vector3d::Unit(face);
    slide.from = drawnClosure(device, random);
    SceneBody plate = wall(along, reach(slide.models.hand, slide.from, along) + 0.003);
    plate.friction = uniform(random, 0.0, 1.0);
    slide.draw(face, along[face], across, random);
    slide.slide_s = i % 2 == 0 ? 1.5 : uniform(random, 0.08, 0.5);
    const Cut how{across, uniform(random, 0.005, 0.05), random() % 2U == 0, random() % 2U == 0};
    SCOPED_TRACE("draw " + std::to_string(i) + (how.meshes ? ", meshes of " : ", boxes of ") +
                 std::to_string(how.width_m) + " m, friction " + std::to_string(plate.friction));
    compared.slide(slide, {plate}, cut(plate, how));
  }
  compared.check("hand over flush planks against one plate, most that is felt apart");
}

/// The same for a plate, and planks, that lie on a table and are free to move.
TEST(Seams, MovablePlanks_FeelAsOnePlate) {
  auto random = seededRandom(3621);
  Compared compared;
  const int draws = fullCounts() ? 100 : 4;
  for (int i = 0; i < draws; ++i) {
    Slide slide;
    slide.models = load(shippedFiles());
    const DeviceModel& device = slide.models.device;
    const Eigen::Vector3d down = -Eigen::Vector3d::UnitZ();
    slide.from = drawnClosure(device, random);
    const double thick_m = 0.02, width_m = uniform(random, 0.04, 0.08);
    const double face_m = reach(slide.models.hand, slide.from, down) + 0.003;
    SceneBody table = wall(down, face_m + thick_m);
    table.friction = 1.0;
    const double friction = uniform(random, 0.0, 0.5);
    const int across = static_cast<int>(random() % 2U);
    std::vector<SceneBody> planks{table}, whole{table};
    Eigen::Vector3d size_m(1.0, 1.0, thick_m);
    const Eigen::Vector3d middle_m = (face_m + 0.5 * thick_m) * down;
    constexpr int kPlanks = 9;
    size_m[across] = kPlanks * width_m;
    whole.push_back(bodyOf(boxShape(size_m), middle_m, 4.5, friction));
    size_m[across] = width_m;
    for (int k = 0; k < kPlanks; ++k) {
      const Eigen::Vector3d aside_m = (k - kPlanks / 2) * width_m * Eigen::Vector3d::Unit(across);
      planks.push_back(bodyOf(boxShape(size_m), middle_m + aside_m, 4.5 / kPlanks, friction));
      planks.back().name = "plank" + std::to_string(k);
    }
    slide.draw(2, -1.0, across, random);
    slide.slide_s = uniform(random, 0.2, 1.5);
    SCOPED_TRACE("draw " + std::to_string(i) + ", planks of " + std::to_string(width_m) +
                 " m, friction " + std::to_string(friction));
    compared.slide(slide, whole, planks);
  }
  compared.check("hand over planks that may move against one plate, most that is felt apart");
}

/// Processor seconds of a tick in which the whole hand presses on `pieces` pieces at one place.
double costAmong(int pieces) {
  Slide slide;
  slide.models = load(shippedFiles("lambda-pride", "empty", "adult-median-right"));
  slide.from = AxisPosition(slide.models.device.axisCount());
  const Eigen::Vector3d down = -Eigen::Vector3d::UnitZ();
  SceneBody floor = wall(down, reach(slide.models.hand, slide.from, down) + 0.003);
  floor.shapes.assign(static_cast<std::size_t>(pieces), floor.shapes[0]);
  slide.models.scene.bodies = {floor};
  slide.pressed = slide.from;
  slide.pressed[2] -= 0.008;
  constexpr int kTicks = 60;
  const auto rig =
      buildScripted(std::move(slide.models), moveAndHold(slide.from, slide.pressed, 20));
  EXPECT_TRUE(rig->renderer->arm());
  int contacts = 0;
  const double before_s = cpu_s();
  runTicks(*rig->renderer, kTicks, [&](const TickRecord& r) { contacts += r.contact_count; });
  EXPECT_GT(contacts, 0);
  return (cpu_s() - before_s) / kTicks;
}

/// Four times as many pieces cost four times as much if the work is proportional, and sixteen times
/// if each piece is compared with each. Other work only adds to a cost, so the smallest of some
/// rounds is used.
TEST(Seams, ManyPiecesAtOnce_CostInProportion) {
  double many_s = costAmong(1200), few_s = costAmong(300);
  for (int round = 1; round < 10 && many_s >= 8.0 * few_s; ++round) {
    many_s = std::min(many_s, costAmong(1200));
    few_s = std::min(few_s, costAmong(300));
  }
  const double ratio = many_s / few_s;
  figure("tick of a hand on 1,200 pieces over one on 300", ratio, "");
  EXPECT_LT(ratio, 8.0);
}

}  // namespace
}  // namespace wholehand::test
