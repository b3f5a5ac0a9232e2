#include "commission_command.hpp"

#include "assembly/commissioning_record.hpp"
#include "chart_file.hpp"
#include "commissioning/commissioning.hpp"
#include "commissioning/console/console_operator.hpp"
#include "commissioning/sealed_file.hpp"
#include "core/printable.hpp"
#include "device/host/hosted_driver.hpp"
#include "device/plugin/plugin_device.hpp"
#include "exit_code.hpp"
#include "files/durable_file.hpp"
#include "files/text_file.hpp"
#include "number_option.hpp"
#include "pages.hpp"
#include "realtime/monotonic_clock.hpp"
#include "realtime/thread_setup.hpp"
#include "runtime/interrupt_scope.hpp"
#include "server/server.hpp"
#include "terminal_operator.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace wholehand {
namespace {

constexpr double kAnyDelay_s = 1.0;  // it is measured
constexpr std::chrono::seconds kPagesAreTold{1};

Expected<std::shared_ptr<DeviceDriver>> openDriver(const CommissionOptions& options,
                                                   const DeviceModel& model) {
  std::shared_ptr<DeviceDriver> driver;
  if (!options.host.empty()) {
    auto hosted = HostedDriver::connect(options.host);
    if (!hosted) return hosted.errors();
    if (Diagnostics other = (*hosted)->differences(model); !other.empty()) return other;
    driver = *hosted;
  } else {
    auto loaded = PluginDriver::load(options.driver, [](const std::string& line) {
      std::printf("%s\n", printable(line, 1000).c_str());
    });
    if (!loaded) return loaded.errors();
    driver = *loaded;
  }
  if (auto fits = PluginDevice::make(driver, model, kAnyDelay_s); !fits) return fits.errors();
  return driver;
}

CommissioningPlan planOf(const CommissionOptions& options) {
  CommissioningPlan plan;
  plan.operator_name = options.operator_name;
  plan.now = placeTimeNow;
  plan.write = writeText;
  plan.draw = writeCharts;
  return plan;
}

std::string fileOf(const CommissionOptions& options, const Commissioning& commissioning,
                   const DeviceModel& model, const DriverIdentity& identity) {
  return options.daily ? dailyCheckPath(model.path, identity.serial) : commissioning.path();
}

int sayNotFinished(const CommissionOptions& options) {
  std::printf("Not finished: no %s was written.\n", options.daily ? "check" : "passport");
  return kExitNotFit;
}

// The recorder of each run keeps every effort.
Expected<std::unique_ptr<CommissioningRecord>> beginRecord(const CommissionOptions& options,
                                                           const DeviceModel& model) {
  auto text = readWhole(model.path);
  if (!text) return text.errors();
  CommissioningRecord::Plan plan;
  plan.path = options.record;
  if (plan.path.empty()) {
    // By chance another one than of a program that begins in the same second.
    plan.path =
        fmt::format("out/recordings/commissioning-{:%Y%m%d-%H%M%S}-{}.h5",
                    fmt::localtime(std::chrono::system_clock::now()), randomName().substr(0, 8));
  }
  plan.title = (options.daily ? "Daily check of " : "Commissioning of ") + model.name;
  plan.device_text = *text;
  plan.period_s = 1.0 / options.rate_hz;
  plan.effort_share = kCommissioningShare;
  return CommissioningRecord::begin(model, plan);
}

CommissioningRecord::Tick kept(const Bench::Tick& tick, const std::vector<std::size_t>& places) {
  const auto axes = static_cast<int>(places.size());
  CommissioningRecord::Tick out;
  out.monotonic_ns = tick.monotonic_ns;
  out.position = AxisPosition(axes);
  out.sent = AxisEffort(axes);
  for (int i = 0; i < axes; ++i) {
    const std::size_t at = places[i];
    out.position[i] = tick.sample.position[at];
    out.sent[i] = tick.command.effort[at];
  }
  out.status = tick.sample.status;
  out.rendering = tick.phase == HostPhase::kRendering;
  out.let_go = static_cast<int>(tick.reason);
  return out;
}

// A bench with recording, and the steps on it.
struct Kept {
  CommissioningRecord& record;
  Bench bench;
  Commissioning commissioning;

  Kept(CommissioningRecord& to, Bench moved, const CommissionOptions& options)
      : record(to), bench(std::move(moved)), commissioning(bench, planOf(options)) {
    bench.listen([this](const Bench::Tick& tick) {
      record.setStep(commissioning.stepUnderWay());
      record.keep(kept(tick, bench.places()));
    });
  }
  Kept(const Kept&) = delete;
  Kept& operator=(const Kept&) = delete;
};

// This thread moves the device, as the loop of a run does. Threads that begin later would inherit
// it.
void askForRealTime() {
  for (const SetupLine& line : setUpThread({})) {
    if (!line.granted) std::printf("%s: %s\n", line.what.c_str(), line.sentence.c_str());
  }
}

// A daily check needs a passport. Its steps report their own findings.
std::optional<int> refuseWithoutPassport(const CommissionOptions& options,
                                         const Commissioning& commissioning) {
  if (!options.daily) return std::nullopt;
  const auto passport = commissioning.passportInForce();
  if (passport) return std::nullopt;
  return refuse(passport.errors());
}

int leadAtTerminal(const CommissionOptions& options, DeviceDriver& driver, const DeviceModel& model,
                   CommissioningRecord& record) {
  TerminalOperator person;
  RealTicks clock(1.0 / options.rate_hz);
  auto bench = Bench::make(driver, model, person, clock, 1.0 / options.rate_hz);
  if (!bench) return refuse(bench.errors());
  Kept steps(record, std::move(*bench), options);
  Commissioning& commissioning = steps.commissioning;
  if (auto refused = refuseWithoutPassport(options, commissioning)) return *refused;
  askForRealTime();
  if (options.daily) return commissioning.checkToday() ? kExitDone : kExitBadInput;
  return leadCommissioning(commissioning, person) ? kExitDone : sayNotFinished(options);
}

// Steps that a page lists.
std::vector<int> stepsOf(bool daily) {
  std::vector<int> steps;
  for (int i = 0; i < kCommissioningSteps; ++i) {
    const auto step = static_cast<CommissioningStep>(i);
    const bool of_a_day = step == CommissioningStep::kHome || step == CommissioningStep::kSigns ||
                          step == CommissioningStep::kWatchdog ||
                          step == CommissioningStep::kEmergencyStop;
    if (!daily || of_a_day) steps.push_back(i);
  }
  return steps;
}

CommissioningFacts aboutDevice(const CommissionOptions& options, const DeviceDriver& driver,
                               const DeviceModel& model) {
  CommissioningFacts facts;
  facts.device = model.name;
  facts.driver = driver.name();
  facts.serial = driver.identity().serial;
  facts.firmware = driver.identity().firmware;
  facts.operator_name = options.operator_name;
  facts.daily = options.daily;
  return facts;
}

int leadAtPage(const CommissionOptions& options, DeviceDriver& driver, const DeviceModel& model,
               CommissioningRecord& record) {
  CommissioningFacts about = aboutDevice(options, driver, model);
  about.recording = record.path();
  ConsoleOperator person(std::move(about), stepsOf(options.daily), monotonicNow_ns,
                         InterruptScope::interrupted);
  RealTicks clock(1.0 / options.rate_hz);
  auto bench = Bench::make(driver, model, person, clock, 1.0 / options.rate_hz);
  if (!bench) return refuse(bench.errors());
  ControlsArbiter controls;
  if (Diagnostics faults = roleTokens(options.pages.tokens).faults; !faults.empty()) {
    return refuse(faults);
  }
  ServerOptions server_options = serverOptions(options.pages, [](const std::string& line) {
    std::fprintf(stderr, "%s\n", printable(line, 1000).c_str());
  });
  server_options.commissioning = [&person] { return person.facts(); };
  auto server = Server::open(person, server_options, controls);
  if (!server) return refuse(server.errors());
  std::printf("Commission the device at %scommission; Ctrl-C ends.\n", (*server)->url().c_str());
  std::fflush(stdout);
  Kept steps(record, std::move(*bench), options);
  Commissioning& commissioning = steps.commissioning;
  if (auto refused = refuseWithoutPassport(options, commissioning)) return *refused;
  askForRealTime();
  const bool written = options.daily ? leadDailyCheck(commissioning, person)
                                     : leadCommissioning(commissioning, person);
  if (!written) return sayNotFinished(options);
  const std::string file = fileOf(options, commissioning, model, driver.identity());
  person.finish(file);
  std::printf("Written: %s\n", printable(file).c_str());
  std::this_thread::sleep_for(kPagesAreTold);
  return kExitDone;
}

}  // namespace

int commissionCommand(const CommissionOptions& options) {
  const auto model = loadDeviceFile(options.device);
  if (!model) return refuse(model.errors());
  const auto driver = openDriver(options, *model);
  if (!driver) return refuse(driver.errors());
  const InterruptScope interrupts;
  const auto record = beginRecord(options, *model);
  if (!record) return refuse(record.errors());
  const int code = options.web ? leadAtPage(options, **driver, *model, **record)
                               : leadAtTerminal(options, **driver, *model, **record);
  if ((*record)->kept() > 0) {
    std::printf("Every move is in %s\n", printable((*record)->path()).c_str());
  }
  return code;
}

void addCommission(CLI::App& app, CommissionOptions& o, int& code) {
  CLI::App* commission = app.add_subcommand(
      "commission", "Measure a device under supervision; its passport lets people use it");
  CLI::Option* driver = commission->add_option("--driver", o.driver.path,
                                               "Driver of the device (docs/drivers.md), .so");
  commission->add_option("--host", o.host, "Name of the `wholehand device-host` that holds it")
      ->excludes(driver);
  commission
      ->add_option("--device-at", o.driver.locator,
                   "Which device, as the driver names it: a serial number, a port ...")
      ->needs(driver);
  commission->add_option("--driver-settings", o.driver.settings, "The driver's own settings")
      ->needs(driver);
  commission->add_option("--device", o.device, "Device file; the passport is written beside it")
      ->required();
  commission->add_option("--operator", o.operator_name, "Your name, for the passport")->required();
  commission->add_option("--rate-hz", o.rate_hz, "Ticks a second")
      ->check(finiteBetween(500.0, 4000.0, "Hz"))
      ->capture_default_str();
  commission->add_option("--record", o.record,
                         "Recording of every move, .h5; out/recordings/commissioning-<time>.h5");
  commission->add_flag("--daily", o.daily, "The two-minute check of a day, with a passport");
  CLI::Option* web = commission->add_flag(
      "--web", o.web, "Lead through it at a page of the console instead of the terminal");
  commission->add_option("--port", o.pages.port, "Port of the page; 0: any free one")
      ->check(CLI::Range(0, 65535))
      ->capture_default_str()
      ->needs(web);
  commission
      ->add_option("--address", o.pages.address,
                   "Address to listen at; any that other machines can reach needs --token")
      ->capture_default_str()
      ->needs(web);
  commission->add_option("--token", o.pages.tokens, "As for `wholehand run`")->needs(web);
  commission->add_option("--token-file", o.token_file, "As for `wholehand run`")->needs(web);
  commission->footer(
      "NOBODY may be attached to the device. Exit code 0: the passport (or check) is written; 1:\n"
      "not finished; 2: bad usage, file or device. docs/commissioning.md leads through it.");
  commission->callback([&o, &code] {
    if (o.driver.path.empty() && o.host.empty()) {
      code = refuse({{"", 0, "--driver", "", "or --host is missing", "name the device's driver"}});
      return;
    }
    if (auto read = o.web ? readTokens(o.token_file, o.pages.tokens) : Expected<Done>(Done{});
        !read) {
      code = refuse(read.errors());
      return;
    }
    code = commissionCommand(o);
  });
}

}  // namespace wholehand
