#pragma once

namespace wholehand {

/// Version and revision of the program as stored in recordings: "0.1.0 (b88b2c58)". Only its source
/// file is recompiled when the revision changes.
[[nodiscard]] const char* programVersion();

}  // namespace wholehand
