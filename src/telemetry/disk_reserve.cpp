#include "telemetry/disk_reserve.hpp"

#include <cerrno>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

namespace wholehand {
namespace {
/// Step of allocation, so that system calls are rare.
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
    // This file system cannot reserve space; checks that plenty is free now.
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
  // Truncating to the present size frees the blocks behind it.
  if (::ftruncate(fd_, status.st_size) != 0) return;
}

}  // namespace wholehand
