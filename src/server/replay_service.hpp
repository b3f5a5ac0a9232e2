#pragma once

#include <functional>
#include <string>

namespace wholehand {

/// What a page is answered that looks at a recording again.
struct ReplayAnswer {
  int status = 200;
  std::string content_type = "application/json";
  std::string body;
};

/// Answers a question ("about", "scene", "states?tick=0&count=1&step=1", "series?...") about the
/// recording at a path. Waits for the disk. Several threads at a time; must not throw.
using ReplayService =
    std::function<ReplayAnswer(const std::string& path, const std::string& question)>;

}  // namespace wholehand
