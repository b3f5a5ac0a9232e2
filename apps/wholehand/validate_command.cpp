#include "validate_command.hpp"

#include "assembly/rig.hpp"
#include "exit_code.hpp"
#include "model/hand_file.hpp"
#include "model/toml_file.hpp"
#include "shipped_files.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <map>

namespace wholehand {
namespace fs = std::filesystem;
namespace {

// The files to check, by kind, and what they are checked against.
class Validation {
 public:
  explicit Validation(const std::vector<std::string>& files) {
    for (const std::string& file : files) {
      if (fs::path(file).extension() == ".csv") {
        kinds_.emplace_back(file, "motion");
      } else if (auto kind = fileKind(file)) {
        kinds_.emplace_back(file, *kind);
      } else {
        kinds_.emplace_back(file, "");
        add(kind.errors());
      }
    }
  }

  void run() {
    for (const auto& [file, kind] : kinds_) {
      const std::size_t before = errors_.size();
      std::string remark;
      if (kind == "device") add(loadDeviceFile(file));
      if (kind == "hand") checkHand(file);
      if (kind == "rendering") remark = checkRendering(file);
      if (kind == "patient") checkWithDevice(file, loadPatientFile);
      if (kind == "scene") add(loadSceneFile(file));
      if (kind == "motion") add(loadMotionFile(file));
      if (!kind.empty() && errors_.size() == before) {
        std::printf("ok  %-9s %s\n%s", kind.c_str(), file.c_str(), remark.c_str());
      }
    }
  }

  [[nodiscard]] const Diagnostics& errors() const { return errors_; }

 private:
  void add(const Diagnostics& errors) {
    errors_.insert(errors_.end(), errors.begin(), errors.end());
  }
  template <class T>
  bool add(const Expected<T>& loaded) {
    if (!loaded) add(loaded.errors());
    return loaded.ok();
  }

  // The device a file is meant for: of the same name among the arguments or beside it, else the
  // only device among the arguments, else the shipped six-axis one.
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

  template <class Load>
  void checkWithDevice(const std::string& file, Load load) {
    auto device = loadDeviceFile(deviceFor(file));
    if (add(device)) add(load(file, *device));
  }

  void checkHand(const std::string& file) {
    auto hand = loadHandFile(file);
    auto device = loadDeviceFile(deviceFor(file));
    if (add(hand) && add(device)) add(assembleHand(*hand, *device));
  }

  // Gains are right only where the loop they close is stable, at 1 kHz, with the shipped hand.
  std::string checkRendering(const std::string& file) {
    Models models;
    auto device = loadDeviceFile(deviceFor(file));
    auto hand_file = loadHandFile(shippedFile("config/hands/adult-median-right.toml"));
    if (!add(device) || !add(hand_file)) return {};
    models.device = *device;
    auto rendering = loadRenderingFile(file, *device);
    auto hand = assembleHand(*hand_file, *device);
    if (!add(rendering) || !add(hand)) return {};
    models.rendering = *rendering;
    models.hand = *hand;
    auto checked = checkGains(models, 1e-3);
    if (!add(checked)) return {};
    add(checked->refused);
    return gainTable(models, checked->gains);
  }

  static std::string gainTable(const Models& models, const CouplingGains& gains) {
    std::string table = fmt::format("    {:<20} {:>10} {:>12} {:>10} {:>8}\n", "axis", "K_pm",
                                    "K_ps 1/s²", "K_ds 1/s", "σ");
    for (int a = 0; a < gains.axes; ++a) {
      table += fmt::format("    {:<20} {:>10.4g} {:>11.0f} {:>10.1f} {:>8.3f}\n",
                           models.device.axes[a].name, gains.k_pm[a], gains.k_ps_per_s2[a],
                           gains.k_ds_per_s[a], gains.contact_scale[a]);
    }
    return table +
           "    (σ: felt over simulated force at 1 kHz with the median hand; 1 is the truth)\n";
  }

  std::vector<std::pair<std::string, std::string>> kinds_;
  Diagnostics errors_;
};

}  // namespace

int validateCommand(const std::vector<std::string>& files) {
  Validation validation(files);
  validation.run();
  return validation.errors().empty() ? kExitDone : refuse(validation.errors());
}

}  // namespace wholehand
