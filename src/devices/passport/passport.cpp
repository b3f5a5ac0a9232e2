#include "devices/passport/passport.hpp"

#include "devices/passport/sealed_file.hpp"
#include "files/page/chart_page.hpp"
#include "files/toml/toml_file.hpp"
#include "loop/core/printable.hpp"
#include "loop/core/sha256.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <utility>

namespace wholehand {

namespace {

constexpr const char* kRemedy = "measure the device again: wholehand device commission";
constexpr double kDelaySlack = 0.1;  // share of a period

// A figure of an axis, with its keys by kind of axis.
struct Figure {
  Interval PassportAxis::*of;
  const char* translation;
  const char* rotation;
  NumberRule rule;
};
std::array<Figure, 5> figures() {
  return {{{&PassportAxis::mass, "mass_kg", "inertia_kg_m2", above(0.0, 1000.0)},
           {&PassportAxis::damping, "damping_n_s_m", "damping_nm_s_rad", between(-1000.0, 1e4)},
           {&PassportAxis::coulomb, "coulomb_n", "coulomb_nm", between(-1000.0, 1e3)},
           {&PassportAxis::gravity, "gravity_n", "gravity_nm", between(-1e4, 1e4)},
           {&PassportAxis::delay_s, "delay_s", "delay_s", between(-1.0, 1.0, "s")}}};
}

std::string axisText(const PassportAxis& axis) {
  const bool turns = axis.kind == AxisKind::kRotation;
  std::string out = fmt::format("\n[[axes]]\nname = {}\ntype = \"{}\"\n", quoted(axis.name),
                                turns ? "rotation" : "translation");
  for (const Figure& f : figures()) {
    const Interval& i = axis.*f.of;
    out += fmt::format("{} = [{:.9g}, {:.9g}]\n", turns ? f.rotation : f.translation, i.lower,
                       i.upper);
  }
  if (axis.transport_s) {
    out += fmt::format("transport_s = {:.9g}  # of delay_s; the rest is the drive's\n",
                       *axis.transport_s);
  }
  if (axis.drive_lag_s.upper > 0.0) {
    out += fmt::format("drive_lag_s = [{:.9g}, {:.9g}]\n", axis.drive_lag_s.lower,
                       axis.drive_lag_s.upper);
  }
  return out + fmt::format("{} = {:.9g}\n{} = {:.9g}\n", turns ? "resolution_rad" : "resolution_m",
                           axis.resolution, turns ? "mark_rad" : "mark_m", axis.mark);
}

PassportAxis readAxis(TomlTable& table) {
  PassportAxis axis;
  axis.name = table.text("name");
  axis.kind = table.choice("type", {"translation", "rotation"}) == "rotation"
                  ? AxisKind::kRotation
                  : AxisKind::kTranslation;
  const bool turns = axis.kind == AxisKind::kRotation;
  for (const Figure& f : figures()) {
    const auto ends = table.interval(turns ? f.rotation : f.translation, f.rule);
    axis.*f.of = {ends[0], ends[1]};
  }
  if (table.has("transport_s")) {
    axis.transport_s = table.number("transport_s", between(0.0, 1.0, "s"));
  }
  if (table.has("drive_lag_s")) {
    const auto ends = table.interval("drive_lag_s", between(0.0, 0.02, "s"));
    axis.drive_lag_s = {ends[0], ends[1]};
  }
  axis.resolution = table.number(turns ? "resolution_rad" : "resolution_m", between(0.0, 1.0));
  axis.mark = table.number(turns ? "mark_rad" : "mark_m", between(-100.0, 100.0));
  return axis;
}

Diagnostic foreign(const Passport& p, const char* key, const std::string& stated,
                   const std::string& has) {
  return keyFault(p.path, key, stated,
                  fmt::format("the passport is foreign: this device says {}", has), kRemedy);
}

constexpr double kMost = 2.0;  // upper end of the scale, relative to the file's value

struct Row {
  const char* figure;
  Interval measured;
  double stated;  ///< value of the device file
  std::string unit;
};

std::array<Row, 4> rowsOf(const PassportAxis& m, const DeviceAxis& axis, double delay_s) {
  const bool turns = axis.kind == AxisKind::kRotation;
  return {
      {{turns ? "passport.inertia" : "passport.mass", m.mass, axis.mass, turns ? "kg·m²" : "kg"},
       {"passport.damping", m.damping, axis.damping, turns ? "N·m·s/rad" : "N·s/m"},
       {"passport.friction", m.coulomb, axis.coulomb, axis.effortUnit()},
       {"passport.delay", m.delay_s, delay_s, "s"}}};
}

std::vector<PageText> cells(const Row& row) {
  const PageText bar = row.stated > 0.0 ? intervalBar(row.measured.lower / row.stated,
                                                      row.measured.upper / row.stated, kMost)
                                        : PageText("");
  return {sentence(row.figure), bar,
          sentence("passport.between", {{"low", fmt::format("{:.4g}", row.measured.lower)},
                                        {"high", fmt::format("{:.4g}", row.measured.upper)},
                                        {"unit", row.unit}}),
          fmt::format("{:.4g}", row.stated)};
}

}  // namespace

std::string passportPath(const std::string& device_file, const std::string& serial) {
  return besideDeviceFile(device_file, serial, "passport");
}

std::string passportText(const Passport& p) {
  std::string out = fmt::format(
      "# Measured by `wholehand device commission`. Do not edit: measure again.\n"
      "kind = \"passport\"\nversion = 1\nmeasured_at = \"{}\"\noperator = {}\n"
      "device = {}\ndevice_sha256 = \"{}\"\nrate_hz = {:.9g}\nresponds_up_to = {:.9g}\n{}",
      format(p.measured_at), quoted(p.operator_name), quoted(p.device), p.device_sha256, p.rate_hz,
      p.responds_up_to,
      p.identity.simulated ? "simulated = true  # of no device: it arms none\n" : "");
  const std::array<std::pair<const char*, std::string>, 5> known = {
      {{"driver", p.driver},
       {"driver_sha256", p.identity.driver_sha256},
       {"serial", p.identity.serial},
       {"firmware", p.identity.firmware},
       {"sdk", p.identity.sdk}}};
  for (const auto& [key, text] : known) {
    if (!text.empty()) out += fmt::format("{} = {}\n", key, quoted(text));
  }
  for (const PassportAxis& axis : p.axes) out += axisText(axis);
  return seal(out + "\n");
}

Expected<Passport> readPassport(const std::string& path) {
  const Expected<std::string> digest = checkSeal(path, kRemedy);
  if (!digest) return digest.errors();
  TomlFile file(path, "passport");
  if (!file.readable()) return file.finish();
  TomlTable& root = file.root();
  Passport p;
  p.path = path;
  p.sha256 = *digest;
  p.measured_at = readTime(root, "measured_at");
  p.operator_name = root.text("operator");
  p.driver = root.text("driver", "");
  p.identity = {root.text("serial"), root.text("firmware", ""), root.text("sdk", ""),
                root.text("driver_sha256", ""), root.flag("simulated", false)};
  p.device = root.text("device");
  p.device_sha256 = root.text("device_sha256");
  p.rate_hz = root.number("rate_hz", above(0.0, 1e5, "Hz"));
  p.responds_up_to = root.number("responds_up_to", between(1.0, 1.0));
  for (TomlTable& table : root.tables("axes", 1)) p.axes.push_back(readAxis(table));
  (void)root.table("seal").text("sha256");
  if (Diagnostics faults = file.finish(); !faults.empty()) return faults;
  return p;
}

bool sameAxes(const Passport& passport, const DeviceModel& model) {
  return std::equal(passport.axes.begin(), passport.axes.end(), model.axes.begin(),
                    model.axes.end(), [](const PassportAxis& a, const DeviceAxis& b) {
                      return a.name == b.name && a.kind == b.kind;
                    });
}

Expected<Done> checkPassport(const Passport& p, const DriverIdentity& identity,
                             const DeviceModel& model, const PlaceTime& now) {
  Diagnostics out;
  const std::array<std::array<std::string, 3>, 3> parts = {
      {{"serial", p.identity.serial, identity.serial},
       {"firmware", p.identity.firmware, identity.firmware},
       {"sdk", p.identity.sdk, identity.sdk}}};
  for (const auto& [key, stated, has] : parts) {
    if (stated != has) out.push_back(foreign(p, key.c_str(), stated, has));
  }
  if (p.identity.simulated && !identity.simulated) {
    out.push_back(keyFault(
        p.path, "simulated", "true",
        "the passport was learned on a simulated plant: it says nothing of a device", kRemedy));
  }
  if (p.identity.driver_sha256 != identity.driver_sha256) {
    out.push_back({p.path, 0, "driver_sha256", "",
                   "the driver, its settings or a file that they name is another one", kRemedy});
  }
  const Expected<std::string> file = readWhole(model.path);
  if (!file) return file.errors();
  if (sha256(*file) != p.device_sha256) {
    out.push_back({p.path, 0, "device_sha256", "",
                   fmt::format("the device file {} was changed since the passport was written",
                               printable(model.path)),
                   kRemedy});
  } else if (!sameAxes(p, model)) {
    out.push_back({p.path, 0, "axes", "", "are not those of the device file", kRemedy});
  }
  if (now.at < p.measured_at.at) {
    out.push_back({p.path, 0, "measured_at", format(p.measured_at),
                   fmt::format("lies in the future: it is {}. The clock was set back, or was wrong",
                               format(now)),
                   "set this machine's clock"});
  } else if (now.at - p.measured_at.at > kPassportLasts) {
    out.push_back(
        keyFault(p.path, "measured_at", format(p.measured_at),
                 fmt::format("the passport has expired: it lasts {} days", kPassportLasts.count()),
                 kRemedy));
  }
  if (!out.empty()) return out;
  return Done{};
}

namespace {

int wholePeriods(double delay_s, double period_s) {
  return static_cast<int>(std::ceil(delay_s / period_s - kDelaySlack - 1e-9));
}

double longestDelay_s(const Passport& passport) {
  double delay_s = 0.0;
  for (const PassportAxis& axis : passport.axes) delay_s = std::max(delay_s, axis.delay_s.upper);
  return delay_s;
}

}  // namespace

std::vector<MeasuredAxis> measuredAxes(const Passport& passport) {
  std::vector<MeasuredAxis> out;
  for (const PassportAxis& axis : passport.axes) {
    out.push_back({axis.mass.middle(), std::max(0.0, axis.damping.middle()),
                   std::max(0.0, axis.delay_s.middle()), axis.drive_lag_s.upper});
  }
  return out;
}

std::vector<DeviceModel> worstCorners(const DeviceModel& model, const Passport& passport,
                                      double period_s) {
  DeviceModel light = model;
  for (std::size_t i = 0; i < model.axes.size(); ++i) {
    const PassportAxis& measured = passport.axes.at(i);
    DeviceAxis& axis = light.axes[i];
    axis.damping = std::max(0.0, std::min(axis.damping, measured.damping.lower));
    axis.coulomb = std::max(0.0, std::min(axis.coulomb, measured.coulomb.lower));
    axis.encoder_step = std::max(axis.encoder_step, measured.resolution);
    axis.mass = measured.mass.lower;
  }
  const int delay = wholePeriods(longestDelay_s(passport), period_s);
  light.output_delay_ticks = std::max(light.output_delay_ticks, delay);
  DeviceModel heavy = light;
  for (std::size_t i = 0; i < model.axes.size(); ++i) {
    heavy.axes[i].mass = passport.axes[i].mass.upper;
  }
  return {std::move(light), std::move(heavy)};
}

ArmingDelay delayAtArming(const DeviceModel& model, const Passport& passport, const Transport& now,
                          double period_s) {
  double drive_s = 0.0;
  bool known = true;
  for (const PassportAxis& axis : passport.axes) {
    known = known && axis.transport_s.has_value();
    drive_s = std::max(drive_s, axis.delay_s.upper - axis.transport_s.value_or(0.0));
  }
  const double now_s = drive_s + now.both_s(), passport_s = longestDelay_s(passport);
  const int certified = worstCorners(model, passport, period_s).front().output_delay_ticks;
  return {std::max(certified, wholePeriods(now_s, period_s)),
          fmt::format("the delay is {:.2f} ms now ({} {:.2f} ms, transport {:.2f} ms), the "
                      "passport's {:.2f} ms",
                      1e3 * now_s,
                      known ? "drive" : "drive, with the unknown transport of its measurement,",
                      1e3 * drive_s, 1e3 * now.both_s(), 1e3 * passport_s)};
}

ChartPage passportChart(const Passport& passport, const DeviceModel& device) {
  ChartPage page;
  page.title =
      sentence("passport.title", {{"device", device.name}, {"serial", passport.identity.serial}});
  page.notes = {sentence("passport.measured", {{"day", format(passport.measured_at.day())},
                                               {"operator", passport.operator_name}}),
                sentence("passport.note")};
  const double delay_s = device.output_delay_ticks / passport.rate_hz;
  for (std::size_t i = 0; i < passport.axes.size(); ++i) {
    ChartTable table;
    table.title = sentence("axis", {{"axes", passport.axes[i].name}});
    table.heads = {sentence("passport.figure"), sentence("passport.share"),
                   sentence("passport.interval"), sentence("passport.file")};
    for (const Row& row : rowsOf(passport.axes[i], device.axes[i], delay_s)) {
      table.rows.push_back(cells(row));
    }
    page.tables.push_back(std::move(table));
  }
  return page;
}

namespace {

constexpr const char* kCommission =
    "commission it: wholehand device commission. While its driver is developed, with nobody "
    "attached: --without-passport";
constexpr const char* kCheck = "do today's check: wholehand device commission --daily";

Expected<Done> checkTime(const PlaceTime& done, const std::string& path, const PlaceTime& now) {
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
  return seal(
      fmt::format("# The two-minute check: zero, signs, watchdog, emergency stop, effort limit. Do "
                  "not edit: do it again.\n"
                  "kind = \"device-check\"\nversion = 1\ndone_at = \"{}\"\noperator = {}\n"
                  "passport_sha256 = \"{}\"\n\n",
                  format(check.done_at), quoted(check.operator_name), check.passport_sha256));
}

Expected<DailyCheck> readDailyCheck(const std::string& path) {
  const auto sealed = checkSeal(path, kCheck);
  if (!sealed) return sealed.errors();
  TomlFile file(path, "device-check");
  if (!file.readable()) return file.finish();
  TomlTable& root = file.root();
  DailyCheck check;
  check.sha256 = *sealed;
  check.done_at = readTime(root, "done_at");
  check.operator_name = root.text("operator");
  check.passport_sha256 = root.text("passport_sha256");
  (void)root.table("seal").text("sha256");
  if (Diagnostics faults = file.finish(); !faults.empty()) return faults;
  return check;
}

std::string enablingsPath(const std::string& device_file, const std::string& serial) {
  return besideDeviceFile(device_file, serial, "enablings");
}

std::string enablingsText(const Enablings& enablings) {
  return seal(
      fmt::format("# Enablings of the device since its daily check. Do not edit: check it again.\n"
                  "kind = \"device-enablings\"\nversion = 1\nlast_at = \"{}\"\ncount = {}\n"
                  "check_sha256 = \"{}\"\n\n",
                  format(enablings.last_at), enablings.count, enablings.check_sha256));
}

Expected<Enablings> readEnablings(const std::string& path) {
  if (const auto sealed = checkSeal(path, kCheck); !sealed) return sealed.errors();
  TomlFile file(path, "device-enablings");
  if (!file.readable()) return file.finish();
  TomlTable& root = file.root();
  Enablings enablings;
  enablings.last_at = readTime(root, "last_at");
  enablings.count = static_cast<int>(root.integer("count", 0, 1'000'000'000));
  enablings.check_sha256 = root.text("check_sha256");
  (void)root.table("seal").text("sha256");
  if (Diagnostics faults = file.finish(); !faults.empty()) return faults;
  return enablings;
}

namespace {

// Enablings since this check. An unreadable count is not trusted, and no visit is open with it.
Enablings enablingsSince(const DailyCheck& check, const std::string& path) {
  Enablings none;
  none.check_sha256 = check.sha256;
  if (!std::filesystem::exists(path)) return none;
  Expected<Enablings> kept = readEnablings(path);
  if (!kept) {
    none.count = kCheckEnablings;
    return none;
  }
  return kept->check_sha256 == check.sha256 ? *kept : none;
}

Expected<Done> checkWear(const DailyCheck& check, const std::string& path, const PlaceTime& now) {
  const Enablings since = enablingsSince(check, path);
  if (since.count < kCheckEnablings) return Done{};
  const auto pause = now.at - since.last_at.at;
  if (pause >= std::chrono::seconds(0) && pause < kVisitPause) return Done{};
  return keyFault(path, "count", std::to_string(since.count),
                  fmt::format("the device was enabled {} times since its check: it is due before "
                              "the next visit",
                              since.count),
                  kCheck);
}

}  // namespace

Expected<Done> countEnabling(
    const DriverIdentity& identity, const DeviceModel& model, const PlaceTime& now,
    const std::function<Expected<Done>(const std::string& path, const std::string& text)>& write) {
  const auto check = readDailyCheck(dailyCheckPath(model.path, identity.serial));
  if (!check) return check.errors();
  const std::string path = enablingsPath(model.path, identity.serial);
  Enablings since = enablingsSince(*check, path);
  ++since.count;
  since.last_at = now;
  return write(path, enablingsText(since));
}

Expected<CheckedPermit> checkArmingPermit(const DriverIdentity& identity, const DeviceModel& model,
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
  if (auto timely = checkTime(check->done_at, check_path, now); !timely) return timely.errors();
  if (check->passport_sha256 != passport->sha256) {
    return keyFault(check_path, "passport_sha256", "",
                    "today's check was done with another passport", kCheck);
  }
  const std::string count_path = enablingsPath(model.path, identity.serial);
  if (auto fresh = checkWear(*check, count_path, now); !fresh) return fresh.errors();
  return CheckedPermit(std::move(*passport));
}

}  // namespace wholehand
