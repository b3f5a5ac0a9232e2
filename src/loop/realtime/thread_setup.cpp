#include "loop/realtime/thread_setup.hpp"

#include <malloc.h>
#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/resource.h>
#if defined(__SSE2__)
#include <immintrin.h>
#endif

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <fstream>

namespace wholehand {
namespace {

constexpr std::size_t kPage_bytes = 4096;

/// Touches the stack below the caller to prefault its pages.
[[gnu::noinline]] void touchStack(std::size_t bytes) noexcept {
  auto* stack = static_cast<volatile unsigned char*>(__builtin_alloca(bytes));
  for (std::size_t i = 0; i < bytes; i += kPage_bytes) {
    stack[i] = 0;
  }
}

/// Keeps freed memory in the process and serves large blocks from the heap, so that mapped and
/// locked pages are reused instead of being mapped again.
SetupLine keepHeap() {
  const bool kept = mallopt(M_TRIM_THRESHOLD, -1) == 1 && mallopt(M_MMAP_MAX, 0) == 1;
  return {"heap", kept,
          kept ? "Freed memory is kept for later use."
               : "The allocator may give memory back: expect page faults after large releases."};
}

/// Reads the program and its libraries into memory. False when the kernel cannot (before 5.14).
bool populateProgram() {
#ifdef MADV_POPULATE_READ
  std::ifstream maps("/proc/self/maps");
  bool all = maps.is_open();
  for (std::string line; std::getline(maps, line);) {
    void* begin = nullptr;
    void* end = nullptr;
    char readable = '-';
    int path_at = 0;
    // Format: begin-end perms offset device inode path.
    if (std::sscanf(line.c_str(), "%p-%p %c%*s %*s %*s %*s %n", &begin, &end, &readable, &path_at) <
            3 ||
        readable != 'r' || path_at == 0 || line[static_cast<std::size_t>(path_at)] != '/') {
      continue;
    }
    const auto bytes = static_cast<char*>(end) - static_cast<char*>(begin);
    all &= madvise(begin, static_cast<std::size_t>(bytes), MADV_POPULATE_READ) == 0;
  }
  return all;
#else
  return false;
#endif
}

SetupLine touchedStack(std::size_t bytes) {
  touchStack(bytes);
  return {"stack", true,
          std::to_string(bytes / 1024) + " KiB of stack are in memory before the first tick."};
}

SetupLine denormals() {
  const bool flushed = flushDenormals();
  return {"denormal numbers", flushed,
          flushed ? "Denormal numbers count as zero in the loop."
                  : "Denormal numbers keep their value on this processor: ticks may take longer."};
}

std::string reason(int error) {
  return std::strerror(error);
}

}  // namespace

SetupLine requestFifoPriority(int priority) {
  sched_param parameter{};
  parameter.sched_priority = priority;
  const int error = pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameter);
  const std::string number = std::to_string(priority);
  if (error == 0) {
    return {"real-time priority", true, "SCHED_FIFO, priority " + number + "."};
  }
  return {"real-time priority", false,
          "The loop runs at normal priority (" + reason(error) + "): other programs delay it. " +
              "Remedy: Add '@realtime - rtprio 99' to /etc/security/limits.d/realtime.conf, join "
              "the group realtime and log in again, or run as root."};
}

SetupLine requestLockedMemory() {
  rlimit limit{};
  const bool unlimited = getrlimit(RLIMIT_MEMLOCK, &limit) == 0 && limit.rlim_cur == RLIM_INFINITY;
  const int later = unlimited ? MCL_FUTURE : 0;
  // Locks what is in memory, and every other page when it comes. Stacks of other threads and rings
  // that are not full take no memory. The program itself is read whole: a stop must not wait for
  // the disk. An older kernel knows neither; there all memory is read.
  if ((mlockall(MCL_CURRENT | MCL_ONFAULT | later) == 0 && populateProgram()) ||
      mlockall(MCL_CURRENT | later) == 0) {
    return {"locked memory", true,
            unlimited ? "All memory is locked, and what is allocated later too."
                      : "All memory in use is locked; memory allocated later is not, since memlock "
                        "is limited."};
  }
  return {"locked memory", false,
          "Memory is not locked (" + reason(errno) + "): a page fault may delay a tick. Remedy: " +
              "Add '@realtime - memlock unlimited' to /etc/security/limits.d/realtime.conf, join "
              "the group realtime and log in again, or run as root."};
}

int lastCore(int cores_before_last) {
  cpu_set_t allowed;
  CPU_ZERO(&allowed);
  std::vector<int> cores = isolatedCpus();
  if (cores.empty() && sched_getaffinity(0, sizeof allowed, &allowed) == 0) {
    for (int i = 0; i < CPU_SETSIZE; ++i) {
      if (CPU_ISSET(i, &allowed)) cores.push_back(i);
    }
    if (cores.size() < 2) return -1;
  }
  if (cores.empty()) return -1;
  std::sort(cores.begin(), cores.end());
  const std::size_t before = std::max(cores_before_last, 0);
  return before < cores.size() ? cores[cores.size() - 1 - before] : cores.front();
}

SetupLine requestLastCore(int cores_before_last) {
  const int core = lastCore(cores_before_last);
  if (core < 0) {
    return {"own core", false,
            "The loop shares the only core it may use. Remedy: Allow it a second one."};
  }
  cpu_set_t wanted;
  CPU_ZERO(&wanted);
  CPU_SET(core, &wanted);
  const int error = pthread_setaffinity_np(pthread_self(), sizeof wanted, &wanted);
  if (error != 0) {
    return {"own core", false,
            "The loop may wander between cores (" + reason(error) + "). Remedy: Allow core " +
                std::to_string(core) + " to this program (taskset, cgroup)."};
  }
  return {"own core", true,
          "The loop stays on core " + std::to_string(core) +
              (isolatedCpus().empty() ? "." : ", which the kernel keeps free of other work.")};
}

SetupReport setUpThread(const ThreadSetupConfig& config) {
  SetupReport report;
  report.push_back(touchedStack(config.stack_bytes));
  if (config.lock_memory) {
    report.push_back(keepHeap());
    report.push_back(requestLockedMemory());
  }
  if (config.pin_to_last_core) {
    report.push_back(requestLastCore(config.cores_before_last));
  }
  report.push_back(denormals());
  // The priority is set last: from here on no thread of normal priority preempts this one.
  if (config.fifo_priority > 0) {
    report.push_back(requestFifoPriority(config.fifo_priority));
  }
  return report;
}

bool flushDenormals() noexcept {
#if defined(__SSE2__)
  constexpr unsigned kFlushToZero = 0x8000;
  constexpr unsigned kDenormalsAreZero = 0x0040;
  _mm_setcsr(_mm_getcsr() | kFlushToZero | kDenormalsAreZero);
  return true;
#elif defined(__aarch64__)
  std::uint64_t control = 0;
  asm volatile("mrs %0, fpcr" : "=r"(control));
  control |= std::uint64_t{1} << 24U;
  asm volatile("msr fpcr, %0" : : "r"(control));
  return true;
#else
  return false;
#endif
}

std::vector<int> parseCpuList(std::string_view list) {
  std::vector<int> cpus;
  while (!list.empty()) {
    const std::size_t comma = std::min(list.find(','), list.size());
    const std::string_view part = list.substr(0, comma);
    list.remove_prefix(std::min(comma + 1, list.size()));
    int first = 0;
    const char* end = part.data() + part.size();
    const auto [rest, error] = std::from_chars(part.data(), end, first);
    if (error != std::errc()) {
      continue;
    }
    int last = first;
    if (rest != end && *rest == '-') {
      std::from_chars(rest + 1, end, last);
    }
    for (int cpu = first; cpu <= last && cpu < CPU_SETSIZE; ++cpu) {
      cpus.push_back(cpu);
    }
  }
  return cpus;
}

std::vector<int> isolatedCpus() {
  std::ifstream file("/sys/devices/system/cpu/isolated");
  std::string line;
  std::getline(file, line);
  return parseCpuList(line);
}

}  // namespace wholehand
