// The program wholehand-tools: commands that do not play. `wholehand NAME` runs them
// (shared/tools.hpp).
#include "apps/tools/certify/certify_command.hpp"
#include "apps/tools/decompose/decompose_command.hpp"
#include "apps/tools/device/device_command.hpp"
#include "apps/tools/experiment/experiment_command.hpp"
#include "apps/tools/sweep/sweep_command.hpp"
#include "apps/wholehand/shared/exit_code.hpp"
#include "apps/wholehand/shared/options.hpp"
#include "apps/wholehand/shared/program_main.hpp"
#include "apps/wholehand/shared/shipped_files.hpp"
#include "apps/wholehand/shared/tools.hpp"
#include "rig/program_version.hpp"

#include <CLI/CLI.hpp>

#include <string>

namespace {

using namespace wholehand;  // NOLINT(google-build-using-namespace): the program's own main

void addCertify(CLI::App& app, CertifyOptions& o, int& code) {
  CLI::App* certify = app.add_subcommand("certify", toolHelp("certify"));
  addHandAndDevice(*certify, o.hand, o.device, o.rendering);
  CLI::Option* exercise = certify->add_option(
      "--exercise", o.exercise,
      "Exercise, a name or a file, whose walls are covered, too (default: no walls)");
  certify->add_option("--level", o.level, "Level of the exercise")
      ->check(wholeBetween(1, 1000))
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

void addSweep(CLI::App& app, SweepOptions& o, int& code) {
  CLI::App* s = app.add_subcommand("sweep", toolHelp("sweep"));
  s->add_option("grid", o.grid, "TOML file of the grid, such as config/sweeps/grasp-map.toml")
      ->required();
  s->add_option("--out", o.out, "HDF5 file of the results; finished cells are kept beside it")
      ->required();
  s->add_option("--chart", o.chart, "Draw the grid's maps into this HTML file");
  s->add_option("--processes", o.processes, "Processes (default: one for each core)")
      ->check(wholeBetween(1, 1024));
  CLI::Option* share =
      s->add_option("--share", o.share, "Only these cells: 2/8 is the second of eight shares");
  s->add_flag("--array", o.array, "Only the share of this task of a Slurm job array")
      ->excludes(share);
  s->footer(
      "Killed or interrupted, the same command goes on.\n"
      "Exit code 0: done; 2: bad input; 3: a process died; 130: interrupted.");
  s->callback([&o, &code] { code = sweepCommand(o); });
}

int runTools(int argc, char** argv) {
  CLI::App app{"Commands of wholehand that do not play; run them as `wholehand NAME`.",
               "wholehand"};
  app.set_version_flag("--version", std::string("wholehand ") + programVersion());
  app.require_subcommand(1);
  app.option_defaults()->always_capture_default(false);
  int code = kExitDone;
  DeviceOptions device;
  addDevice(app, device, code);
  CertifyOptions certify{shippedFile("config/devices/lambda-pride.toml"), "",
                         shippedFile("config/hands/adult-median-right.toml")};
  addCertify(app, certify, code);
  ExperimentOptions experiment;
  BarExperimentOptions bar;
  addExperiments(app, experiment, bar, code);
  SweepOptions sweep;
  addSweep(app, sweep, code);
  DecomposeOptions decompose;
  addDecompose(app, decompose, code);
  return parseCommandLine(app, argc, argv, code);
}

}  // namespace

int main(int argc, char** argv) {
  return runMain(argc, argv, runTools);
}
