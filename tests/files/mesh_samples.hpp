#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

namespace wholehand::test {

/// The bytes of a number in a little-endian file.
template <class T>
std::string littleEndian(T value) {
  return std::string(reinterpret_cast<const char*>(&value), sizeof value);
}

/// The same tetrahedron, 20 x 20 x 40 mm, in every supported kind of file: ending, bytes.
inline std::vector<std::pair<std::string, std::string>> meshSamples() {
  const float corners[4][3] = {{0, 0, 0}, {0.02F, 0, 0}, {0, 0.02F, 0}, {0, 0, 0.04F}};
  const int faces[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  std::string stl(80, ' '), data, indices, obj = "# tetrahedron\n", ascii = "solid t\n";
  stl += littleEndian(std::uint32_t{4});
  for (const auto& c : corners) {
    obj += "v";
    for (const float x : c) {
      data += littleEndian(x);
      obj += " " + std::to_string(x);
    }
    obj += "\n";
  }
  for (const auto& face : faces) {
    for (int i = 0; i < 3; ++i) stl += littleEndian(0.0F);
    obj += "f";
    ascii += "facet normal 0 0 0\nouter loop\n";
    for (const int i : face) {
      indices += littleEndian(static_cast<std::uint16_t>(i));
      obj += " " + std::to_string(i + 1);
      ascii += "vertex";
      for (const float x : corners[i]) {
        stl += littleEndian(x);
        ascii += " " + std::to_string(x);
      }
      ascii += "\n";
    }
    stl += littleEndian(std::uint16_t{0});
    obj += "\n";
    ascii += "endloop\nendfacet\n";
  }
  std::string json = R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],
    "nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],
    "buffers":[{"byteLength":72}],"bufferViews":[{"buffer":0,"byteLength":48},
    {"buffer":0,"byteOffset":48,"byteLength":24}],"accessors":[{"bufferView":0,"count":4,
    "componentType":5126,"type":"VEC3","min":[0,0,0],"max":[0.02,0.02,0.04]},
    {"bufferView":1,"count":12,"componentType":5123,"type":"SCALAR"}]})";
  json.resize((json.size() + 3) / 4 * 4, ' ');
  const auto chunk = [](const std::string& body, const char* type) {
    return littleEndian(static_cast<std::uint32_t>(body.size())) + std::string(type, 4) + body;
  };
  const std::string chunks = chunk(json, "JSON") + chunk(data + indices, "BIN\0");
  const std::string glb = "glTF" + littleEndian(std::uint32_t{2}) +
                          littleEndian(static_cast<std::uint32_t>(12 + chunks.size())) + chunks;
  const std::string dae = R"(<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="millimeter" meter="0.001"/><up_axis>Z_UP</up_axis></asset>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="pa" count="12">0 0 0 20 0 0 0 20 0 0 0 40</float_array>
<technique_common><accessor source="#pa" count="4" stride="3"><param name="X" type="float"/>
<param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="4"><input semantic="VERTEX" source="#v" offset="0"/>
<p>0 2 1 0 1 3 0 3 2 1 2 3</p></triangles></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n"><instance_geometry url="#g"/></node>
</visual_scene></library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>)";
  const auto ply = [](const char* format, const std::string& rows) {
    return std::string("ply\nformat ") + format +
           " 1.0\ncomment a tetrahedron\nelement vertex 4\nproperty float x\nproperty float y\n"
           "property float z\nelement face 4\nproperty list uchar int "
           "vertex_indices\nend_header\n" +
           rows;
  };
  std::string text, little, big;
  const auto put = [&](auto value) {
    std::string bytes = littleEndian(value);
    little += bytes;
    big += std::string(bytes.rbegin(), bytes.rend());
  };
  for (const auto& c : corners) {
    for (const float x : c) {
      put(x);
      text += std::to_string(x) + " ";
    }
    text += "\n";
  }
  for (const auto& face : faces) {
    put(std::uint8_t{3});
    text += "3";
    for (const int i : face) {
      put(std::int32_t{i});
      text += " " + std::to_string(i);
    }
    text += "\n";
  }
  return {{"stl", stl},
          {"stl", ascii + "endsolid t\n"},
          {"obj", obj},
          {"glb", glb},
          {"dae", dae},
          {"ply", ply("ascii", text)},
          {"ply", ply("binary_little_endian", little)},
          {"ply", ply("binary_big_endian", big)}};
}

}  // namespace wholehand::test
