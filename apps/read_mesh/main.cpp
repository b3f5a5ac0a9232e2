// wholehand-read-mesh FILE: sends the triangles of a mesh file to the program that started it
// (src/files/mesh/mesh_file.hpp), which also sets its limits.
#include "files/mesh/mesh_file.hpp"

#include <cstdio>
#include <exception>
#include <string>

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: wholehand-read-mesh FILE; started by Wholehand to read a mesh\n", stderr);
    return 2;
  }
  try {
    const std::string mesh = wholehand::encodeMesh(wholehand::readMeshHere(argv[1]));
    const bool done = std::fwrite(mesh.data(), 1, mesh.size(), stdout) == mesh.size();
    return done && std::fflush(stdout) == 0 ? 0 : 1;
  } catch (const std::exception&) {  // out of memory
    return 1;
  }
}
