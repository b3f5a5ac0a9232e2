// Measures the time of MuJoCo alone for the shipped hand, which follows a motion recorded with
// Bullet:
//
//   mujoco_steps CONFIG MOTION THREADS ROUNDS
//
// CONFIG: folder of the shipped files, whose scene is four-shapes. MOTION: little-endian doubles,
// written by bench/steps_per_second.py: for each body of the scene position [m] and orientation x,
// y, z, w at the beginning, then q_s and its speeds before each tick. A tick is one mj_step() with
// MuJoCo's own solver, without the device, patient, coupling and safety of a rig. Every thread has
// its own copy of the same world. Prints the ticks per second of all threads in the fastest round,
// and the share of ticks with contacts.
#include "lab/mujoco/hand_map.hpp"
#include "lab/mujoco/model_text.hpp"
#include "lab/mujoco/mujoco_engine.hpp"
#include "rig/models.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <string>
#include <thread>
#include <vector>

using namespace wholehand;

namespace {

constexpr int kPoseNumbers = 7;
// MuJoCo's default settings, not those that ADR 39 uses with a person.
constexpr mujoco::SolverSettings kStock{
    .iterations = 100, .tolerance = 1e-8, .impedance = 0.95, .friction_ratio = 1.0};
using Model = std::unique_ptr<mjModel, mujoco::Deleter>;
using Data = std::unique_ptr<mjData, mujoco::Deleter>;

struct Tick {
  AxisPosition q;
  AxisVelocity qd;
};
struct Motion {
  std::vector<std::array<double, kPoseNumbers>> bodies;
  std::vector<Tick> ticks;
};

template <class Numbers>
bool read(std::ifstream& in, Numbers& numbers) {
  in.read(reinterpret_cast<char*>(numbers.data()), numbers.size() * sizeof(double));
  return static_cast<bool>(in);
}

Motion readMotion(const std::string& path, const Models& models) {
  std::ifstream in(path, std::ios::binary);
  Motion motion;
  motion.bodies.resize(models.scene.bodies.size());
  for (auto& pose : motion.bodies) (void)read(in, pose);
  const int axes = models.hand.axis_count;
  for (Tick tick{AxisPosition(axes), AxisVelocity(axes)}; read(in, tick.q) && read(in, tick.qd);) {
    motion.ticks.push_back(tick);
  }
  return motion;
}

Model compile(const Models& models, std::string& error) {
  const std::string text = mujoco::modelText(models.hand, models.scene, kStock);
  const auto files = std::make_unique<mjVFS>();
  mj_defaultVFS(files.get());
  mj_makeEmptyFileVFS(files.get(), "hand.xml", static_cast<int>(text.size()));
  std::copy(text.begin(), text.end(), static_cast<char*>(files->filedata[0]));
  error.resize(500);
  Model model(mj_loadXML("hand.xml", files.get(), error.data(), static_cast<int>(error.size())));
  mj_deleteVFS(files.get());
  if (model) model->opt.timestep = 1e-3;
  return model;
}

Data begin(const mjModel& model, const Motion& motion) {
  Data data(mj_makeData(&model));
  for (std::size_t i = 0; i < motion.bodies.size(); ++i) {
    const auto& pose = motion.bodies[i];
    const int id = mj_name2id(&model, mjOBJ_BODY, mujoco::bodyName(static_cast<int>(i)).c_str());
    const int mocap = model.body_mocapid[id];
    double* at = mocap >= 0 ? data->mocap_pos + 3 * mocap
                            : data->qpos + model.jnt_qposadr[model.body_jntadr[id]];
    double* turned = mocap >= 0 ? data->mocap_quat + 4 * mocap : at + 3;
    std::copy_n(pose.data(), 3, at);
    turned[0] = pose[6];
    std::copy_n(pose.data() + 3, 3, turned + 1);
  }
  return data;
}

// Runs the motion once. Returns the number of ticks with contacts.
int run(const mjModel& model, const mujoco::HandMap& map, const Motion& motion, mjData& data) {
  int touching = 0;
  for (const Tick& tick : motion.ticks) {
    map.put(data, tick.q, tick.qd);
    mj_step(&model, &data);
    touching += data.ncon > 0 ? 1 : 0;
  }
  return touching;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 5) return EXIT_FAILURE;
  const std::string config = argv[1];
  const int threads = std::atoi(argv[3]), rounds = std::atoi(argv[4]);
  ModelFiles files;
  for (std::string* file :
       {&files.scene, &files.hand, &files.device, &files.rendering, &files.patient}) {
    *file = config + file->substr(file->find('/'));
  }
  const auto models = loadModels(files);
  if (!models) return std::fprintf(stderr, "%s\n", format(models.errors()).c_str()), EXIT_FAILURE;
  const Motion motion = readMotion(argv[2], *models);
  std::string error;
  const Model model = compile(*models, error);
  if (!model) return std::fprintf(stderr, "%s\n", error.c_str()), EXIT_FAILURE;
  const mujoco::HandMap map(models->hand, *model);

  // Runs all threads in each round and keeps the fastest round.
  double best_s = 1e9;
  int touching = 0;
  for (int round = 0; round < rounds; ++round) {
    std::vector<Data> worlds;
    for (int i = 0; i < threads; ++i) worlds.push_back(begin(*model, motion));
    const auto began = std::chrono::steady_clock::now();
    {
      std::vector<std::jthread> others;
      for (int i = 1; i < threads; ++i) {
        others.emplace_back([&, i] { (void)run(*model, map, motion, *worlds[i]); });
      }
      touching = run(*model, map, motion, *worlds[0]);
    }
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - began;
    best_s = std::min(best_s, took.count());
  }
  const auto ticks = static_cast<double>(motion.ticks.size());
  std::printf("%.17g %.17g\n", threads * ticks / best_s, touching / ticks);
  return EXIT_SUCCESS;
}
