#include "device/host/host_list.hpp"

#include "device/host/host_segment.hpp"
#include "realtime/monotonic_clock.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

namespace wholehand {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPrefix = "wholehand-";
constexpr const char* kLock = ".lock";

// An open file, mapped for reading if it has this version's size.
class Mapped {
 public:
  explicit Mapped(const std::string& path) : fd_(::open(path.c_str(), O_RDONLY | O_CLOEXEC)) {
    struct stat file {};
    if (fd_ < 0 || ::fstat(fd_, &file) != 0) {
      problem_ = std::string("cannot be read: ") + std::strerror(errno);
    } else if (file.st_size != static_cast<off_t>(sizeof(SharedFrame))) {
      problem_ = "shares memory of another size: it is of another version";
    } else {
      at_ = ::mmap(nullptr, sizeof(SharedFrame), PROT_READ, MAP_SHARED, fd_, 0);
      if (at_ == MAP_FAILED) problem_ = std::string("cannot be mapped: ") + std::strerror(errno);
    }
  }
  ~Mapped() {
    if (problem_.empty()) ::munmap(at_, sizeof(SharedFrame));
    if (fd_ >= 0) ::close(fd_);
  }
  Mapped(const Mapped&) = delete;
  Mapped& operator=(const Mapped&) = delete;

  [[nodiscard]] const std::string& problem() const { return problem_; }
  [[nodiscard]] const SharedFrame& frame() const { return *static_cast<const SharedFrame*>(at_); }
  // A connected loop holds a lock on the whole file (HostSegment::attach).
  [[nodiscard]] bool isLocked() const {
    struct flock lock {};
    lock.l_type = F_WRLCK;
    lock.l_whence = SEEK_SET;
    return ::fcntl(fd_, F_OFD_GETLK, &lock) == 0 && lock.l_type != F_UNLCK;
  }

 private:
  int fd_;
  void* at_ = MAP_FAILED;
  std::string problem_;
};

HostFacts look(const std::string& path, const std::string& name) {
  HostFacts out;
  out.name = name;
  const Mapped mapped(path);
  out.problem = mapped.problem();
  if (!out.problem.empty()) return out;
  const SharedFrame& frame = mapped.frame();
  out.problem = whyForeign(frame);
  if (!out.problem.empty()) return out;
  out.driver.assign(frame.driver, ::strnlen(frame.driver, sizeof(frame.driver)));
  out.pid = frame.host_pid;
  out.lives = processLives(frame.host_pid);
  out.in_use = mapped.isLocked();
  out.axes.assign(frame.axes, frame.axes + frame.axis_count);
  HostSample sample{};
  out.sample_age_s = -1.0;
  if (!frame.sample.take(sample)) return out;
  out.sample_age_s = static_cast<double>(monotonicNow_ns() - sample.monotonic_ns) * 1e-9;
  out.phase = sample.phase;
  out.reason = sample.reason;
  return out;
}

}  // namespace

std::vector<HostFacts> listHosts(const std::string& folder) {
  std::vector<HostFacts> out;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    const std::string file = entry.path().filename().string();
    if (!file.starts_with(kPrefix) || file.ends_with(kLock)) continue;
    out.push_back(look(entry.path().string(), file.substr(std::strlen(kPrefix))));
  }
  std::sort(out.begin(), out.end(),
            [](const HostFacts& a, const HostFacts& b) { return a.name < b.name; });
  return out;
}

const char* describe(HostPhase phase) noexcept {
  switch (phase) {
    case HostPhase::kIdle:
      return "idle";
    case HostPhase::kWaiting:
      return "enabled, at neutral";
    case HostPhase::kRendering:
      return "rendering";
    case HostPhase::kRamping:
      return "lets go";
    case HostPhase::kLatched:
      return "let go, at neutral";
  }
  return "unknown";
}

}  // namespace wholehand
