#include "loop/physics/bullet/bullet_chains.hpp"

#include "loop/physics/bullet/bullet_types.hpp"

#include <algorithm>

namespace wholehand::bullet {

BulletChains::BulletChains(const SceneModel& scene, std::vector<BulletBody>& bodies) {
  for (std::vector<int>& members : jointChains(scene.bodies)) {
    Tree& tree = trees_.emplace_back();
    tree.chain = std::make_unique<JointChain>(scene.bodies, members);
    tree.members = std::move(members);
    for (std::size_t i = 0; i < tree.members.size(); ++i) {
      BulletBody& body = bodies[tree.members[i]];
      tree.bodies.push_back(&body);
      body.joinChain(*tree.chain, static_cast<int>(i), tree.members.front());
    }
  }
}

void BulletChains::addTo(ReducedContactSolver& solver) {
  for (Tree& tree : trees_) {
    std::vector<btRigidBody*> links;
    for (BulletBody* body : tree.bodies) links.push_back(&body->rigid());
    solver.addChain(links, *tree.chain);
  }
}

void BulletChains::predict(const RestingBodies& resting, const std::vector<char>& touched,
                           double step_s) noexcept {
  for (Tree& tree : trees_) {
    if (!resting.awake(tree.members.front())) continue;
    const bool meets = std::any_of(tree.members.begin(), tree.members.end(),
                                   [&](int body) { return touched[body] != 0; });
    tree.chain->predict(toEigen(tree.bodies.front()->rigid().getGravity()), step_s, meets);
    for (BulletBody* body : tree.bodies) body->moveWithChain();
  }
}

// The solver stores the change of q̇ as that of the lead's angular velocity.
void BulletChains::finish(const RestingBodies& resting, double step_s) noexcept {
  for (Tree& tree : trees_) {
    if (!resting.awake(tree.members.front())) continue;
    JointChain& chain = *tree.chain;
    const Eigen::Vector3d changed =
        toEigen(tree.bodies.front()->rigid().getAngularVelocity()) - chain.spin(0);
    chain.move(chain.rate() + changed, step_s);
    for (BulletBody* body : tree.bodies) {
      body->placeOnChain();
      body->moveWithChain();
    }
  }
}

}  // namespace wholehand::bullet
