#pragma once

// A station that runs in its own thread and gets orders as from clients. In real time.
#include "station/server/server.hpp"
#include "support/bar_station.hpp"
#include "support/figure.hpp"
#include "support/folder.hpp"
#include "support/watched_main.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <future>
#include <mutex>
#include <thread>

namespace wholehand::test {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

constexpr auto kHang = 300s;  ///< bounds a hang; a slow machine stays below it

inline const std::string kRoot = WHOLEHAND_SOURCE_DIR;
inline const std::vector<orders::Any> kStops{orders::Stop{}, orders::EmergencyStop{}};
/// Loads the second level of the current exercise.
inline const orders::LoadExercise kLoadLevel2{.level = 2};

/// A player that jumps to another position, faster than the device allows, 0.7 s after `may` is
/// set.
class FastPlayer final : public Player {
 public:
  explicit FastPlayer(int axes, std::shared_ptr<const std::atomic<bool>> may = nullptr)
      : rest_(axes), may_(std::move(may)) {}
  [[nodiscard]] AxisPosition start() const override { return rest_; }
  void reset() override { periods_ = 0; }
  void advance(double, AxisPosition& q, AxisVelocity& qd) noexcept override {
    q = rest_;
    qd = AxisVelocity(rest_.size());
    if (!may_ || *may_) ++periods_;
    q[0] = periods_ < 700 ? -0.08 : 0.3;  // 300 N/m on 1.8 kg: exceeds 1.5 m/s
  }
  void onRecord(const TickRecord&) noexcept override {}

 private:
  AxisPosition rest_;
  std::shared_ptr<const std::atomic<bool>> may_;  ///< null: set from the start
  int periods_ = 0;
};

/// Fixture with the bar's station and a temporary folder.
class Bar : public testing::Test {
 protected:
  /// The bar's station; a test may change it before it is loaded.
  StationConfig barConfig() {
    StationConfig config = barStation();
    config.recordings_folder = folder_ + "/recordings";
    config.rehearsal.allowed_period_share = 100.0;  // passes on a busy machine
    config.log = [this](const std::string& line) {
      const std::lock_guard lock(log_mutex_);
      log_ += line + "\n";
    };
    return config;
  }
  void load(const StationConfig& config) {
    station_ = std::make_unique<Station>(config);
    const auto loaded = station_->load();
    ASSERT_TRUE(loaded) << format(loaded.errors());
    station_->addSink([this](const TickRecord& record) {
      ++records_;
      last_ = record.tick;
    });
  }
  void TearDown() override {
    if (thread_.joinable()) {
      station_->quit();
      thread_.join();
    }
  }

  void run(bool arm_at_once) {
    seesRealTime();
    if (!station_) load(barConfig());
    thread_ = std::thread([this, arm_at_once] {
      auto outcome = station_->run(arm_at_once, 0.0);
      ASSERT_TRUE(outcome) << format(outcome.errors());
      outcome_ = std::move(*outcome);
    });
  }
  /// Ends the station and returns its outcome.
  const StationOutcome& quit() {
    station_->quit();
    thread_.join();
    return outcome_;
  }
  /// Waits until the log contains `part`; the log has its own thread.
  [[nodiscard]] bool logContains(const std::string& part) {
    return becomes([&] { return log().find(part) != std::string::npos; });
  }
  [[nodiscard]] std::string log() {
    const std::lock_guard lock(log_mutex_);
    return log_;
  }
  std::future<OrderReply> askLater(const Order& order) {
    auto answered = std::make_shared<std::promise<OrderReply>>();
    station_->order(order, [answered](const OrderReply& reply) { answered->set_value(reply); });
    return answered->get_future();
  }
  OrderReply ask(const Order& order) {
    auto answer = askLater(order);
    if (answer.wait_for(kHang) != std::future_status::ready) return {false, "no answer"};
    return answer.get();
  }
  OrderReply ask(orders::Any what) { return ask(of(std::move(what))); }
  /// An order of a client that has seen the present state: an order to arm names the newest ending
  /// and the basis, an order to set a parameter or to act the basis.
  [[nodiscard]] Order of(orders::Any what, std::uint32_t claim = 0) const {
    auto* arm = std::get_if<orders::Arm>(&what);
    auto* set = std::get_if<orders::SetParameter>(&what);
    auto* act = std::get_if<orders::Action>(&what);
    if (station_ && (arm != nullptr || set != nullptr || act != nullptr)) {
      const LoopStatus shown = station_->status();
      if (arm != nullptr) *arm = {shown.endings, shown.basis};
      if (set != nullptr) set->basis_seen = shown.basis;
      if (act != nullptr) act->basis_seen = shown.basis;
    }
    Order order{std::move(what)};
    order.claim = claim;
    return order;
  }
  template <class Condition>
  static bool becomes(Condition&& condition) {
    const auto until = Clock::now() + kHang;
    while (Clock::now() < until) {
      if (condition()) return true;
      std::this_thread::sleep_for(2ms);
    }
    return condition();
  }
  bool becomes(RunState state) {
    return becomes([&] { return station_->status().run_state == state; });
  }
  bool rendersOn() {
    const std::uint64_t before = records_;
    return becomes([&] { return records_ > before + 100; });
  }

  /// Waits until the virtual patient squeezes a dispenser: the exercise pushes, and there is an
  /// effort that a stop must remove.
  bool squeezes() {
    TickRecord record;
    return becomes([&] {
      return station_->latest(record) && record.exercise.alpha == 1.0 &&
             largest(record.exercise.effort) > 0.01 && largest(record.sent) > 0.1;
    });
  }
  static double largest(const AxisEffort& effort) {
    double most = 0.0;
    for (double e : effort) most = std::max(most, std::abs(e));
    return most;
  }
  /// Checks that the state is reached and kept for 1.5 s; an unwanted arming would take less than 1
  /// s.
  void staysAt(RunState state) {
    EXPECT_TRUE(becomes(state));
    std::this_thread::sleep_for(1500ms);
    EXPECT_EQ(station_->status().run_state, state) << kAlways;
    expectNeutral();
  }
  /// Checks that the last record, if there is one, has no effort.
  void expectNeutral() {
    TickRecord record;
    if (station_->latest(record)) {
      EXPECT_EQ(largest(record.sent), 0.0) << kAlways;
    }
  }
  void later(orders::Any what) {
    station_->order(of(std::move(what)), [](const OrderReply&) {});
  }

  const Folder temporary_;
  const std::string folder_ = temporary_.path();
  StationOutcome outcome_;
  std::mutex log_mutex_;
  std::string log_;
  std::unique_ptr<Station> station_;
  std::atomic<std::uint64_t> records_{0}, last_{0};
  std::thread thread_;
};

/// The bar with a server, so that pages can connect.
class ServedBar : public Bar {
 protected:
  void serve() {
    ServerOptions options;
    options.port = 0;
    server_ = orThrow(Server::open(*station_, options, controls_));
    run(false);
  }
  void TearDown() override {
    Bar::TearDown();
    server_.reset();
  }

  ControlHolder controls_;
  std::unique_ptr<Server> server_;
};

}  // namespace wholehand::test
