// Checks of the shared object, and of writes beyond the ends of structures.
#include "devices/conformance/conformance.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>

namespace wholehand {
namespace {

constexpr unsigned char kMark = 0xA5;
constexpr std::uint32_t kFlags = WH_NEVER_WAITS;
constexpr std::size_t kLongestName = 63;  // longest name that a host passes on

CheckFinding loads(DriverBench& bench) {
  return unless(bench.reach(DriverStage::kLoaded));
}

CheckFinding symbol(DriverBench& bench) {
  return bench.symbol() != nullptr ? passed() : failed("has no wh_plugin_v1()");
}

CheckFinding same(DriverBench& bench) {
  if (bench.symbol() == nullptr) return skipped("has no wh_plugin_v1()");
  const wh_plugin* const first = bench.symbol()();
  if (first == nullptr) return failed("gives no driver");
  return first == bench.symbol()() ? passed() : failed("gives another structure at every call");
}

// The driver's wh_plugin; null where there is none.
const wh_plugin* given(DriverBench& bench) {
  return bench.symbol() != nullptr ? bench.symbol()() : nullptr;
}

CheckFinding size(DriverBench& bench) {
  const wh_plugin* const plugin = given(bench);
  if (plugin == nullptr) return skipped("gives no driver");
  if (plugin->size >= sizeof(wh_plugin)) return passed();
  return failed("size is " + std::to_string(plugin->size) + ", the six functions need " +
                std::to_string(sizeof(wh_plugin)));
}

CheckFinding major(DriverBench& bench) {
  const wh_plugin* const plugin = given(bench);
  if (plugin == nullptr) return skipped("gives no driver");
  if (plugin->major == WH_MAJOR) return passed();
  return failed("is built for version " + std::to_string(plugin->major) + ", this is " +
                std::to_string(WH_MAJOR));
}

CheckFinding minor(DriverBench& bench) {
  const wh_plugin* const plugin = given(bench);
  if (plugin == nullptr) return skipped("gives no driver");
  const bool newer = plugin->size > sizeof(wh_plugin);
  if (plugin->minor > WH_MINOR || !newer) return passed();
  return failed("says version " + std::to_string(plugin->major) + "." +
                std::to_string(plugin->minor) + " and is longer than that is");
}

CheckFinding functions(DriverBench& bench) {
  const wh_plugin* const plugin = given(bench);
  if (plugin == nullptr || plugin->size < sizeof(wh_plugin))
    return skipped("its size is too small");
  std::string missing;
  const auto miss = [&](bool there, const char* name) {
    if (!there) missing += std::string(missing.empty() ? "" : ", ") + name;
  };
  miss(plugin->open != nullptr, "open");
  miss(plugin->describe != nullptr, "describe");
  miss(plugin->control != nullptr, "control");
  miss(plugin->read != nullptr, "read");
  miss(plugin->write != nullptr, "write");
  miss(plugin->close != nullptr, "close");
  return missing.empty() ? passed() : failed("leaves out " + missing);
}

CheckFinding flags(DriverBench& bench) {
  const std::uint32_t unknown = bench.plugin().flags & ~kFlags;
  return unknown == 0 ? passed() : failed("has unknown flags " + std::to_string(unknown));
}

CheckFinding name(DriverBench& bench) {
  const char* const name = bench.plugin().name;
  if (name == nullptr || *name == 0) return failed("has no name");
  const std::size_t length = ::strnlen(name, kLongestName + 1);
  if (length > kLongestName) return failed("is longer than 63 bytes");
  const bool plain = std::none_of(name, name + length,
                                  [](char c) { return static_cast<unsigned char>(c) < 0x20; });
  return plain ? passed(name) : failed("has control characters");
}

// Index of the first byte from `from` on that was overwritten; -1: none.
long firstWritten(const unsigned char* bytes, std::size_t from, std::size_t size) {
  for (std::size_t i = from; i < size; ++i) {
    if (bytes[i] != kMark) return static_cast<long>(i);
  }
  return -1;
}

// Reads into a sample whose size field is `says`, with marked bytes behind it.
CheckFinding readInto(DriverBench& bench, std::size_t stated_size) {
  alignas(wh_sample) std::array<unsigned char, sizeof(wh_sample) + 256> bytes{};
  bytes.fill(kMark);
  const auto size = static_cast<std::uint32_t>(stated_size);
  std::memcpy(bytes.data(), &size, sizeof(size));
  const int result =
      bench.plugin().read(bench.device(), reinterpret_cast<wh_sample*>(bytes.data()));
  const std::size_t end = std::min(stated_size, sizeof(wh_sample));
  const long at = firstWritten(bytes.data(), end, bytes.size());
  if (at >= 0) {
    return failed("read writes byte " + std::to_string(at) + " of a sample of " +
                  std::to_string(stated_size) + " bytes");
  }
  std::uint32_t left = 0;
  std::memcpy(&left, bytes.data(), sizeof(left));
  if (left != size) return failed("read changes the size, which the caller has set");
  return result >= 0 ? passed() : failed("read fails for a sample of another size");
}

CheckFinding olderSample(DriverBench& bench) {
  return readInto(bench, offsetof(wh_sample, temperature_c));
}

CheckFinding newerSample(DriverBench& bench) {
  return readInto(bench, sizeof(wh_sample) + 128);
}

CheckFinding capacity(DriverBench& bench) {
  constexpr std::size_t kBytes = sizeof(wh_axis) * (WH_MAX_AXES + 1);
  alignas(wh_axis) std::array<unsigned char, kBytes> bytes{};
  bytes.fill(kMark);
  const std::uint32_t size = sizeof(wh_axis);
  std::memcpy(bytes.data(), &size, sizeof(size));
  std::uint32_t count = 0;
  const int result =
      bench.plugin().describe(bench.device(), reinterpret_cast<wh_axis*>(bytes.data()), 1, &count);
  const long at = firstWritten(bytes.data(), sizeof(wh_axis), bytes.size());
  if (at >= 0) return failed("describe writes a second axis where there is room for one");
  if (result < 0) return passed("refuses a capacity of one");
  return count == bench.axes().size()
             ? passed()
             : failed("says " + std::to_string(count) + " axes where there is room for one, " +
                      std::to_string(bench.axes().size()) + " where there is more");
}

CheckFinding axisSize(DriverBench& bench) {
  for (const wh_axis& axis : bench.axes()) {
    if (axis.size == 0 || axis.size > sizeof(wh_axis)) {
      return failed(std::string(axis.name) + ": size is " + std::to_string(axis.size));
    }
  }
  return passed();
}

constexpr const char* kBuild = "build it with this version's wholehand/device.h";
constexpr const char* kBeyond = "touch no field that lies beyond the size that the caller has set";
using enum DriverStage;

}  // namespace

std::span<const Check> boundaryChecks() {
  static constexpr Check kChecks[] = {
      {"boundary.loads", "the shared object loads, and all its symbols are found",
       "link it with every library it needs", loads, kFile},
      {"boundary.symbol", "exports wh_plugin_v1", kBuild, symbol, kLoaded},
      {"boundary.same", "wh_plugin_v1 gives one structure, the same at every call",
       "return the address of a static structure", same, kLoaded},
      {"boundary.size", "wh_plugin holds the six functions", "set size to sizeof(wh_plugin)", size,
       kLoaded},
      {"boundary.major", "is built for this major version", kBuild, major, kLoaded},
      {"boundary.minor", "minor version and size belong together",
       "set major, minor and size from the header", minor, kLoaded},
      {"boundary.functions", "none of the six functions is null",
       "write all six; what a device cannot do returns WH_UNSUPPORTED", functions, kLoaded},
      {"boundary.flags", "only known flags are set", "set WH_NEVER_WAITS or 0", flags, kPlugin},
      {"boundary.name", "has a name for a person: one line, at most 63 bytes", "set wh_plugin.name",
       name, kPlugin},
      {"boundary.older_sample", "read touches nothing beyond the size of a shorter sample", kBeyond,
       olderSample},
      {"boundary.newer_sample", "read fills a longer sample as far as it knows it", kBeyond,
       newerSample},
      {"boundary.capacity", "describe fills no more axes than there is room for",
       "stop at capacity; say in *count how many there are", capacity},
      {"boundary.axis_size", "describe leaves the sizes of the axes as they are",
       "leave wh_axis.size to the caller", axisSize},
  };
  return kChecks;
}

}  // namespace wholehand
