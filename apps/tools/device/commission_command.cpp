#include "apps/tools/device/commission_command.hpp"

#include "apps/wholehand/shared/exit_code.hpp"
#include "apps/wholehand/shared/options.hpp"
#include "apps/wholehand/shared/pages.hpp"
#include "apps/wholehand/shared/result_files.hpp"
#include "devices/commissioning/commissioning.hpp"
#include "devices/commissioning/console/console_operator.hpp"
#include "devices/commissioning/simulated/simulated_plant.hpp"
#include "devices/host/hosted_driver.hpp"
#include "devices/passport/sealed_file.hpp"
#include "devices/plugin/plugin_device.hpp"
#include "files/device/device_file.hpp"
#include "files/text/text_file.hpp"
#include "loop/core/printable.hpp"
#include "loop/realtime/monotonic_clock.hpp"
#include "loop/realtime/thread_setup.hpp"
#include "loop/runtime/interrupt_scope.hpp"
#include "rig/run/commissioning_record.hpp"
#include "station/server/server.hpp"
#include "vocabulary/operator.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <functional>
#include <memory>
#include <optional>
#include <poll.h>
#include <string>
#include <termios.h>
#include <thread>
#include <unistd.h>
#include <utility>
#include <vector>

namespace wholehand {
namespace {

/// The operator at this terminal. The hold-to-move key is the space bar. A terminal reports no key
/// release, but a held key repeats: it counts as held from its first repetition on, and as released
/// after kRelease_ns without one. Ctrl-C releases and cancels; needs an InterruptScope.
/// At a terminal, a question accepts only what is typed after it is shown; from a pipe, also
/// earlier input.
class TerminalOperator final : public Operator {
 public:
  static constexpr std::int64_t kFirstRepeat_ns = 700'000'000;
  static constexpr std::int64_t kRelease_ns = 120'000'000;
  /// After a longer pause between two polls, the age of waiting input is unknown.
  static constexpr std::int64_t kLookedAway_ns = 100'000'000;

  TerminalOperator();
  ~TerminalOperator() override;
  TerminalOperator(const TerminalOperator&) = delete;
  TerminalOperator& operator=(const TerminalOperator&) = delete;

  void reportLine(const std::string& line, const std::vector<FoundFigure>& findings) override;
  void reportStep(const StepNews& news) override;
  void reportMotion(const Motion& motion, MotionState state) override;
  [[nodiscard]] std::optional<std::string> ask(const Question& question,
                                               const std::function<void()>& meanwhile) override;
  [[nodiscard]] bool holdsKey() override;
  [[nodiscard]] bool gaveUp() override;

 private:
  void setRaw(bool raw);
  termios former_{};
  std::string typed_;  ///< input not yet used as an answer
  bool is_terminal_ = false, raw_ = false, repeats_ = false, closed_ = false;
  std::int64_t last_space_ns_ = 0, last_look_ns_ = 0;
};

/// Ticks by CLOCK_MONOTONIC. After a missed tick, the next one follows at once.
class RealTicks final : public TickClock {
 public:
  explicit RealTicks(double period_s);
  void waitForTick() override;
  [[nodiscard]] std::int64_t now_ns() const override;

 private:
  std::int64_t period_ns_, next_ns_ = 0;
};

constexpr int kLook_ms = 5;

// Reads the input that arrives within that time; empty optional: end of the input.
std::optional<std::string> readWithin(int milliseconds) {
  pollfd in{STDIN_FILENO, POLLIN, 0};
  if (::poll(&in, 1, milliseconds) <= 0) return std::string();
  std::array<char, 256> bytes{};
  const ssize_t count = ::read(STDIN_FILENO, bytes.data(), bytes.size());
  if (count < 0 && (errno == EAGAIN || errno == EINTR)) return std::string();
  if (count <= 0) return std::nullopt;
  return std::string(bytes.data(), static_cast<std::size_t>(count));
}

std::string trimmed(const std::string& line) {
  const std::size_t first = line.find_first_not_of(" \t\r");
  if (first == std::string::npos) return {};
  return line.substr(first, line.find_last_not_of(" \t\r") - first + 1);
}

TerminalOperator::TerminalOperator() : is_terminal_(::isatty(STDIN_FILENO) == 1) {
  if (is_terminal_) ::tcgetattr(STDIN_FILENO, &former_);
}

TerminalOperator::~TerminalOperator() {
  setRaw(false);
}

void TerminalOperator::setRaw(bool raw) {
  if (!is_terminal_ || raw == raw_) return;
  termios wanted = former_;
  if (raw) wanted.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
  ::tcsetattr(STDIN_FILENO, raw ? TCSANOW : TCSAFLUSH, &wanted);
  raw_ = raw;
}

void TerminalOperator::reportLine(const std::string& line, const std::vector<FoundFigure>&) {
  std::printf("%s\n", printable(line, 1000).c_str());
}

void TerminalOperator::reportStep(const StepNews& news) {
  if (news.state == StepState::kUnderWay) {
    std::printf("Step %d of %d: %s\n", news.step + 1, kCommissioningSteps,
                stepName(static_cast<CommissioningStep>(news.step)));
  }
  if (news.state == StepState::kFailed) {
    std::fprintf(stderr, "%s\n", format(news.why).c_str());
  }
}

void TerminalOperator::reportMotion(const Motion& motion, MotionState state) {
  if (state == MotionState::kAwaitsKey) {
    std::printf("Hold the space bar: %s.\n", motion.text.c_str());
  }
}

std::optional<std::string> TerminalOperator::ask(const Question& question,
                                                 const std::function<void()>& meanwhile) {
  setRaw(false);
  if (is_terminal_) {
    typed_.clear();
    ::tcflush(STDIN_FILENO, TCIFLUSH);
  }
  std::printf("%s ", question.text.c_str());
  std::fflush(stdout);
  while (!InterruptScope::interrupted()) {
    meanwhile();
    if (const std::size_t end = typed_.find('\n'); end != std::string::npos) {
      const std::string line = trimmed(typed_.substr(0, end));  // the space bar, the hold-to-move
                                                                // key, adds leading spaces
      typed_.erase(0, end + 1);
      return line;
    }
    const auto more = readWithin(kLook_ms);
    if (!more) {
      closed_ = true;
      return std::nullopt;
    }
    typed_ += *more;
  }
  return std::nullopt;
}

bool TerminalOperator::gaveUp() {
  return !is_terminal_ || closed_ || InterruptScope::interrupted();
}

bool TerminalOperator::holdsKey() {
  if (gaveUp()) return false;
  setRaw(true);
  typed_.clear();
  const std::int64_t now_ns = monotonicNow_ns();
  if (now_ns - std::exchange(last_look_ns_, now_ns) > kLookedAway_ns) {
    ::tcflush(STDIN_FILENO, TCIFLUSH);
    // A key that was held before counts as held again with its next repetition.
    last_space_ns_ = std::exchange(repeats_, false) ? now_ns - kRelease_ns : 0;
  }
  const auto typed = readWithin(0);
  closed_ = !typed;
  if (closed_) return false;
  if (typed->find(' ') != std::string::npos) {
    repeats_ = last_space_ns_ != 0 && now_ns - last_space_ns_ < kFirstRepeat_ns;
    last_space_ns_ = now_ns;
  }
  if (repeats_ && now_ns - last_space_ns_ >= kRelease_ns) {
    repeats_ = false;
    last_space_ns_ = 0;
  }
  return repeats_;
}

RealTicks::RealTicks(double period_s) : period_ns_(std::llround(1e9 * period_s)) {}

std::int64_t RealTicks::now_ns() const {
  return monotonicNow_ns();
}

void RealTicks::waitForTick() {
  constexpr std::int64_t kSecond_ns = 1'000'000'000;
  const std::int64_t now = now_ns();
  next_ns_ = next_ns_ + period_ns_ > now - period_ns_ ? next_ns_ + period_ns_ : now + period_ns_;
  const timespec until{next_ns_ / kSecond_ns, next_ns_ % kSecond_ns};
  while (::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) == EINTR) {
  }
}

constexpr double kAnyDelay_s = 1.0;  // any delay fits, because it is measured
constexpr std::chrono::seconds kPagesAreNotified{1};

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

/// Ticks of a simulated plant in real time. On a busy machine they come late, but none is skipped.
class SimulatedTicks final : public TickClock {
 public:
  SimulatedTicks(std::shared_ptr<SimulatedPlant> plant, double period_s)
      : plant_(std::move(plant)), pace_(period_s) {}
  void waitForTick() override {
    pace_.waitForTick();
    plant_->waitForTick();
  }
  [[nodiscard]] std::int64_t now_ns() const override { return plant_->now_ns(); }

 private:
  std::shared_ptr<SimulatedPlant> plant_;
  RealTicks pace_;
};

/// The device and its clock; `plant` is set for a simulated device, `observed` for a real one.
struct Commissioned {
  std::shared_ptr<DeviceDriver> driver;
  std::shared_ptr<TickClock> clock;
  SimulatedPlant* plant = nullptr;
  std::shared_ptr<const ObservedDriver> observed = nullptr;
};

/// Tells the people at the terminal and at the pages when a call of the driver does not return. Its
/// own thread, because that of the commissioning waits for the call.
class AnswerWatch {
 public:
  /// @param show receives each change; null: only the terminal is told
  AnswerWatch(std::shared_ptr<const ObservedDriver> device, std::function<void(bool silent)> show)
      : device_(std::move(device)), show_(std::move(show)) {
    if (device_) thread_ = std::thread([this] { watch(); });
  }
  ~AnswerWatch() {
    ends_.store(true);
    if (thread_.joinable()) thread_.join();
  }
  AnswerWatch(const AnswerWatch&) = delete;
  AnswerWatch& operator=(const AnswerWatch&) = delete;

 private:
  void watch() {
    constexpr std::chrono::milliseconds kEvery{10};
    for (bool silent = false; !ends_.load(); std::this_thread::sleep_for(kEvery)) {
      if (device_->facts().overdue == silent) continue;
      silent = !silent;
      if (show_) show_(silent);
      std::printf("\r\n%s\r\n", silent ? kNoAnswer : kAnswersAgain);
      std::fflush(stdout);
    }
  }

  std::shared_ptr<const ObservedDriver> device_;
  std::function<void(bool)> show_;
  std::atomic<bool> ends_{false};
  std::thread thread_;
};

Expected<Commissioned> openCommissioned(const CommissionOptions& options,
                                        const DeviceModel& model) {
  const double period_s = 1.0 / options.rate_hz;
  if (options.simulated) {
    const auto plant = std::make_shared<SimulatedPlant>(model, period_s);
    return Commissioned{plant, std::make_shared<SimulatedTicks>(plant, period_s), plant.get()};
  }
  auto driver = openDriver(options, model);
  if (!driver) return driver.errors();
  auto observed = std::make_shared<ObservedDriver>(std::move(*driver));
  return Commissioned{observed, std::make_shared<RealTicks>(period_s), nullptr, observed};
}

/// The person. With a simulated plant, the person's hands are simulated.
class SignalActions {
 public:
  SignalActions(Operator& person, const Commissioned& what, const DeviceModel& model)
      : person_(person) {
    if (what.plant != nullptr) hands_.emplace(person, *what.plant, model);
  }
  Operator& operator*() { return hands_ ? static_cast<Operator&>(*hands_) : person_; }

 private:
  Operator& person_;
  std::optional<SimulatedHands> hands_;
};

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

int printNotFinished(const CommissionOptions& options) {
  std::printf("Not finished: no %s was written.\n", options.daily ? "check" : "passport");
  return kExitNotFit;
}

// Begins the recording of every effort of this run.
Expected<std::unique_ptr<CommissioningRecord>> beginRecord(const CommissionOptions& options,
                                                           const DeviceModel& model) {
  auto text = readWhole(model.path);
  if (!text) return text.errors();
  CommissioningRecord::Plan plan;
  plan.path = options.record;
  if (plan.path.empty()) {
    // A random part distinguishes the name from that of a program started in the same second.
    plan.path =
        fmt::format("out/recordings/commissioning-{:%Y%m%d-%H%M%S}-{}.h5",
                    fmt::localtime(std::chrono::system_clock::now()), randomName().substr(0, 8));
  }
  plan.title = (options.daily ? "Daily check of " : "Commissioning of ") + model.name +
               (options.simulated ? ", simulated" : "");
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

// A bench with a recording, and the steps that use it.
struct RecordedSteps {
  CommissioningRecord& record;
  Bench bench;
  Commissioning commissioning;

  RecordedSteps(CommissioningRecord& to, Bench moved, const CommissionOptions& options)
      : record(to), bench(std::move(moved)), commissioning(bench, planOf(options)) {
    bench.listen([this](const Bench::Tick& tick) {
      record.setStep(commissioning.stepUnderWay());
      record.keep(kept(tick, bench.places()));
    });
  }
  RecordedSteps(const RecordedSteps&) = delete;
  RecordedSteps& operator=(const RecordedSteps&) = delete;
};

// Requests real time for this thread, which moves the device like the loop of a run. Call it after
// the other threads have started, because later threads would inherit it.
void askForRealTime(const Commissioned& what) {
  if (what.plant != nullptr) return;  // a simulated clock waits for this machine
  for (const SetupLine& line : setUpThread({})) {
    if (!line.granted) std::printf("%s: %s\n", line.what.c_str(), line.sentence.c_str());
  }
}

// Refuses a daily check without a passport. Steps report their own findings.
std::optional<int> refuseWithoutPassport(const CommissionOptions& options,
                                         const Commissioning& commissioning) {
  if (!options.daily) return std::nullopt;
  const auto passport = commissioning.passportInForce();
  if (passport) return std::nullopt;
  return refuse(passport.errors());
}

int leadAtTerminal(const CommissionOptions& options, const Commissioned& what,
                   const DeviceModel& model, CommissioningRecord& record) {
  TerminalOperator terminal;
  SignalActions acting(terminal, what, model);
  Operator& person = *acting;
  auto bench = Bench::make(*what.driver, model, person, *what.clock, 1.0 / options.rate_hz);
  if (!bench) return refuse(bench.errors());
  RecordedSteps steps(record, std::move(*bench), options);
  Commissioning& commissioning = steps.commissioning;
  if (auto refused = refuseWithoutPassport(options, commissioning)) return *refused;
  const AnswerWatch watch(what.observed, nullptr);
  askForRealTime(what);
  if (options.daily) return commissioning.checkToday() ? kExitDone : kExitBadInput;
  return leadCommissioning(commissioning, person) ? kExitDone : printNotFinished(options);
}

// Steps that a page lists.
std::vector<int> stepsOf(bool daily) {
  std::vector<int> steps;
  for (int i = 0; i < kCommissioningSteps; ++i) {
    const auto step = static_cast<CommissioningStep>(i);
    const bool of_a_day = step == CommissioningStep::kHome || step == CommissioningStep::kSigns ||
                          step == CommissioningStep::kWatchdog ||
                          step == CommissioningStep::kEmergencyStop ||
                          step == CommissioningStep::kEffortLimit;
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

int leadAtPage(const CommissionOptions& options, const Commissioned& what, const DeviceModel& model,
               CommissioningRecord& record) {
  DeviceDriver& driver = *what.driver;
  CommissioningFacts about = aboutDevice(options, driver, model);
  about.recording = record.path();
  ConsoleOperator person(std::move(about), stepsOf(options.daily), monotonicNow_ns,
                         InterruptScope::interrupted);
  SignalActions acting(person, what, model);
  auto bench = Bench::make(driver, model, *acting, *what.clock, 1.0 / options.rate_hz);
  if (!bench) return refuse(bench.errors());
  ControlHolder controls;
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
  RecordedSteps steps(record, std::move(*bench), options);
  Commissioning& commissioning = steps.commissioning;
  if (auto refused = refuseWithoutPassport(options, commissioning)) return *refused;
  const AnswerWatch watch(what.observed, [&person](bool silent) { person.setSilent(silent); });
  askForRealTime(what);
  const bool written = options.daily ? leadDailyCheck(commissioning, *acting)
                                     : leadCommissioning(commissioning, *acting);
  if (!written) return printNotFinished(options);
  const std::string file = fileOf(options, commissioning, model, driver.identity());
  person.finish(file);
  std::printf("Written: %s\n", printable(file).c_str());
  std::this_thread::sleep_for(kPagesAreNotified);
  return kExitDone;
}

}  // namespace

int commissionCommand(const CommissionOptions& options) {
  const auto model = loadDeviceFile(options.device);
  if (!model) return refuse(model.errors());
  const auto what = openCommissioned(options, *model);
  if (!what) return refuse(what.errors());
  const InterruptScope interrupts;
  const auto record = beginRecord(options, *model);
  if (!record) return refuse(record.errors());
  const int code = options.web ? leadAtPage(options, *what, *model, **record)
                               : leadAtTerminal(options, *what, *model, **record);
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
  CLI::Option* host =
      commission->add_option("--host", o.host, "Name of the `wholehand device-host` that holds it")
          ->excludes(driver);
  commission
      ->add_flag("--simulated", o.simulated,
                 "Learn it: on a simulated plant of the device file; the passport arms nothing")
      ->excludes(driver)
      ->excludes(host);
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
      ->check(wholeBetween(0, 65535))
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
    if (o.driver.path.empty() && o.host.empty() && !o.simulated) {
      code = refuse({keyFault("", "--driver", "", "or --host is missing",
                              "name the device's driver, or learn with --simulated")});
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
