#include "apps/wholehand/certify/certify_command.hpp"
#include "apps/wholehand/decompose/decompose_command.hpp"
#include "apps/wholehand/device/device_command.hpp"
#include "apps/wholehand/device/device_host_command.hpp"
#include "apps/wholehand/doctor/doctor.hpp"
#include "apps/wholehand/experiment/experiment_command.hpp"
#include "apps/wholehand/measures/measures_command.hpp"
#include "apps/wholehand/replay/replay_command.hpp"
#include "apps/wholehand/report/report_command.hpp"
#include "apps/wholehand/run/run_command.hpp"
#include "apps/wholehand/shared/exit_code.hpp"
#include "apps/wholehand/shared/options.hpp"
#include "apps/wholehand/shared/pages.hpp"
#include "apps/wholehand/shared/shipped_files.hpp"
#include "apps/wholehand/sweep/sweep_command.hpp"
#include "apps/wholehand/validate/validate_command.hpp"
#include "loop/core/printable.hpp"
#include "rig/program_version.hpp"

#include <CLI/CLI.hpp>

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

namespace {

using namespace wholehand;  // NOLINT(google-build-using-namespace): the program's own main

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

void addCertify(CLI::App& app, CertifyOptions& o, int& code) {
  CLI::App* certify = app.add_subcommand(
      "certify",
      "Check that gains are stable with any passive person and object, and by what margin");
  addHandAndDevice(*certify, o.hand, o.device, o.rendering);
  CLI::Option* exercise = certify->add_option(
      "--exercise", o.exercise,
      "Exercise, a name or a file, whose walls are covered, too (default: no walls)");
  certify->add_option("--level", o.level, "Level of the exercise")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str()
      ->needs(exercise);
  addRate(*certify, o.rate_hz);
  CLI::Option* passport = certify->add_option(
      "--passport", o.passport,
      "Passport of the device: judge the worst corner of what was measured of it");
  certify->add_option("--json", o.json, "Write the certificate to this file");
  certify->add_option("--charts", o.charts,
                      "Draw each axis's Z-width (or felt impedance) into this HTML file");
  CLI::Option* impedance =
      certify->add_flag("--impedance", o.impedance,
                        "Predict and measure what the person feels on every axis, instead");
  impedance->excludes(exercise)->excludes(passport);
  addEngine(*certify, o.engine)->needs(impedance);
  certify
      ->add_option("--contact-stiffness", o.contact_stiffness_n_m,
                   "With --impedance: the spring that the simulated hand meets [N/m]")
      ->check(finiteBetween(1.0, 1e6, "N/m"))
      ->capture_default_str()
      ->needs(impedance);
  certify->footer("Exit code 0: certified; 1: not; 2: a file is not well formed.");
  certify->callback([&o, certify, &code] {
    if (!o.exercise.empty()) o.exercise = exerciseFile(o.exercise);
    if (certify->count("--rendering") > 0 || findGains(o.device, o.rendering, code)) {
      code = certifyCommand(o);
    }
  });
}

void addReplay(CLI::App& app, ReplayOptions& o, int& code) {
  CLI::App* r = app.add_subcommand("replay", "Play a recording back, or run it again and compare");
  r->add_option("recording", o.recording, "HDF5 file, or black box (.wbb)")->required();
  CLI::Option* again = r->add_flag(
      "--resimulate", o.resimulate,
      "Run the recorded inputs again and compare bit by bit (exit code 1: they differ)");
  CLI::Option* extract =
      r->add_option("--extract", o.extract, "Write the last seconds of a black box as a recording")
          ->excludes(again);
  CLI::Option* speed = r->add_option("--speed", o.speed, "How fast to play it back")
                           ->check(finiteBetween(0.01, 1000.0, "times"))
                           ->capture_default_str();
  CLI::Option* web = r->add_flag("--web", o.web, "Show it in the browser, until Ctrl-C");
  web->excludes(again)->excludes(extract)->excludes(speed);
  CLI::Option* report =
      r->add_option("--report", o.report, "Write it as one HTML page that needs nothing else")
          ->excludes(again)
          ->excludes(extract)
          ->excludes(speed)
          ->excludes(web);
  r->add_option("--before", o.before,
                "Recording of the session before; the report marks improvements")
      ->needs(report);
  r->add_option("--beside", o.beside, "HDF5 file to show beside it in the browser")->needs(web);
  r->add_option("--port", o.port, "Port of the pages; 0: any that is free")
      ->check(finiteBetween(0, 65535, ""))
      ->capture_default_str()
      ->needs(web);
  r->add_flag("--answer", o.answer)->group("");  // for child processes of this program; hidden from
                                                 // --help
  r->callback([&o, &code] { code = replayCommand(o); });
}

void addSweep(CLI::App& app, SweepOptions& o, int& code) {
  CLI::App* s =
      app.add_subcommand("sweep", "Run every combination of a grid: gains, hands, patients");
  s->add_option("grid", o.grid, "TOML file of the grid, such as config/sweeps/grasp-map.toml")
      ->required();
  s->add_option("--out", o.out, "HDF5 file of the results; finished cells are kept beside it")
      ->required();
  s->add_option("--chart", o.chart, "Draw the grid's maps into this HTML file");
  s->add_option("--processes", o.processes, "Processes (default: one for each core)")
      ->check(finiteBetween(1, 1024, ""));
  CLI::Option* share =
      s->add_option("--share", o.share, "Only these cells: 2/8 is the second of eight shares");
  s->add_flag("--array", o.array, "Only the share of this task of a Slurm job array")
      ->excludes(share);
  s->footer(
      "Killed or interrupted, the same command goes on.\n"
      "Exit code 0: done; 2: bad input; 3: a process died; 130: interrupted.");
  s->callback([&o, &code] { code = sweepCommand(o); });
}

void addValidate(CLI::App& app, std::vector<std::string>& files, AdmitOptions& o, int& code) {
  CLI::App* v =
      app.add_subcommand("validate", "Check files; list every fault with its place and remedy");
  CLI::Option* all = v->add_option("files", files, "TOML files, or a motion's CSV");
  CLI::Option* admit =
      v->add_option(
           "--admit", o.scene,
           "Instead: measure the tick of this scene or exercise here, and say whether the rate "
           "admits it")
          ->excludes(all);
  addRate(*v, o.rate_hz)->needs(admit);
  addEngine(*v, o.engine)->needs(admit);
  for (CLI::Option* file : addHandAndDevice(*v, o.hand, o.device, o.rendering)) file->needs(admit);
  v->footer("Exit code 0: no fault, admitted; 1: not admitted; 2: a fault.");
  v->callback([&files, &o, v, &code] {
    if (!o.scene.empty()) {
      if (v->count("--rendering") > 0 || findGains(o.device, o.rendering, code)) {
        code = admitCommand(o);
      }
    } else if (files.empty()) {
      throw CLI::RequiredError("files");
    } else {
      code = validateCommand(files);
    }
  });
}

void addOthers(CLI::App& app, ReportOptions& report, std::string& measured, int& code) {
  CLI::App* p =
      app.add_subcommand("report", "Make the report of a recording: one HTML file, index.html");
  p->add_option("recording", report.recording, "HDF5 file, or black box (.wbb)")->required();
  p->add_option("--out", report.page, "Folder to write into")->required();
  p->add_option("--before", report.before,
                "Recording of the session before; the report marks improvements");
  p->callback([&] {
    code = reportCommand({report.recording, pageIn(report.page), report.before});
  });

  CLI::App* m = app.add_subcommand(
      "measures", "Print what a recording says of the person, as one line of JSON");
  m->add_option("recording", measured, "HDF5 file")->required();
  m->callback([&] { code = measuresCommand(measured); });

  CLI::App* d = app.add_subcommand("doctor", "Check whether this machine may drive a device");
  d->callback([&] { code = runDoctor(shippedFile("scripts/packages.txt")); });
}

int runProgram(int argc, char** argv) {
  CLI::App app{
      "Whole-hand haptic rendering on an off-the-shelf physics engine.\n"
      "Research software, not a certified medical device."};
  app.set_version_flag("--version", std::string("wholehand ") + programVersion());
  app.require_subcommand(1);
  app.option_defaults()->always_capture_default(false);
  int code = kExitDone;
  RunOptions run = shippedRun();
  ReplayOptions replay;
  ReportOptions report;
  ExperimentOptions experiment;
  BarExperimentOptions bar;
  std::vector<std::string> files;
  DeviceHostOptions host;
  DeviceOptions device;
  addRun(app, run, code);
  addDeviceHost(app, host, code);
  addDevice(app, device, code);
  CertifyOptions certify{shippedFile("config/devices/lambda-pride.toml"), "",
                         shippedFile("config/hands/adult-median-right.toml")};
  addCertify(app, certify, code);
  addReplay(app, replay, code);
  addExperiments(app, experiment, bar, code);
  SweepOptions sweep;
  addSweep(app, sweep, code);
  AdmitOptions admit;
  admit.hand = certify.hand;
  admit.device = certify.device;
  addValidate(app, files, admit, code);
  DecomposeOptions decompose;
  addDecompose(app, decompose, code);
  std::string measured;
  addOthers(app, report, measured, code);
  // Copies the arguments before hideSecrets() overwrites the tokens.
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

int main(int argc, char** argv) {
  limitStacks();
  std::signal(SIGPIPE, SIG_IGN);  // a run whose output nobody reads still ends with its ramp
  std::setvbuf(stdout, nullptr, _IOLBF, BUFSIZ);  // keeps the order with standard error, also in a
                                                  // file
  try {
    return flushOutput(runProgram(argc, argv));
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
