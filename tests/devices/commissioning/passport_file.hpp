#pragma once

#include "devices/passport/passport.hpp"
#include "devices/passport/sealed_file.hpp"
#include "files/device/device_file.hpp"
#include "loop/core/sha256.hpp"
#include "support/figure.hpp"
#include "support/folder.hpp"

#include <fstream>

/// A device file with a passport and a daily check beside it, in a temporary folder.
namespace wholehand::test {

inline void writeFile(const std::string& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

class PassportFolder {
 public:
  PassportFolder() {
    device_file = folder.file("mine.toml");
    std::filesystem::copy_file(WHOLEHAND_SOURCE_DIR "/config/devices/desktop-3axis.toml",
                               device_file);
    model = orThrow(loadDeviceFile(device_file));
    passport.identity = identity;
    passport.driver = "test";
    passport.device = model.name;
    passport.device_sha256 = sha256(orThrow(readWhole(device_file)));
    passport.operator_name = "A. \"B\"";
    passport.measured_at = now;
    for (const DeviceAxis& axis : model.axes) {
      PassportAxis measured;
      measured.name = axis.name;
      measured.kind = axis.kind;
      measured.mass = {0.98 * axis.mass, 1.02 * axis.mass};
      measured.damping = {0.95 * axis.damping, 1.05 * axis.damping};
      measured.coulomb = {0.95 * axis.coulomb, 1.05 * axis.coulomb};
      measured.gravity = {-0.01, 0.01};
      measured.delay_s = {0.9e-3, 1.1e-3};
      measured.resolution = axis.encoder_step;
      passport.axes.push_back(measured);
    }
    path = passportPath(device_file, identity.serial);
    check_path = dailyCheckPath(device_file, identity.serial);
  }
  /// Writes the passport and today's check as commissioning does.
  void keep() {
    writeFile(path, passportText(passport));
    writeFile(check_path, dailyCheckText({orThrow(readPassport(path)).sha256,
                                          passport.operator_name, now, ""}));
  }

  Folder folder;
  /// 9:30 in the morning in Central Europe.
  PlaceTime now{
      std::chrono::sys_days(std::chrono::year(2026) / 11 / 21) + std::chrono::minutes(510),
      std::chrono::minutes(60)};
  DriverIdentity identity{"S-1", "1.0", "7", "5ba1"};
  double rate_hz = 1000.0;
  std::string device_file, path, check_path;
  DeviceModel model;
  Passport passport;
};

}  // namespace wholehand::test
