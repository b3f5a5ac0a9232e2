// Prints a recording as a table: the forces of every tick as CSV on standard output.
//
// Without a file it first records half a second of the shipped hand at rest, so that there is
// something to read.
//
//   03_read_a_recording [recording.h5] > forces.csv
#include "wholehand/recording.hpp"
#include "wholehand/wholehand.hpp"

#include <cstdio>
#include <filesystem>
#include <string>
#include <unistd.h>

using namespace wholehand;

Expected<RunOutcome> recordHalfASecond(const std::string& path) {
  const std::string config = WHOLEHAND_SOURCE_DIR "/config/";
  auto models = loadModels({.scene = config + "scenes/empty.toml",
                            .hand = config + "hands/adult-median-right.toml",
                            .device = config + "devices/lambda-pride.toml",
                            .rendering = config + "rendering/lambda-pride.toml",
                            .patient = config + "patients/relaxed-adult.toml"});
  if (!models) return models.errors();
  AxisPosition begin(models->device.axisCount()), end = begin;
  end[models->device.axisIndex("x")] = 0.05;
  auto rig = buildRig(*models, Intention::throughWaypoints({{0.0, begin}, {0.4, end}}), {});
  if (!rig) return rig.errors();
  const InterruptScope signals;  // Ctrl-C ends the run gently
  RunPlan plan;
  plan.interrupts = &InterruptScope::shared();
  plan.title = "Half a second, 50 mm forward";
  plan.duration_ticks = 500;
  plan.record = path;
  plan.simulated_clock = true;  // runs as fast as possible
  return runAndRecord(**rig, plan);
}

int main(int argc, char** argv) {
  std::string path = argc > 1 ? argv[1] : "";
  const bool own = path.empty();
  if (own) {
    path =
        std::filesystem::temp_directory_path() / ("wholehand-example-" + std::to_string(getpid()));
    if (auto run = recordHalfASecond(path); !run) {
      return std::fprintf(stderr, "%s\n", format(run.errors()).c_str()), 2;
    }
  }
  auto reader = RecordingReader::open(path);
  if (!reader) return std::fprintf(stderr, "%s\n", format(reader.errors()).c_str()), 2;
  const RecordingMeta& meta = (*reader)->meta();
  std::fprintf(stderr, "%s: %llu ticks of %g s, engine %s, version %s\n", meta.title.c_str(),
               static_cast<unsigned long long>((*reader)->size()), meta.period_s,
               meta.engine.c_str(), meta.git_version.c_str());

  // One column per axis, then one line per tick.
  std::printf("time_s");
  for (std::size_t a = 0; a < meta.axis_names.size(); ++a) {
    std::printf(",%s_%s", meta.axis_names[a].c_str(), meta.axis_units[a] == "m" ? "n" : "nm");
  }
  std::printf("\n");
  TickRecord record;
  for (std::uint64_t i = 0; (*reader)->read(i, record); ++i) {
    std::printf("%.4f", record.time_s);
    for (double effort : record.sent) std::printf(",%.6g", effort);
    std::printf("\n");
  }
  if (own) std::filesystem::remove(path);
}
