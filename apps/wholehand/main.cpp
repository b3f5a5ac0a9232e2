#include "apps/wholehand/device_host/device_host_command.hpp"
#include "apps/wholehand/doctor/doctor.hpp"
#include "apps/wholehand/measures/measures_command.hpp"
#include "apps/wholehand/prescribe/prescribe_command.hpp"
#include "apps/wholehand/replay/replay_command.hpp"
#include "apps/wholehand/report/report_command.hpp"
#include "apps/wholehand/run/run_command.hpp"
#include "apps/wholehand/shared/exit_code.hpp"
#include "apps/wholehand/shared/options.hpp"
#include "apps/wholehand/shared/pages.hpp"
#include "apps/wholehand/shared/program_main.hpp"
#include "apps/wholehand/shared/shipped_files.hpp"
#include "apps/wholehand/shared/tools.hpp"
#include "apps/wholehand/validate/validate_command.hpp"
#include "rig/program_version.hpp"

#include <CLI/CLI.hpp>

#include <string>
#include <vector>

namespace {

using namespace wholehand;  // NOLINT(google-build-using-namespace): the program's own main

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
      ->check(wholeBetween(0, 65535))
      ->capture_default_str()
      ->needs(web);
  r->add_flag("--answer", o.answer)->group("");  // for child processes of this program; hidden from
                                                 // --help
  r->callback([&o, &code] { code = replayCommand(o); });
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

/// Recording to be measured, and the CSV file for its answers.
struct Measured {
  std::string recording, answers;
};

std::string isCode(const std::string& text) {
  const bool good = !text.empty() && text.size() <= 100 &&
                    text.find_first_not_of(
                        "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                        "0123456789-_") == std::string::npos;
  return good ? "" : "must be a code of letters, digits, - and _, not a person's name";
}

void addOthers(CLI::App& app, ReportOptions& report, Measured& measured,
               PrescribeOptions& prescribed, int& code) {
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
  m->add_option("recording", measured.recording, "HDF5 file")->required();
  m->add_option("--answers", measured.answers,
                "Write the answers of an exercise that compares to this CSV file");
  m->callback([&] { code = measuresCommand(measured.recording, measured.answers); });

  CLI::App* l = app.add_subcommand(
      "prescribe", "Make a prescription: limits at the ends of a person's own movement");
  l->add_option("recordings", prescribed.recordings,
                "HDF5 files of the exercise own-range; a later one replaces what it measured again")
      ->required();
  l->add_option("--name", prescribed.name, "Code of the person")
      ->check(CLI::Validator(isCode, "letters, digits, - and _"))
      ->capture_default_str();
  l->add_option("--out", prescribed.output, "Write it to this file");
  l->callback([&] { code = prescribeCommand(prescribed); });

  CLI::App* d = app.add_subcommand("doctor", "Check whether this machine may drive a device");
  d->callback([&] { code = runDoctor(shippedFile("scripts/packages.txt")); });
}

/// Lists the commands of wholehand-tools in --help. runProgram() hands them over before parsing.
void addTools(CLI::App& app) {
  for (const ToolCommand& tool : kToolCommands) app.add_subcommand(tool.name, tool.help);
}

int runProgram(int argc, char** argv) {
  if (argc > 1 && isToolCommand(argv[1])) return runTool(argc, argv);
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
  std::vector<std::string> files;
  DeviceHostOptions host;
  addRun(app, run, code);
  addDeviceHost(app, host, code);
  addTools(app);
  addReplay(app, replay, code);
  AdmitOptions admit;
  admit.hand = shippedFile("config/hands/adult-median-right.toml");
  admit.device = shippedFile("config/devices/lambda-pride.toml");
  addValidate(app, files, admit, code);
  Measured measured;
  PrescribeOptions prescribed;
  addOthers(app, report, measured, prescribed, code);
  // Copies the arguments before hideSecrets() overwrites the tokens.
  return parseCommandLine(app, argc, argv, code);
}

}  // namespace

int main(int argc, char** argv) {
  return runMain(argc, argv, runProgram);
}
