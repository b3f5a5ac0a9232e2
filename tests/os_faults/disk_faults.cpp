// Loaded into the program by LD_PRELOAD: calls that touch files below given folders fail, or hang
// as on a share whose server is gone. The thread of a call that hangs sleeps uninterruptibly (it
// waits for a child that vfork made), so that no signal reaches it either.
//
//   DISK_FOLDERS   folders, separated by ':'
//   DISK_CONTROL   a file of five 32-bit numbers that is shared with the test:
//                  [0] which calls are affected, a bit each, in the order of `Call`
//                  [1] how many hang at present   [2] how many were ever affected
//                  [3] how many processes have loaded this library
//                  [4] the errno with which they fail; 0: they hang
//   DISK_MS        for how long each hangs
#include <climits>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <dlfcn.h>
#include <fcntl.h>
#include <string_view>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <type_traits>
#include <unistd.h>

namespace {

enum class Call { kOpen, kRead, kPwrite, kStat, kFsync, kFallocate };

std::atomic<unsigned>* g_control = nullptr;
char g_folders[4096];  // an array: no constructor may run before begin()
long g_ms = 5000;

__attribute__((constructor)) void begin() {
  const char* folders = std::getenv("DISK_FOLDERS");
  const char* control = std::getenv("DISK_CONTROL");
  const char* ms = std::getenv("DISK_MS");
  if (folders == nullptr || control == nullptr) return;
  std::snprintf(g_folders, sizeof g_folders, "%s", folders);
  if (ms != nullptr) g_ms = std::atol(ms);
  const auto fd = static_cast<int>(::syscall(SYS_openat, AT_FDCWD, control, O_RDWR | O_CLOEXEC));
  if (fd < 0) return;
  void* at = ::mmap(nullptr, 4096, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
  ::close(fd);
  if (at == MAP_FAILED) return;
  g_control = static_cast<std::atomic<unsigned>*>(at);
  ++g_control[3];
}

bool isOn(Call call) {
  return g_control != nullptr && (g_control[0].load() >> static_cast<unsigned>(call) & 1U) != 0;
}

bool isBelow(std::string_view path) {
  std::string_view folders = g_folders;
  while (!folders.empty()) {
    const std::string_view folder = folders.substr(0, folders.find(':'));
    folders.remove_prefix(std::min(folders.size(), folder.size() + 1));
    if (folder.empty() || path.substr(0, folder.size()) != folder) continue;
    if (path.size() == folder.size() || path[folder.size()] == '/') return true;
  }
  return false;
}

void hang() {
  const int saved = errno;
  ++g_control[1];
  const pid_t child = ::vfork();  // NOLINT: vfork makes the sleep uninterruptible
  if (child == 0) {
    timespec left{g_ms / 1000, g_ms % 1000 * 1'000'000};
    ::syscall(SYS_nanosleep, &left, nullptr);
    ::_exit(0);
  }
  while (child > 0 && ::waitpid(child, nullptr, 0) < 0 && errno == EINTR) {
  }
  --g_control[1];
  errno = saved;
}

/// Hangs, or returns the errno with which the call fails.
int hit() {
  ++g_control[2];
  const auto error = static_cast<int>(g_control[4].load());
  if (error == 0) hang();
  return error;
}

// Length of the target of /proc/self/<link>; 0 if there is none.
std::size_t follow(const char* link, char* whole, std::size_t size) {
  const long n = ::syscall(SYS_readlinkat, AT_FDCWD, link, whole, size - 1);
  if (n <= 0) return 0;
  whole[n] = '\0';
  return static_cast<std::size_t>(n);
}

/// The errno with which a call that touches this path fails; 0 if it does not.
int touchPath(Call call, int folder, const char* name) {
  if (!isOn(call) || name == nullptr) return 0;
  char link[64] = "/proc/self/cwd";
  char whole[2 * PATH_MAX] = "";
  if (name[0] != '/') {
    if (folder != AT_FDCWD) std::snprintf(link, sizeof link, "/proc/self/fd/%d", folder);
    const std::size_t n = follow(link, whole, sizeof whole);
    if (n == 0) return 0;
    std::snprintf(whole + n, sizeof whole - n, "/%s", name);
  }
  return isBelow(name[0] == '/' ? name : whole) ? hit() : 0;
}

int touchFile(Call call, int fd) {
  if (!isOn(call)) return 0;
  char link[64], whole[PATH_MAX];
  std::snprintf(link, sizeof link, "/proc/self/fd/%d", fd);
  return follow(link, whole, sizeof whole) > 0 && isBelow(whole) ? hit() : 0;
}

/// Return value of a failing call.
template <class Result>
Result failWith(int error) {
  errno = error;
  if constexpr (std::is_pointer_v<Result>) {
    return nullptr;
  } else {
    return -1;
  }
}

/// The original function that this library replaces.
template <class Function>
Function* behind(const char* name) {
  return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}

int reallyOpen(int folder, const char* path, int flags, va_list more) {
  const bool makes = (flags & (O_CREAT | O_TMPFILE)) != 0;
  const unsigned mode = makes ? va_arg(more, unsigned) : 0U;
  return static_cast<int>(::syscall(SYS_openat, folder, path, flags, mode));
}

}  // namespace

extern "C" {

#define OPENS(name, folder, ...)                                              \
  int name(__VA_ARGS__, ...) {                                                \
    va_list more;                                                             \
    va_start(more, flags);                                                    \
    if (const int error = touchPath(Call::kOpen, folder, path); error != 0) { \
      return failWith<int>(error);                                            \
    }                                                                         \
    const int result = reallyOpen(folder, path, flags, more);                 \
    va_end(more);                                                             \
    return result;                                                            \
  }
OPENS(open, AT_FDCWD, const char* path, int flags)
OPENS(open64, AT_FDCWD, const char* path, int flags)
OPENS(openat, folder, int folder, const char* path, int flags)
OPENS(openat64, folder, int folder, const char* path, int flags)

#define ON_PATH(call, result, name, folder, declared, ...)             \
  result name declared {                                               \
    static auto* const real = behind<result declared>(#name);          \
    if (const int error = touchPath(call, folder, path); error != 0) { \
      return failWith<result>(error);                                  \
    }                                                                  \
    return real(__VA_ARGS__);                                          \
  }
#define ON_FILE(call, result, name, declared, ...)                                         \
  result name declared {                                                                   \
    static auto* const real = behind<result declared>(#name);                              \
    if (const int error = touchFile(call, fd); error != 0) return failWith<result>(error); \
    return real(__VA_ARGS__);                                                              \
  }
ON_PATH(Call::kOpen, FILE*, fopen, AT_FDCWD, (const char* path, const char* how), path, how)
ON_PATH(Call::kOpen, FILE*, fopen64, AT_FDCWD, (const char* path, const char* how), path, how)
ON_FILE(Call::kRead, ssize_t, read, (int fd, void* to, size_t n), fd, to, n)
ON_FILE(Call::kRead, ssize_t, pread, (int fd, void* to, size_t n, off_t at), fd, to, n, at)
ON_FILE(Call::kRead, ssize_t, pread64, (int fd, void* to, size_t n, off64_t at), fd, to, n, at)
ON_FILE(Call::kPwrite, ssize_t, write, (int fd, const void* from, size_t n), fd, from, n)
ON_FILE(Call::kPwrite, ssize_t, pwrite, (int fd, const void* from, size_t n, off_t at), fd, from, n,
        at)
ON_FILE(Call::kPwrite, ssize_t, pwrite64, (int fd, const void* from, size_t n, off64_t at), fd,
        from, n, at)
ON_FILE(Call::kFsync, int, fsync, (int fd), fd)
ON_FILE(Call::kFsync, int, fdatasync, (int fd), fd)
ON_FILE(Call::kFallocate, int, fallocate, (int fd, int how, off_t at, off_t n), fd, how, at, n)
ON_FILE(Call::kFallocate, int, fallocate64, (int fd, int how, off64_t at, off64_t n), fd, how, at,
        n)
ON_FILE(Call::kFallocate, int, ftruncate, (int fd, off_t n) noexcept, fd, n)
ON_FILE(Call::kFallocate, int, ftruncate64, (int fd, off64_t n) noexcept, fd, n)
ON_FILE(Call::kStat, int, fstat, (int fd, struct stat* to) noexcept, fd, to)
ON_FILE(Call::kStat, int, fstat64, (int fd, struct stat64* to) noexcept, fd, to)
ON_PATH(Call::kStat, int, stat, AT_FDCWD, (const char* path, struct stat* to) noexcept, path, to)
ON_PATH(Call::kStat, int, stat64, AT_FDCWD, (const char* path, struct stat64* to) noexcept, path,
        to)
ON_PATH(Call::kStat, int, lstat, AT_FDCWD, (const char* path, struct stat* to) noexcept, path, to)
ON_PATH(Call::kStat, int, lstat64, AT_FDCWD, (const char* path, struct stat64* to) noexcept, path,
        to)
ON_PATH(Call::kStat, int, fstatat, folder,
        (int folder, const char* path, struct stat* to, int flags) noexcept, folder, path, to,
        flags)
ON_PATH(Call::kStat, int, fstatat64, folder,
        (int folder, const char* path, struct stat64* to, int flags) noexcept, folder, path, to,
        flags)
ON_PATH(Call::kStat, int, statx, folder,
        (int folder, const char* path, int flags, unsigned mask, struct statx* to) noexcept, folder,
        path, flags, mask, to)

}  // extern "C"
