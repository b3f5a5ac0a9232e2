// Once nobody holds the key, nothing pushes: in every step, for every way of release, at any tick,
// also while a question is asked. A page and an operator control the fake device on its simulated
// clock.
#include "devices/commissioning/commissioning.hpp"
#include "devices/commissioning/console/console_operator.hpp"
#include "fake_device.hpp"
#include "files/device/device_file.hpp"
#include "passport_file.hpp"
#include "support/contains.hpp"
#include "support/figure.hpp"
#include "support/seed.hpp"

#include <numeric>

namespace wholehand::test {
namespace {

using Step = CommissioningStep;

constexpr std::int64_t kMillisecond_ns = 1'000'000;
constexpr std::int64_t kBeat_ns = 40 * kMillisecond_ns;
// Requirement of docs/commissioning.md.
constexpr std::int64_t kNeutralWithin_ns = 150 * kMillisecond_ns;
// An effort acts for so long after it was commanded [the delays of the device files, and a tick].
constexpr std::int64_t kActs_ns = 5 * kMillisecond_ns;
constexpr std::int64_t kPressedAgainAfter_ns = 1'000 * kMillisecond_ns;

const char* const kWays[] = {"key up", "leader lost",   "controls released",
                             "Stop",   "EmergencyStop", "page silent"};

/// The leading page, and the person who holds its button and carries out the requested actions by
/// hand.
class AttendingOperator final : public Operator {
 public:
  AttendingOperator(FakeDevice& device, const DeviceModel& model)
      : device_(device), hands_(device, model) {
    device_.on_tick = [this] { tick(); };
  }

  void reportLine(const std::string& line, const std::vector<FoundFigure>& f) override {
    console_.reportLine(line, f);
    hands_.reportLine(line, f);
  }
  void reportStep(const StepNews& news) override { console_.reportStep(news); }
  void reportMotion(const Motion& motion, MotionState state) override {
    console_.reportMotion(motion, state);
    hands_.reportMotion(motion, state);
  }
  std::optional<std::string> ask(const Question& question,
                                 const std::function<void()>& meanwhile) override {
    noteLetGo(device_.now_ns());
    bool answered = false;
    auto words = console_.ask(question, [&] {
      if (std::exchange(answered, true)) return;
      for (int i = 0; i < 300; ++i) {  // the person reads and thinks
        device_.waitForTick();
        meanwhile();
      }
      const std::uint32_t number = console_.facts()->question;
      give(orders::Answer{number, *hands_.ask(question, meanwhile)});
    });
    pressAnew();
    return words;
  }
  bool holdsKey() override {
    (void)hands_.holdsKey();
    return console_.holdsKey();
  }
  bool gaveUp() override { return false; }

  /// Releases the key once in `ticks` ticks, by way `way`; presses it again a second later.
  void letGoIn(long ticks, std::size_t way) {
    lets_go_in_ = ticks;
    way_ = way;
  }
  [[nodiscard]] long ticks() const { return ticks_; }
  [[nodiscard]] double longest_ms() const {
    return static_cast<double>(longest_ns_) / kMillisecond_ns;
  }

 private:
  void give(orders::Any what) {
    Order order{std::move(what)};
    order.claim = claim_;
    console_.order(order, [](const OrderReply&) {});
  }
  void beat(bool held) {
    give(orders::HoldToMove{press_, held});
    beat_ns_ = device_.now_ns();
  }
  void noteLetGo(std::int64_t at_ns) {
    holds_ = false;
    let_go_ns_ = std::min(let_go_ns_, at_ns);
  }
  void pressAnew() {
    holds_ = true;
    let_go_ns_ = INT64_MAX;
    ++press_;
    beat(true);
  }
  void letGo() {
    const std::int64_t last_ns = way_ == 5 ? beat_ns_ : device_.now_ns();
    switch (way_) {
      case 0:
        beat(false);
        break;
      case 1:
        give(orders::HolderAlive{false});
        ++claim_;
        break;
      case 2:
        give(orders::Steer{});
        ++claim_;
        break;
      case 3:
        give(orders::Stop{});
        break;
      case 4:
        give(orders::EmergencyStop{});
        break;
      default:
        break;
    }
    noteLetGo(last_ns);
  }
  void tick() {
    ++ticks_;
    const std::int64_t now_ns = device_.now_ns();
    if (lets_go_in_ > 0 && --lets_go_in_ == 0 && holds_) {
      letGo();
      pressed_again_ns_ = now_ns + kPressedAgainAfter_ns;
    }
    if (now_ns >= pressed_again_ns_) {
      pressed_again_ns_ = INT64_MAX;
      if (console_.facts()->asked == QuestionKind::kNothing) pressAnew();
    }
    if (holds_ && now_ns - beat_ns_ >= kBeat_ns) beat(true);
    check(now_ns);
  }
  // Judges by the motors, not by the reports of the bench.
  void check(std::int64_t now_ns) {
    const Mechanism& m = device_.mechanism;
    for (std::size_t i = 0; i < device_.acting.size(); ++i) {
      const double pulled = std::abs(m.pushed[i]) / m.axis(i).mass * 1e-3;
      const bool faster = std::abs(m.speed(i)) > std::abs(speed_[i]) + pulled + 1e-9;
      if (let_go_ns_ != INT64_MAX && (device_.enabled() || device_.acting[i] != 0.0)) {
        longest_ns_ = std::max(longest_ns_, now_ns - let_go_ns_);
      }
      const bool later = let_go_ns_ != INT64_MAX && now_ns - let_go_ns_ > kNeutralWithin_ns;
      EXPECT_FALSE(later && device_.enabled()) << where();
      EXPECT_FALSE(later && device_.acting[i] != 0.0) << where();
      const bool long_after = later && now_ns - let_go_ns_ > kNeutralWithin_ns + kActs_ns;
      EXPECT_FALSE(long_after && faster) << where() << ": axis " << i << " is driven";
      speed_[i] = m.speed(i);
    }
  }
  [[nodiscard]] std::string where() const {
    const auto facts = console_.facts();
    std::string out = kWays[way_];
    for (const auto& step : facts->steps) {
      if (step.state == StepState::kUnderWay) out += " in " + step.name;
    }
    return out + ", asked " + std::to_string(static_cast<int>(facts->asked));
  }
  static std::vector<int> everyStep() {
    std::vector<int> steps(kCommissioningSteps);
    std::iota(steps.begin(), steps.end(), 0);
    return steps;
  }

  FakeDevice& device_;
  ScriptedOperator hands_;
  ConsoleOperator console_{
      {}, everyStep(), [this] { return device_.now_ns(); }, [] { return false; }};
  bool holds_ = true;
  std::uint32_t claim_ = 1, press_ = 1;
  std::int64_t beat_ns_ = 0, let_go_ns_ = INT64_MAX, pressed_again_ns_ = INT64_MAX;
  std::int64_t longest_ns_ = 0;
  long ticks_ = 0, lets_go_in_ = 0;
  std::size_t way_ = 0;
  std::array<double, WH_MAX_AXES> speed_{};
};

TEST(LettingGo, KeyReleasedInAnyWayAndStep_DisablesWithin150Ms) {
  Folder folder;
  const std::string file = folder.file("mine.toml");
  std::filesystem::copy_file(WHOLEHAND_SOURCE_DIR "/config/devices/desktop-3axis.toml", file);
  const DeviceModel model = orThrow(loadDeviceFile(file));
  FakeDevice device(model, {});
  AttendingOperator bedside(device, model);
  Bench bench = orThrow(Bench::make(device, model, bedside, device, 1e-3));
  CommissioningPlan plan;
  plan.operator_name = "Test";
  plan.now = [] { return PlaceTime{}; };
  plan.write = [](const std::string&, const std::string&) -> Expected<Done> { return Done{}; };
  plan.draw = [](const ChartPage&, const std::string&) -> Expected<Done> { return Done{}; };
  Commissioning commissioning(bench, plan);
  std::mt19937_64 random = seededRandom(434);
  // A step that ended may leave the device anywhere; a person puts it back, takes the weight off
  // and releases the stop.
  const auto carryOut = [&](Step step) {
    for (std::size_t i = 0; i < model.axes.size(); ++i) {
      const DeviceAxis& a = model.axes[i];
      device.mechanism.pushed[i] = 0.0;
      device.mechanism.place(i, a.lower + 0.35 * (a.upper - a.lower));
    }
    device.stop_pressed = false;
    return commissioning.carryOut(step);
  };
  for (int i = 0; i < kCommissioningSteps; ++i) {
    const auto step = static_cast<Step>(i);
    const long before = bedside.ticks();
    const auto first = carryOut(step);
    ASSERT_TRUE(first.ok()) << format(first.errors());
    // Only the beginning of a long measurement is tested.
    const long takes = std::min(bedside.ticks() - before, underFull() ? 1L << 40 : 6000L);
    for (std::size_t way = 0; takes > 0 && way < std::size(kWays); ++way) {
      for (int run = 0; run < cases(1); ++run) {
        bedside.letGoIn(std::uniform_int_distribution<long>(1, takes)(random), way);
        (void)carryOut(step);  // refused, or released while nothing moved
        if (HasFailure()) return;
      }
    }
    bedside.letGoIn(0, 0);
    const auto last = carryOut(step);
    ASSERT_TRUE(last.ok()) << format(last.errors());
  }
  figure("let go in a commissioning, disabled after", bedside.longest_ms(), "ms");
  EXPECT_GT(bedside.longest_ms(), 20.0) << "no way to let go ended a move";
}

}  // namespace
}  // namespace wholehand::test
