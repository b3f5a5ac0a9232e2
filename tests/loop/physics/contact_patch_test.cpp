// Contact points of meshes lie at the distance of the shapes, whatever their sizes and poses.
#include "loop/physics/bullet/contact_patch.hpp"

#include "files/scene/separation.hpp"
#include "loop/physics/body_yard.hpp"
#include "loop/physics/bullet/bullet_shapes.hpp"
#include "loop/physics/bullet/bullet_types.hpp"
#include "support/figure.hpp"

#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletCollision/CollisionShapes/btConvexPointCloudShape.h>

#include <algorithm>
#include <cstdio>

namespace wholehand::test {
namespace {

using Eigen::Vector3d;

/// A shape that stands somewhere, as the engine sees it.
struct Placed {
  Shape form;
  Pose pose;
  std::unique_ptr<btCollisionShape> shape = bullet::makeShape(form);
  btCollisionObject object;

  Placed(Shape form_in, const Pose& at) : form(std::move(form_in)), pose(at) {
    object.setCollisionShape(shape.get());
    object.setWorldTransform(bullet::toBt(at));
  }
  /// The same mesh as a body of a game has it: only Bullet holds its points.
  void takeCloud() {
    for (const Vector3d& p : form.points_m) cloud.push_back(bullet::toBt(p));
    shape = std::make_unique<btConvexPointCloudShape>(cloud.data(), static_cast<int>(cloud.size()),
                                                      btVector3(1.0, 1.0, 1.0));
    shape->setMargin(0.0);
    object.setCollisionShape(shape.get());
    form.points_m.clear(), form.triangles.clear();
  }
  std::vector<btVector3> cloud;
};

Vector3d anyDirection(std::mt19937_64& random) {
  return anyTurn(random) * Vector3d::UnitX();
}

Shape anyMesh(std::mt19937_64& random) {
  const auto size_m = [&] { return logUniform(random, 0.01, 0.1); };
  if (random() % 3 != 0) return meshShape({size_m(), size_m(), size_m()});
  Shape shape;
  shape.type = ShapeType::kConvexMesh;
  shape.points_m = {
      {0.0, 0.0, 0.0}, {size_m(), 0.0, 0.0}, {0.0, size_m(), 0.0}, {0.0, 0.0, size_m()}};
  shape.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  return shape;
}

/// A capsule, a mesh that lies `gap_m` from it, and what findPatch() gives at once.
struct Meeting {
  double gap_m = 0.0, found_m = 1.0;

  Meeting(std::mt19937_64& random, bool of_game) {
    const Shape mesh = anyMesh(random);
    const Shape round =
        roundShape(ShapeType::kCapsule, uniform(random, 0.005, 0.02), uniform(random, 0.0, 0.05));
    const Pose at{anyTurn(random), Vector3d::Zero()};
    const Vector3d direction = anyDirection(random);
    Pose of{anyTurn(random), Vector3d::Zero()};
    const double wanted_m = uniform(random, -0.5 * round.radius_m, 4e-4);
    double low_m = 0.0, high_m = 0.3;
    for (int k = 0; k < 50; ++k) {
      of.translation_m = 0.5 * (low_m + high_m) * direction;
      const bool nearer = separation(round, of, mesh, at) < wanted_m;
      (nearer ? low_m : high_m) = 0.5 * (low_m + high_m);
    }
    gap_m = separation(round, of, mesh, at);
    const Placed a(round, of);
    Placed b(mesh, at);
    if (of_game) b.takeCloud();
    const bullet::ContactPatch patch =
        bullet::findPatch(a.object, a.form, b.object, b.form, 5e-4, nullptr);
    for (int k = 0; k < patch.count; ++k) found_m = std::min(found_m, patch.points[k].gap_m);
  }
};

// The axis of the capsule is outside the mesh, so the nearest points are known. The search for them
// ended too early in some poses; a thumb then felt a mesh 4 mm away from it as 1 mm deep.
TEST(FindPatch, OfACapsuleAndAMesh_LiesAtTheirDistance) {
  auto random = seededRandom(6104);
  int none = 0, off = 0, wrong = 0;
  const int draws = kReducedCounts ? 500 : cases(2000);
  for (int i = 0; i < draws; ++i) {
    const Meeting is(random, i % 2 == 1);
    if (is.found_m == 1.0) {
      ++none;
      continue;
    }
    if (std::abs(is.found_m - is.gap_m) > 1.1e-5) ++off;
    if (std::abs(is.found_m - is.gap_m) > 5e-4) {
      ++wrong;
      std::printf("figure: draw %d is %.2f mm off\n", i, 1e3 * (is.found_m - is.gap_m));
    }
  }
  // Beside an edge that lies flush, a capsule that is apart has no point.
  EXPECT_LE(none, draws / 100);
  EXPECT_LE(off, draws / 500);
  EXPECT_EQ(wrong, 0);
  figure("meshes whose contact is more than 11 µm from their distance", 1e3 * off / draws,
         "of 1000");
}

}  // namespace
}  // namespace wholehand::test
