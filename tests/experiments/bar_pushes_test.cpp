// Hands that do not grip push the bottles of the bar: with the back, flat, or as a fist. Whole
// rigs.
#include "experiments/bar_figures.hpp"
#include "loop/core/compiler.hpp"
#include "loop/patient/motion.hpp"
#include "support/constants.hpp"
#include "support/rig_tools.hpp"
#include "support/seed.hpp"
#include "support/shipped.hpp"

#include <cmath>

namespace wholehand::test {
namespace {

constexpr int kFingers = 3, kTurn = 4, kThumb = 5;  // axes of lambda-pride, after x, y, z

enum class How {
  kBack,     ///< the back of the hand, fingers straight to closed
  kFlat,     ///< the palm's side, fingers and thumb straight: all parts press in one direction
  kFist,     ///< knuckles first; the dispenser is in front of the closed hand
  kHalfOpen  ///< the palm's side, fingers half bent; fingers close around a bottle at about 105°
};
constexpr const char* kNames[] = {"back", "flat", "fist", "half open"};

struct Push {
  How how = How::kBack;
  std::string exercise, hand;
  int level = 1;
  double flexion_rad = 0.0, turn_rad = 0.0, thumb_rad = 0.0;
  double ahead_m = 0.0, up_m = 0.0;  ///< position of the hand's base relative to the dispenser
  double depth_m = 0.0;              ///< intended depth into the dispenser
  double time_s = 0.5;               ///< duration of the approach
};

std::ostream& operator<<(std::ostream& out, const Push& p) {
  return out << kNames[static_cast<int>(p.how)] << ", " << p.hand << ", " << p.exercise
             << ", level " << p.level << ", fingers " << p.flexion_rad << ", turn " << p.turn_rad
             << ", thumb " << p.thumb_rad << ", ahead " << p.ahead_m << ", up " << p.up_m
             << ", depth " << p.depth_m << ", time " << p.time_s;
}

struct Felt {
  double flow_l_s = 0.0;  ///< largest
  double poured_l = 0.0;
  double pressed_n = 0.0;  ///< largest sum of normal forces on a dispenser
};

/// A motion from the side (or from the front) against the first dispenser, held for a second.
Intention motionOf(const Push& push, const Eigen::Vector3d& at_m, double side,
                   const DeviceModel& device) {
  const auto waypoint = [&](double time_s, double x, double y) {
    AxisPosition q(device.axisCount());
    const double wanted[] = {
        x, y, at_m.z() + push.up_m, push.flexion_rad, push.turn_rad, push.thumb_rad};
    for (int a = 0; a < q.size(); ++a) {
      q[a] = std::clamp(wanted[a], device.axes[a].lower, device.axes[a].upper);
    }
    return Waypoint{time_s, q};
  };
  const double x = at_m.x() - push.ahead_m, back = -0.085;
  // The palm faces `side`; half a hand and the dispenser's radius are 0.041 m.
  const double from = push.how == How::kBack ? side : -side;
  const double aside_m = at_m.y() + from * 0.11, in_m = at_m.y() + from * (0.041 - push.depth_m);
  if (push.how == How::kFist) {
    return Intention::throughWaypoints({{waypoint(0.0, back, at_m.y())},
                                        {waypoint(0.3, back, at_m.y())},
                                        {waypoint(0.3 + push.time_s, 0.085, at_m.y())},
                                        {waypoint(1.3 + push.time_s, 0.085, at_m.y())}});
  }
  return Intention::throughWaypoints({{waypoint(0.0, back, aside_m)},
                                      {waypoint(0.8, x, aside_m)},
                                      {waypoint(0.8 + push.time_s, x, in_m)},
                                      {waypoint(2.0 + push.time_s, x, in_m)}});
}

Felt feel(const Push& push) {
  Models models = load(exerciseFiles(push.exercise, push.level, push.hand));
  const int body = models.scene.bodyIndex("dispenser_lemon");
  const Eigen::Vector3d at_m = models.scene.bodies[body].pose.translation_m;
  const double side = models.hand.side == Side::kLeft ? -1.0 : 1.0;
  const BarFigures figures(models.exercise->description());
  auto player = std::make_unique<ScriptedPlayer>(motionOf(push, at_m, side, models.device));
  const auto rig = orThrow(buildRig(std::move(models), std::move(player), {}));
  if (auto armed = rig->renderer->arm(); !armed) {
    ADD_FAILURE() << format(armed.errors()) << push;
    return {};
  }
  Felt felt;
  TickRecord record;
  for (int k = 0; k < static_cast<int>(1e3 * (2.0 + push.time_s)); ++k) {
    rig->renderer->tick(1, record);
    double pressed_n = 0.0;
    for (int i = 0; i < record.contact_count; ++i) {
      const Contact& c = record.contacts[i];
      if (c.body == body) pressed_n += c.force_n.eigen().dot(c.normal.eigen());
    }
    felt.pressed_n = std::max(felt.pressed_n, pressed_n);
    felt.flow_l_s = std::max(felt.flow_l_s, figures(BarFigures::kFlow, record.exercise));
    felt.poured_l = figures(BarFigures::kPouredTotal, record.exercise);
  }
  return felt;
}

/// Regression test: straight fingers with the arm pushing sideways once poured 30.7 of 40 ml.
TEST(BarPushed, PushWithTheBackOfTheHand_PoursNothing) {
  for (const char* hand : {"adult-median-right", "adult-median-left"}) {
    Push push;
    push.exercise = "cocktail-bar";
    push.hand = hand;
    push.ahead_m = 0.034;
    push.depth_m = 0.06;
    const Felt felt = feel(push);
    EXPECT_EQ(felt.flow_l_s, 0.0) << push;
    EXPECT_EQ(felt.poured_l, 0.0) << push;
    EXPECT_GT(felt.pressed_n, 5.0) << push;  // threshold of level 1: 3 N
  }
}

Push drawn(std::mt19937_64& random, How how, const std::vector<std::string>& hands) {
  const auto draw = [&random](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  Push push;
  push.how = how;
  push.exercise = random() % 4 == 0 ? "cocktail-bar-free" : "cocktail-bar";
  push.hand = hands[random() % hands.size()];
  // The back pushes at a single dispenser; a neighbour would come between fingers and thumb.
  const int levels = how == How::kBack ? 1 : push.exercise == "cocktail-bar" ? 4 : 2;
  push.level = 1 + static_cast<int>(random() % static_cast<unsigned>(levels));
  push.flexion_rad = how == How::kFlat       ? draw(0.0, 25.0 * kDeg)
                     : how == How::kHalfOpen ? draw(25.0 * kDeg, 85.0 * kDeg)
                     : how == How::kFist     ? draw(150.0 * kDeg, 180.0 * kDeg)
                                             : draw(0.0, 180.0 * kDeg);
  push.turn_rad = how == How::kBack ? draw(0.0, 90.0 * kDeg) : draw(0.0, 10.0 * kDeg);
  push.thumb_rad = how == How::kFlat || how == How::kHalfOpen ? 0.0 : draw(0.0, 60.0 * kDeg);
  push.ahead_m = draw(-0.01, 0.08);
  push.up_m = draw(-0.04, 0.04);
  push.depth_m = draw(0.0, 0.08);
  push.time_s = draw(0.15, 1.0);
  return push;
}

/// Pushes in `pushes` random ways of the kinds `hows`; nothing may be poured.
void expectNothingPoured(int pushes, unsigned stream, const std::vector<How>& hows) {
  std::mt19937_64 random = seededRandom(stream);
  const std::vector<std::string> hands = shipped("hands");
  int pressed = 0;
  for (int i = 0; i < pushes; ++i) {
    const Push push = drawn(random, hows[random() % hows.size()], hands);
    const Felt felt = feel(push);
    EXPECT_EQ(felt.flow_l_s, 0.0) << push;
    EXPECT_EQ(felt.poured_l, 0.0) << push;
    pressed += felt.pressed_n > 3.0 ? 1 : 0;
  }
  figure("pushes", pushes, "");
  figure("pushes above the lowest threshold", pressed, "");
  if (kStatisticsMeaningful) {
    EXPECT_GT(pressed, pushes / 4);  // otherwise the test proves nothing
  }
}

/// @return `full` with WHOLEHAND_FULL, else `sample`; WHOLEHAND_PUSHES sets the number directly
int pushesOf(int full, int sample) {
  if (const char* slice = std::getenv("WHOLEHAND_PUSHES")) return std::atoi(slice);
  if (fullCounts()) return full;
  return kReducedCounts ? 2 : sample;
}

TEST(BarPushed, PushWithoutAPalmarGrip_PoursNothing) {
  expectNothingPoured(pushesOf(1000, 10), 74, {How::kBack, How::kFlat, How::kFist});
}

TEST(BarPushed, PushWithAnOpenOrHalfOpenHand_PoursNothing) {
  expectNothingPoured(pushesOf(1000, 10), 75, {How::kFlat, How::kHalfOpen});
}

}  // namespace
}  // namespace wholehand::test
