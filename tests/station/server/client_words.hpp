#pragma once

#include "station/server/wire.hpp"
#include "support/watched_main.hpp"
#include "wholehand_generated.h"

#include <cstdint>
#include <string>
#include <vector>

/// Builds the messages of a client with flatc's own code, as clients in other languages do.
namespace wholehand::test::words {

namespace fb = wholehand::protocol;
using Builder = flatbuffers::FlatBufferBuilder;

template <class Table>
wire::Bytes command(std::uint32_t id, flatbuffers::Offset<Table> order, Builder& b,
                    std::uint16_t version = wire::kSchemaVersion) {
  const auto c = fb::CreateCommand(b, id, fb::OrderTraits<Table>::enum_value, order.Union());
  fb::FinishMessageBuffer(b, fb::CreateMessage(b, version, fb::Payload::Command, c.Union()));
  return {b.GetBufferPointer(), b.GetBufferPointer() + b.GetSize()};
}

/// Message of a command whose order `make(builder)` builds.
template <class Make>
wire::Bytes command(std::uint32_t id, Make make, std::uint16_t version = wire::kSchemaVersion) {
  Builder b;
  const auto order = make(b);
  return command(id, order, b, version);
}

inline wire::Bytes arm(std::uint32_t id, std::uint16_t version = wire::kSchemaVersion,
                       std::uint32_t acknowledged_stop = 1, std::uint32_t basis_seen = 1) {
  return command(
      id, [&](Builder& b) { return fb::CreateArm(b, acknowledged_stop, basis_seen); }, version);
}
inline wire::Bytes armAcknowledging(std::uint32_t endings, std::uint32_t id,
                                    std::uint32_t basis_seen = 1) {
  return arm(id, wire::kSchemaVersion, endings, basis_seen);
}
inline wire::Bytes stop(std::uint32_t id) {
  return command(id, [](Builder& b) { return fb::CreateStop(b); });
}
inline wire::Bytes emergencyStop(std::uint32_t id) {
  return command(id, [](Builder& b) { return fb::CreateEmergencyStop(b); });
}
inline wire::Bytes rest(std::uint32_t id) {
  return command(id, [](Builder& b) { return fb::CreateRest(b); });
}
inline wire::Bytes load(std::uint32_t id, const char* exercise, std::uint16_t level,
                        const char* hand) {
  return command(
      id, [&](Builder& b) { return fb::CreateLoadExerciseDirect(b, exercise, level, hand); });
}
inline wire::Bytes aim(std::uint32_t id, const std::vector<float>& q,
                       fb::Help by = fb::Help::Unspecified) {
  return command(id, [&](Builder& b) { return fb::CreateAimDirect(b, &q, by); });
}
inline wire::Bytes setParameter(std::uint32_t id, const char* name, double value,
                                std::uint32_t basis_seen = 1) {
  return command(
      id, [&](Builder& b) { return fb::CreateSetParameterDirect(b, name, value, basis_seen); });
}
inline wire::Bytes steer(std::uint32_t id, fb::Steering by) {
  return command(id, [&](Builder& b) { return fb::CreateSteer(b, by); });
}
inline wire::Bytes setHelp(std::uint32_t id, fb::Help help) {
  return command(id, [&](Builder& b) { return fb::CreateSetHelp(b, help); });
}
inline wire::Bytes action(std::uint32_t id, fb::Act act, std::uint32_t basis_seen,
                          std::uint8_t chosen = 0) {
  return command(id, [&](Builder& b) { return fb::CreateAction(b, act, basis_seen, chosen); });
}
/// Takes the controls. The holder must send a sign of life every 200 ms.
inline wire::Bytes takeControls(std::uint32_t id, const char* token = "") {
  seesRealTime();
  return command(id, [&](Builder& b) { return fb::CreateTakeControlsDirect(b, token); });
}
inline wire::Bytes releaseControls(std::uint32_t id) {
  return command(id, [](Builder& b) { return fb::CreateReleaseControls(b); });
}
inline wire::Bytes heartbeat(std::uint32_t id, bool busy = false) {
  return command(id, [&](Builder& b) { return fb::CreateHeartbeat(b, busy); });
}

// Orders of a game to its bodies.

inline fb::Pose placed(float x, float y, float z, const fb::QuatXyzw& turn = {0, 0, 0, 1}) {
  return {{x, y, z}, turn};
}
/// @param fill makes the pieces: a vector of offsets of fb::Shape
template <class Fill>
wire::Bytes prepareShapes(std::uint32_t id, std::uint16_t set, Fill fill) {
  return command(id, [&](Builder& b) {
    std::vector<flatbuffers::Offset<fb::Shape>> pieces = fill(b);
    return fb::CreatePrepareShapesDirect(b, set, &pieces);
  });
}
inline wire::Bytes prepareBall(std::uint32_t id, std::uint16_t set, float radius_m) {
  return prepareShapes(id, set, [&](Builder& b) {
    return std::vector{fb::CreateShape(b, fb::ShapeType::Sphere, nullptr, radius_m)};
  });
}
inline wire::Bytes prepareBox(std::uint32_t id, std::uint16_t set, const fb::Vec3& half_m,
                              const fb::Pose* in_body = nullptr) {
  return prepareShapes(id, set, [&](Builder& b) {
    return std::vector{fb::CreateShape(b, fb::ShapeType::Box, &half_m, 0.0F, 0.0F, 0, 0, in_body)};
  });
}
inline wire::Bytes prepareMesh(std::uint32_t id, std::uint16_t set,
                               const std::vector<fb::Vec3>& points,
                               const std::vector<std::uint32_t>& triangles) {
  return prepareShapes(id, set, [&](Builder& b) {
    return std::vector{fb::CreateShapeDirect(b, fb::ShapeType::ConvexMesh, nullptr, 0.0F, 0.0F,
                                             &points, &triangles)};
  });
}

struct SpawnWords {
  std::uint16_t slot = 0;
  std::uint32_t generation = 1;
  std::uint16_t shape_set = 0;
  fb::BodyOwner owner = fb::BodyOwner::Loop;
  float mass_kg = 0.1F, friction = 0.8F;
  fb::Pose pose = placed(0.5F, 0.3F, 0.2F);
  fb::Vec3 velocity_m_s{0, 0, 0};
  bool refuse_overlap = false;
};
inline wire::Bytes spawn(std::uint32_t id, const std::vector<SpawnWords>& bodies) {
  return command(id, [&](Builder& b) {
    std::vector<flatbuffers::Offset<fb::SpawnBody>> out;
    for (const SpawnWords& w : bodies) {
      out.push_back(fb::CreateSpawnBody(b, w.slot, w.generation, w.shape_set, w.owner, w.mass_kg,
                                        w.friction, &w.pose, &w.velocity_m_s, w.refuse_overlap));
    }
    return fb::CreateSpawnDirect(b, &out);
  });
}
inline wire::Bytes remove(std::uint32_t id, const std::vector<fb::BodyName>& bodies) {
  return command(id, [&](Builder& b) { return fb::CreateRemoveDirect(b, &bodies); });
}
inline wire::Bytes teleport(std::uint32_t id, const std::vector<fb::BodyPlace>& bodies) {
  return command(id, [&](Builder& b) { return fb::CreateTeleportDirect(b, &bodies); });
}
inline wire::Bytes setOwner(std::uint32_t id, const std::vector<fb::BodyHandover>& bodies) {
  return command(id, [&](Builder& b) { return fb::CreateSetOwnerDirect(b, &bodies); });
}
inline wire::Bytes bodyTargets(std::uint32_t id, const std::vector<fb::BodyPlace>& bodies) {
  return command(id, [&](Builder& b) { return fb::CreateBodyTargetsDirect(b, &bodies); });
}

/// One message of each kind, with ids from 1.
inline std::vector<wire::Bytes> oneOfEach() {
  return {arm(1, wire::kSchemaVersion, 1, 6),
          stop(2),
          emergencyStop(3),
          load(4, "cocktail-bar", 2, "adult"),
          aim(5, {0.1F, -0.2F}, fb::Help::None),
          setParameter(6, "lead_in_m", 0.01, 7),
          steer(7, fb::Steering::Person),
          action(8, fb::Act::Pause, 0),
          takeControls(9, "a token of 18 char"),
          releaseControls(10),
          heartbeat(11),
          rest(12),
          setHelp(13, fb::Help::Some),
          prepareBall(14, 0, 0.03F),
          spawn(15, {{}}),
          remove(16, {{0, 1}}),
          teleport(17, {{0, 1, placed(0.4F, 0.0F, 0.1F)}}),
          setOwner(18, {{0, 1, fb::BodyOwner::Fixed}}),
          bodyTargets(19, {{0, 1, placed(0.4F, 0.0F, 0.1F)}})};
}

}  // namespace wholehand::test::words
