#pragma once

#include <csetjmp>

namespace wholehand::mujoco {

/// Where MuJoCo's errors go in this thread while one exists. MuJoCo ends the program at an error
/// that nobody takes, prints, and writes a log; with this it does neither.
class ErrorTrap {
 public:
  ErrorTrap() noexcept;
  ~ErrorTrap();
  ErrorTrap(const ErrorTrap&) = delete;
  ErrorTrap& operator=(const ErrorTrap&) = delete;

  std::jmp_buf jump;  ///< where an error goes on

 private:
  ErrorTrap* outer_;
};

/// Takes MuJoCo's errors and warnings of the whole process; later calls do nothing. A warning is
/// only counted, in mjData::warning.
void takeErrors() noexcept;

/// Whether `call` came to its end. Where MuJoCo met an error it is left at once: nothing that call
/// creates may have a destructor. Real-time safe if call is.
template <class Call>
[[nodiscard]] bool endsWell(const Call& call) noexcept {
  ErrorTrap trap;
  if (setjmp(trap.jump) != 0) return false;
  call();
  return true;
}

}  // namespace wholehand::mujoco
