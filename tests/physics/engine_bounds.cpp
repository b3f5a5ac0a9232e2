#include "physics/engine_bounds.hpp"

namespace wholehand::test {
namespace {

/// Reached: 2.2 N, 0.12 N·m, 1.8 mrad. A contact acts on the joints one by one, not on the synergy,
/// and what it bends is put back after the step: part of its force does no work on the axes.
Bounds ofThePapersWay() {
  Bounds bounds;
  bounds.virtual_work_n = 4.0;
  bounds.virtual_work_nm = 0.25;
  bounds.synergy_rad = 5e-3;
  bounds.bodies = 128;  // a list of every pair
  return bounds;
}

/// It sorts more than 62 links and bodies in memory that it asks for in a tick, and refuses them.
Bounds ofMujoco() {
  Bounds bounds;
  bounds.bodies = 32;
  return bounds;
}

}  // namespace

const Bounds& boundsOf(const std::string& engine) {
  static const Bounds kAsked, kPaper = ofThePapersWay(), kMujoco = ofMujoco();
  if (engine == "mujoco") return kMujoco;
  return engine == "bullet-paper" ? kPaper : kAsked;
}

}  // namespace wholehand::test
