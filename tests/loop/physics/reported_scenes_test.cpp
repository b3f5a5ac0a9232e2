// Scenes of field reports on bodies on joints, as the files were sent: each does what its closed
// form says, at every rate of the loop, whether bodies that stand still may rest or not.
#include "files/scene/scene_file.hpp"
#include "loop/physics/body_yard.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace wholehand::test {
namespace {

using std::numbers::pi;

/// A reported scene far from the hand.
class ReportedScene : public ::testing::Test {
 protected:
  /// @param lets_rest as `run` does; false: every body is computed in each step
  void open(const std::string& name, double rate_hz = 1000.0, bool lets_rest = true) {
    scene_ = orThrow(loadSceneFile(std::string(WHOLEHAND_SOURCE_DIR) +
                                   "/tests/loop/physics/reported_scenes/" + name + ".toml"));
    yard_ = std::make_unique<Yard>("bullet", scene_.bodies, scene_.gravity_m_s2, rate_hz,
                                   Eigen::Matrix3d::Identity(), lets_rest);
  }
  [[nodiscard]] const SceneBody& body(int i) const { return scene_.bodies[i]; }
  /// Way of a body from its place in the file.
  [[nodiscard]] Eigen::Vector3d way(int i) const {
    return yard_->at(i) - body(i).pose.translation_m;
  }
  /// 1 kHz, as in the reports, and any rate; one of the two with reduced counts.
  [[nodiscard]] std::vector<double> rates() {
    const double any_hz = logUniform(random_, 500.0, kReducedCounts ? 2000.0 : 8000.0);
    if (!kReducedCounts) return {1000.0, any_hz};
    return {random_() % 2 == 0 ? 1000.0 : any_hz};
  }

  std::mt19937_64 random_{seed()};
  SceneModel scene_;
  std::unique_ptr<Yard> yard_;
};

TEST_F(ReportedScene, PressOnALightThing_StandsAndRests) {
  double sunk_m = 0.0, off_m = 0.0, fastest_m_s = 0.0;
  for (const char* name :
       {"press-free-40n-5g-cylinder", "press-slide-40n-5g-cylinder", "press-slide-10n-0.5g-box",
        "press-spring-40n-5g-cylinder", "press-spring-10n-0.5g-cylinder"}) {
    for (const double rate_hz : rates()) {
      SCOPED_TRACE(testing::Message() << name << " at " << rate_hz << " Hz");
      open(name, rate_hz, rate_hz == 1000.0 && random_() % 2 == 0);
      for (int k = 0; k < static_cast<int>(2.0 * rate_hz); ++k) {
        yard_->step();
        sunk_m = std::max(sunk_m, std::abs(yard_->at(1).z() - 0.01));
        off_m = std::max(off_m, std::abs(yard_->at(2).z() - 0.04));
      }
      // 10 µm of every contact, twice for the press.
      EXPECT_LE(sunk_m, 2e-5);
      EXPECT_LE(off_m, 4e-5);
      for (const int i : {1, 2}) fastest_m_s = std::max(fastest_m_s, yard_->velocity(i).norm());
      EXPECT_LE(fastest_m_s, 1e-4);
    }
  }
  figure("reported presses: thing off its place", 1e3 * sunk_m, "mm");
  figure("reported presses: press off its place", 1e3 * off_m, "mm");
  figure("reported presses: fastest after 2 s", fastest_m_s, "m/s");
}

TEST_F(ReportedScene, CardUnderABook_Stands) {
  open("card-under-book", 1000.0, false);
  yard_->run(2.0);
  for (const auto& [i, height_m] : {std::pair{1, 0.0005}, {2, 0.021}, {3, 0.025}, {4, 0.1}}) {
    EXPECT_NEAR(yard_->at(i).z(), height_m, 1e-4) << body(i).name;
    EXPECT_LE(yard_->velocity(i).norm(), 1e-4) << body(i).name;
  }
}

TEST_F(ReportedScene, CreepingDrawers_AreWhereTheDamperLetsThem) {
  for (const char* name : {"drawer-10", "drawer-20", "drawer-50"}) {
    for (const double rate_hz : rates()) {
      SCOPED_TRACE(testing::Message() << name << " at " << rate_hz << " Hz");
      open(name, rate_hz);
      const double per_s = body(0).joint->spring_stiffness / body(0).joint->viscous_friction;
      double now_s = 0.0;
      for (const double until_s : {0.1, 1.0, kReducedCounts ? 3.0 : 10.0}) {
        yard_->run(until_s - now_s);
        now_s = until_s;
        const double way_m = 0.04 * (1.0 - std::exp(-per_s * now_s));
        EXPECT_NEAR(way(0).x(), way_m, 2e-6 + 2e-3 * way_m) << now_s << " s";
      }
    }
  }
  // 60 s, as reported: 27.95 mm.
  open("drawer-20", 500.0);
  yard_->run(60.0);
  EXPECT_NEAR(way(0).x(), 0.02795, 2e-5);
}

TEST_F(ReportedScene, WeakSpring_SwingsThereAndBack) {
  open("weak-spring");
  yard_->run(pi);
  EXPECT_NEAR(way(0).x(), 0.04, 1e-4);
  yard_->run(pi);
  EXPECT_NEAR(way(0).x(), 0.0, 1e-4);
}

// θ̈ = g sin α · m r cos θ / I, by fine steps of the midpoint rule.
double openedBy(const SceneBody& door, double pull_m_s2, double seconds) {
  const double r_m = 0.2, inertia = door.inertia_kg_m2(2, 2) + door.mass_kg * r_m * r_m;
  constexpr double kStep_s = 1e-4;
  double angle = 0.0, rate = 0.0;
  for (int k = 0; k < static_cast<int>(std::lround(seconds / kStep_s)); ++k) {
    const double middle = angle + 0.5 * kStep_s * rate;
    const double turns = pull_m_s2 * door.mass_kg * r_m * std::cos(middle) / inertia;
    angle += kStep_s * (rate + 0.5 * kStep_s * turns);
    rate += kStep_s * turns;
  }
  return angle;
}

TEST_F(ReportedScene, SlopeOfATenthOfADegree_MovesEverything) {
  open("slope-0.1");
  const double pull_m_s2 = scene_.gravity_m_s2.x(), seconds = 5.0;
  yard_->run(seconds);
  const double way_m = 0.5 * pull_m_s2 * seconds * seconds;
  EXPECT_NEAR(way(1).x(), 5.0 / 7.0 * way_m, 0.01 * way_m) << "ball";
  EXPECT_NEAR(way(2).x(), 2.0 / 3.0 * way_m, 0.01 * way_m) << "can";
  EXPECT_NEAR(way(3).x(), way_m, 0.01 * way_m) << "without friction";
  EXPECT_NEAR(way(4).x(), 0.2 * std::sin(openedBy(body(4), pull_m_s2, seconds)), 1e-3) << "door";
  if (kReducedCounts) return;
  yard_->run(10.0);
  EXPECT_NEAR(way(4).x(), 0.2, 1e-5) << "the door is not at its end";
}

TEST_F(ReportedScene, UndampedSprings_KeepPeriodAndEnergy) {
  for (const char* name : {"spring-100", "spring-1000", "spring-10000"}) {
    for (const double rate_hz : {1000.0, 4000.0}) {
      SCOPED_TRACE(testing::Message() << name << " at " << rate_hz << " Hz");
      open(name, rate_hz);
      const double k = body(0).joint->spring_stiffness, m = body(0).mass_kg;
      double first_s = 0.0, last_s = 0.0, before_m = way(0).x() - 0.02, least_j = 1e9;
      int passes = 0;
      for (int i = 1; i <= static_cast<int>(2.0 * rate_hz); ++i) {
        yard_->step();
        const double off_m = way(0).x() - 0.02;
        const double energy_j = 0.5 * (m * yard_->velocity(0).squaredNorm() + k * off_m * off_m);
        least_j = std::min(least_j, energy_j);
        if (before_m < 0.0 && off_m >= 0.0) {
          last_s = (i - off_m / (off_m - before_m)) / rate_hz;
          if (passes++ == 0) first_s = last_s;
        }
        before_m = off_m;
      }
      const double period_s = 2.0 * pi * std::sqrt(m / k);
      EXPECT_GE(least_j, 0.999 * 0.5 * k * 0.02 * 0.02);
      ASSERT_GT(passes, 2);
      EXPECT_NEAR((last_s - first_s) / (passes - 1), period_s, 1e-3 * period_s);
    }
  }
}

}  // namespace
}  // namespace wholehand::test
