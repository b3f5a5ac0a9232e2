#pragma once

#include "vocabulary/backend.hpp"
#include "vocabulary/operator.hpp"

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace wholehand {

/// Dead-man switch: says whether a button is held on another machine that sends periodic
/// heartbeats. A press that has ended, for any reason, stays ended, even if late heartbeats of it
/// arrive. A press must last a moment before it counts, so that a click moves nothing. Time is an
/// argument [ns, monotonic]; one thread at a time.
class HoldSwitch {
 public:
  static constexpr std::int64_t kSilent_ns = 120'000'000;  ///< timeout of a press
  static constexpr std::int64_t kClick_ns = 200'000'000;   ///< shorter presses are clicks

  /// Receives a heartbeat of a press.
  /// @param claim number of the holder's claim to the controls (Order::claim); increases
  /// @param press number of the press within one claim; increases
  void beat(std::uint32_t claim, std::uint32_t press, std::int64_t now_ns) noexcept;
  /// Ends the current press: controls lost, stop pressed or button released.
  void end() noexcept { alive_ = false; }
  [[nodiscard]] bool held(std::int64_t now_ns) noexcept;

 private:
  void check(std::int64_t now_ns) noexcept;

  std::uint32_t claim_ = 0, press_ = 0;  ///< newest claim and press
  std::int64_t began_ns_ = 0, beat_ns_ = 0;
  bool alive_ = false;
};

/// The person who commissions a device at a page of the console. One thread asks and waits through
/// Operator. The server's thread delivers answers and the held button as orders. The server has
/// already authorised them: only the therapist who holds the controls may answer and hold the
/// button (station/server/access.hpp). Any stop ends a motion, and so does a lost or changed holder
/// of the controls.
class ConsoleOperator final : public Operator, public ServerBackend {
 public:
  /// @param about facts about the device; their steps correspond to `steps`, in order
  /// @param now_ns CLOCK_MONOTONIC, or simulated
  /// @param ended true when the program ends and no answer will come
  ConsoleOperator(CommissioningFacts about, const std::vector<int>& steps,
                  std::function<std::int64_t()> now_ns, std::function<bool()> ended);

  /// Facts for ServerOptions::commissioning. Any thread.
  [[nodiscard]] std::shared_ptr<const CommissioningFacts> facts() const;
  /// Shows pages the alarm that the device does not answer, or takes it back. Any thread.
  void setSilent(bool silent) noexcept { silent_.store(silent); }
  /// Reports to clients that the passport or check was written.
  void finish(const std::string& file);

  // Overrides of Operator, called in the thread of the commissioning.
  void reportLine(const std::string& line, const std::vector<FoundFigure>& findings) override;
  void reportStep(const StepNews& news) override;
  void reportMotion(const Motion& motion, MotionState state) override;
  [[nodiscard]] std::optional<std::string> ask(const Question& question,
                                               const std::function<void()>& meanwhile) override;
  [[nodiscard]] bool holdsKey() override;
  [[nodiscard]] bool gaveUp() override { return ended_(); }

  // Overrides of ServerBackend, called in any thread.
  void order(const Order& order, std::function<void(OrderReply)> done) override;
  [[nodiscard]] std::shared_ptr<const SceneFacts> scene() const override { return nullptr; }
  [[nodiscard]] LoopStatus status() const override;
  [[nodiscard]] bool latest(TickRecord&) const override { return false; }
  [[nodiscard]] std::vector<RecordingEntry> recordings() const override { return {}; }
  [[nodiscard]] std::string recordingPath(const std::string&) const override { return {}; }
  [[nodiscard]] std::string reportFolder(const std::string&, std::string& why) override;

 private:
  template <class Change>
  void publish(Change&& change);
  [[nodiscard]] OrderReply apply(const Order& order);
  [[nodiscard]] OrderReply takeAnswer(const orders::Answer& answer);
  OrderReply hold(const orders::HoldToMove& hold, std::uint32_t claim);

  const std::vector<int> places_;  ///< for each CommissioningStep, its index in the facts' steps
  const std::function<std::int64_t()> now_ns_;
  const std::function<bool()> ended_;

  std::atomic<bool> silent_{false};
  mutable std::mutex mutex_;
  std::condition_variable answered_;
  std::shared_ptr<const CommissioningFacts> facts_;
  HoldSwitch switch_;
  std::optional<std::string> answer_;
  int step_ = -1;  ///< index of the current step
};

}  // namespace wholehand
