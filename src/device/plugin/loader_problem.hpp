#pragma once

#include <dlfcn.h>
#include <string>

namespace wholehand {

/// Why the last dlopen() of `path` failed, without the path, which dlerror() puts first.
inline std::string loaderProblem(const std::string& path) {
  const char* const why = ::dlerror();
  const std::string problem = why != nullptr ? why : "cannot be loaded";
  const std::string lead = path + ": ";
  return problem.starts_with(lead) ? problem.substr(lead.size()) : problem;
}

}  // namespace wholehand
