#include "experiments/worker_pool.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <poll.h>
#include <string_view>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

namespace wholehand {
namespace {

struct Worker {
  pid_t process = -1;
  int results = -1;  // read end
  std::string text;  // not yet a whole line
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

Worker start(int first, int jobs, int step, const std::function<std::string(int)>& work) {
  std::array<int, 2> pipe{};
  if (::pipe(pipe.data()) != 0) return {};
  std::fflush(nullptr);  // or the worker would print it again
  const pid_t process = ::fork();
  if (process == 0) {
    ::close(pipe[0]);
    bool heard = true;
    for (int job = first; job < jobs && heard; job += step) {
      heard = writeAll(pipe[1], std::to_string(job) + " " + work(job) + "\n");
    }
    std::fflush(nullptr);
    ::_exit(0);  // what the parent would tidy up is the parent's
  }
  ::close(pipe[1]);
  if (process < 0) ::close(pipe[0]);
  return {process, process < 0 ? -1 : pipe[0], {}};
}

// Hands over the whole lines; false at the end of the worker's results.
bool read(Worker& worker, const std::function<void(int, const std::string&)>& done, int& told) {
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
    ++told;
  }
  return true;
}

}  // namespace

bool workInProcesses(int jobs, int workers, const std::function<std::string(int)>& work,
                     const std::function<void(int, const std::string&)>& done) {
  const int count = std::clamp(workers, 1, std::max(jobs, 1));
  std::vector<Worker> all;
  for (int i = 0; i < count; ++i) all.push_back(start(i, jobs, count, work));
  int told = 0;
  for (;;) {
    std::vector<pollfd> waiting;
    for (const Worker& w : all) waiting.push_back({w.results, POLLIN, 0});  // -1 is left out
    if (std::all_of(all.begin(), all.end(), [](const Worker& w) { return w.results < 0; })) break;
    if (::poll(waiting.data(), waiting.size(), -1) < 0) continue;
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (waiting[i].revents == 0 || read(all[i], done, told)) continue;
      ::close(all[i].results);
      all[i].results = -1;
    }
  }
  for (const Worker& w : all) {
    while (w.process > 0 && ::waitpid(w.process, nullptr, 0) < 0 && errno == EINTR) {
    }
  }
  return told == jobs;
}

}  // namespace wholehand
