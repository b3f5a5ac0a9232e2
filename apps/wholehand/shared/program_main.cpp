#include "apps/wholehand/shared/program_main.hpp"

#include "apps/wholehand/shared/exit_code.hpp"
#include "apps/wholehand/shared/pages.hpp"
#include "loop/core/printable.hpp"

#include <cerrno>
#include <csignal>
#include <cstddef>
#include <cstdio>
#include <cstring>
#include <exception>
#include <new>
#include <pthread.h>
#include <sstream>
#include <string>
#include <system_error>
#include <vector>

namespace wholehand {
namespace {

constexpr std::size_t kLongestProblem = 400;  // characters of a line

// The first unknown word of the command line. CLI11 alone would report a missing option instead.
std::string unknownWord(const CLI::App& app, const CLI::ParseError& error) {
  if (dynamic_cast<const CLI::RequiredError*>(&error) == nullptr) return {};
  const std::vector<std::string> rest = app.remaining(true);
  return rest.empty() ? std::string{} : rest.front();
}

// Replaces line feeds in the words of the command line where they occur in a text.
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

/// Prints the error of a command line, or the requested help. Words of the command line, in
/// `words`, are printed as plain text. Returns the exit code.
int printUsage(const CLI::App& app, const CLI::ParseError& error,
               const std::vector<std::string>& words) {
  if (const std::string word = unknownWord(app, error); !word.empty()) {
    std::fprintf(stderr,
                 "'%s' is not a subcommand or option here\nRun with --help for more information.\n",
                 printable(word).c_str());
    return kExitBadInput;
  }
  std::ostringstream out, problem;
  const int code = app.exit(error, out, problem);
  print(stdout, out.str(), std::string::npos);  // help has no length limit
  print(stderr, onOneLine(problem.str(), words), kLongestProblem);
  // CLI11 has a different exit code for every mistake; the shell gets one.
  return code == 0 ? kExitDone : kExitBadInput;
}

// Flushes standard output, and reports a failure.
int flushOutput(int code) {
  const bool lost = std::fflush(stdout) != 0 || std::ferror(stdout) != 0;
  if (!lost || code != kExitDone || errno == EPIPE) return code;
  return refuse(
      {fileFault("standard output", std::string("cannot be written: ") + std::strerror(errno),
                 "make room, or print elsewhere")});
}

/// Limits the stacks of threads started later: locked memory counts each stack whole, 8 MB by
/// default. A size that somebody chose (`ulimit -s`) stays.
void limitStacks() {
  constexpr std::size_t kDefault_bytes = std::size_t{8} << 20U, kStack_bytes = kDefault_bytes / 4;
  pthread_attr_t attributes;
  if (pthread_getattr_default_np(&attributes) != 0) return;
  std::size_t is_bytes = 0;
  if (pthread_attr_getstacksize(&attributes, &is_bytes) == 0 && is_bytes == kDefault_bytes &&
      pthread_attr_setstacksize(&attributes, kStack_bytes) == 0) {
    pthread_setattr_default_np(&attributes);
  }
  pthread_attr_destroy(&attributes);
}

}  // namespace

int parseCommandLine(CLI::App& app, int argc, char** argv, const int& code) {
  const std::vector<std::string> words(argv, argv + argc);
  std::vector<const char*> given;
  for (const std::string& word : words) given.push_back(word.c_str());
  hideSecrets(argc, argv);
  try {
    app.parse(argc, given.data());
  } catch (const CLI::ParseError& error) {
    return printUsage(app, error, std::vector<std::string>(words.begin() + 1, words.end()));
  }
  return code;
}

int runMain(int argc, char** argv, int (*program)(int argc, char** argv)) {
  limitStacks();
  std::signal(SIGPIPE, SIG_IGN);  // a run whose output nobody reads still ends with its ramp
  std::setvbuf(stdout, nullptr, _IOLBF, BUFSIZ);  // keeps the order with standard error, also in a
                                                  // file
  try {
    return flushOutput(program(argc, argv));
  } catch (const std::bad_alloc&) {
    std::fputs("wholehand: there is not enough memory\n", stderr);
  } catch (const std::system_error& error) {
    const bool thread = error.code() == std::errc::resource_unavailable_try_again;
    std::fprintf(
        stderr,
        thread ? "wholehand: a thread could not be started: %s; end other programs, or raise what "
                 "`ulimit -a` shows of memory, stack and processes\n"
               : "wholehand: failed: %s\n",
        printable(error.what()).c_str());
  } catch (const std::exception& error) {
    std::fprintf(stderr, "wholehand: failed: %s\n", printable(error.what()).c_str());
  }
  return kExitFailed;
}

}  // namespace wholehand
