// Bodies of a game, as all clients are told of them.
#include "server/clients.hpp"

#include <algorithm>

namespace wholehand {
namespace {

using Shapes = std::vector<std::shared_ptr<const GameShapes>>;

/// Shapes of the bodies, each once, without those of `known`.
Shapes shapesOf(const GameBodies& bodies, const Shapes& known) {
  Shapes out;
  for (const GameBody& body : bodies) {
    const auto has = [&](const Shapes& in) {
      return std::find(in.begin(), in.end(), body.shapes) != in.end();
    };
    if (!has(known) && !has(out)) out.push_back(body.shapes);
  }
  return out;
}

}  // namespace

SharedBytes Clients::bodiesMessage() const {
  return std::make_shared<const wire::Bytes>(
      wire::gameBodiesMessage(bodies_session_, *bodies_shown_, shapesOf(*bodies_shown_, {})));
}

// A client that joined since the last message was told of the same bodies as all others.
void Clients::followBodies(const LoopStatus& status) {
  if (status.bodies == bodies_shown_) return;
  static const auto kNone = std::make_shared<const GameBodies>();
  const auto before = bodies_shown_ ? bodies_shown_ : kNone;
  const auto now = status.bodies ? status.bodies : kNone;
  bodies_shown_ = status.bodies;
  bodies_session_ = status.session;
  if (now->empty() && before->empty()) return;
  deliverToAll(std::make_shared<const wire::Bytes>(
      wire::gameBodiesMessage(status.session, *now, shapesOf(*now, shapesOf(*before, {})))));
}

}  // namespace wholehand
