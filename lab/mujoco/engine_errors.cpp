#include "lab/mujoco/engine_errors.hpp"

#include <mujoco/mujoco.h>

namespace wholehand::mujoco {
namespace {

thread_local ErrorTrap* innermost = nullptr;

void leave(const char*) {
  if (innermost != nullptr) std::longjmp(innermost->jump, 1);
}

void ignore(const char*) {}

}  // namespace

ErrorTrap::ErrorTrap() noexcept : outer_(innermost) {
  innermost = this;
}

ErrorTrap::~ErrorTrap() {
  innermost = outer_;
}

void takeErrors() noexcept {
  mju_user_error = leave;
  mju_user_warning = ignore;
}

}  // namespace wholehand::mujoco
