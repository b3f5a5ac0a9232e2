#pragma once

#include "vocabulary/backend.hpp"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <stdexcept>
#include <string>
#include <vector>

namespace wholehand::test {

/// A program without a loop: stores orders and shows their effect in the records that it makes.
/// Values of its exercise: 0: lead_in_m as set, 1: whether the game is alive, 2: number of aims, 3:
/// first axis of the last aim. Call it from any thread.
class FakeBackend : public ServerBackend {
 public:
  static constexpr int kAxes = 9, kJoints = 19, kValues = 48;

  FakeBackend() : scene_(makeScene(1)) {}

  void order(const Order& order, std::function<void(OrderReply)> done) override {
    OrderReply reply;
    const auto* set = order.as<orders::SetParameter>();
    if (set != nullptr && set->name == "throw") throw std::runtime_error("asked for");
    {
      const std::lock_guard lock(mutex_);
      const bool overtaken = !order.stops() && order.claim != 0 && order.claim < claim_;
      claim_ = std::max(claim_, order.claim);
      reply = overtaken
                  ? OrderReply{false, "another client holds the controls by now"}
                  : std::visit([this](const auto& what) { return carryOut(what); }, order.what);
      if (!order.is<orders::Aim>()) orders_.push_back(order);
    }
    done(reply);
  }
  [[nodiscard]] std::shared_ptr<const SceneFacts> scene() const override {
    const std::lock_guard lock(mutex_);
    return scene_;
  }
  [[nodiscard]] LoopStatus status() const override {
    const std::lock_guard lock(mutex_);
    LoopStatus status;
    status.session = scene_->session;
    status.run_state = run_state_;
    status.steering = steering_;
    status.endings = endings_;
    return status;
  }
  [[nodiscard]] bool latest(TickRecord&) const override { return false; }
  [[nodiscard]] std::vector<RecordingEntry> recordings() const override { return {}; }
  [[nodiscard]] std::string recordingPath(const std::string&) const override { return {}; }
  [[nodiscard]] std::string reportFolder(const std::string&, std::string&) override { return {}; }

  /// A record as large as those of the cocktail bar; the hand oscillates at 1 Hz.
  [[nodiscard]] TickRecord record(std::uint64_t tick) const {
    TickRecord r;
    r.tick = tick;
    r.time_s = static_cast<double>(tick) * 1e-3;
    const double swing = std::sin(2.0 * 3.14159265358979 * r.time_s);
    r.q_m = r.q_s = r.intention = AxisPosition(kAxes, 0.1 * swing);
    r.theta = JointPosition(kJoints, swing);
    r.coupling = r.damping = r.sent = r.exercise.effort = AxisEffort(kAxes, -swing);
    r.phi = AxisRatio(kAxes, 0.5);
    r.exercise.value_count = kValues;
    const std::lock_guard lock(mutex_);
    r.exercise.values[0] = lead_in_m_;
    r.exercise.values[1] = holder_alive_;
    r.exercise.values[2] = aims_;
    r.exercise.values[3] = aimed_;
    return r;
  }

  void changeScene() {
    const std::lock_guard lock(mutex_);
    scene_ = makeScene(scene_->session + 1);
  }
  /// All orders but aims, in the order of arrival.
  [[nodiscard]] std::vector<Order> orders() const {
    const std::lock_guard lock(mutex_);
    return orders_;
  }
  [[nodiscard]] int aims() const {
    const std::lock_guard lock(mutex_);
    return static_cast<int>(aims_);
  }
  [[nodiscard]] double holderAlive() const {
    const std::lock_guard lock(mutex_);
    return holder_alive_;
  }

 private:
  /// A scene of nine axes and forty capsules, which needs several datagrams.
  static std::shared_ptr<const SceneFacts> makeScene(std::uint32_t session) {
    auto facts = std::make_shared<SceneFacts>();
    facts->session = session;
    facts->program_version = "0.2.0 (test)";
    facts->hand.name = "stand-in";
    facts->hand.axis_count = kAxes;
    facts->hand.joint_count = kJoints;
    for (int i = 0; i < kJoints; ++i) {
      facts->hand.joint_names.push_back("joint_" + std::to_string(i));
    }
    for (int i = 0; i < 40; ++i) {
      Capsule capsule;
      capsule.name = "capsule_" + std::to_string(i);
      capsule.radius_m = 0.001 * i;
      facts->hand.capsules.push_back(capsule);
    }
    facts->device.name = "stand-in";
    facts->device.axes.resize(kAxes);
    for (int i = 0; i < kAxes; ++i) facts->device.axes[i].name = "axis_" + std::to_string(i);
    facts->scene.name = "scene_" + std::to_string(session);
    facts->exercise_name = "stand-in";
    facts->exercise_json = "{\"kind\":\"stand_in\"}";
    facts->value_names.assign(kValues, "value");
    facts->event_names = {"swung", "shaken"};
    facts->parameters = {{"lead_in_m", ParameterGroup::kExercise, "m", 0.0, 0.02, 0.005, 0.01}};
    facts->exercises = {"stand-in"};
    return facts;
  }

  OrderReply carryOut(const orders::Arm& arm) {
    if (arm.acknowledged_stop != endings_) return {false, "it was stopped after this was asked"};
    run_state_ = RunState::kRendering;
    return {true, ""};
  }
  OrderReply stop() {
    ++endings_;
    run_state_ = RunState::kStopped;
    return {true, ""};
  }
  OrderReply carryOut(const orders::Stop&) { return stop(); }
  OrderReply carryOut(const orders::Rest&) { return stop(); }
  OrderReply carryOut(const orders::EmergencyStop&) { return stop(); }
  OrderReply carryOut(const orders::SetParameter& set) {
    if (set.name != "lead_in_m") return {false, set.name + " is no parameter"};
    if (set.value < 0.0 || set.value > 0.02) return {false, "lead_in_m must be in [0, 0.02] m"};
    lead_in_m_ = set.value;
    return {true, ""};
  }
  OrderReply carryOut(const orders::Aim& aim) {
    if (aim.q.size() != kAxes) return {false, "an aim has 9 axes"};
    ++aims_;
    aimed_ = aim.q[0];
    return {true, ""};
  }
  OrderReply carryOut(const orders::Steer& steer) {
    steering_ = steer.by;
    return {true, ""};
  }
  OrderReply carryOut(const orders::HolderAlive& holder) {
    holder_alive_ = holder.alive ? 1.0 : 0.0;
    return {true, ""};
  }
  OrderReply carryOut(const orders::LoadExercise& load) {
    if (load.exercise != "stand-in") return {false, "there is no exercise " + load.exercise};
    scene_ = makeScene(scene_->session + 1);
    return {true, ""};
  }
  template <class Other>
  OrderReply carryOut(const Other&) {
    return {true, ""};
  }

  mutable std::mutex mutex_;
  std::shared_ptr<const SceneFacts> scene_;
  RunState run_state_ = RunState::kDisarmed;
  Steering steering_ = Steering::kVirtualPatient;
  double lead_in_m_ = 0.005, holder_alive_ = 1.0, aims_ = 0.0, aimed_ = 0.0;
  std::vector<Order> orders_;
  std::uint32_t endings_ = 1;  ///< as in a station: an order to arm must name the newest ending
  std::uint32_t claim_ = 0;    ///< as in a station: orders of a former holder are refused
};

}  // namespace wholehand::test
