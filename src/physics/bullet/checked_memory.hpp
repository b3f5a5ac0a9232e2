#pragma once

namespace wholehand::bullet {

/// Makes Bullet's allocations throw std::bad_alloc where no memory is left; its own write to
/// address 0. For the whole process; before the first object of Bullet.
void useCheckedMemory();

}  // namespace wholehand::bullet
