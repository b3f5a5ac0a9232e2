#pragma once

namespace wholehand::mujoco {

/// From now on, in every model of this process: bodies that touch each other have several contact
/// points, whatever the flag `multiccd` says, so that what stands does not rock (pairs with the
/// hand follow the flag); and a pair whose boxes are apart is not looked at any closer (MuJoCo
/// compares spheres, and that of a table reaches every finger). Thread-safe.
void refineCollisions();

}  // namespace wholehand::mujoco
