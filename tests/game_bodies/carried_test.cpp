// Free bodies on a body that a game moves: friction carries them along, and they slide where it
// cannot.
#include "game_bodies/game_tools.hpp"
#include "support/seed.hpp"

#include <cmath>

namespace wholehand::test {
namespace {

using Eigen::Vector3d;

constexpr double kFriction = 0.5;
constexpr double kThing_m = 0.04, kPlateLow_m = 0.02;
const Vector3d kPlate_m(0.3, 0.2, kPlateLow_m);

/// A plate that the game moves, with a thing on it, away from the hand.
struct Tray {
  Game game;
  BodyPose plate = poseAt(kAside_m);

  Tray(Shape thing, double thing_kg) : game(std::vector<Shape>{test::boxShape(kPlate_m)}) {
    game.prepare(1, {std::move(thing)});
    SpawnOrder under = spawnOf(0, 0, BodyOwner::kGame, plate);
    under.mass_kg = 0.8;
    SpawnOrder above =
        spawnOf(1, 1, BodyOwner::kLoop,
                poseAt(kAside_m + 0.5 * (kThing_m + kPlateLow_m) * Vector3d::UnitZ()));
    above.mass_kg = thing_kg;
    for (SpawnOrder* order : {&under, &above}) {
      order->friction = kFriction;
      game.order(spawnCommand(*order));
    }
    run(1500, [](double) { return poseAt(kAside_m); });
    EXPECT_NEAR(onPlate().z(), 0.5 * (kThing_m + kPlateLow_m), 1e-4);
  }
  /// Moves the plate for some ticks. @param at its target, by the time since the start [s]
  void run(int ticks, const std::function<BodyPose(double)>& at) {
    for (int k = 0; k < ticks; ++k) {
      game.order(bodyTargetCommand(0, 1, at(1e-3 * k)));
      game.tick();
      ASSERT_FALSE(any(game.record.faults & kStoppingFaults)) << "tick " << k;
    }
  }
  [[nodiscard]] Eigen::Quaterniond turn() const {
    return game.body(0).orientation_xyzw.eigen().normalized();
  }
  /// The thing's centre in the plate's frame.
  [[nodiscard]] Vector3d onPlate() const {
    return turn().conjugate() * (game.body(1).position_m.eigen() - game.body(0).position_m.eigen());
  }
};

Shape anyThing(std::mt19937_64& random) {
  Shape shape = test::boxShape(Vector3d::Constant(kThing_m));
  if (random() % 3 == 0) {
    shape.type = ShapeType::kCylinder;
    shape.radius_m = 0.5 * kThing_m;
    shape.length_m = kThing_m;
  }
  return random() % 3 == 0 ? boxMesh(Vector3d::Constant(kThing_m)) : shape;
}

TEST(CarriedThings, OnAMovedPlate_GoAlongWithinFriction) {
  auto random = seededRandom(4321);
  double worst_m = 0.0;
  for (int n = 0; n < cases(10); ++n) {
    SCOPED_TRACE(n);
    Tray tray(anyThing(random), uniform(random, 0.02, 0.1));
    const Vector3d held_m = tray.onPlate();
    // Swings in the plane and up and down. Its acceleration is at most half of what friction
    // bears where the upward motion makes the thing lightest.
    const double pace = uniform(random, 2.0, 8.0), about = uniform(random, 0.0, 2.0 * kPi);
    const double most_m_s2 = 0.5 * kFriction * kGravity_m_s2 / (1.0 + kFriction);
    const double wide_m = std::min(0.08, most_m_s2 / (pace * pace));
    const Vector3d way(std::cos(about), std::sin(about), uniform(random, -1.0, 1.0));
    tray.run(4000, [&](double t) {
      // Begins without a jump of its acceleration.
      const double grows = std::min(1.0, t);
      const double swing = grows * grows * (3.0 - 2.0 * grows) * std::sin(pace * t);
      return poseAt(kAside_m + wide_m * swing * way);
    });
    worst_m = std::max(worst_m, (tray.onPlate() - held_m).norm());
  }
  figure("things on a plate that a game swings, slip in 4 s", 1e3 * worst_m, "mm");
  EXPECT_LE(worst_m, 1e-4);
}

/// Tilts a plate and tells how far a thing slides along x on it in 0.3 s, and how much faster in
/// their second half.
struct Tilted {
  static constexpr int kHalf = 150;  // ticks
  double slides_m = 0.0, gains_m = 0.0;
  double expected_m = 0.0;  ///< gains_m of a block on a slope

  Tilted(double tilt_rad, std::mt19937_64& random) {
    Tray tray(anyThing(random), uniform(random, 0.02, 0.03));
    const BodyPose steep =
        poseAt(kAside_m, Eigen::Quaterniond(Eigen::AngleAxisd(tilt_rad, Vector3d::UnitY())));
    const auto target = [&](double) { return steep; };
    const auto angle = [&] { return 2.0 * std::atan2(tray.turn().y(), tray.turn().w()); };
    // The loop turns the plate slowly.
    for (int k = 0; k < 5000 && angle() < tilt_rad - 1e-4; ++k) tray.run(1, target);
    std::array<double, 2 * kHalf + 1> at_m{};
    for (int k = 0; k <= 2 * kHalf; ++k) {
      at_m[k] = tray.onPlate().x();
      // The plate yields to the thing's weight, so its angle is not the target's.
      const double speeds_up_m_s2 =
          kGravity_m_s2 * (std::sin(angle()) - kFriction * std::cos(angle()));
      expected_m += 1e-6 * std::min(k, 2 * kHalf - k) * speeds_up_m_s2;
      tray.run(1, target);
    }
    slides_m = at_m[2 * kHalf] - at_m[0];
    gains_m = at_m[2 * kHalf] - 2.0 * at_m[kHalf] + at_m[0];
  }
};

TEST(CarriedThings, OnATiltedPlate_SlideWhereFrictionEnds) {
  auto random = seededRandom(4322);
  double slipped_m = 0.0, off = 0.0;
  for (int n = 0; n < cases(5); ++n) {
    SCOPED_TRACE(n);
    const Tilted holds(std::atan(0.9 * kFriction), random);
    slipped_m = std::max(slipped_m, std::abs(holds.slides_m));
    const Tilted slides(std::atan(1.25 * kFriction), random);
    off = std::max(off, std::abs(slides.gains_m / slides.expected_m - 1.0));
  }
  figure("things on a plate below the angle of friction, slip", 1e3 * slipped_m, "mm");
  figure("things on a steeper plate, acceleration, worst", 100.0 * off, "% off");
  EXPECT_LE(slipped_m, 1e-5);
  EXPECT_LE(off, 0.02);
}

}  // namespace
}  // namespace wholehand::test
