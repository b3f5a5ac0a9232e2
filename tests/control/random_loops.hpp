#pragma once

#include "certified_sets.hpp"
#include "worst_termination.hpp"

/// Walls, persons and objects at random for a loop.
namespace wholehand::test {

/// In three loops of ten.
inline void drawWall(AxisLoop& l, Draw& draw) {
  if (!draw.chance(0.3)) return;
  l.wall_stiffness = draw.between(0.05, 0.5) * l.k_pm;
  l.wall_damping = draw.chance(0.3) ? 0.0 : draw.unit();
}

/// Gives the loop a person and an object that the library's matrix has, too, and returns the same
/// as a termination.
inline Termination drawPersonAndObject(AxisLoop& l, Draw& draw, bool rigid) {
  l.person = {draw.between(0.1, 10.0), 0.0, draw.between(10.0, 5000.0)};
  Termination t;
  t.world = World::kEngine;
  t.mass = l.mass + l.person.mass;
  t.stiffness = l.person.stiffness;
  t.held_mass = l.held_mass = draw.between(0.01, 10.0);
  t.spring_per_s2 = l.spring_per_s2 = draw.between(10.0, 1e5);
  t.rigid = rigid;
  return t;
}

}  // namespace wholehand::test
