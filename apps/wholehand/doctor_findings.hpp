#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace wholehand {

/// What a finding stands in the way of.
enum class Blocks { kNothing, kDevice, kEverything };

struct Finding {
  std::string what;
  bool good = false;
  Blocks blocks = Blocks::kNothing;  ///< while it is not good
  std::string fact;
  std::string remedy;  ///< empty where good
};
using Findings = std::vector<Finding>;

/// Kernel, cores, governor and limits.
[[nodiscard]] Findings findingsAboutMachine();
/// How this program was built, the packages of the list, the free disk.
[[nodiscard]] Findings findingsAboutSoftware(const std::filesystem::path& packages_file);
/// What a loop's thread is granted and how late it wakes up. Takes two seconds.
[[nodiscard]] Findings findingsAboutLoop();

}  // namespace wholehand
