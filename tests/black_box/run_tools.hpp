#pragma once

#include "assembly/kept_black_box.hpp"
#include "assembly/models.hpp"
#include "assembly/recorded_run.hpp"
#include "assembly/rig.hpp"
#include "support/rig_tools.hpp"

#include <array>
#include <cstdio>
#include <memory>
#include <string>
#include <sys/wait.h>

namespace wholehand::test {

/// The cocktail bar, whose virtual patient moves and grasps from the first second on.
inline Models bar() {
  ModelFiles files = shippedFiles();
  files.exercise = std::string(WHOLEHAND_SOURCE_DIR) + "/config/exercises/cocktail-bar.toml";
  return load(files);
}

/// Shows the virtual patient what happens.
class Watching final : public TickListener {
 public:
  explicit Watching(Player& player) : player_(player) {}
  void beforeTick(const TickRecord&) noexcept override {}
  void afterTick(const TickRecord& record) noexcept override { player_.see(record); }

 private:
  Player& player_;
};

struct Said {
  int code = -1;
  std::string text;
};

/// Runs the program with these arguments; standard output and error together.
inline Said program(const std::string& arguments) {
  FILE* pipe = ::popen((std::string(WHOLEHAND_PROGRAM) + " " + arguments + " 2>&1").c_str(), "r");
  Said said;
  std::array<char, 4096> piece{};
  while (const std::size_t n = std::fread(piece.data(), 1, piece.size(), pipe)) {
    said.text.append(piece.data(), n);
  }
  const int status = ::pclose(pipe);
  said.code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return said;
}

/// `replay --resimulate` of this box finds every bit the same; what it said.
inline std::string expectSameAgain(const std::string& box) {
  const Said said = program("replay --resimulate " + box);
  EXPECT_EQ(said.code, 0) << said.text;
  EXPECT_NE(said.text.find("every bit the same"), std::string::npos) << said.text;
  return said.text;
}

}  // namespace wholehand::test
