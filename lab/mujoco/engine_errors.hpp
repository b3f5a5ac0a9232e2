#pragma once

#include <csetjmp>

namespace wholehand::mujoco {

/// Catches MuJoCo's errors in this thread during its lifetime. At an uncaught error MuJoCo prints,
/// writes a log and ends the program.
class ErrorTrap {
 public:
  ErrorTrap() noexcept;
  ~ErrorTrap();
  ErrorTrap(const ErrorTrap&) = delete;
  ErrorTrap& operator=(const ErrorTrap&) = delete;

  std::jmp_buf jump;  ///< target of the jump after an error

 private:
  ErrorTrap* outer_;
};

/// Installs handlers for MuJoCo's errors and warnings in the whole process; later calls do nothing.
/// Warnings are only counted, in mjData::warning.
void takeErrors() noexcept;

/// Runs `call`; returns false when MuJoCo reported an error. An error leaves `call` by longjmp, so
/// `call` must not create objects with destructors. Real-time safe if `call` is.
template <class Call>
[[nodiscard]] bool endsWell(const Call& call) noexcept {
  ErrorTrap trap;
  if (setjmp(trap.jump) != 0) return false;
  call();
  return true;
}

}  // namespace wholehand::mujoco
