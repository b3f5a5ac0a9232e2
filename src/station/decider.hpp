#pragma once

#include "station/decide.hpp"

#include <cstdint>
#include <string>
#include <utility>

namespace wholehand {

/// One call of decide(): the state, the time, and the effects so far.
class Decider {
 public:
  Decider(StationState& state, std::chrono::steady_clock::time_point now) : s_(state), now_(now) {}

  void on(const events::Asked& event);
  void on(const events::Turn&);
  void on(const events::FirstStart&);
  void on(const events::EndDue& event);
  void on(const events::RenewalDue&);
  void on(const events::PersonMoved&);
  void on(const events::Quit&) { s_.quit = true; }
  void on(const events::Over&);
  void on(const events::ProfileRead& event);
  void on(const events::ProfileSaved& event);
  void on(const events::ScenePublished&) { finish({true, ""}); }
  void on(const events::ModelsRead& event);
  void on(const events::Rehearsed& event);
  void on(const events::LoopFinished& event);
  void on(const events::SessionEnded& event);
  void on(const events::Prepared& event);
  void on(const events::Begun& event);
  void on(const events::FirstTick& event);
  void on(const events::UnusedClosed&);
  void on(const events::WorkFailed& event);

  [[nodiscard]] Effects effects() { return std::move(effects_); }

 private:
  // Orders on arrival (decide_orders.cpp):
  void answer(std::uint64_t asked, OrderReply reply);
  OrderReply enqueue(const Order& order);
  void countParticipant(const Order& order);
  OrderReply carryOut(const Order& order);
  OrderReply stop(const Order& order);
  OrderReply setParameter(const orders::SetParameter& order, std::uint32_t client);
  OrderReply setHelp(const orders::SetHelp& order);
  OrderReply aim(const orders::Aim& order);
  OrderReply steer(Steering by);
  OrderReply act(const orders::Action& action, std::uint32_t client);
  OrderReply tellHolderAlive(bool alive);
  OrderReply markUnattended(const Order& order);
  OrderReply push(const Command& command);
  void beginStop(bool at_once);

  // Orders at their turn (decide_turns.cpp):
  void takeTurn(UnderWay& turn);
  OrderReply load(const orders::LoadExercise& order);
  OrderReply saveProfile(const orders::SaveProfile& order);
  OrderReply loadProfile(const orders::LoadProfile& order);
  OrderReply openVisit(const orders::OpenVisit& order);
  OrderReply closeVisit(const orders::CloseVisit& order);
  OrderReply fitsModels(const Profile& profile, const std::string& whose) const;
  OrderReply fitsRead(const events::ModelsRead& read) const;
  void endForLoad();
  void useModels();
  std::string changePerson(const UnderWay& load);
  void finish(OrderReply reply);

  // Steps from an order to arm to a running loop (decide_starts.cpp):
  void start(bool for_client);
  void prepare();
  void adopt();
  void restore(OrderReply reply);
  void finishStart(OrderReply reply);

  StationState& s_;
  const std::chrono::steady_clock::time_point now_;
  std::uint64_t asked_ = 0;  ///< number of the order that arrives
  Effects effects_;
};

/// True when an order is about to start the device and nothing has cancelled it.
[[nodiscard]] bool isArming(const StationState& state, std::chrono::steady_clock::time_point now);

/// Refuses an order of an earlier holder, or notes the newest claim. Stops and lowered limits are
/// always obeyed.
[[nodiscard]] OrderReply refuseSuperseded(StationState& state, const Order& order);

[[nodiscard]] Profile profileNow(const StationState& state);

}  // namespace wholehand
