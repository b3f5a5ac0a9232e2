// Goals that exercises name for the corridor of a prescription.
#include "exercises/exercise_session.hpp"

#include <fmt/format.h>

namespace wholehand::test {
namespace {

/// A goal is where the hand's base arrives: from its naming to its end the hand comes nearer to it,
/// and at the end it is within a hand's length. It never moves while it is named.
TEST(MovementGoal, NamedGoal_IsWhereTheHandArrives) {
  for (const char* task : {"cocktail-bar", "squeeze-to-level", "drawer", "light-switch"}) {
    SCOPED_TRACE(task);
    ExerciseSession session(exerciseFiles(task));
    const MovementGoal* goal = nullptr;
    MovementGoal before;
    double begin_m = 0.0, distance_m = 0.0;
    int movements = 0;
    session.on_record = [&](const TickRecord& r) {
      goal = &session.rig->models.exercise->goal();
      const bool same = goal->known && before.known && goal->movement == before.movement;
      if (same) EXPECT_EQ(goal->at_m.eigen(), before.at_m.eigen());
      if (before.known && !same) {
        ++movements;
        EXPECT_LT(distance_m, 0.11) << "movement " << movements;
        EXPECT_LE(distance_m, begin_m) << "movement " << movements;
      }
      const Eigen::Vector3d base_m(r.q_m[0], r.q_m[1], r.q_m[2]);
      distance_m = (goal->at_m.eigen() - base_m).norm();
      if (!same) begin_m = distance_m;
      before = *goal;
    };
    session.run(12'000);
    std::printf("figure: %s, %d movements with a goal in 12 s\n", task, movements);
    EXPECT_GE(movements, 1);
  }
}

}  // namespace
}  // namespace wholehand::test
