#include "record/disk_reserve.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdint>
#include <fcntl.h>
#include <filesystem>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <system_error>
#include <unistd.h>

namespace wholehand {
namespace {

namespace fs = std::filesystem;

/// Assumed bytes per tick in the file. Measured: 190 in the cocktail bar; more when a hand holds
/// many bodies.
constexpr double kBytesPerTick = 300.0;
/// Bytes for the description, the tables and the reservation of DiskReserve.
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
  if (room_s >= (length_s > 0.0 ? length_s : kRoomWorthReporting_s)) return {};
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
  if (error || space.capacity == 0) return {};  // this file system reports no capacity
  return roomSentence(recording, space.available, period_s, length_s);
}

namespace {
/// Step of allocation, chosen so that system calls are rare.
constexpr std::uint64_t kStep = std::uint64_t{2} << 20U;
}  // namespace

DiskReserve::~DiskReserve() {
  if (fd_ >= 0) ::close(fd_);
}

int DiskReserve::create(const std::string& path) {
  fd_ = ::open(path.c_str(), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  return fd_ >= 0 ? 0 : errno;
}

bool DiskReserve::claim(std::uint64_t end) {
  rlimit limit{};
  if (::getrlimit(RLIMIT_FSIZE, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY &&
      end > limit.rlim_cur) {
    return false;
  }
  return end <= claimed_ || allocate(end + kStep) || allocate(end);
}

bool DiskReserve::allocate(std::uint64_t end) {
  const auto from = static_cast<off_t>(claimed_);
  const auto length = static_cast<off_t>(end - claimed_);
  int result = 0;
  do {
    result = ::fallocate(fd_, FALLOC_FL_KEEP_SIZE, from, length);
  } while (result != 0 && errno == EINTR);
  if (result != 0 && (errno == EOPNOTSUPP || errno == ENOSYS)) {
    // This file system cannot reserve space, so the function checks that plenty is free now.
    struct statvfs room {};
    if (::fstatvfs(fd_, &room) != 0) return false;
    const auto free_bytes = static_cast<std::uint64_t>(room.f_bavail) * room.f_frsize;
    result = free_bytes > static_cast<std::uint64_t>(length) + kStep ? 0 : -1;
  }
  if (result == 0) claimed_ = end;
  return result == 0;
}

bool DiskReserve::hasName() const {
  struct stat status {};
  return fd_ >= 0 && ::fstat(fd_, &status) == 0 && status.st_nlink > 0;
}

void DiskReserve::mark() const {
  (void)::flock(fd_, LOCK_SH | LOCK_NB);  // not supported by every file system
}

bool DiskReserve::isOpenElsewhere(const std::string& path) {
  const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd < 0) return false;
  const bool held = ::flock(fd, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  ::close(fd);
  return held;
}

void DiskReserve::release() {
  struct stat status {};
  if (fd_ >= 0) (void)::flock(fd_, LOCK_UN);
  if (fd_ < 0 || ::fstat(fd_, &status) != 0) return;
  claimed_ = static_cast<std::uint64_t>(status.st_size);
  // Truncation to the current size frees the blocks behind it.
  if (::ftruncate(fd_, status.st_size) != 0) return;
}

}  // namespace wholehand
