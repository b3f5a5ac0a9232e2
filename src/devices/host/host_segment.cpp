#include "devices/host/host_segment.hpp"

#include "loop/realtime/monotonic_clock.hpp"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <new>
#include <sys/mman.h>
#include <sys/stat.h>
#include <thread>
#include <unistd.h>
#include <utility>

namespace wholehand {
namespace {

constexpr std::chrono::milliseconds kPulseEvery{1};
constexpr std::chrono::milliseconds kPulseWithin{1000};
constexpr double kStandsStill_s = 1.0;  // a host gives no sample while it carries out a verb
constexpr const char* kStartHost = "start it with wholehand device-host";

Diagnostic no(const std::string& name, const std::string& problem, const std::string& remedy) {
  return {"", 0, "host", name, problem, remedy};
}

std::string withErrno(const std::string& what) {
  return what + ": " + std::strerror(errno);
}

bool isName(const std::string& name) {
  return !name.empty() && name.size() <= 32 &&
         name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789-") == std::string::npos;
}

Diagnostic badName(const std::string& name) {
  return no(name, "is no name of a host", "1 to 32 of a-z, 0-9 and -");
}

std::string pathOf(const std::string& name) {
  return "/wholehand-" + name;
}

struct flock wholeFile() {
  struct flock lock {};
  lock.l_type = F_WRLCK;
  lock.l_whence = SEEK_SET;
  return lock;
}

// File descriptor, closed unless released.
class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {}
  ~Descriptor() {
    if (fd_ >= 0) ::close(fd_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  [[nodiscard]] int get() const { return fd_; }
  [[nodiscard]] int take() { return std::exchange(fd_, -1); }

 private:
  int fd_;
};

SharedFrame* mapped(int fd) {
  void* const at = ::mmap(nullptr, sizeof(SharedFrame), PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
  return at == MAP_FAILED ? nullptr : static_cast<SharedFrame*>(at);
}

namespace fs = std::filesystem;

constexpr const char* kPrefix = "wholehand-";
constexpr const char* kLock = ".lock";

// An open file, mapped for reading if it has the size of this version.
class FileMapping {
 public:
  explicit FileMapping(const std::string& path) : fd_(::open(path.c_str(), O_RDONLY | O_CLOEXEC)) {
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
  ~FileMapping() {
    if (problem_.empty()) ::munmap(at_, sizeof(SharedFrame));
    if (fd_ >= 0) ::close(fd_);
  }
  FileMapping(const FileMapping&) = delete;
  FileMapping& operator=(const FileMapping&) = delete;

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
  const FileMapping mapped(path);
  out.problem = mapped.problem();
  if (!out.problem.empty()) return out;
  const SharedFrame& frame = mapped.frame();
  out.problem = incompatibility(frame);
  if (!out.problem.empty()) return out;
  out = factsOf(frame, name);
  out.lives = processLives(frame.host_pid);
  out.in_use = mapped.isLocked();
  return out;
}

}  // namespace

HostFacts factsOf(const SharedFrame& frame, const std::string& name) {
  HostFacts out;
  out.name = name;
  out.driver.assign(frame.driver, ::strnlen(frame.driver, sizeof(frame.driver)));
  out.pid = frame.host_pid;
  out.axes.assign(frame.axes, frame.axes + frame.axis_count);
  HostSample sample{};
  out.sample_age_s = -1.0;
  if (!frame.sample.take(sample)) return out;
  const std::int64_t now_ns = monotonicNow_ns();
  const auto since_s = [now_ns](std::int64_t at_ns) {
    return static_cast<double>(now_ns - at_ns) * 1e-9;
  };
  out.sample_age_s = since_s(sample.monotonic_ns);
  out.phase = sample.phase;
  out.reason = sample.reason;
  out.drive = sample.drive;
  out.status = sample.sample.status;
  out.held = sample.held != 0;
  out.drive_heard_s = sample.drive_heard_ns != 0 ? since_s(sample.drive_heard_ns) : -1.0;
  out.drive_since_s = since_s(sample.drive_since_ns);
  return out;
}

std::string incompatibility(const SharedFrame& frame) {
  if (frame.magic.load(std::memory_order_acquire) != kFrameMagic) return "is not set up by a host";
  if (frame.layout != kFrameLayout) {
    return "shares memory of version " + std::to_string(frame.layout) + ", this is " +
           std::to_string(kFrameLayout);
  }
  if (frame.size != sizeof(SharedFrame)) return "shares memory of another size";
  if (frame.axis_count < 1 || frame.axis_count > WH_MAX_AXES) {
    return "says that it has " + std::to_string(frame.axis_count) + " axes";
  }
  for (std::uint32_t i = 0; i < frame.axis_count; ++i) {
    if (::strnlen(frame.axes[i].name, sizeof(frame.axes[i].name)) == sizeof(frame.axes[i].name)) {
      return "gives an axis a name without end";
    }
  }
  return {};
}

bool processLives(std::int64_t pid) {
  std::ifstream file("/proc/" + std::to_string(pid) + "/stat");
  std::string text;
  if (!std::getline(file, text)) return false;
  const std::size_t name_end = text.rfind(')');  // the process name may contain any character
  const char state = name_end + 2 < text.size() ? text[name_end + 2] : 'X';
  return state != 'Z' && state != 'X';
}

Expected<std::unique_ptr<HostLock>> HostLock::take(const std::string& name) {
  if (!isName(name)) return badName(name);
  const std::string path = pathOf(name) + ".lock";
  Descriptor fd(::shm_open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600));
  if (fd.get() < 0) {
    return no(name, withErrno("cannot be locked"), "does it belong to another user? See /dev/shm");
  }
  // A lock of the process; its children do not inherit it.
  struct flock lock = wholeFile();
  if (::fcntl(fd.get(), F_SETLK, &lock) == 0) {
    return std::unique_ptr<HostLock>(new HostLock(name, fd.take()));
  }
  lock = wholeFile();
  (void)::fcntl(fd.get(), F_GETLK, &lock);
  return no(name, "runs already, as process " + std::to_string(lock.l_pid),
            "one host holds one device: end that one, or take another name");
}

HostLock::~HostLock() {
  ::close(fd_);
}

Expected<std::unique_ptr<HostSegment>> HostSegment::create(const HostLock& lock) {
  const std::string path = pathOf(lock.name());
  (void)::shm_unlink(path.c_str());
  Descriptor fd(::shm_open(path.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0600));
  SharedFrame* frame = nullptr;
  if (fd.get() >= 0 && ::ftruncate(fd.get(), sizeof(SharedFrame)) == 0) frame = mapped(fd.get());
  if (frame == nullptr) {
    return no(lock.name(), withErrno("gets no shared memory"), "look at /dev/shm");
  }
  (void)::madvise(frame, sizeof(SharedFrame), MADV_DONTFORK);
  new (frame) SharedFrame{};
  return std::unique_ptr<HostSegment>(new HostSegment(path, fd.take(), frame, true));
}

Expected<std::unique_ptr<HostSegment>> HostSegment::attach(const std::string& name) {
  if (!isName(name)) return badName(name);
  const std::string path = pathOf(name);
  Descriptor fd(::shm_open(path.c_str(), O_RDWR | O_CLOEXEC, 0));
  if (fd.get() < 0) {
    return errno == ENOENT
               ? no(name, "does not run", kStartHost)
               : no(name, withErrno("cannot be reached"), "run as the user of the host");
  }
  struct stat file {};
  if (::fstat(fd.get(), &file) != 0 || file.st_uid != ::geteuid()) {
    return no(name, "belongs to another user", "run as the user of the host");
  }
  if (file.st_size != static_cast<off_t>(sizeof(SharedFrame))) {
    return no(name, "shares memory of another size", "run the same version as the host");
  }
  SharedFrame* const frame = mapped(fd.get());
  if (frame == nullptr) return no(name, withErrno("cannot be mapped"), "is there memory left?");
  std::unique_ptr<HostSegment> segment(new HostSegment(path, fd.take(), frame, false));
  if (const std::string why = incompatibility(*frame); !why.empty()) {
    return no(name, why, "run the same version as the host");
  }
  if (!segment->hostLives()) return no(name, "is gone", kStartHost);
  // A lock of the open file description, because it also refuses a second loop in this process.
  struct flock lock = wholeFile();
  if (::fcntl(segment->fd_, F_OFD_SETLK, &lock) != 0) {
    HostRequest last{};
    const bool known = frame->request.take(last);
    return no(name,
              "is in use by another loop" +
                  (known ? ", process " + std::to_string(last.pid) : std::string()),
              "end that one first");
  }
  if (!segment->publishesSamples()) return no(name, "stands still", "end it and start it again");
  return segment;
}

HostSegment::~HostSegment() {
  if (owned_) (void)::shm_unlink(path_.c_str());
  ::munmap(frame_, sizeof(SharedFrame));
  ::close(fd_);
}

bool HostSegment::hostLives() const {
  return processLives(frame_->host_pid);
}

bool HostSegment::replaced() const {
  struct stat now {};
  return ::fstat(fd_, &now) != 0 || now.st_nlink == 0;
}

bool HostSegment::publishesSamples() const {
  HostSample first{}, later{};
  const bool had = frame_->sample.take(first);
  for (auto waited = kPulseEvery; waited < kPulseWithin; waited += kPulseEvery) {
    std::this_thread::sleep_for(kPulseEvery);
    if (frame_->sample.take(later) && (!had || later.cycle != first.cycle)) return true;
  }
  return false;
}

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

const char* describe(DriveState drive) noexcept {
  switch (drive) {
    case DriveState::kUnheard:
      return "has said nothing yet";
    case DriveState::kOn:
      return "is on";
    case DriveState::kOff:
      return "is off: no effort reaches its motors";
    case DriveState::kSilenced:
      return "is off: its watchdog let go";
    case DriveState::kFault:
      return "is off: it is in fault";
    case DriveState::kUnreadable:
      return "gives no sample";
    case DriveState::kStill:
      return "says nothing new";
    case DriveState::kRefuses:
      return "refuses commands";
  }
  return "is in an unknown state";
}

std::string stateOf(const HostFacts& host) {
  if (!host.lives) return "gone";
  if (host.sample_age_s < 0.0) return "starts";
  if (host.sample_age_s > kStandsStill_s) return "stands still";
  if (shouldBeOn(host.phase, host.held) && host.drive != DriveState::kOn) {
    return std::string("its drive ") + describe(host.drive);
  }
  return host.held ? "enabled, at neutral, between two sessions" : describe(host.phase);
}

}  // namespace wholehand
