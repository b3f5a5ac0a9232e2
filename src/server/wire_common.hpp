#pragma once

#include "core/axis_array.hpp"
#include "core/geometry.hpp"
#include "model/scene/scene_model.hpp"
#include "wholehand_generated.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

// Helpers shared by src/server/wire*.cpp. It exposes FlatBuffers, so nothing else may include it.
namespace wholehand::wire {

namespace fb = wholehand::protocol;

using Builder = flatbuffers::FlatBufferBuilder;
template <class T>
using Offset = flatbuffers::Offset<T>;
template <class T>
using VectorOffset = flatbuffers::Offset<flatbuffers::Vector<T>>;

inline fb::Vec3 toWire(const Vec3& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}
inline fb::Vec3 toWire(const Eigen::Vector3d& v) {
  return toWire(Vec3::from(v));
}
inline fb::QuatXyzw toWire(const QuatXyzw& q) {
  return {static_cast<float>(q.x), static_cast<float>(q.y), static_cast<float>(q.z),
          static_cast<float>(q.w)};
}
inline fb::Pose toWire(const Pose& pose) {
  return {toWire(pose.translation_m), toWire(QuatXyzw::from(Eigen::Quaterniond(pose.rotation)))};
}

/// Writes doubles from a range with data() and size() as a vector of floats, within the builder's
/// memory.
template <class Range>
VectorOffset<float> floats(Builder& b, const Range& values) {
  float* out = nullptr;
  const std::size_t n = values.size();
  const auto offset = b.CreateUninitializedVector<float>(n, &out);
  const double* in = values.data();
  for (std::size_t i = 0; i < n; ++i) {
    flatbuffers::WriteScalar(out + i, static_cast<float>(in[i]));
  }
  return offset;
}

/// A shape of a body, placed relative to the body's centre of mass.
Offset<fb::Shape> shapeToWire(Builder& b, const Shape& shape, const Eigen::Vector3d& com_m);

/// Finishes a message around a payload.
template <class T>
void finish(Builder& b, Offset<T> payload, std::uint16_t schema_version) {
  b.Finish(fb::CreateMessage(b, schema_version, fb::PayloadTraits<T>::enum_value, payload.Union()),
           fb::MessageIdentifier());
}

}  // namespace wholehand::wire
