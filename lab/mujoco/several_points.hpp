#pragma once

namespace wholehand::mujoco {

/// Bodies that touch each other have several contact points from now on, whatever the model's flag
/// `multiccd` says, so that what stands does not rock. Pairs with the hand follow the flag. Sets
/// MuJoCo's table of collision functions, once a process. Thread-safe.
void giveBodiesSeveralPoints();

}  // namespace wholehand::mujoco
