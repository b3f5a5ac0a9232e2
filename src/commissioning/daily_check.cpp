#include "commissioning/daily_check.hpp"

#include "commissioning/sealed_file.hpp"
#include "model/toml/toml_file.hpp"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>

namespace wholehand {
namespace {

constexpr const char* kCommission =
    "commission it: wholehand device commission. While its driver is developed, with nobody "
    "attached: --without-passport";
constexpr const char* kCheck = "do today's check: wholehand device commission --daily";

Expected<Done> judgeTime(const PlaceTime& done, const std::string& path, const PlaceTime& now) {
  const auto no = [&](const std::string& why, const char* remedy) {
    return Diagnostic{path, 0, "done_at", format(done), why, remedy};
  };
  if (done.at > now.at) {
    return no(fmt::format("lies in the future: it is {}. The clock was set back, or was wrong",
                          format(now)),
              "set this machine's clock, and check again");
  }
  if (done.day() != now.day()) {
    return no("the device was not checked today, " + format(now.day()), kCheck);
  }
  if (now.at - done.at > kCheckLasts) {
    return no(fmt::format("today's check has expired: it lasts {} hours", kCheckLasts.count()),
              kCheck);
  }
  return Done{};
}

}  // namespace

std::string dailyCheckPath(const std::string& device_file, const std::string& serial) {
  return besideDeviceFile(device_file, serial, "check");
}

std::string dailyCheckText(const DailyCheck& check) {
  return seal(fmt::format(
      "# The two-minute check: zero, signs, watchdog, emergency stop. Do not edit: do it again.\n"
      "kind = \"device-check\"\nversion = 1\ndone_at = \"{}\"\noperator = {}\n"
      "passport_sha256 = \"{}\"\n\n",
      format(check.done_at), quoted(check.operator_name), check.passport_sha256));
}

Expected<DailyCheck> readDailyCheck(const std::string& path) {
  if (const auto sealed = checkSeal(path, kCheck); !sealed) return sealed.errors();
  TomlFile file(path, "device-check");
  if (!file.readable()) return file.finish();
  TomlTable& root = file.root();
  DailyCheck check;
  check.done_at = readTime(root, "done_at");
  check.operator_name = root.text("operator");
  check.passport_sha256 = root.text("passport_sha256");
  (void)root.table("seal").text("sha256");
  if (Diagnostics faults = file.finish(); !faults.empty()) return faults;
  return check;
}

Expected<Cleared> clearToArm(const DriverIdentity& identity, const DeviceModel& model,
                             double rate_hz, const PlaceTime& now) {
  if (identity.simulated) {
    return keyFault(model.path, "driver", "", "is a simulated plant: it arms nothing",
                    "name the device's driver");
  }
  if (identity.serial.empty()) {
    return keyFault(model.path, "serial", "",
                    "the driver says no serial number: no passport can be matched to it",
                    "let the driver fill in wh_plugin.identify");
  }
  const std::string path = passportPath(model.path, identity.serial);
  if (!std::filesystem::exists(path)) {
    return fileFault(path, "device " + identity.serial + " has no passport", kCommission);
  }
  Expected<Passport> passport = readPassport(path);
  if (!passport) return passport.errors();
  if (auto fits = checkPassport(*passport, identity, model, now); !fits) return fits.errors();
  if (std::abs(passport->rate_hz - rate_hz) > 1e-6 * rate_hz) {
    return keyFault(path, "rate_hz", fmt::format("{:.6g}", passport->rate_hz),
                    fmt::format("the device was measured at another rate than {:.6g} Hz", rate_hz),
                    "run at the passport's rate, or measure at this one");
  }

  const std::string check_path = dailyCheckPath(model.path, identity.serial);
  if (!std::filesystem::exists(check_path)) {
    return fileFault(check_path, "the device was not checked today", kCheck);
  }
  const Expected<DailyCheck> check = readDailyCheck(check_path);
  if (!check) return check.errors();
  if (auto timely = judgeTime(check->done_at, check_path, now); !timely) return timely.errors();
  if (check->passport_sha256 != passport->sha256) {
    return keyFault(check_path, "passport_sha256", "",
                    "today's check was done with another passport", kCheck);
  }
  return Cleared(std::move(*passport));
}

}  // namespace wholehand
