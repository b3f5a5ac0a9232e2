// Bodies of a game, as all clients are told of them.
#include "server/clients.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace wholehand {
namespace {

using Shapes = std::vector<std::shared_ptr<const GameShapes>>;

/// Null: none.
template <class Bodies>
const Bodies& orNone(const std::shared_ptr<const Bodies>& bodies) {
  static const Bodies kNone;
  return bodies ? *bodies : kNone;
}

bool byId(const std::shared_ptr<const GameShapes>& a, const std::shared_ptr<const GameShapes>& b) {
  return a->id < b->id;
}

/// Shapes of the bodies, each once.
template <class Bodies>
Shapes shapesOf(const Bodies& bodies) {
  Shapes out;
  for (const auto& body : bodies) out.push_back(body.shapes);
  std::sort(out.begin(), out.end(), byId);
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

/// Adds those of `now` that are neither in `before` nor there yet.
void addNew(const Shapes& now, const Shapes& before, Shapes& out) {
  for (const auto& shapes : now) {
    const bool known = std::binary_search(before.begin(), before.end(), shapes, byId);
    if (!known && std::find(out.begin(), out.end(), shapes) == out.end()) out.push_back(shapes);
  }
}

bool same(const ShownBody& a, const ShownBody& b) {
  const auto place_of = [](const ShownBody& shown) {
    const Vec3& p = shown.body.pose.position_m;
    const QuatXyzw& q = shown.body.pose.orientation_xyzw;
    return std::array{p.x, p.y, p.z, q.x, q.y, q.z, q.w};
  };
  if (a.shapes != b.shapes || a.body.generation != b.body.generation ||
      a.body.slot != b.body.slot || a.body.whereabouts != b.body.whereabouts) {
    return false;
  }
  return a.body.slot >= 0 || place_of(a) == place_of(b);  // in a slot, states have the pose
}

/// What changed: both are sorted by number.
RegisteredBodies changesOf(const RegisteredBodies& before, const RegisteredBodies& now) {
  RegisteredBodies out;
  auto was = before.begin();
  const auto gone_below = [&](int number) {
    for (; was != before.end() && was->body.number < number; ++was) {
      out.push_back({was->body, nullptr});
      out.back().body.slot = -1;
    }
  };
  for (const ShownBody& shown : now) {
    gone_below(shown.body.number);
    const bool known = was != before.end() && was->body.number == shown.body.number;
    if (!known || !same(*was, shown)) out.push_back(shown);
    if (known) ++was;
  }
  gone_below(kLastNumber + 1);
  return out;
}

}  // namespace

SharedBytes Clients::bodiesMessage() const {
  const GameBodies& bodies = orNone(bodies_shown_);
  const RegisteredBodies& registered = orNone(registered_shown_);
  Shapes shapes;
  addNew(shapesOf(bodies), {}, shapes);
  addNew(shapesOf(registered), {}, shapes);
  return std::make_shared<const wire::Bytes>(
      wire::gameBodiesMessage(bodies_session_, bodies, shapes, registered));
}

// A client that joined since the last message was told of the same bodies as all others.
void Clients::followBodies(const LoopStatus& status) {
  if (status.bodies == bodies_shown_ && status.registered == registered_shown_) return;
  const auto bodies_before = std::exchange(bodies_shown_, status.bodies);
  const auto registered_before = std::exchange(registered_shown_, status.registered);
  bodies_session_ = status.session;
  const GameBodies &was = orNone(bodies_before), &bodies = orNone(bodies_shown_);
  const RegisteredBodies changes = changesOf(orNone(registered_before), orNone(registered_shown_));
  if (bodies.empty() && was.empty() && changes.empty()) return;
  Shapes shapes;
  addNew(shapesOf(bodies), shapesOf(was), shapes);
  addNew(shapesOf(orNone(registered_shown_)), shapesOf(orNone(registered_before)), shapes);
  deliverToAll(std::make_shared<const wire::Bytes>(
      wire::gameBodiesMessage(status.session, bodies, shapes, changes)));
}

}  // namespace wholehand
