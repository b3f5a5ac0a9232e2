#include "usage.hpp"

#include "core/printable.hpp"
#include "exit_code.hpp"

#include <cstddef>
#include <cstdio>
#include <sstream>
#include <string>
#include <vector>

namespace wholehand {
namespace {

constexpr std::size_t kLongestProblem = 400;  // characters of a line

// The first unknown word of the command line; CLI11 alone would report a missing option.
std::string unknownWord(const CLI::App& app, const CLI::ParseError& error) {
  if (dynamic_cast<const CLI::RequiredError*>(&error) == nullptr) return {};
  const std::vector<std::string> rest = app.remaining(true);
  return rest.empty() ? std::string{} : rest.front();
}

// The words of the command line within a text, each on one line.
std::string onOneLine(std::string text, const std::vector<std::string>& words) {
  for (const std::string& word : words) {
    if (word.find('\n') == std::string::npos) continue;
    const std::string shown = printable(word);
    for (std::size_t at = text.find(word); at != std::string::npos;
         at = text.find(word, at + shown.size())) {
      text.replace(at, word.size(), shown);
    }
  }
  return text;
}

void print(std::FILE* to, const std::string& text, std::size_t longest_line) {
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::fprintf(to, "%s\n", printable(line, longest_line).c_str());
  }
}

}  // namespace

int tellUsage(const CLI::App& app, const CLI::ParseError& error,
              const std::vector<std::string>& words) {
  if (const std::string word = unknownWord(app, error); !word.empty()) {
    std::fprintf(stderr,
                 "'%s' is not a subcommand or option here\nRun with --help for more information.\n",
                 printable(word).c_str());
    return kExitBadInput;
  }
  std::ostringstream out, problem;
  const int code = app.exit(error, out, problem);
  print(stdout, out.str(), std::string::npos);  // help, as long as it is
  print(stderr, onOneLine(problem.str(), words), kLongestProblem);
  // CLI11 has an exit code for every mistake; the shell gets one.
  return code == 0 ? kExitDone : kExitBadInput;
}

}  // namespace wholehand
