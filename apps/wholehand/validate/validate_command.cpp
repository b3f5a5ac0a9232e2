#include "apps/wholehand/validate/validate_command.hpp"

#include "apps/wholehand/run/run_summary.hpp"
#include "apps/wholehand/shared/exit_code.hpp"
#include "apps/wholehand/shared/shipped_files.hpp"
#include "apps/wholehand/shared/sweep_files.hpp"
#include "clinic/presets/presets.hpp"
#include "devices/passport/passport.hpp"
#include "files/device/device_file.hpp"
#include "files/device/rendering_file.hpp"
#include "files/hand/hand_file.hpp"
#include "files/patient/motion_file.hpp"
#include "files/patient/patient_file.hpp"
#include "files/patient/prescription_file.hpp"
#include "files/scene/object_scene.hpp"
#include "files/scene/scene_file.hpp"
#include "files/toml/toml_file.hpp"
#include "loop/core/printable.hpp"
#include "rig/rig.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <filesystem>
#include <set>

namespace wholehand {
namespace fs = std::filesystem;
namespace {

// True for a motion file, judged by its extension in any case: instruments and Windows write
// MOTION.CSV.
bool isMotionName(const std::string& file) {
  std::string ending = fs::path(file).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending == ".csv";
}

// Shipped driver for settings of a kind; empty: none.
std::string driverOfKind(const std::string& kind) {
  if (kind == "moteus" || kind == "composite") return kind;
  return kind == "force-dimension" ? "force_dimension" : "";
}

// The files to check, by kind, and the files to check them against.
class Validation {
 public:
  explicit Validation(const std::vector<std::string>& files) {
    for (const std::string& file : files) {
      if (isMotionName(file)) {
        kinds_.emplace_back(file, "motion");
      } else if (isUrdf(file)) {
        kinds_.emplace_back(file, "object");
      } else {
        auto kind = fileKind(file);
        kinds_.emplace_back(file, kind ? *kind : "");
      }
    }
  }

  void run() {
    for (const auto& [file, kind] : kinds_) {
      std::string remark;
      faulty_ = false;
      faulty_device_.clear();
      if (kind.empty() && add(fileKind(file))) checkKind(file, kind);
      if (kind == "device") checkDevice(file);
      if (kind == "hand") checkHand(file);
      if (kind == "rendering") remark = checkRendering(file);
      if (kind == "patient") checkWithDevice(file, loadPatientFile);
      if (kind == "prescription") checkWithDevice(file, loadPrescriptionFile);
      if (kind == "scene" || kind == "object") remark = checkScene(file);
      if (kind == "exercise") remark = checkExercise(file);
      if (kind == "passport") remark = checkPassportFile(file);
      if (kind == "device-check") add(readDailyCheck(file));
      if (kind == "device-enablings") add(readEnablings(file));
      if (kind == "clinic-presets") add(clinic::loadPresets(file));
      if (kind == "sweep") remark = checkSweep(file);
      if (kind == "motion") remark = checkMotion(file);
      if (kind != "motion" && kind != "object" && !kind.empty()) checkKind(file, kind);
      if (!faulty_device_.empty()) {
        std::printf("-   %-9s %s (not checked: correct %s first)\n", kind.c_str(),
                    printable(file).c_str(), faulty_device_.c_str());
      } else if (!faulty_) {
        std::printf("ok  %-9s %s\n%s", kind.c_str(), printable(file).c_str(), remark.c_str());
      }
    }
  }

  [[nodiscard]] const Diagnostics& errors() const { return errors_; }

 private:
  // Reports a device's faults once, although they recur with every file checked against it.
  void add(const Diagnostics& errors) {
    faulty_ = faulty_ || !errors.empty();
    for (const Diagnostic& error : errors) {
      if (reported_.insert(format(error)).second) errors_.push_back(error);
    }
  }
  template <class T>
  bool add(const Expected<T>& loaded) {
    if (!loaded) add(loaded.errors());
    return loaded.ok();
  }

  // Device for a file: the one of the same name among the arguments or in its folder, else the only
  // device among the arguments, else the shipped six-axis one.
  [[nodiscard]] std::string deviceFor(const std::string& file) const {
    const fs::path name = fs::path(file).filename();
    std::string only;
    for (const auto& [other, kind] : kinds_) {
      if (kind != "device") continue;
      if (fs::path(other).filename() == name) return other;
      only = only.empty() ? other : only;
    }
    const fs::path beside = fs::path(file).parent_path().parent_path() / "devices" / name;
    std::error_code error;
    if (fs::exists(beside, error)) return beside.string();
    return only.empty() ? shippedFile("config/devices/lambda-pride.toml") : only;
  }

  Expected<DeviceModel> loadDeviceFor(const std::string& file) {
    const std::string device_file = deviceFor(file);
    auto device = loadDeviceFile(device_file);
    if (!add(device)) faulty_device_ = device_file;
    return device;
  }

  // The only file of a kind among the arguments, else a shipped one.
  [[nodiscard]] std::string onlyOr(const std::string& wanted, const std::string& shipped) const {
    std::string only;
    int count = 0;
    for (const auto& [other, kind] : kinds_) {
      if (kind != wanted) continue;
      only = other;
      ++count;
    }
    return count == 1 ? only : shippedFile(shipped);
  }
  // Hand for a device.
  [[nodiscard]] std::string handFor() const {
    return onlyOr("hand", "config/hands/adult-median-right.toml");
  }

  // Reports axes with non-standard names, which drive nothing.
  void checkDevice(const std::string& file) {
    auto device = loadDeviceFile(file);
    auto hand = loadHandFile(handFor());
    if (add(device) && hand) add(assembleHand(*hand, *device));
  }

  void checkKind(const std::string& file, const std::string& kind) {
    TomlFile toml(file, kind);
    if (!toml.readable()) return;
    if (const std::string driver = driverOfKind(kind); !driver.empty()) {
      toml.root().fail("kind", "is the settings of a driver, which reads them itself",
                       fmt::format("check it with: wholehand device inspect --driver {} "
                                   "--driver-settings {}",
                                   driver, printable(file)));
      toml.root().ignoreUnknownKeys();
      add(toml.finish());
      return;
    }
    toml.root().choice(
        "kind", {"hand", "device", "rendering", "patient", "prescription", "scene", "exercise",
                 "passport", "device-check", "device-enablings", "sweep", "clinic-presets"});
    if (toml.root().isGood("kind")) return;
    toml.root().ignoreUnknownKeys();
    add(toml.finish());
  }

  template <class Load>
  void checkWithDevice(const std::string& file, Load load) {
    auto device = loadDeviceFor(file);
    if (device) addOfAxes(file, load(file, *device));
  }

  // Adds a note which device was assumed, because a file may be correct for another one.
  template <class T>
  bool addOfAxes(const std::string& file, const Expected<T>& loaded) {
    if (loaded.ok()) return true;
    const std::string device_file = deviceFor(file);
    Diagnostics errors = loaded.errors();
    for (Diagnostic& error : errors) {
      if (!named(device_file) && error.problem.find(device_file) != std::string::npos) {
        error.remedy += "; if it is for another device, name its device file beside it";
      }
    }
    add(errors);
    return false;
  }

  [[nodiscard]] bool named(const std::string& file) const {
    return std::any_of(kinds_.begin(), kinds_.end(),
                       [&](const auto& other) { return other.first == file; });
  }

  void checkHand(const std::string& file) {
    auto hand = loadHandFile(file);
    auto device = loadDeviceFor(file);
    if (add(hand) && device) add(assembleHand(*hand, *device));
  }

  std::string checkScene(const std::string& file) {
    const auto scene = loadSceneFile(file);
    if (!add(scene)) return {};
    return noticed(scene->notices);
  }

  // Checks a motion, against the device among the arguments if there is exactly one.
  std::string checkMotion(const std::string& file) {
    const std::string device_file = onlyOr("device", "");
    const auto device = device_file.empty() || !named(device_file)
                            ? Expected<DeviceModel>(Diagnostics{})
                            : loadDeviceFile(device_file);
    const auto motion = loadMotionFile(file, device ? &*device : nullptr);
    if (!add(motion)) return {};
    const char* const alone = "    (not held against a device: name its device file beside it)\n";
    return (device ? "" : alone) + noticed(motion->notices);
  }

  static std::string noticed(const Diagnostics& notices) {
    std::string lines;
    for (const Diagnostic& notice : notices) lines += "    " + format(notice) + "\n";
    return lines;
  }

  // Checks gains. They are valid only if the loop is stable at 1 kHz.
  std::string checkRendering(const std::string& file) {
    Models models;
    auto device = loadDeviceFor(file);
    auto hand_file = loadHandFile(handFor());
    if (!device || !add(hand_file)) return {};
    models.device = *device;
    auto rendering = loadRenderingFile(file, *device);
    auto hand = assembleHand(*hand_file, *device);
    if (!addOfAxes(file, rendering) || !add(hand)) return {};
    models.rendering = *rendering;
    models.hand = *hand;
    auto checked = checkGains(models, 1e-3);
    if (!add(checked)) return {};
    add(checked->refused);
    return gainTable(models, checked->gains);
  }

  // Checks every level of an exercise, with the device among the arguments (else the shipped one)
  // and its gains.
  std::string checkExercise(const std::string& file) {
    // With several devices, some may lack the axes that the exercise needs.
    const std::string device_file = onlyOr("device", "config/devices/lambda-pride.toml");
    auto rendering = renderingFor(device_file);
    if (!add(rendering)) return {};
    int levels = 1;
    std::string notices;
    for (int level = 1; level <= levels; ++level) {
      ModelFiles files;
      files.hand = handFor();
      files.device = device_file;
      files.rendering = *rendering;
      files.patient = shippedFile("config/patients/relaxed-adult.toml");
      files.exercise = file;
      files.level = level;
      auto models = loadModels(files);
      if (!add(models)) return {};
      auto checked = checkGains(*models, 1e-3);
      if (!add(checked)) return {};
      add(checked->refused);
      levels = models->exercise->description().levels;
      for (const Diagnostic& notice : models->scene.notices) {
        const std::string line = noticed({notice});
        if (notices.find(line) == std::string::npos) notices += line;
      }
    }
    return fmt::format("    {} level{}, with the device {}\n{}", levels, levels == 1 ? "" : "s",
                       device_file, notices);
  }

  // Checks a grid, and that every file that its cells read exists.
  std::string checkSweep(const std::string& file) {
    auto summary = summarizeSweep(file);
    return add(summary) ? "    " + *summary + "\n" : std::string{};
  }

  // Checks the passport itself, and against the only device file among the arguments. The connected
  // device is unknown here.
  std::string checkPassportFile(const std::string& file) {
    const auto passport = readPassport(file);
    if (!add(passport)) return {};
    std::string remark =
        fmt::format("    {}, serial number {}, measured {}\n", printable(passport->device),
                    printable(passport->identity.serial), format(passport->measured_at.day()));
    const std::string device_file = onlyOr("device", "");
    if (!named(device_file))
      return remark + "    (name its device file beside it to hold it against that)\n";
    const auto device = loadDeviceFile(device_file);
    if (!add(device)) {
      faulty_device_ = device_file;
      return {};
    }
    if (auto fits = checkPassport(*passport, passport->identity, *device, placeTimeNow()); !fits) {
      add(fits.errors());
    }
    return remark;
  }

  static std::string gainTable(const Models& models, const CouplingGains& gains) {
    std::string table = fmt::format("    {:<20} {:>8} {:>10} {:>10} {:>10} {:>9}\n", "axis", "K_pm",
                                    "armature", "inertia", "felt", "at tip, g");
    for (int a = 0; a < gains.axes; ++a) {
      const DeviceAxis& axis = models.device.axes[a];
      const double felt = feltInertia(gains, a, 1e-3);
      const double lever_m = axis.lever_arm_m;
      const std::string tip =
          lever_m > 0.0 ? fmt::format("{:.1f}", 1e3 * felt / (lever_m * lever_m)) : "-";
      table += fmt::format("    {:<20} {:>8.4g} {:>10.3g} {:>10.3g} {:>10.3g} {:>9}\n", axis.name,
                           gains.k_pm[a], gains.armature[a], gains.inertia[a], felt, tip);
    }
    return table + fmt::format(
                       "    (kg or kg·m², of the simulated hand at 1 kHz\n    on the device {} "
                       "with the hand {};\n"
                       "    felt: in free motion. Forces are felt as they act: σ = 1)\n",
                       models.device.name, models.hand.name);
  }

  std::vector<std::pair<std::string, std::string>> kinds_;
  Diagnostics errors_;
  std::set<std::string> reported_;
  bool faulty_ = false;        // the current file has a fault
  std::string faulty_device_;  // device file whose faults prevent checking the current file
};

}  // namespace

int validateCommand(const std::vector<std::string>& files) {
  Validation validation(files);
  validation.run();
  return validation.errors().empty() ? kExitDone : refuse(validation.errors());
}

}  // namespace wholehand
