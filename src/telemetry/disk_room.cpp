#include "telemetry/disk_room.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <system_error>

namespace wholehand {
namespace {

namespace fs = std::filesystem;

/// Bytes per tick in the file. Measured: 190 in the cocktail bar; more when a hand holds many
/// bodies.
constexpr double kBytesPerTick = 300.0;
/// Description, tables and DiskReserve's reservation.
constexpr double kBesideTicks_bytes = 4e6;

std::string about(double length_s) {
  if (length_s < 120.0) return std::to_string(std::lround(length_s)) + " s";
  return std::to_string(std::lround(length_s / 60.0)) + " min";
}

}  // namespace

std::string roomSentence(const std::string& recording, std::uint64_t free_bytes, double period_s,
                         double length_s) {
  const double ticks_bytes = std::max(0.0, static_cast<double>(free_bytes) - kBesideTicks_bytes);
  const double room_s = ticks_bytes / kBytesPerTick * period_s;
  if (room_s >= (length_s > 0.0 ? length_s : kRoomWorthTelling_s)) return {};
  return "the disk has room for about " + about(room_s) + " of recording (" +
         std::to_string(free_bytes / 1'000'000) + " MB free): " + recording;
}

std::string roomNotice(const std::string& recording, double period_s, double length_s) {
  std::error_code error;
  fs::path folder = fs::absolute(recording, error).parent_path();
  while (!error && !fs::exists(folder, error) && folder.has_relative_path()) {
    folder = folder.parent_path();
  }
  const fs::space_info space = fs::space(folder, error);
  if (error || space.capacity == 0) return {};  // a file system that reports no capacity
  return roomSentence(recording, space.available, period_s, length_s);
}

}  // namespace wholehand
