#include "run_line.hpp"

#include "engine_option.hpp"
#include "exit_code.hpp"
#include "number_option.hpp"
#include "pages.hpp"
#include "play_command.hpp"
#include "shipped_files.hpp"

namespace wholehand {
namespace {

// Chooses the bar if no exercise is named.
void chooseExercise(RunOptions& o) {
  o.files.motion.clear();
  o.files.exercise = exerciseFile(o.files.exercise.empty() ? "cocktail-bar" : o.files.exercise);
}

const char* deviceOption(const RunOptions& o) {
  return o.host.empty() ? "--driver" : "--host";
}

// Options that would have no effect.
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
  for (const char* door : {"--port", "--address", "--token", "--token-file", "--origin", "--udp",
                           "--udp-key", "--wait"}) {
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
  for (const char* simulated : {"--no-rehearsal", "--uncertified", "--simulated-clock"}) {
    if (!isRealDevice(o) || run.count(simulated) == 0) continue;
    faults.push_back(
        {"", 0, simulated, "",
         std::string("is for simulated devices, and ") + deviceOption(o) + " names a real one",
         "leave one of them out"});
  }
  if (o.without_passport && !isRealDevice(o)) {
    faults.push_back({"", 0, "--without-passport", "", "is about a real device, and none is named",
                      "leave it out, or give --driver or --host"});
  }
  if (isRealDevice(o) && !pages) {
    faults.push_back({"", 0, deviceOption(o), o.host.empty() ? o.driver.path : o.host,
                      "needs the console: a person arms and stops",
                      "leave out --no-web, --scene and --motion"});
  }
  if (run.count("--udp-key") > 0 && run.count("--udp") == 0) {
    faults.push_back({"", 0, "--udp-key", "", "needs the port that it opens", "give --udp, too"});
  }
  return faults;
}

void addPages(CLI::App& run, RunOptions& o) {
  run.add_option("--port", o.port, "Port of the pages; 0: any free one")
      ->check(CLI::Range(0, 65535))
      ->capture_default_str();
  run.add_option("--address", o.address,
                 "Address to listen at; any that other machines can reach needs --token")
      ->capture_default_str();
  run.add_option("--token", o.tokens,
                 "Secret that clients must show, at least 16 characters; for one role only: "
                 "therapist=..., player=..., watcher=... (others read it in the list of processes: "
                 "prefer --token-file)");
  run.add_option("--token-file", o.token_file,
                 "File with a token on each line, as for --token (default: those of the variable "
                 "WHOLEHAND_TOKEN, separated by commas)");
  run.add_option("--origin", o.origins, "Pages of other origins that may connect");
  run.add_option("--udp", o.udp,
                 "Port for game engines, or address:port; 0: any port (default: closed)");
  run.add_option("--udp-key", o.udp_key,
                 "Key of a game or microcontroller that speaks UDP only: 16 hexadecimal digits");
  run.add_flag("--no-web", o.no_web, "Open no port");
  run.add_flag("--wait", o.wait, "Arm only when a client asks for it");
}

}  // namespace

RunOptions shippedRun() {
  RunOptions run;
  run.files.scene = shippedFile("config/scenes/four-shapes.toml");
  run.files.hand = shippedFile("config/hands/adult-median-right.toml");
  run.files.device = shippedFile("config/devices/lambda-pride.toml");
  run.files.rendering.clear();
  run.files.patient = shippedFile("config/patients/relaxed-adult.toml");
  run.files.motion = shippedFile("data/human-motion/reach-grasp-00.csv");
  return run;
}

void addRun(CLI::App& app, RunOptions& options, int& code) {
  RunOptions& o = options;
  CLI::App* run = app.add_subcommand(
      "run", "Run an exercise with its pages (the cocktail bar), or play a recorded motion");
  run->add_option("--exercise", o.files.exercise,
                  "Exercise: a name (cocktail-bar, the default; free-grasping ...) or a file");
  run->add_option("--level", o.files.level, "Level of the exercise")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  run->add_option("--seed", o.seed, "Seed of the virtual patient")
      ->check(wholeNumber())
      ->capture_default_str();
  run->add_option("--scene", o.files.scene, "Scene file, without exercise: free grasping")
      ->capture_default_str();
  run->add_option("--hand", o.files.hand, "Hand file")->capture_default_str();
  run->add_option("--device", o.files.device, "Device file")->capture_default_str();
  CLI::Option* driver = run->add_option(
      "--driver", o.driver.path, "Driver of a real device (docs/drivers.md): a name or a path");
  run->add_option("--device-at", o.driver.locator,
                  "Which device, as the driver names it: a serial number, a port ...")
      ->needs(driver);
  run->add_option("--driver-settings", o.driver.settings, "The driver's own settings")
      ->needs(driver);
  run->add_option("--host", o.host, "Name of the `wholehand device-host` that holds a real device")
      ->excludes(driver);
  run->add_flag("--without-passport", o.without_passport,
                "Take a real device that was not commissioned; NOBODY MAY BE ATTACHED (recorded)");
  run->add_option("--rendering", o.files.rendering,
                  "Gains that go with the device (default: the file of the device's name)");
  run->add_option("--patient", o.files.patient, "Virtual patient file")->capture_default_str();
  run->add_option("--motion", o.files.motion, "Recorded motion to play in the scene, CSV")
      ->capture_default_str();
  addEngine(*run, o.engine);
  run->add_option("--rate-hz", o.rate_hz, "Ticks a second")
      ->check(finiteBetween(100.0, 16000.0, "Hz"))
      ->capture_default_str();
  run->add_option("--duration", o.duration_s,
                  "Length of the run (default: the motion's and 1 s of rest; with pages endless)")
      ->check(finiteBetween(0.001, 86400.0, "s"));
  run->add_option("--record", o.record, "Write every tick to this HDF5 file");
  run->add_option("--report", o.report, "Write the report into this folder");
  run->add_option("--json", o.json, "Write the summary to this file");
  run->add_flag("--simulated-clock", o.simulated_clock,
                "Run as fast as possible, not in real time");
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
    if (auto read = pages ? readTokens(o.token_file, o.tokens) : Expected<Done>(Done{}); !read) {
      code = refuse(read.errors());
      return;
    }
    code = pages ? playCommand(o) : runCommand(o);
  });
}

}  // namespace wholehand
