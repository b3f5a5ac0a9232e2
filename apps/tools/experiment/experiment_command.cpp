#include "apps/tools/experiment/experiment_command.hpp"

#include "apps/wholehand/shared/exit_code.hpp"
#include "apps/wholehand/shared/options.hpp"
#include "apps/wholehand/shared/shipped_files.hpp"
#include "apps/wholehand/shared/tools.hpp"

#include <CLI/CLI.hpp>

namespace wholehand {
namespace {

void addFiles(CLI::App& command, BarFiles& files) {
  command.add_option("--exercise", files.exercise,
                     "Exercise file, or the name of a shipped one (default: cocktail-bar)");
  command.add_option("--hand", files.hand, "Hand file");
  command.add_option("--device", files.device, "Device file");
  command.add_option("--rendering", files.rendering,
                     "Gains that go with the device (default: the file of the device's name)");
  command.add_option("--patient", files.patient, "Virtual patient");
}

std::string orShipped(const std::string& named, const char* shipped) {
  return named.empty() ? shippedFile(shipped) : named;
}

/// The experiments in the cocktail bar.
void addBarExperiments(CLI::App& experiment, BarExperimentOptions& options, int& code) {
  CLI::App* bar = experiment.add_subcommand(
      "cocktail-bar", "Every level of the cocktail bar, played by many virtual patients");
  CocktailOptions& c = options.cocktail;
  bar->add_option("--seeds", c.seeds, "Patients a level: start, aim and strength differ")
      ->check(wholeBetween(1, 100000))
      ->capture_default_str();
  bar->add_option("--first-seed", c.first_seed, "Seed of the first one")
      ->check(wholeNumber())
      ->capture_default_str();
  bar->add_option("--level", c.level, "Only this level (default: all)")
      ->check(wholeBetween(1, 1000));
  bar->add_option("--processes", c.processes, "Processes at a time (default: one for each core)")
      ->check(wholeBetween(1, 256));
  bar->add_option("--set", c.parameters, "A live parameter and its value, repeatable")
      ->type_name("NAME VALUE");
  bar->add_option("--json", c.json, "Write the results to this file");
  addEngine(*bar, c.engine);
  addFiles(*bar, c.files);
  bar->footer("On the simulated clock, faster than real time; opens no port.");
  bar->callback([&] { code = cocktailCommand(options.cocktail); });

  CLI::App* exercise = experiment.add_subcommand(
      "exercise", "Fig. 7: bump into the dispenser, approach, squeeze, let go");
  ExerciseOptions& e = options.exercise;
  exercise->add_option("--seed", e.seed, "Seed of the patient's start and aim")
      ->check(wholeNumber())
      ->capture_default_str();
  exercise->add_option("--json", e.json, "Write the results to this file");
  exercise->add_option("--record", e.record, "Write every tick to this HDF5 file");
  exercise->add_option("--charts", e.charts, "Draw the figure into this HTML file");
  exercise->add_option("--out", e.folder, "Folder for what is not named")->capture_default_str();
  addEngine(*exercise, e.engine);
  addFiles(*exercise, e.files);
  exercise->footer("On the simulated clock; opens no port.");
  exercise->callback([&] { code = exerciseCommand(options.exercise); });

  CLI::App* liquids = experiment.add_subcommand(
      "liquids", "What a fingertip feels of every liquid, device included");
  LiquidsOptions& l = options.liquids;
  liquids->add_option("--json", l.json, "Write the results to this file");
  liquids->add_option("--out", l.folder, "Folder for results and chart")->capture_default_str();
  addFiles(*liquids, l.files);
  liquids->footer("On the simulated clock; opens no port.");
  liquids->callback([&] { code = liquidsCommand(options.liquids); });

  CLI::App* thresholds = experiment.add_subcommand(
      "thresholds", "Thresholds of feeling: how well they are found, or that of a file of answers");
  ThresholdsOptions& t = options.thresholds;
  thresholds->add_option("--answers", t.answers, "Answers of each block")
      ->check(wholeBetween(10, 80))
      ->capture_default_str();
  thresholds->add_option("--blocks", t.blocks, "Blocks of each virtual observer")
      ->check(wholeBetween(1, 1000000))
      ->capture_default_str();
  thresholds->add_option("--seed", t.seed, "Seed of the observers")
      ->check(wholeNumber())
      ->capture_default_str();
  thresholds->add_option("--fit", t.fit,
                         "Fit this CSV file: x,other,said_second,is_catch; x = ln(second / first)");
  thresholds->add_option("--json", t.json, "Write the results to this file");
  thresholds->callback([&] { code = thresholdsCommand(options.thresholds); });
}

void addTouch(CLI::App& experiment, TouchOptions& options, int& code) {
  CLI::App* touch = experiment.add_subcommand(
      "touch", "Move every joint of an object through its range with a fingertip");
  touch->add_option("files", options.files, "URDFs or scenes")->required();
  touch->add_option("--json", options.json, "Write the results to this file");
  addEngine(*touch, options.engine);
  touch->footer("Exit code 0: every joint moves through its range; 1: not; 2: a bad file.");
  touch->callback([&] { code = touchCommand(options); });
}

void addComplexity(CLI::App& larger, ExperimentOptions& o) {
  larger.add_option("--only", o.only,
                    "Only what contains this: pile, stacks, apart, far, vertices, contacts");
  larger.add_option("--ticks", o.scene_ticks, "Ticks of each scene")
      ->check(wholeBetween(100, 1000000))
      ->capture_default_str();
  larger
      .add_option("--passes", o.passes, "Runs of each scene; the shortest time of each tick counts")
      ->check(wholeBetween(1, 100))
      ->capture_default_str();
}

}  // namespace

Expected<ModelFiles> barModelFiles(const BarFiles& files) {
  ModelFiles out;
  out.scene.clear();  // the exercise names its scene
  out.exercise = exerciseFile(files.exercise.empty() ? "cocktail-bar" : files.exercise);
  out.hand = orShipped(files.hand, "config/hands/adult-median-right.toml");
  out.device = orShipped(files.device, "config/devices/lambda-pride.toml");
  out.patient = orShipped(files.patient, "config/patients/relaxed-adult.toml");
  out.rendering = files.rendering;
  if (!out.rendering.empty()) return out;
  auto rendering = renderingFor(out.device);
  if (!rendering) return rendering.errors();
  out.rendering = *rendering;
  return out;
}

void addExperiments(CLI::App& app, ExperimentOptions& experiment, BarExperimentOptions& bar,
                    int& code) {
  CLI::App* e = app.add_subcommand("experiment", toolHelp("experiment"));
  e->require_subcommand(1);
  CLI::App* grasping = e->add_subcommand("grasping", "Fig. 5: grasp, carry and hold four shapes");
  CLI::App* timing =
      e->add_subcommand("timing", "Fig. 6: time of 100,000 ticks while grasping in the bar");
  CLI::App* compared =
      e->add_subcommand("engines", "Compare every engine built in: time, slip, forces, noise");
  CLI::App* larger =
      e->add_subcommand("complexity", "Measure the time of a tick in larger and larger scenes");
  for (CLI::App* sub : {grasping, timing, larger}) addEngine(*sub, experiment.engine);
  for (CLI::App* sub : {grasping, timing, compared, larger}) {
    sub->add_option("--json", experiment.json, "Write the results to this file");
    sub->add_option("--out", experiment.folder, "Folder for plots, pictures and recordings")
        ->capture_default_str();
  }
  grasping->add_option("--jittered", experiment.jittered, "Number of jittered trials")
      ->check(wholeBetween(0, 10000))
      ->capture_default_str();
  grasping->add_option("--seed", experiment.seed, "Seed of the jitter")
      ->check(wholeNumber())
      ->capture_default_str();
  grasping->add_option("--only", experiment.only, "Only trials whose name contains this");
  timing->add_option("--ticks", experiment.ticks, "Number of ticks")
      ->check(wholeBetween(1000, 100000000))
      ->capture_default_str();
  timing->add_option("--scene", experiment.scene,
                     "Grasp the first movable body of this scene, without an exercise");
  timing->add_flag("--simulated-clock", experiment.simulated_clock,
                   "Run as fast as possible, not in real time");
  compared->add_option("--hold", experiment.hold_s, "How long the cylinder is held")
      ->check(finiteBetween(0.1, 60, "seconds"))
      ->capture_default_str();
  compared->add_option("--ticks", experiment.ticks, "Ticks in which the cylinder is gripped")
      ->check(wholeBetween(1000, 1000000))
      ->capture_default_str();
  compared->add_option("--rates-hz", experiment.rates_hz, "Ticks a second, one comparison each")
      ->check(finiteBetween(250, 8000, "Hz"))
      ->delimiter(',')
      ->capture_default_str();
  addComplexity(*larger, experiment);
  larger->callback([&] { code = complexityCommand(experiment); });
  compared->callback([&] { code = enginesCommand(experiment); });
  grasping->callback([&] { code = graspingCommand(experiment); });
  timing->callback([&] { code = timingCommand(experiment); });
  addBarExperiments(*e, bar, code);
  addTouch(*e, bar.touch, code);
}

#ifndef WHOLEHAND_LAB
int enginesCommand(const ExperimentOptions& /*options*/) {
  return refuse({{"", 0, "experiment", "engines", "is not built into this program", kLabRemedy}});
}
#endif

}  // namespace wholehand
