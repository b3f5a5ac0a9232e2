#pragma once

#include "loop/core/compiler.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

/// Crashes in separate processes.
namespace wholehand::test {

/// Runs `body` in a child process, silently and without core dump. @return its wait status
inline int inChild(const std::function<void()>& body) {
  const pid_t child = ::fork();
  if (child == 0) {
    const rlimit none{0, 0};
    ::setrlimit(RLIMIT_CORE, &none);
    ::close(STDERR_FILENO);
    ::alarm(60);
    body();
    ::_exit(99);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  return status;
}

/// Checks that the process died of that signal, as it would have without the crash handler. A
/// sanitizer's handler was installed earlier, so it runs after ours and exits instead.
inline void expectDiedOf([[maybe_unused]] int signal, int status) {
#if WHOLEHAND_SANITIZED
  EXPECT_TRUE(WIFSIGNALED(status) || WEXITSTATUS(status) != 99) << status;
#else
  ASSERT_TRUE(WIFSIGNALED(status)) << "exit code " << WEXITSTATUS(status);
  EXPECT_EQ(WTERMSIG(status), signal);
#endif
}

[[gnu::noinline]] inline void writeToNowhere() {
  volatile int* volatile nowhere = nullptr;
  *nowhere = 1;
}

}  // namespace wholehand::test
