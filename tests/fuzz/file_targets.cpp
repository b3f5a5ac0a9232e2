#include "devices/passport/passport.hpp"
#include "devices/passport/sealed_file.hpp"
#include "exercises/load_exercise.hpp"
#include "files/device/device_file.hpp"
#include "files/device/rendering_file.hpp"
#include "files/hand/hand_file.hpp"
#include "files/mesh/convex_mesh.hpp"
#include "files/mesh/mesh_file.hpp"
#include "files/mesh_samples.hpp"
#include "files/patient/motion_file.hpp"
#include "files/patient/patient_file.hpp"
#include "files/scene/scene_file.hpp"
#include "fuzz_targets.hpp"
#include "loop/model/device_model.hpp"
#include "loop/model/patient_config.hpp"
#include "loop/model/rendering_config.hpp"
#include "loop/model/scene_model.hpp"
#include "loop/patient/motion.hpp"
#include "station/profiles.hpp"
#include "support/file_bytes.hpp"
#include "support/folder.hpp"
#include "support/mocap_files.hpp"

#include <algorithm>
#include <filesystem>
#include <memory>

namespace wholehand::test {
namespace {

constexpr std::size_t kMostFaults = 20;  // of one file; one more line says how many were left out

const std::string kSource = WHOLEHAND_SOURCE_DIR;

/// A stand with a tree of joints, one that follows, and what public files write for no end.
constexpr const char* kTree =
    R"(<robot name="r"><link name="stand"><collision><geometry><box size="0.4 0.3 0.6"/></geometry>
</collision></link><link name="one"><contact><lateral_friction value="0.5"/></contact><inertial>
<mass value="0.1"/><inertia ixx="1e-3" iyy="1e-3" izz="1e-3" iyx="0"/></inertial><collision>
<origin xyz="0.2 0 0" rpy="0 0 1"/><geometry><capsule radius="0.02" length="0.1"/></geometry>
</collision><visual><geometry><sphere radius="0.05"/></geometry></visual></link><link name="bare"/>
<link name="two"><collision><geometry><cylinder radius="0.02" length="0.1"/></geometry></collision>
</link><joint name="a" type="revolute"><parent link="stand"/><child link="one"/>
<origin xyz="0.2 0 0"/><axis xyz="0 0 1"/><limit lower="0.2" upper="1.5"/>
<dynamics damping="0.1" friction="100"/></joint><joint name="b" type="prismatic">
<parent link="one"/><child link="bare"/><axis xyz="1 0 0"/><limit lower="-15" upper="15"/>
<safety_controller soft_lower_limit="-0.5"/></joint><joint name="c" type="continuous">
<parent link="bare"/><child link="two"/><axis xyz="0 1 0"/><mimic joint="a" multiplier="-0.5"/>
</joint><gazebo reference="one"><mu1>0.7</mu1></gazebo></robot>)";

using Load = std::function<Diagnostics(const std::string& path)>;

template <class T>
Diagnostics faultsOf(const Expected<T>& loaded) {
  return loaded ? Diagnostics{} : loaded.errors();
}

std::string wrongWith(const Diagnostics& faults) {
  if (faults.size() > kMostFaults + 1) return "lists " + std::to_string(faults.size()) + " faults";
  for (const Diagnostic& fault : faults) {
    if (fault.problem.empty()) return "a refusal without a problem";
    if (fault.remedy.empty()) return "a refusal without a remedy: " + format(fault);
  }
  return "";
}

/// A target whose bytes are a file of this name, with the shipped scenes beside its folder.
FuzzTarget fileTarget(const std::string& target, const std::vector<std::string>& good,
                      const std::string& file, const Load& load) {
  const auto folder = std::make_shared<Folder>();
  const std::string path = folder->write(file, "");
  std::filesystem::create_symlink(kSource + "/config/scenes", folder->file("scenes"));
  return {target, good, [folder, path, load](const std::string& bytes) {
            writeBytes(path, bytes);
            return wrongWith(load(path));
          }};
}

FuzzTarget tomlTarget(const std::string& kind, const std::string& file, const Load& load) {
  return fileTarget("toml-" + kind, {bytesOfFile(kSource + "/config/" + file)}, "a.toml", load);
}

const DeviceModel& device() {
  static const DeviceModel model =
      loadDeviceFile(kSource + "/config/devices/lambda-pride.toml").value();
  return model;
}

const HandModel& hand() {
  static const HandModel model =
      assembleHand(loadHandFile(kSource + "/config/hands/adult-median-right.toml").value(),
                   device())
          .value();
  return model;
}

/// A passport from commissioning, changed by somebody who can compute its seal.
FuzzTarget passportTarget() {
  Passport passport;
  passport.identity = {.serial = "S-1", .firmware = "1.0", .sdk = "7", .driver_sha256 = {}};
  passport.driver = "test";
  passport.device = device().name;
  passport.device_sha256 = std::string(64, 'a');
  passport.operator_name = "A. \"B\"";
  passport.measured_at.at = std::chrono::sys_days{std::chrono::days{20'000}};
  for (const DeviceAxis& axis : device().axes) {
    PassportAxis measured;
    measured.name = axis.name;
    measured.kind = axis.kind;
    measured.mass = {0.98 * axis.mass, 1.02 * axis.mass};
    measured.damping = {0.95 * axis.damping, 1.05 * axis.damping};
    passport.axes.push_back(measured);
  }
  const std::string sealed = passportText(passport);
  return fileTarget("toml-passport", {sealed.substr(0, sealed.find("[seal]"))}, "a.toml",
                    [](const std::string& path) {
                      const std::string text = bytesOfFile(path);
                      writeBytes(path, seal(text));
                      return faultsOf(readPassport(path));
                    });
}

FuzzTarget profileTarget() {
  const std::string good =
      "kind = \"profile\"\nversion = 1\nname = \"old\"\ndevice = \"lambda-pride\"\n"
      "side = \"right\"\nhand = \"man-p50-right\"\nexercise = \"cocktail-bar\"\nlevel = 3\n"
      "help = \"some\"\n\n[parameters]\nlead_in_m = 0.004\n";
  return fileTarget("toml-profile", {good}, "old.toml", [](const std::string& path) {
    return faultsOf(Profiles(std::filesystem::path(path).parent_path()).load("old"));
  });
}

FuzzTarget exerciseTarget() {
  std::vector<std::string> good;
  for (const char* name : {"cocktail-bar", "squeeze-to-level", "free-grasping"}) {
    good.push_back(bytesOfFile(kSource + "/config/exercises/" + name + ".toml"));
  }
  return fileTarget("toml-exercise", good, "exercises/a.toml", [](const std::string& path) {
    return faultsOf(loadExercise(path, 1, device(), hand()));
  });
}

/// A mesh file of that kind, read in this process, and its collider.
FuzzTarget meshTarget(const std::string& ending) {
  std::vector<std::string> good;
  for (const auto& [kind, bytes] : meshSamples()) {
    if (kind == ending) good.push_back(bytes);
  }
  return fileTarget("mesh-" + ending, good, "a." + ending, [](const std::string& path) {
    const Expected<MeshFile> file = readMeshHere(path);
    return file ? faultsOf(meshCollider(*file)) : file.errors();
  });
}

std::string firstLines(const std::string& text, std::size_t bytes) {
  return text.substr(0, text.rfind('\n', std::min(text.size() - 1, bytes)) + 1);
}

}  // namespace

std::vector<FuzzTarget> fileTargets() {
  std::vector<FuzzTarget> targets = {
      tomlTarget("device", "devices/lambda-pride.toml",
                 [](const std::string& p) { return faultsOf(loadDeviceFile(p)); }),
      tomlTarget("hand", "hands/adult-median-right.toml",
                 [](const std::string& p) { return faultsOf(loadHandFile(p)); }),
      tomlTarget("rendering", "rendering/lambda-pride.toml",
                 [](const std::string& p) { return faultsOf(loadRenderingFile(p, device())); }),
      tomlTarget("patient", "patients/spastic-fist.toml",
                 [](const std::string& p) { return faultsOf(loadPatientFile(p, device())); }),
      tomlTarget("scene", "scenes/cocktail-bar.toml",
                 [](const std::string& p) { return faultsOf(loadSceneFile(p)); }),
      exerciseTarget(),
      profileTarget(),
      passportTarget(),
      fileTarget(
          "csv",
          {firstLines(bytesOfFile(kSource + "/data/human-motion/reach-grasp-00.csv"), 4096),
           std::string("# columns: Wrist Position X = x, up = z\n") + kMotive,
           std::string("# columns: RWRI X = x_mm\n") + kNexus,
           "sep=;\nTime (s);x (mm)\n0,00;1,5\n0,01;2,5\n",
           "# columns: X = x_m, Part = only 1, rate_hz = "
           "9\nFrame,Part,X\n0,1,2\n0,2,3\n1,1,2\n1,2,3\n",
           "time_s\tx_m\ty_m\n0\t0,5\t1\n1\t0,5\t1\n",
           "#timestamp,Hand x,Hand y,Hand z,qx,qy,qz,qw\n5,1,2,3,0,0,0,1\n6,nan,2,3,0,0,0,1\n",
           "Objects\n100\n,,A:B,,,,,,\nFrame,Sub Frame,RX,RY,RZ,RW,TX,TY,TZ,\n,,,,,,mm,mm,mm,\n"
           "1,0,0,0,0,1,1,2,3,\n2,0,0,0,0,1,1,2,3,\n"},
          "a.csv", [](const std::string& p) { return faultsOf(loadMotionFile(p)); }),
      fileTarget("urdf", {bytesOfFile(kSource + "/config/scenes/assets/mug.urdf"), kTree}, "a.urdf",
                 [](const std::string& p) { return faultsOf(loadSceneFile(p)); })};
  for (const char* ending : {"stl", "obj", "ply", "dae", "glb"}) {
    targets.push_back(meshTarget(ending));
    targets.back().sampled = 100;
  }
  for (FuzzTarget& target : targets) {
    if (target.name.starts_with("toml-")) target.full = 20'000;
  }
  return targets;
}

}  // namespace wholehand::test
