// Left hands of every size against right ones, in mirrored scenes, through the whole renderer.
#include "support/rig_tools.hpp"
#include "support/tolerance.hpp"

#include <Eigen/Core>

#include <cmath>

namespace wholehand::test {
namespace {

/// Of lambda-pride: mirrored in the plane y = 0, only y changes its sign.
template <class Axes>
Axes mirrored(Axes axes) {
  axes[1] = -axes[1];
  return axes;
}

/// From the back a hand reaches for a fixed ball beside it and closes, and is pushed back.
std::unique_ptr<Rig> reaching(const std::string& size, bool left) {
  Models m = load(shippedFiles("lambda-pride", "empty", size + (left ? "-left" : "-right")));
  // Frictionless, so that where the solver lays its tangents does not matter.
  SceneBody body = ball({0.09, left ? -0.07 : 0.07, 0.0}, 0.03, 0.0);
  body.friction = 0.0;
  m.scene.bodies = {body};
  AxisPosition from(6), to(6);
  from[0] = -0.07;
  to[0] = 0.03;
  to[1] = 0.02;
  to[3] = 2.2;
  to[5] = 0.8;
  return buildScripted(std::move(m), left ? moveAndHold(mirrored(from), mirrored(to), 800)
                                          : moveAndHold(from, to, 800));
}

TEST(LeftHandOfEverySize, InTheMirroredScene_FeelsTheMirroredEffort) {
  double apart_n = 0.0;
  for (const char* size :
       {"adult-median", "woman-p05", "woman-p50", "woman-p95", "man-p05", "man-p50", "man-p95"}) {
    const std::unique_ptr<Rig> right = reaching(size, false), left = reaching(size, true);
    ASSERT_TRUE(right->renderer->arm()) << size;
    ASSERT_TRUE(left->renderer->arm()) << size;
    std::vector<AxisEffort> felt;
    double most = 0.0;
    runTicks(*right->renderer, 1200, [&](const TickRecord& r) {
      felt.push_back(r.sent);
      most = std::max(most, std::abs(r.sent[3]));
    });
    EXPECT_GT(most, 0.05) << size << ": the fingers met the ball";  // N m
    runTicks(*left->renderer, 1200, [&](const TickRecord& r) {
      const AxisEffort image = mirrored(r.sent);
      apart_n = std::max(apart_n, (image.vec() - felt[r.tick].vec()).cwiseAbs().maxCoeff());
    });
  }
  figure("left hands' effort against the mirror image of the right ones'", apart_n, "N or N m");
  EXPECT_LE(apart_n, tolerance(1e-6));
}

}  // namespace
}  // namespace wholehand::test
