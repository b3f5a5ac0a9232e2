// Steps a simulated rig from C++, for comparison with wholehand.Rig:
//   rig_steps session|loop CONFIG TICKS AIMS OUT
// CONFIG: folder of the shipped files. AIMS: rows of little-endian doubles, one value for each
// axis; each row is the aim of the next TICKS ticks. OUT: q_m, q_s and sent after each row.
// `session` uses the program's own Session and is the reference for bit-identical results. `loop`
// calls tick() alone, is the reference for time, and prints the CPU seconds of the loop.
#include "loop/patient/steered_player.hpp"
#include "loop/realtime/thread_setup.hpp"
#include "loop/runtime/session.hpp"
#include "rig/models.hpp"
#include "rig/rig.hpp"
#include "support/player_commands.hpp"

#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <memory>
#include <string>
#include <utility>
#include <vector>

using namespace wholehand;

namespace {

using Aims = std::vector<AxisPosition>;

Aims readAims(const std::string& path, int axes) {
  Aims aims;
  std::ifstream in(path, std::ios::binary);
  AxisPosition aim(axes);
  while (in.read(reinterpret_cast<char*>(aim.data()), axes * sizeof(double))) aims.push_back(aim);
  return aims;
}

void write(std::ofstream& out, const TickRecord& record) {
  const auto put = [&](const auto& values) {
    out.write(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(double));
  };
  put(record.q_m);
  put(record.q_s);
  put(record.sent);
}

void runSession(Rig& rig, const Aims& aims, std::uint64_t ticks, std::ofstream& out) {
  SessionConfig config;
  config.listener = rig.listener.get();
  config.duration_ticks = ticks * aims.size() + 1;
  Session session(*rig.renderer, config);
  (void)session.tryCommand(test::steer(Steering::kPerson));
  (void)session.tryCommand(test::aim(aims[0]));
  session.runSimulated([&](const TickRecord& record) {
    const std::uint64_t row = (record.tick + 1) / ticks;
    if ((record.tick + 1) % ticks != 0 || row > aims.size()) return;
    write(out, record);
    if (row < aims.size()) (void)session.tryCommand(test::aim(aims[row]));
  });
}

double cpu_s() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

void runLoop(Rig& rig, const Aims& aims, std::uint64_t ticks, std::ofstream& out) {
  TickRecord record;
  std::uint64_t next = 0;
  const double began_s = cpu_s();
  for (const AxisPosition& aim : aims) {
    const DenormalsFlushed scope;
    record.command_count = 0;
    if (next == 0) record.commands[record.command_count++] = test::steer(Steering::kPerson);
    record.commands[record.command_count++] = test::aim(aim);
    for (std::uint64_t i = 0; i < ticks; ++i) {
      record.tick = next++;
      record.time_s = static_cast<double>(record.tick) * rig.options.period_s;
      rig.listener->beforeTick(record);
      rig.renderer->tick(1, record);
      rig.listener->afterTick(record);
      record.command_count = 0;
    }
  }
  std::printf("%.9f\n", cpu_s() - began_s);
  write(out, record);
}

int fail(const Diagnostics& why) {
  return std::fprintf(stderr, "%s\n", format(why).c_str()), 2;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 6) return std::fprintf(stderr, "five arguments; see rig_steps.cpp\n"), 2;
  const std::string config = argv[2];
  auto models =
      loadModels({config + "/scenes/four-shapes.toml", config + "/hands/adult-median-right.toml",
                  config + "/devices/lambda-pride.toml", config + "/rendering/lambda-pride.toml",
                  config + "/patients/relaxed-adult.toml",
                  config + "/../data/human-motion/reach-grasp-00.csv", "", 1});
  if (!models) return fail(models.errors());
  auto player = std::make_unique<SteeredPlayer>(makeMotionPlayer(*models), models->device);
  const int axes = models->device.axisCount();
  auto rig = buildRig(std::move(*models), std::move(player), RigOptions{});
  if (!rig) return fail(rig.errors());
  if (auto armed = (*rig)->renderer->arm(); !armed) return fail(armed.errors());
  const Aims aims = readAims(argv[4], axes);
  if (aims.empty()) return std::fprintf(stderr, "%s: no aims\n", argv[4]), 2;
  std::ofstream out(argv[5], std::ios::binary);
  const std::uint64_t ticks = std::strtoull(argv[3], nullptr, 10);
  if (argv[1] == std::string("session")) {
    runSession(**rig, aims, ticks, out);
  } else {
    runLoop(**rig, aims, ticks, out);
  }
  return out.good() ? 0 : 1;
}
