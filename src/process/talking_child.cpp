#include "process/talking_child.hpp"

#include "process/spawn.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <poll.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

namespace wholehand {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kLook_ms = 20;
/// Time limit for the child's exit after it closed its socket.
constexpr auto kEndsWithin = std::chrono::seconds(10);
constexpr std::size_t kPiece_bytes = 1 << 16;

}  // namespace

std::unique_ptr<TalkingChild> TalkingChild::start(const std::string& program,
                                                  const std::vector<std::string>& arguments,
                                                  const Limits& limits) {
  std::array<int, 2> ends{};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) return nullptr;
  pid_t child = 0;
  const int error = process::spawn(program, arguments, ends[1], ends[1], child);
  ::close(ends[1]);
  if (error != 0) {
    ::close(ends[0]);
    errno = error;
    return nullptr;
  }
  process::limit(child, limits.memory_bytes, limits.idle);
  return std::unique_ptr<TalkingChild>(new TalkingChild(child, ends[0]));
}

TalkingChild::~TalkingChild() {
  ::close(socket_);
  if (!over_) process::kill(child_);
}

bool TalkingChild::send(std::string_view text) {
  while (!text.empty()) {
    const ssize_t n = ::send(socket_, text.data(), text.size(), MSG_NOSIGNAL);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) hung_up_ = true;
    if (n <= 0) return false;
    text.remove_prefix(n);
  }
  return true;
}

std::string TalkingChild::receive(std::size_t bytes, Clock::time_point until,
                                  const std::function<bool()>& stop) {
  std::string said;
  while (said.size() < bytes && Clock::now() < until && !(stop && stop())) {
    pollfd ready{socket_, POLLIN, 0};
    if (::poll(&ready, 1, kLook_ms) <= 0) continue;
    const std::size_t at = said.size();
    said.resize(at + std::min(bytes - at, kPiece_bytes));
    const ssize_t n = ::recv(socket_, said.data() + at, said.size() - at, 0);
    said.resize(at + std::max<ssize_t>(n, 0));
    hung_up_ = n == 0 || (n < 0 && errno != EINTR);
    if (hung_up_) break;
  }
  return said;
}

int TalkingChild::signal() {
  if (!hung_up_) return 0;
  for (const auto until = Clock::now() + kEndsWithin; !over_ && Clock::now() < until;) {
    over_ = process::isOver(child_, status_);
    if (!over_) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return over_ && WIFSIGNALED(status_) ? WTERMSIG(status_) : 0;
}

}  // namespace wholehand
