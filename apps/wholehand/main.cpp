#include "bar_experiments.hpp"
#include "certify_command.hpp"
#include "doctor.hpp"
#include "exit_code.hpp"
#include "experiment_command.hpp"
#include "git_version.hpp"
#include "number_option.hpp"
#include "picture_command.hpp"
#include "play_command.hpp"
#include "replay_command.hpp"
#include "report_command.hpp"
#include "run_options.hpp"
#include "shipped_files.hpp"
#include "validate_command.hpp"

#include <CLI/CLI.hpp>

#include <csignal>
#include <cstdio>

namespace {

using namespace wholehand;  // NOLINT(google-build-using-namespace): the program's own main

// The gains that go with a device where none are named; false and the exit code where there are
// none.
bool findGains(const std::string& device, std::string& rendering, int& code) {
  auto found = renderingFor(device);
  if (found) {
    rendering = *found;
  } else {
    code = refuse(found.errors());
  }
  return found.ok();
}

// The exercise by name or path.
std::string exerciseFile(const std::string& exercise) {
  const bool is_path = exercise.find('/') != std::string::npos || exercise.ends_with(".toml");
  return is_path ? exercise : shippedFile("config/exercises") + "/" + exercise + ".toml";
}

// The bar where none is named.
void chooseExercise(RunOptions& o) {
  o.files.motion.clear();
  o.files.exercise = exerciseFile(o.files.exercise.empty() ? "cocktail-bar" : o.files.exercise);
}

// Options that would be passed over in silence.
Diagnostics mismatched(const CLI::App& run, const RunOptions& o, bool scene, bool pages) {
  Diagnostics faults;
  if (scene && run.count("--exercise") > 0) {
    faults.push_back({"", 0, "--exercise", o.files.exercise,
                      "cannot go with --scene or --motion: it names its own scene",
                      "leave one of them out"});
  }
  if (scene && run.count("--level") > 0) {
    faults.push_back({"", 0, "--level", std::to_string(o.files.level),
                      "belongs to an exercise, not to a scene", "leave one of them out"});
  }
  for (const char* door :
       {"--port", "--address", "--token", "--origin", "--udp", "--udp-peer", "--wait"}) {
    if (pages || run.count(door) == 0) continue;
    faults.push_back({"", 0, door, "", "is about pages and games, and this run opens no port",
                      scene && !o.no_web && !o.simulated_clock
                          ? "give --port, too, or leave it out"
                          : "leave out --no-web and --simulated-clock"});
  }
  if (o.no_rehearsal && o.simulated_clock) {
    faults.push_back({"", 0, "--no-rehearsal", "", "is about real time: there is none",
                      "leave out --no-rehearsal or --simulated-clock"});
  }
  if (run.count("--udp-peer") > 0 && run.count("--udp") == 0) {
    faults.push_back(
        {"", 0, "--udp-peer", "", "needs the port that it is served from", "give --udp, too"});
  }
  return faults;
}

void addPages(CLI::App& run, RunOptions& o) {
  run.add_option("--port", o.port, "Of the pages; 0: any that is free")
      ->check(CLI::Range(0, 65535))
      ->capture_default_str();
  run.add_option("--address", o.address, "To listen at; another than this machine needs --token")
      ->capture_default_str();
  run.add_option("--token", o.token, "What clients must show, at least 16 characters");
  run.add_option("--origin", o.origins, "Pages of other origins that may connect");
  run.add_option("--udp", o.udp,
                 "Port for game engines, or address:port; 0: any port (default: closed)");
  run.add_option("--udp-peer", o.udp_peers, "Game on another machine: host or host:port");
  run.add_flag("--no-web", o.no_web, "Open no port");
  run.add_flag("--wait", o.wait, "Arm only when a client asks for it");
}

void addRun(CLI::App& app, RunOptions& o, int& code) {
  CLI::App* run =
      app.add_subcommand("run", "Open the cocktail bar, or play a motion: a hand that feels");
  run->add_option("--exercise", o.files.exercise,
                  "Exercise: a name (cocktail-bar, the default; free-grasping ...) or a file");
  run->add_option("--level", o.files.level, "Level of the exercise")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  run->add_option("--seed", o.seed, "Of the virtual patient who plays")
      ->check(wholeNumber())
      ->capture_default_str();
  run->add_option("--scene", o.files.scene, "Scene file, without exercise: free grasping")
      ->capture_default_str();
  run->add_option("--hand", o.files.hand, "Hand file")->capture_default_str();
  run->add_option("--device", o.files.device, "Device file")->capture_default_str();
  run->add_option("--rendering", o.files.rendering,
                  "Gains that go with the device (default: the file of the device's name)");
  run->add_option("--patient", o.files.patient, "Virtual patient")->capture_default_str();
  run->add_option("--motion", o.files.motion, "Recorded motion to play in the scene, CSV")
      ->capture_default_str();
  run->add_option("--engine", o.engine, "Physics engine")
      ->check(CLI::IsMember({"bullet"}))
      ->capture_default_str();
  run->add_option("--rate-hz", o.rate_hz, "Ticks a second")
      ->check(finiteBetween(100.0, 16000.0, "Hz"))
      ->capture_default_str();
  run->add_option("--duration", o.duration_s,
                  "Length of the run (default: the motion's and 1 s of rest; with pages endless)")
      ->check(finiteBetween(0.001, 86400.0, "s"));
  run->add_option("--record", o.record, "Write every tick to this HDF5 file");
  run->add_option("--report", o.report, "Write a page with plots into this folder");
  run->add_option("--json", o.json, "Write the summary to this file");
  run->add_flag("--simulated-clock", o.simulated_clock, "As fast as it goes, no real time");
  run->add_flag("--no-rehearsal", o.no_rehearsal,
                "Arm without having run the worst contacts first (simulated device only)");
  run->add_flag("--uncertified", o.uncertified,
                "Allow gains that are not certified (simulated device only; recorded)")
      ->excludes(run->add_option("--certificate", o.certificate,
                                 "Run only what this file of `certify --json` says is certified"));
  addPages(*run, o);
  run->footer(
      "An exercise opens the pages and prints their address first. A scene with a motion,\n"
      "--simulated-clock and --no-web open no port (--port opens it for a scene) and write what\n"
      "--record, --report and --json name, or all three into out/run-<time>/.");
  run->callback([&o, run, &code] {
    const bool scene = run->count("--scene") + run->count("--motion") > 0;
    const bool pages = !o.no_web && !o.simulated_clock && (!scene || run->count("--port") > 0);
    if (const Diagnostics faults = mismatched(*run, o, scene, pages); !faults.empty()) {
      code = refuse(faults);
      return;
    }
    if (!scene) chooseExercise(o);
    if (run->count("--rendering") == 0 && !findGains(o.files.device, o.files.rendering, code)) {
      return;
    }
    code = pages ? playCommand(o) : runCommand(o);
  });
}

void addPicture(CLI::App& app, PictureOptions& o, int& code) {
  CLI::App* picture =
      app.add_subcommand("picture", "Draw the hand and what it holds at a moment of a recording");
  picture->add_option("recording", o.recording, "HDF5 file, or black box (.wbb)")->required();
  picture->add_option("--out", o.png, "PNG file to write")->required();
  picture
      ->add_option("--at", o.moment.time_s, "Moment (default: that of the largest contact force)")
      ->check(finiteBetween(0.0, 1e9, "s"));
  picture
      ->add_option("--azimuth", o.moment.azimuth_deg,
                   "Camera about z; 0 looks away from the person")
      ->check(finiteBetween(-360.0, 360.0, "degrees"))
      ->capture_default_str();
  picture->add_option("--elevation", o.moment.elevation_deg, "Camera above the horizon")
      ->check(finiteBetween(-89.0, 89.0, "degrees"))
      ->capture_default_str();
  picture->add_option("--distance", o.moment.distance_m, "Camera from the palm")
      ->check(finiteBetween(0.1, 5.0, "m"))
      ->capture_default_str();
  picture->callback([&o, &code] { code = pictureCommand(o); });
}

void addCertify(CLI::App& app, CertifyOptions& o, int& code) {
  CLI::App* certify = app.add_subcommand(
      "certify", "Are these gains stable with any passive person and object, and by what margin?");
  certify->add_option("--device", o.device, "Device file")->capture_default_str();
  certify->add_option("--rendering", o.rendering,
                      "Gains that go with the device (default: the file of the device's name)");
  certify->add_option("--hand", o.hand, "Hand file")->capture_default_str();
  CLI::Option* exercise = certify->add_option(
      "--exercise", o.exercise,
      "Exercise, a name or a file: its walls are borne, too (default: no walls)");
  certify->add_option("--level", o.level, "Level of the exercise")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str()
      ->needs(exercise);
  certify->add_option("--rate-hz", o.rate_hz, "Ticks a second")
      ->check(finiteBetween(100.0, 16000.0, "Hz"))
      ->capture_default_str();
  certify->add_option("--json", o.json, "Write the certificate to this file");
  certify->add_option("--svg", o.svg,
                      "Draw each axis's Z-width (or felt impedance) into this file");
  CLI::Option* impedance =
      certify->add_flag("--impedance", o.impedance,
                        "Predict and measure what the person feels on every axis, instead");
  impedance->excludes(exercise);
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

void addOthers(CLI::App& app, ReplayOptions& replay, ReportOptions& report,
               ExperimentOptions& experiment, BarExperimentOptions& bar,
               std::vector<std::string>& files, int& code) {
  CLI::App* r = app.add_subcommand("replay", "Play a recording back, or run it again and compare");
  r->add_option("recording", replay.recording, "HDF5 file, or black box (.wbb)")->required();
  r->add_flag("--resimulate", replay.resimulate,
              "Run the recorded inputs again and compare bit by bit (exit code 1: they differ)");
  r->add_option("--extract", replay.extract, "Write the ticks of a black box to this HDF5 file")
      ->excludes("--resimulate");
  r->add_option("--speed", replay.speed, "How fast to play it back")
      ->check(finiteBetween(0.01, 1000.0, "times"))
      ->capture_default_str();
  r->callback([&] { code = replayCommand(replay); });

  CLI::App* p = app.add_subcommand("report", "Make a self-contained HTML page of a recording");
  p->add_option("recording", report.recording, "HDF5 file, or black box (.wbb)")->required();
  p->add_option("--out", report.folder, "Folder to write into")->required();
  p->callback([&] { code = reportCommand(report); });

  CLI::App* e = app.add_subcommand("experiment", "Repeat the paper's experiments");
  e->require_subcommand(1);
  CLI::App* grasping = e->add_subcommand("grasping", "Fig. 5: grasp, carry and hold four shapes");
  CLI::App* timing = e->add_subcommand("timing", "Fig. 6: time of 100,000 ticks while grasping");
  for (CLI::App* sub : {grasping, timing}) {
    sub->add_option("--json", experiment.json, "Write the results to this file");
    sub->add_option("--out", experiment.folder, "Folder for plots, pictures and recordings")
        ->capture_default_str();
  }
  grasping->add_option("--jittered", experiment.jittered, "Number of jittered trials")
      ->check(finiteBetween(0, 10000, ""))
      ->capture_default_str();
  grasping->add_option("--seed", experiment.seed, "Seed of the jitter")
      ->check(wholeNumber())
      ->capture_default_str();
  grasping->add_option("--only", experiment.only, "Only trials whose name contains this");
  timing->add_option("--ticks", experiment.ticks, "Number of ticks")
      ->check(finiteBetween(1000, 1e8, "ticks"))
      ->capture_default_str();
  timing->add_flag("--simulated-clock", experiment.simulated_clock, "As fast as it goes");
  grasping->callback([&] { code = graspingCommand(experiment); });
  timing->callback([&] { code = timingCommand(experiment); });
  addBarExperiments(*e, bar, code);

  CLI::App* v =
      app.add_subcommand("validate", "Every fault of every file, with its place and remedy");
  v->add_option("files", files, "TOML files, or a motion's CSV")->required();
  v->callback([&] { code = validateCommand(files); });

  CLI::App* d = app.add_subcommand("doctor", "Is this machine fit to drive a device?");
  d->callback([&] { code = runDoctor(shippedFile("scripts/packages.txt")); });
}

// What of the command line nobody knew; CLI11 would only say that something else is missing.
std::string unknownWord(const CLI::App& app, const CLI::ParseError& error) {
  if (dynamic_cast<const CLI::RequiredError*>(&error) == nullptr) return {};
  const std::vector<std::string> rest = app.remaining(true);
  return rest.empty() ? std::string{} : rest.front();
}

}  // namespace

int main(int argc, char** argv) {
  std::signal(SIGPIPE, SIG_IGN);  // where nobody reads on, a run still ends with its ramp
  std::setvbuf(stdout, nullptr, _IOLBF, BUFSIZ);  // in order with standard error, also into a file
  CLI::App app{
      "Whole-hand haptic rendering on an off-the-shelf physics engine.\n"
      "Research software, not a certified medical device."};
  app.set_version_flag("--version", std::string("wholehand ") + WHOLEHAND_VERSION);
  app.require_subcommand(1);
  app.option_defaults()->always_capture_default(false);
  int code = kExitDone;
  RunOptions run;
  run.files.scene = shippedFile("config/scenes/four-shapes.toml");
  run.files.hand = shippedFile("config/hands/adult-median-right.toml");
  run.files.device = shippedFile("config/devices/lambda-pride.toml");
  run.files.rendering.clear();
  run.files.patient = shippedFile("config/patients/relaxed-adult.toml");
  run.files.motion = shippedFile("data/human-motion/reach-grasp-00.csv");
  ReplayOptions replay;
  ReportOptions report;
  ExperimentOptions experiment;
  BarExperimentOptions bar;
  std::vector<std::string> files;
  PictureOptions picture;
  addRun(app, run, code);
  CertifyOptions certify{shippedFile("config/devices/lambda-pride.toml"), "",
                         shippedFile("config/hands/adult-median-right.toml")};
  addPicture(app, picture, code);
  addCertify(app, certify, code);
  addOthers(app, replay, report, experiment, bar, files, code);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (const std::string word = unknownWord(app, error); !word.empty()) {
      std::fprintf(
          stderr,
          "'%s' is not a subcommand or option here\nRun with --help for more information.\n",
          word.c_str());
      return kExitBadInput;
    }
    // CLI11 has a code of its own for every mistake; the shell gets one.
    return app.exit(error) == 0 ? kExitDone : kExitBadInput;
  }
  return code;
}
