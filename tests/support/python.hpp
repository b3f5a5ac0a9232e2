#pragma once

#include <array>
#include <cstdio>
#include <string>

namespace wholehand::test {

/// Runs a script with Debian's Python, which has h5py. @return its output, including errors
inline std::string python(const std::string& script) {
  const std::string command = "/usr/bin/python3 - 2>&1 <<'END'\n" + script + "\nEND\n";
  FILE* pipe = ::popen(command.c_str(), "r");
  std::string out;
  std::array<char, 4096> piece{};
  while (std::size_t n = std::fread(piece.data(), 1, piece.size(), pipe))
    out.append(piece.data(), n);
  ::pclose(pipe);
  return out;
}

}  // namespace wholehand::test
