#include "telemetry/recording_parts.hpp"

#include "telemetry/disk_reserve.hpp"
#include "telemetry/hdf5_handle.hpp"
#include "telemetry/recording.hpp"

#include <array>
#include <filesystem>
#include <fstream>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>

namespace wholehand {
namespace recording {

std::string partPath(const std::string& path, int part) {
  const std::filesystem::path first = path;
  const std::string name = first.stem().string() + ".part" + std::to_string(part);
  return (first.parent_path() / (name + first.extension().string())).string();
}

std::string reasonNotToReplace(const std::string& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) return {};
  if (!S_ISREG(status.st_mode)) return "is no regular file";
  std::ifstream in(path, std::ios::binary);
  std::array<char, hdf5::kSignature.size()> head{};
  in.read(head.data(), head.size());
  if (status.st_size > 0 && head != hdf5::kSignature)
    return "holds something else than a recording";
  if (DiskReserve::isOpenElsewhere(path)) return "is open in another program";
  return {};
}

void removeParts(const std::string& path) {
  for (const std::string& part : recordingParts(path)) {
    if (reasonNotToReplace(part).empty()) ::unlink(part.c_str());
  }
}

}  // namespace recording

std::vector<std::string> recordingParts(const std::string& path) {
  std::vector<std::string> parts;
  std::error_code error;
  for (int part = 2; part <= recording::kMostParts; ++part) {
    std::string name = recording::partPath(path, part);
    if (!std::filesystem::is_regular_file(name, error)) break;
    parts.push_back(std::move(name));
  }
  return parts;
}

}  // namespace wholehand
