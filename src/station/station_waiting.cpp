// Orders that wait for the station's main thread, and what must hold when their turn has come.
#include "runtime/interrupt_scope.hpp"
#include "station/station_core.hpp"

#include <fmt/format.h>

#include <chrono>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <string>
#include <utility>

namespace wholehand {
namespace {

constexpr auto kPoll = std::chrono::milliseconds(20);

}  // namespace

// Whether an order that waited, or that takes time, may take effect now: asked again in the moment
// of starting. What its client may do was judged when it asked; here it is that all of it still
// holds.
OrderReply Station::Core::mayStillDo(const Task& task) const {
  const Order& order = task.order;
  if (quit_) return refused(Refusal::kEnding, "the program is ending");
  if (task.refused_before) {
    return refused(Refusal::kRefusedBefore,
                   "what this client asked for before was refused: look why, then ask again");
  }
  if (task.waited_s > kLongestWait) {
    return refused(Refusal::kWaitedTooLong,
                   fmt::format("it waited {:.1f} s behind other orders, at most {} s are allowed: "
                               "look, then ask again",
                               task.waited_s.count(), kLongestWait.count()));
  }
  if (order.asker && !order.asker->connected) {
    return refused(Refusal::kNotHolder, "the client that asked is gone");
  }
  const bool lost = order.asker && order.asker->claim != order.claim;
  if (order.claim != 0 && (lost || order.claim < claim_)) {
    return refused(Refusal::kNotHolder, "this client has lost the controls since it asked");
  }
  if (!task.starts) return {true, ""};
  if (stop_asked_ > task.asked || InterruptScope::interrupted()) {
    return refused(Refusal::kStopCame, "a stop was ordered meanwhile; nothing was armed");
  }
  return refuseUnseen(order.endings_seen);
}

OrderReply Station::Core::stillDo(const Task& task) const {
  const std::lock_guard lock(mutex_);
  return mayStillDo(task);
}

// An order to arm is valid for the state that its person saw: any ending since then cancels it.
OrderReply Station::Core::refuseUnseen(std::uint32_t seen) const {
  if (seen == status_.endings) return {true, ""};
  if (seen == 0) {
    return refused(Refusal::kOtherVersion,
                   "the order does not say which stop it has seen (Arm.endings_seen, "
                   "docs/protocol.md): bring client and program to the same version");
  }
  return refused(Refusal::kStopNotSeen,
                 fmt::format("it was stopped after this was asked (ending {}, the order has seen "
                             "{}): look why, then arm again",
                             status_.endings, seen));
}

// Refuses what would be refused when its turn comes, as things are now.
OrderReply Station::Core::enqueue(const Order& order, std::uint64_t asked,
                                  const std::function<void(OrderReply)>& done) {
  Task task;
  task.order = order;
  task.asked = asked;
  task.asked_at = now();
  task.starts = order.type == OrderType::kArm;
  if (order.type == OrderType::kLoadExercise) task.order.endings_seen = status_.endings;
  if (order.type == OrderType::kSaveProfile) task.profile = profileNow();
  task.person = person_;
  task.done = done;
  OrderReply may = mayStillDo(task);
  if (!may.accepted) return may;
  if (task.starts) stops_.clear();
  tasks_.push_back(std::move(task));
  wake_.notify_all();
  return may;
}

// The order whose turn it is. The others see whether it was refused: what its client asked for next
// builds on it.
void Station::Core::runTask() {
  Task task;
  {
    std::unique_lock lock(mutex_);
    wake_.wait_for(lock, kPoll, [this] { return quit_ || !tasks_.empty(); });
    if (tasks_.empty()) return;
    task = std::move(tasks_.front());
    tasks_.pop_front();
  }
  OrderReply reply;
  try {
    reply = carryOutTask(task);
  } catch (const std::exception& error) {  // a running loop continues
    reply = refused(Refusal::kFailed, std::string("failed: ") + error.what());
    say("an order " + reply.reason);
  }
  if (!reply.accepted && task.order.client != 0) {
    const std::lock_guard lock(mutex_);
    for (Task& next : tasks_) next.refused_before |= next.order.client == task.order.client;
  }
  task.done(reply);
}

OrderReply Station::Core::carryOutTask(Task& task) {
  task.waited_s = now() - task.asked_at;
  if (OrderReply may = stillDo(task); !may.accepted) return may;
  if (task.order.type == OrderType::kArm) return armForClient(task);
  if (task.order.type == OrderType::kSaveProfile) return saveProfile(task);
  if (task.order.type == OrderType::kLoadProfile) return loadProfile(task);
  return loadExercise(task);
}

// Answers every waiting task, so that no client waits for ever.
void Station::Core::endTasks() {
  std::deque<Task> tasks;
  {
    const std::lock_guard lock(mutex_);
    over_ = true;
    tasks.swap(tasks_);
  }
  for (const Task& task : tasks) task.done(refused(Refusal::kEnding, "the program is ending"));
}

}  // namespace wholehand
