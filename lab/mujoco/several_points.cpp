#include "lab/mujoco/several_points.hpp"

#include "lab/mujoco/model_text.hpp"

#include <array>
#include <mujoco/mujoco.h>

namespace wholehand::mujoco {
namespace {

std::array<std::array<mjfCollision, mjNGEOMTYPES>, mjNGEOMTYPES> stock{};

bool ofBodies(const mjModel& model, int a, int b) {
  return (model.geom_contype[a] & model.geom_contype[b] & kOfBodies) != 0;
}

int collide(const mjModel* model, const mjData* data, mjContact* contacts, int a, int b,
            mjtNum margin) {
  const mjfCollision find = stock.at(model->geom_type[a]).at(model->geom_type[b]);
  if (!ofBodies(*model, a, b)) return find(model, data, contacts, a, b, margin);
  // The model is the caller's own; the flag is the only way to say it.
  int& flags = const_cast<mjModel*>(model)->opt.enableflags;
  const int before = flags;
  flags |= mjENBL_MULTICCD;
  const int count = find(model, data, contacts, a, b, margin);
  flags = before;
  return count;
}

bool replaceTable() {
  for (std::size_t a = 0; a < stock.size(); ++a) {
    for (std::size_t b = 0; b < stock.size(); ++b) {
      mjfCollision& found = mjCOLLISIONFUNC[a][b];
      stock.at(a).at(b) = found;
      if (found != nullptr) found = collide;
    }
  }
  return true;
}

}  // namespace

void giveBodiesSeveralPoints() {
  static const bool replaced = replaceTable();
  static_cast<void>(replaced);
}

}  // namespace wholehand::mujoco
