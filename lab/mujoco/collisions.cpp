#include "lab/mujoco/collisions.hpp"

#include "lab/mujoco/model_text.hpp"

#include <Eigen/Core>

#include <array>
#include <mujoco/mujoco.h>
#include <mutex>

namespace wholehand::mujoco {
namespace {

std::array<std::array<mjfCollision, mjNGEOMTYPES>, mjNGEOMTYPES> stock{};

bool ofBodies(const mjModel& model, int a, int b) {
  return (model.geom_contype[a] & model.geom_contype[b] & kOfBodies) != 0;
}

/// Half edges of a geom's bounding box in its own frame [m]; returns false when they are unknown.
bool halfEdges(const mjModel& model, int geom, Eigen::Vector3d& half) {
  const mjtNum* size = model.geom_size + 3 * geom;
  switch (model.geom_type[geom]) {
    case mjGEOM_BOX:
      half = {size[0], size[1], size[2]};
      return true;
    case mjGEOM_CYLINDER:
      half = {size[0], size[0], size[1]};
      return true;
    default:
      return false;
  }
}

/// True when the bounding sphere of `other` is farther than the margin from the bounding box of
/// `geom`.
bool apart(const mjModel& model, const mjData& data, int geom, int other, double margin_m) {
  Eigen::Vector3d half;
  if (!halfEdges(model, geom, half)) return false;
  using Axes = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  const Eigen::Map<const Axes> axes(data.geom_xmat + 9 * geom);
  const Eigen::Map<const Eigen::Vector3d> here(data.geom_xpos + 3 * geom),
      there(data.geom_xpos + 3 * other);
  const Eigen::Vector3d gap = (axes.transpose() * (there - here)).cwiseAbs() - half;
  return gap.cwiseMax(0.0).norm() > model.geom_rbound[other] + margin_m;
}

int collide(const mjModel* model, const mjData* data, mjContact* contacts, int a, int b,
            mjtNum margin) {
  if (apart(*model, *data, a, b, margin) || apart(*model, *data, b, a, margin)) return 0;
  const mjfCollision find = stock.at(model->geom_type[a]).at(model->geom_type[b]);
  if (!ofBodies(*model, a, b)) return find(model, data, contacts, a, b, margin);
  // The model belongs to the caller. MuJoCo takes this setting only from the model's flag, so the
  // flag is changed for the call.
  int& flags = const_cast<mjModel*>(model)->opt.enableflags;
  const int before = flags;
  flags |= mjENBL_MULTICCD;
  const int count = find(model, data, contacts, a, b, margin);
  flags = before;
  return count;
}

void replaceTable() {
  for (std::size_t a = 0; a < stock.size(); ++a) {
    for (std::size_t b = 0; b < stock.size(); ++b) {
      mjfCollision& found = mjCOLLISIONFUNC[a][b];
      stock.at(a).at(b) = found;
      if (found != nullptr) found = collide;
    }
  }
}

}  // namespace

void refineCollisions() {
  static std::once_flag once;
  std::call_once(once, replaceTable);
}

}  // namespace wholehand::mujoco
