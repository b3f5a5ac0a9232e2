#pragma once

#include "assembly/engines.hpp"

#include <CLI/CLI.hpp>

#include <string>

namespace wholehand {

/// Adds `--engine NAME` to a command that builds a world.
inline CLI::Option* addEngine(CLI::App& command, std::string& engine) {
  return command.add_option("--engine", engine, "Physics engine (docs/engines.md)")
      ->check(CLI::IsMember(engineNames()))
      ->capture_default_str();
}

}  // namespace wholehand
