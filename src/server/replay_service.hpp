#pragma once

#include <functional>
#include <string>

namespace wholehand {

/// Answer to a page that replays a recording.
struct ReplayAnswer {
  int status = 200;
  std::string content_type = "application/json";
  std::string body;
};

/// Answers a question ("about", "scene", "states?tick=0&count=1&step=1", "series?...") about the
/// recording at a path. Waits for the disk. Called from several threads at a time; must not throw.
using ReplayService =
    std::function<ReplayAnswer(const std::string& path, const std::string& question)>;

}  // namespace wholehand
