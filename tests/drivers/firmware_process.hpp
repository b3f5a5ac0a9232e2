#pragma once

#include "support/watched_main.hpp"

#include <array>
#include <csignal>
#include <cstdio>
#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <stdexcept>
#include <string>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

/// Runs the reference firmware as a process beside the test.
namespace wholehand::test {

/// A line that the firmware prints (drivers/frame/firmware/posix_main.c).
struct PhaseLine {
  std::string phase;
  double silent_ms = 0.0;    ///< time since the last command was received
  double most_effort = 0.0;  ///< largest |effort - neutral|
  double gap_ms = 0.0;       ///< longest time between two ticks since the last line
};

class FirmwareProcess {
 public:
  /// @param where "serial", "udp:0" or "shm:NAME"
  explicit FirmwareProcess(const std::string& where, bool commanded = false) {
    where == "serial" ? seesTerminal() : seesRealTime();
    std::vector<std::string> words = {std::string(WHOLEHAND_BINARY_DIR) + "/frame_firmware", where};
    if (commanded) words.emplace_back("commanded");
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    std::array<int, 2> ends{};
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) throw std::runtime_error("no pipe");
    posix_spawn_file_actions_t actions;
    ::posix_spawn_file_actions_init(&actions);
    ::posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
    if (::posix_spawn(&pid_, argv[0], &actions, nullptr, argv.data(), environ) != 0) pid_ = 0;
    ::posix_spawn_file_actions_destroy(&actions);
    ::close(ends[1]);
    out_ = ends[0];
    const std::string first = line();
    if (first.rfind("at ", 0) != 0) throw std::runtime_error("the firmware says: " + first);
    locator_ = first.substr(3);
  }
  ~FirmwareProcess() {
    send(SIGTERM);  // it then removes its shared memory
    wait();
    ::close(out_);
  }
  FirmwareProcess(const FirmwareProcess&) = delete;
  FirmwareProcess& operator=(const FirmwareProcess&) = delete;

  /// The locator for --device-at.
  [[nodiscard]] const std::string& locator() const { return locator_; }
  void send(int signal) const {
    if (pid_ > 0) ::kill(pid_, signal);
  }
  void wait() {
    if (pid_ > 0) ::waitpid(pid_, nullptr, 0);
    pid_ = 0;
  }
  /// The next line; empty after 20 s or at the end.
  [[nodiscard]] std::string line() {
    std::string text;
    for (char c = 0;;) {
      pollfd input{out_, POLLIN, 0};
      if (::poll(&input, 1, 20'000) <= 0 || ::read(out_, &c, 1) != 1) return "";
      if (c == '\n') return text;
      text += c;
    }
  }
  /// Reads lines until the one of that phase; its fields are empty if none comes. `gap_ms` is the
  /// largest of all lines read.
  [[nodiscard]] PhaseLine until(const std::string& phase) {
    double gap_ms = 0.0;
    for (;;) {
      const std::string text = line();
      std::array<char, 32> word{};
      PhaseLine reported;
      if (std::sscanf(text.c_str(), "%31s %lf %lf %lf", word.data(), &reported.silent_ms,
                      &reported.most_effort, &reported.gap_ms) != 4) {
        return {};
      }
      gap_ms = reported.gap_ms > gap_ms ? reported.gap_ms : gap_ms;
      if (phase != word.data()) continue;
      reported.phase = phase;
      reported.gap_ms = gap_ms;
      return reported;
    }
  }

 private:
  pid_t pid_ = 0;
  int out_ = -1;
  std::string locator_;
};

/// Locators of every carrier, unique to this test process.
inline std::vector<std::string> everyCarrier() {
  return {"udp:0", "serial", "shm:test-" + std::to_string(::getpid())};
}

}  // namespace wholehand::test
