#pragma once

namespace wholehand::mujoco {

/// Changes collision detection for every model of this process. Bodies that touch each other get
/// several contact points independent of the flag `multiccd`, so that standing bodies do not rock;
/// pairs with the hand follow the flag. Pairs whose bounding boxes are apart are skipped; MuJoCo
/// compares bounding spheres, and the sphere of a table reaches every finger. Thread-safe.
void refineCollisions();

}  // namespace wholehand::mujoco
