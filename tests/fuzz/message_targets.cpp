#include "files/mesh/mesh_file.hpp"
#include "fuzz_targets.hpp"
#include "station/server/client_words.hpp"
#include "station/server/http_line.hpp"
#include "station/server/site.hpp"
#include "station/server/udp_host.hpp"
#include "station/server/wire.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <zlib.h>

namespace wholehand::test {
namespace {

std::string text(const std::vector<std::uint8_t>& bytes) {
  return {bytes.begin(), bytes.end()};
}

/// Checks that the reader stays within the bytes and gives no command with a non-finite number.
std::string enterWebSocket(const std::string& bytes) {
  const wire::Bytes exact(bytes.begin(), bytes.end());  // exact size: a read beyond it is detected
  const auto message = wire::decode(exact);
  if (!message) return message.errors().front().problem.empty() ? "refused without a reason" : "";
  const auto* set = message->as<orders::SetParameter>();
  if (set != nullptr && !std::isfinite(set->value)) return "a value that is no number";
  const auto* aim = message->as<orders::Aim>();
  if (aim != nullptr && !allFinite(aim->q)) return "an aim that is no number";
  if (aim != nullptr && aim->q.size() > kMaxAxes) return "an aim of too many axes";
  return "";
}

constexpr std::size_t kChecksumAt = 44;  // docs/udp.md

std::string withRightChecksum(std::string datagram) {
  if (datagram.size() < udp::kHeaderSize) return datagram;
  const auto* const bytes = reinterpret_cast<const Bytef*>(datagram.data());
  uLong crc = ::crc32(0, bytes, kChecksumAt);
  crc =
      ::crc32(crc, bytes + udp::kHeaderSize, static_cast<uInt>(datagram.size() - udp::kHeaderSize));
  const auto little_endian = static_cast<std::uint32_t>(crc);
  std::memcpy(datagram.data() + kChecksumAt, &little_endian, sizeof little_endian);
  return datagram;
}

/// Consecutive datagrams of a sender who can compute a checksum: for each 2 bytes of length, then
/// the datagram.
std::string enterUdp(const std::string& bytes) {
  for (std::size_t at = 0; at + 2 <= bytes.size();) {
    const std::size_t length =
        static_cast<std::uint8_t>(bytes[at]) + 256U * static_cast<std::uint8_t>(bytes[at + 1]);
    const std::string datagram = withRightChecksum(bytes.substr(at + 2, length));
    at += 2 + length;
    const std::vector<std::uint8_t> exact(datagram.begin(), datagram.end());
    const udp::Received got = udp::read(exact);
    if (got.flaw != udp::Flaw::kNone) {
      if (!got.payload.empty()) return "a payload of a bad datagram";
      continue;
    }
    const std::string wrong = enterWebSocket({got.payload.begin(), got.payload.end()});
    if (!wrong.empty()) return wrong;
  }
  return "";
}

std::string behindItsLength(const std::vector<std::uint8_t>& datagram) {
  std::string out = {static_cast<char>(datagram.size() & 0xFFU),
                     static_cast<char>(datagram.size() >> 8U)};
  return out + text(datagram);
}

std::vector<std::string> goodDatagrams() {
  std::vector<std::string> good;
  udp::Header header;
  udp::Datagram datagram;
  const auto add = [&](const wire::Bytes& message) {
    header.kind = message.empty() ? udp::Kind::kAlive : udp::Kind::kCommand;
    ++header.sequence;
    const auto size = static_cast<std::ptrdiff_t>(udp::write(datagram, header, message));
    good.push_back(behindItsLength({datagram.begin(), datagram.begin() + size}));
  };
  for (const wire::Bytes& message : words::oneOfEach()) add(message);
  add({});
  return good;
}

std::string enterHttp(const std::string& target) {
  HttpRequest request;
  request.target = target;
  (void)Site::routeOf(request);
  (void)request.credentials();
  (void)queryValue(request.query(), "token");
  const auto path = decodedPath(request.path());
  if (!path) return "";
  if (path->find("/../") != std::string::npos || path->ends_with("/..")) return "leaves the folder";
  if (path->find('\0') != std::string::npos) return "a path with a zero byte";
  if (path->find('\\') != std::string::npos) return "a path with a backslash";
  return "";
}

std::string enterMeshHandOver(const std::string& bytes) {
  const Expected<MeshFile> file = decodeMesh(bytes);
  if (!file) return "";
  const MeshSurface* mesh = &file->surface;
  for (const Eigen::Vector3i& t : mesh->triangles) {
    if (t.minCoeff() < 0 || t.maxCoeff() >= static_cast<int>(mesh->points.size())) {
      return "a corner that is no point";
    }
  }
  return "";
}

std::vector<std::string> goodMeshes() {
  MeshFile mesh;
  mesh.surface.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.part = {0, 0, 0, 1};
  mesh.notices = {"has a skin"};
  mesh.surface.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  return {encodeMesh(mesh), encodeMesh(fileFault("", "is broken", "repair it"))};
}

}  // namespace

std::vector<FuzzTarget> messageTargets() {
  std::vector<std::string> messages;
  for (const wire::Bytes& message : words::oneOfEach()) messages.push_back(text(message));
  constexpr int kFull = 10'000'000, kSampled = 20'000;
  return {{"websocket", messages, enterWebSocket, kFull, 5 * kSampled},
          {"udp", goodDatagrams(), enterUdp, kFull, kSampled},
          {"http-target",
           {"/recordings/night%20shift.h5?token=a-long-secret&x=1", "/assets/../%2e%2e/etc/passwd",
            "/report/a/%c3%bc.html", "/..%2f..%2f%5c%00?token"},
           enterHttp,
           kFull,
           kSampled},
          {"mesh-hand-over", goodMeshes(), enterMeshHandOver, kFull, kSampled}};
}

}  // namespace wholehand::test
