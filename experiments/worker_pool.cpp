#include "experiments/worker_pool.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <new>
#include <poll.h>
#include <string_view>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

namespace wholehand {
namespace {

constexpr int kLookForStop_ms = 100;

struct Worker {
  pid_t process = -1;
  int results = -1;  // read end
  std::string text;  // received part of an incomplete line
};

bool writeAll(int file, std::string_view text) {
  while (!text.empty()) {
    const ssize_t n = ::write(file, text.data(), text.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    text.remove_prefix(static_cast<std::size_t>(n));
  }
  return true;
}

/// Data shared by the processes.
struct Shared {
  std::atomic<int> next{0};  ///< next job that no process has taken
  std::atomic<bool> stop{false};
};

/// Allocates memory that forked processes share; null when there is no memory.
Shared* share() {
  void* const memory =
      ::mmap(nullptr, sizeof(Shared), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  return memory == MAP_FAILED ? nullptr : new (memory) Shared();
}

[[noreturn]] void workUntilDone(int results, int jobs, Shared& shared, pid_t parent,
                                const std::function<std::string(int)>& work) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  bool heard = ::getppid() == parent;
  while (heard && !shared.stop) {
    const int job = shared.next++;
    if (job >= jobs) break;
    heard = writeAll(results, std::to_string(job) + " " + work(job) + "\n");
  }
  std::fflush(nullptr);
  ::_exit(0);  // skips destructors and exit handlers, which belong to the parent
}

Worker start(int jobs, Shared& shared, const std::function<std::string(int)>& work) {
  std::array<int, 2> pipe{};
  if (::pipe(pipe.data()) != 0) return {};
  std::fflush(nullptr);  // otherwise the worker would print buffered text again
  const pid_t parent = ::getpid();
  const pid_t process = ::fork();
  if (process == 0) {
    ::close(pipe[0]);
    workUntilDone(pipe[1], jobs, shared, parent, work);
  }
  ::close(pipe[1]);
  if (process < 0) ::close(pipe[0]);
  return {process, process < 0 ? -1 : pipe[0], {}};
}

// Reads from a worker and passes on complete lines; returns false at the end of its results.
bool read(Worker& worker, const std::function<void(int, const std::string&)>& done, int& reported) {
  std::array<char, 4096> buffer{};
  const ssize_t n = ::read(worker.results, buffer.data(), buffer.size());
  if (n < 0 && errno == EINTR) return true;
  if (n <= 0) return false;
  worker.text.append(buffer.data(), static_cast<std::size_t>(n));
  for (std::size_t end = 0; (end = worker.text.find('\n')) != std::string::npos;) {
    const std::string line = worker.text.substr(0, end);
    worker.text.erase(0, end + 1);
    const std::size_t space = line.find(' ');
    done(std::stoi(line.substr(0, space)), line.substr(space + 1));
    ++reported;
  }
  return true;
}

}  // namespace

bool workInProcesses(int jobs, int workers, const std::function<std::string(int)>& work,
                     const std::function<void(int, const std::string&)>& done,
                     const std::function<bool()>& stop) {
  Shared* const shared = share();
  if (shared == nullptr) return false;
  const int count = std::clamp(workers, 1, std::max(jobs, 1));
  std::vector<Worker> all;
  for (int i = 0; i < count; ++i) all.push_back(start(jobs, *shared, work));
  int reported = 0;
  for (;;) {
    std::vector<pollfd> waiting;
    for (const Worker& w : all) waiting.push_back({w.results, POLLIN, 0});  // poll() ignores -1
    if (std::all_of(all.begin(), all.end(), [](const Worker& w) { return w.results < 0; })) break;
    if (stop && stop()) shared->stop = true;
    if (::poll(waiting.data(), waiting.size(), kLookForStop_ms) < 0) continue;
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (waiting[i].revents == 0 || read(all[i], done, reported)) continue;
      ::close(all[i].results);
      all[i].results = -1;
    }
  }
  for (const Worker& w : all) {
    while (w.process > 0 && ::waitpid(w.process, nullptr, 0) < 0 && errno == EINTR) {
    }
  }
  ::munmap(shared, sizeof *shared);
  return reported == jobs;
}

}  // namespace wholehand
