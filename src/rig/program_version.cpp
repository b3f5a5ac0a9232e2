#include "rig/program_version.hpp"

#include "git_version.hpp"

namespace wholehand {

const char* programVersion() {
  return WHOLEHAND_VERSION;
}

}  // namespace wholehand
