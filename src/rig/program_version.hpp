#pragma once

namespace wholehand {

/// Version and revision of the program, as recordings state it: "0.1.0 (b88b2c58)". The only source
/// that is compiled anew when the revision changes defines it.
[[nodiscard]] const char* programVersion();

}  // namespace wholehand
