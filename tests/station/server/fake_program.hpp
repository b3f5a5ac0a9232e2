#pragma once

#include "loop/realtime/monotonic_clock.hpp"
#include "station/server/raw_client.hpp"
#include "station/server/server.hpp"
#include "support/watched_main.hpp"
#include "vocabulary/backend.hpp"
#include "wholehand_generated.h"

#include <atomic>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <future>
#include <mutex>
#include <new>
#include <stdexcept>
#include <thread>

namespace wholehand::test {

/// A program without a loop: gives the answers that the test sets and stores the orders that it
/// gets.
class FakeProgram final : public ServerBackend {
 public:
  struct ReceivedOrder {
    Order order;
    std::int64_t at_ns = 0;
  };

  void order(const Order& order, std::function<void(OrderReply)> done) override {
    {
      const std::lock_guard lock(mutex_);
      asked_.push_back({order, monotonicNow_ns()});
    }
    const auto* set = order.as<orders::SetParameter>();
    if (set != nullptr && set->name == "throw") throw std::runtime_error("asked for");
    if (set != nullptr && set->value > 1.0) {
      done(refused(Refusal::kOutOfRange, "lead_in_m = 2: must be in [0, 1]"));
    } else if (order.is<orders::LoadExercise>()) {
      std::thread([done = std::move(done)] {
        done({true, ""});
      }).detach();  // from another thread, as in the real program
    } else {
      done({true, ""});
    }
  }
  std::shared_ptr<const SceneFacts> scene() const override {
    if (in_tick) in_tick();
    const std::lock_guard lock(mutex_);
    return scene_;
  }
  LoopStatus status() const override {
    if (in_status) in_status();
    const std::lock_guard lock(mutex_);
    return status_;
  }
  bool latest(TickRecord& record) const override {
    const std::lock_guard lock(mutex_);
    if (has_record_) record = record_;
    return has_record_;
  }
  std::vector<RecordingEntry> recordings() const override {
    const std::string name = "night shift.h5";
    return {{name, "cocktail-bar, level 2", "", "2026-11-20T08:00:00Z", 61.5, 11, 0,
             scene()->recording == name}};
  }
  std::string recordingPath(const std::string& name) const override {
    if (no_memory) throw std::bad_alloc();
    return name == "night shift.h5" ? (folder / "night shift.h5").string() : "";
  }
  std::string reportFolder(const std::string& name, std::string& why) override {
    report_begun = true;
    if (report_waits_for.valid()) report_waits_for.wait();
    if (report_fails) why = "the recording is <damaged>";
    return report_fails || name != "night shift.h5" ? "" : (folder / "report").string();
  }

  // The test calls the following from any thread.
  void setScene(SceneFacts facts) {
    auto scene = std::make_shared<const SceneFacts>(std::move(facts));
    const std::lock_guard lock(mutex_);
    scene_ = std::move(scene);
  }
  void setStatus(LoopStatus status) {
    const std::lock_guard lock(mutex_);
    status_ = std::move(status);
  }
  void setRecord(const TickRecord& record) {
    const std::lock_guard lock(mutex_);
    record_ = record;
    has_record_ = true;
  }
  std::vector<ReceivedOrder> asked() const {
    const std::lock_guard lock(mutex_);
    return asked_;
  }
  /// Orders of these kinds, as soon as `count` have come or the time is over.
  template <class... Kinds>
  std::vector<ReceivedOrder> askedFor(std::size_t count,
                                      std::chrono::milliseconds within = kPatience) const {
    const auto until = std::chrono::steady_clock::now() + within;
    while (true) {
      std::vector<ReceivedOrder> found;
      for (const ReceivedOrder& a : asked()) {
        if ((a.order.is<Kinds>() || ...)) found.push_back(a);
      }
      if (found.size() >= count || std::chrono::steady_clock::now() > until) return found;
      std::this_thread::sleep_for(1ms);
    }
  }
  /// The same for orders that name bodies.
  std::vector<ReceivedOrder> askedForBodies(std::size_t count,
                                            std::chrono::milliseconds within = kPatience) const {
    return askedFor<orders::Spawn, orders::Remove, orders::Teleport, orders::SetOwner,
                    orders::BodyTargets>(count, within);
  }

  std::filesystem::path folder;
  /// Set it before the server is opened. It runs first in each tick of the server, and may run in
  /// other threads.
  std::function<void()> in_tick;
  std::function<void()> in_status;            ///< called when the status is asked for
  std::shared_future<void> report_waits_for;  ///< if set, a report waits for it
  std::atomic<bool> report_begun{false};
  bool report_fails = false;
  std::atomic<bool> no_memory{false};

 private:
  mutable std::mutex mutex_;
  std::vector<ReceivedOrder> asked_;
  std::shared_ptr<const SceneFacts> scene_ = std::make_shared<const SceneFacts>();
  LoopStatus status_;
  TickRecord record_;
  bool has_record_ = false;
};

/// A record as large as the bar's: 9 axes, 64 contacts, 48 values.
inline TickRecord busyRecord() {
  TickRecord r;
  r.q_m = r.q_s = r.intention = AxisPosition(9, 0.1);
  r.coupling = r.damping = r.sent = r.exercise.effort = AxisEffort(9, 0.1);
  r.phi = AxisRatio(9, 0.1);
  r.theta = JointPosition(25, 0.1);
  r.body_count = 8;
  r.contact_count = kMaxContacts;
  r.exercise.value_count = kMaxExerciseValues;
  return r;
}

/// Publishes 1000 records a second, as telemetry does.
class FakeLoop {
 public:
  FakeLoop(FakeProgram& program, Server& server)
      : thread_([this, &program, &server] {
          seesRealTime();
          TickRecord r = busyRecord();
          auto next = std::chrono::steady_clock::now();
          while (!stopping_) {
            ++r.tick;
            program.setRecord(r);
            server.publish(r);
            std::this_thread::sleep_until(next += 1ms);
          }
        }) {}
  ~FakeLoop() {
    stopping_ = true;
    thread_.join();
  }
  FakeLoop(const FakeLoop&) = delete;
  FakeLoop& operator=(const FakeLoop&) = delete;

 private:
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

/// Reads the messages of the program.
namespace replies {

namespace fb = wholehand::protocol;

inline const fb::Message& message(const WebSocket::Frame& frame) {
  flatbuffers::Verifier verifier(frame.bytes().data(), frame.bytes().size());
  if (frame.opcode != 2 || !fb::VerifyMessageBuffer(verifier))
    throw std::runtime_error("no message");
  return *fb::GetMessage(frame.payload.data());
}

/// The next message of one kind; others are skipped. None if the time is over.
inline std::optional<WebSocket::Frame> next(WebSocket& socket, fb::Payload kind,
                                            std::chrono::milliseconds within = kPatience) {
  const auto until = std::chrono::steady_clock::now() + within;
  while (std::chrono::steady_clock::now() < until) {
    auto frame = socket.receive(within);
    if (!frame || frame->opcode != 2) return std::nullopt;
    if (message(*frame).payload_type() == kind) return frame;
  }
  return std::nullopt;
}

struct Answer {
  std::uint32_t command = 0;
  bool accepted = false;
  std::string reason = "no reply came";
  fb::Refusal refusal = fb::Refusal::None;
};

inline Answer answer(WebSocket& socket) {
  const auto frame = next(socket, fb::Payload::Reply);
  if (!frame) return {};
  const auto* r = message(*frame).payload_as_Reply();
  return {r->command(), r->accepted(), r->reason()->str(), r->refusal()};
}

}  // namespace replies

}  // namespace wholehand::test
