// The station's decisions, as a value: every order of events to a bounded depth, and long drawn
// ones. No thread, clock, file or device takes part; the test is the world around decide().
#include "station/decide.hpp"

#include "station/press_permit.hpp"
#include "support/figure.hpp"
#include "support/seed.hpp"
#include "support/tolerance.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <unordered_set>
#include <vector>

namespace wholehand::test {
namespace {

using Time = std::chrono::steady_clock::time_point;
using std::chrono::milliseconds;

constexpr int kClients = 3;
constexpr const char* kLimit = "most_push_n";  // what a limit is does not follow from its name
constexpr double kFileLimit_n = 8.0, kVisitLimit_n = 3.0;

/// What a client was shown, and what it then may mean by Start.
struct Shown {
  std::uint32_t endings = 1, basis = 1;
  int ended = 0;  ///< endings as the test counts them
  std::uint64_t visit = 0;
  std::string hand = "right";
  double limit_n = kFileLimit_n;
  int client = 0;
  /// What differs since only because of this client's own orders.
  bool own_hand = false, own_visit = false, own_limit = false;
};

struct Client {
  bool connected = true;
  std::uint32_t claim = 0;
  std::uint32_t named_claim = 0;  ///< what its orders name; after a loss still the lost one
  int heard_ms = 0;
  Shown shown;
};

/// Events of the world. Those of a client name it.
enum class Step : std::uint8_t {
  // of a client:
  kLook,
  kArm,
  kStop,
  kEmergencyStop,
  kRest,
  kRepeatStop,
  kLoadLevel,
  kLoadHand,
  kOpenVisit,
  kCloseVisit,
  kLoadProfile,
  kLowerLimit,
  kRaiseLimit,
  kGoesOn,
  kLeaves,
  kTakesControls,
  kFallsSilent,
  // of the program:
  kTurn,
  kWorkDone,
  kWorkRefused,
  kWorkThrows,
  kFault,
  kPasses,
  kPassesLong,
  kSteps
};
constexpr int kOfClients = static_cast<int>(Step::kTurn);
constexpr std::array<const char*, static_cast<int>(Step::kSteps)> kNames{
    "looks",        "Arm",
    "Stop",         "EmergencyStop",
    "Rest",         "repeat the stop",
    "load level",   "load hand",
    "open visit",   "close visit",
    "load profile", "lower limit",
    "raise limit",  "Go on",
    "leaves",       "takes the controls",
    "falls silent", "turn",
    "work done",    "work refused",
    "work throws",  "fault",
    "0.3 s",        "3.1 s"};

struct Event {
  Step step = Step::kTurn;
  int client = 0;
};

std::string nameOf(const Event& event) {
  const bool of_client = static_cast<int>(event.step) < kOfClients;
  const char* name = kNames[static_cast<std::size_t>(event.step)];
  return of_client ? fmt::format("{} {}", static_cast<char>('A' + event.client), name) : name;
}

std::shared_ptr<const SceneFacts> scene(const std::string& hand, int level) {
  auto facts = std::make_shared<SceneFacts>();
  facts->hand.name = hand;
  facts->hand.side = hand == "left" ? Side::kLeft : Side::kRight;
  facts->level = level;
  facts->exercise_name = "bar";
  facts->parameters.push_back(
      {kLimit, ParameterGroup::kPatient, "N", 0.0, kFileLimit_n, kFileLimit_n, 10.0, true});
  return facts;
}

Profile models(const std::string& hand, int level) {
  Profile loaded;
  loaded.device = "device";
  loaded.side = hand;
  loaded.hand = hand;
  loaded.exercise = "bar";
  loaded.level = level;
  return loaded;
}

/// Requesters belong to the test; a world writes its clients into them before it decides.
std::array<std::shared_ptr<Requester>, kClients>& requesters() {
  static std::array<std::shared_ptr<Requester>, kClients> all{
      std::make_shared<Requester>(), std::make_shared<Requester>(), std::make_shared<Requester>()};
  return all;
}

std::shared_ptr<const StationRules> rules(bool rehearse) {
  auto rules = std::make_shared<StationRules>();
  rules->rehearse = rehearse;
  rules->robot = true;
  rules->clinic = true;
  return rules;
}

/// The station's state with the world around it: clients, loop, and what the laws remember.
class World {
 public:
  explicit World(bool rehearse = true) : state_(rules(rehearse)) {
    state_.scene = scene("right", 1);
    state_.loaded = models("right", 1);
    // The first client is a therapist with the controls, the second a therapist without, the third
    // a player.
    for (int i = 0; i < kClients; ++i) clients_[i].shown.client = i;
    clients_[0].claim = clients_[0].named_claim = state_.claim = claims_ = 1;
  }

  /// False when the event cannot happen now.
  [[nodiscard]] bool happens(const Event& event);
  /// Laws that the newest event broke; empty: none.
  [[nodiscard]] const std::string& broken() const { return broken_; }
  /// Abstraction of the state: counters by rank, times cut at what they are compared with.
  [[nodiscard]] std::string key() const;
  [[nodiscard]] const StationState& state() const { return state_; }
  [[nodiscard]] std::size_t unanswered() const { return unanswered_.size(); }
  /// The client's orders still name controls that another has taken.
  [[nodiscard]] bool lostControls(int client) const {
    return clients_[client].named_claim != 0 && clients_[client].claim == 0;
  }
  [[nodiscard]] bool adopted() const { return adopted_; }
  [[nodiscard]] const OrderReply& lastReply() const { return last_reply_; }

 private:
  [[nodiscard]] Time now() const { return Time(std::chrono::hours(1) + milliseconds(now_ms_)); }
  void share() const;
  void feed(const events::Any& event);
  void judge(const effects::Any& effect);
  void judgeStart();
  void judgeTurn(const WaitingOrder& turn);
  void noteReply(std::uint64_t asked, const OrderReply& reply);
  void ask(int client, orders::Any what, bool may_raise = true);
  void stop(int client, orders::Any what);
  void goOn(int client);
  bool setLimit(int client, double value_n);
  bool work(bool done, bool throws);
  void workOn(const work::Any& work, bool done);
  void law(bool holds, const std::string& what) {
    if (!holds && broken_.empty()) broken_ = what;
  }
  void noteModels();
  template <class Change>
  void eachShownTo(int client, Change change) {
    change(clients_[client].shown);
    for (auto& [asked, shown] : pressed_) {
      if (shown.client == client) change(shown);
    }
  }

  StationState state_;
  std::array<Client, kClients> clients_;
  std::uint32_t claims_ = 0, order_ids_ = 0;
  int now_ms_ = 0;
  bool fault_ = false;     ///< the live loop has faulted
  bool stopping_ = false;  ///< the live loop was asked to stop
  bool raised_ = false;    ///< a client that did not press raised a limit since
  std::uint32_t presser_ = 0;
  bool began_ = false;     ///< effort has begun in the live session
  bool adopted_ = false;   ///< the newest event adopted a run
  bool has_loop_ = false;  ///< a run was adopted, and neither dropped nor retired
  /// The newest load whose models were read.
  struct Load {
    Order order;
    std::uint64_t asked = 0;
    std::optional<Profile> profile;
    std::optional<Visit> visit;
    bool other_hand = false, rendered = false;
  } load_;
  std::string next_hand_;  ///< of the models read last
  std::uint64_t last_stop_ = 0;
  std::uint64_t turn_asked_ = 0;            ///< the newest order that the main thread took up
  int ended_ = 0;                           ///< stops and ends of sessions
  std::map<std::uint64_t, Shown> pressed_;  ///< what was shown at each order to arm
  std::map<std::uint64_t, int> asked_by_;   ///< client of each waiting order
  std::set<std::uint64_t> doomed_;  ///< orders behind one of the same client that was refused
  std::uint32_t repeated_id_ = 0;   ///< of a stop that is repeated; 0: a new one
  std::array<std::uint32_t, kClients> stop_ids_{};
  std::set<std::uint64_t> unanswered_;
  OrderReply last_reply_;
  /// The limit as an independent account holds it: the file's, the visit's, or what was accepted.
  double limit_n_ = kFileLimit_n;
  std::uint64_t limit_set_ = 0;  ///< number of the order that set it
  std::uint64_t visit_ = 0;
  std::string broken_;
};

void World::share() const {
  for (int i = 0; i < kClients; ++i) {
    Requester& requester = *requesters()[i];
    requester.connected = clients_[i].connected;
    requester.claim = clients_[i].claim;
    requester.heard_ns =
        std::chrono::nanoseconds(std::chrono::hours(1) + milliseconds(clients_[i].heard_ms))
            .count();
  }
}

void World::feed(const events::Any& event) {
  share();
  state_.loop_ends = state_.live && (fault_ || stopping_);
  const bool rendered = state_.run_state == RunState::kRendering;
  adopted_ = false;
  for (const effects::Any& effect : decide(state_, event, now())) judge(effect);
  law(adopted_ || rendered || state_.run_state != RunState::kRendering,
      "the state says Rendering though nothing was started");
  law(state_.live == has_loop_, "the state does not know whether a loop is there");
  law(state_.live || state_.run_state != RunState::kRendering, "Rendering without a session");
  const double limit_n = state_.person.valueOf(state_.scene->parameters[0]);
  law(limit_n == limit_n_,
      fmt::format("the limit is {} N where {} N follow from what was accepted", limit_n, limit_n_));
  if (std::holds_alternative<work::None>(state_.work)) {
    law(!state_.under_way, "something is under way without work");
  } else {
    law(state_.under_way.has_value(), "work of nobody");
  }
  if (state_.waiting.empty() && !state_.under_way) {
    law(unanswered_.empty(), "an order is not answered");
  }
}

// Judges a start at the instant that its run becomes live, or that its first tick comes.
void World::judgeStart() {
  const WaitingOrder& start = state_.under_way->start;
  law(start.asked > last_stop_, "a start that a later stop has cancelled");
  if (start.order.client == 0) return;
  const Client& client = clients_[start.order.client - 1];
  law(client.connected, "a start whose presser is gone");
  law(start.order.claim == 0 || client.claim == start.order.claim,
      "a start whose presser has lost the controls");
  law(now_ms_ - client.heard_ms <= 200, "a start whose presser is not heard");
  law(now() - start.asked_at <= std::chrono::seconds(30), "a start after more than 30 s");
  if (!start.order.is<orders::Arm>()) return;
  const Shown& shown = pressed_.at(start.asked);
  law(shown.ended == ended_, "a start whose presser has not seen the last ending");
  law(shown.own_visit || shown.visit == state_.visit.number, "a start into another visit");
  law(shown.own_hand || shown.own_visit || shown.hand == state_.scene->hand.name,
      "a start with another hand");
  const double limit_n = state_.person.valueOf(state_.scene->parameters[0]);
  law(shown.own_limit || shown.own_visit || shown.own_hand || limit_n <= shown.limit_n,
      "a start above the limit that was shown");
}

// What a client asked for before its refused order was answered is refused, too: it builds on it. A
// stop that cancelled the order was seen by whatever came after the stop.
void World::noteReply(std::uint64_t asked, const OrderReply& reply) {
  law(!reply.accepted || doomed_.count(asked) == 0,
      "an order is obeyed that builds on a refused one");
  doomed_.erase(asked);
  const int client = asked_by_.at(asked);
  asked_by_.erase(asked);
  if (reply.accepted || asked > turn_asked_) return;
  for (const auto& [other, by] : asked_by_) {
    const bool knew = last_stop_ > asked && other > last_stop_;
    if (by == client && !knew) doomed_.insert(other);
  }
}

// Judges what the main thread takes up.
void World::judgeTurn(const WaitingOrder& turn) {
  if (!state_.under_way) return;
  const Order& order = turn.order;
  const Client& client = clients_[order.client - 1];
  law(client.connected, "an order of a client that is gone is carried out");
  law(order.claim == 0 || client.claim == order.claim, "an order without the controls it had");
  law(now() - turn.asked_at <= std::chrono::seconds(3), "an order that waited more than 3 s");
  const bool person = order.is<orders::OpenVisit>() || order.is<orders::CloseVisit>() ||
                      order.is<orders::LoadProfile>();
  law(!person || !state_.live, "another person is loaded while it is armed");
}

void World::judge(const effects::Any& effect) {
  const bool to_loop = std::holds_alternative<effects::StopLoop>(effect) ||
                       std::holds_alternative<effects::SetLoopParameter>(effect) ||
                       std::holds_alternative<effects::Command>(effect) ||
                       std::holds_alternative<effects::TellHolderAlive>(effect);
  law(!to_loop || state_.live, "an effect on a loop that is not there");
  if (const auto* reply = std::get_if<effects::Reply>(&effect)) {
    law(unanswered_.erase(reply->asked) == 1, "an order is answered twice");
    last_reply_ = reply->reply;
    noteReply(reply->asked, reply->reply);
  } else if (const auto* command = std::get_if<effects::Command>(&effect)) {
    law(unanswered_.erase(command->asked) == 1, "an order is answered twice");
    last_reply_ = {true, ""};
  } else if (const auto* raise = std::get_if<effects::RaiseLimit>(&effect)) {
    raised_ = raised_ || raise->client != presser_;
  } else if (std::holds_alternative<effects::StopLoop>(effect)) {
    stopping_ = true;
  } else if (std::holds_alternative<effects::AdoptRun>(effect)) {
    adopted_ = has_loop_ = true;
    stopping_ = fault_ = began_ = raised_ = false;
    presser_ = state_.under_way->start.order.client;
    judgeStart();
  } else if (std::holds_alternative<effects::RetireRun>(effect) ||
             std::holds_alternative<effects::DropRun>(effect)) {
    has_loop_ = false;
    stopping_ = fault_ = began_ = false;
  } else if (std::holds_alternative<effects::UseModels>(effect)) {
    noteModels();
  }
}

// The limit after a load, by the rules of docs/profiles.md and docs/clinic.md: that of the person
// or of the files. It rises only for another visit, or where the client may set values and nothing
// renders; a value that was set after the load was asked stays.
void World::noteModels() {
  const Load& load = load_;
  law(load.order.claim == 0 || clients_[load.order.client - 1].claim == load.order.claim,
      "a load is carried out without the controls it had");
  const Order& order = load.order;
  if (!load.profile && !load.other_hand) return;
  const bool sets = load.profile && load.profile->parameters.count(kLimit) > 0;
  const double coming_n = sets ? load.profile->parameters.at(kLimit) : kFileLimit_n;
  const bool another_visit =
      load.visit && (load.visit->number == 0 || visit_ != load.visit->number);
  const bool may_rise = (load.visit ? another_visit : order.may_raise_limits) && !load.rendered;
  const bool set_later = limit_set_ > load.asked;
  const double before_n = limit_n_;
  if (set_later && !load.visit) {
    limit_n_ = before_n;
  } else if (set_later || !may_rise) {
    limit_n_ = std::min(before_n, coming_n);
  } else {
    limit_n_ = coming_n;
  }
  // What a visit replaced does not outlive it.
  if (limit_n_ != before_n) limit_set_ = load.asked;
  visit_ = load.visit ? load.visit->number : visit_;
  eachShownTo(static_cast<int>(order.client) - 1, [&](Shown& shown) {
    shown.own_hand = shown.own_hand || load.other_hand;
    shown.own_visit = shown.own_visit || load.visit.has_value() || load.profile.has_value();
  });
}

void World::ask(int client, orders::Any what, bool may_raise) {
  const double limit_before_n = state_.person.valueOf(state_.scene->parameters[0]);
  last_reply_ = {};
  Order order{std::move(what)};
  order.client = static_cast<std::uint32_t>(client) + 1;
  order.claim = clients_[client].named_claim;
  order.id = repeated_id_ != 0 ? repeated_id_ : ++order_ids_;
  order.requester = requesters()[client];
  order.may_raise_limits = may_raise;
  unanswered_.insert(state_.orders + 1);
  asked_by_[state_.orders + 1] = client;
  const bool lost = order.claim != 0 && order.claim < state_.claim;
  const bool lowers =
      order.is<orders::SetParameter>() && order.as<orders::SetParameter>()->value < limit_before_n;
  feed(events::Asked{order});
  law(!lost || order.stops() || lowers || !last_reply_.accepted,
      "an order of a former holder is obeyed");
}

void World::stop(int client, orders::Any what) {
  const bool was_live = state_.live;
  ask(client, std::move(what));
  law(last_reply_.accepted, "a stop is refused");
  last_stop_ = state_.orders;
  if (repeated_id_ == 0) ++ended_;
  law(!was_live || stopping_, "a stop does not reach the loop");
  law(state_.run_state != RunState::kRendering, "Rendering after a stop");
}

// The exercise goes on only for a client that was shown the person, hand, level and limits of now.
void World::goOn(int client) {
  const Shown shown = clients_[client].shown;
  ask(client, orders::Action{Act::kResume, shown.basis});
  if (!last_reply_.accepted) return;
  law(shown.own_visit || shown.visit == state_.visit.number, "goes on with another visit");
  law(shown.own_hand || shown.own_visit || shown.hand == state_.scene->hand.name,
      "goes on with another hand");
  law(shown.own_limit || shown.own_visit || shown.own_hand ||
          state_.person.valueOf(state_.scene->parameters[0]) <= shown.limit_n,
      "goes on above the limit that was shown");
}

bool World::setLimit(int client, double value_n) {
  const double before_n = limit_n_;
  const Client& by = clients_[client];
  const bool lost = by.named_claim != 0 && by.named_claim < state_.claim;
  if (value_n == before_n) return false;
  // A lower limit is obeyed; a higher one by a client that was shown what is in force.
  const bool obeyed = value_n < before_n ||
                      (!lost && state_.basis.refuseOutdated(by.shown.basis, client + 1).accepted);
  if (obeyed) {
    limit_n_ = value_n;
    limit_set_ = state_.orders + 1;
  }
  ask(client, orders::SetParameter{kLimit, value_n, by.shown.basis});
  law(last_reply_.accepted == obeyed, obeyed ? "a limit is refused" : "a limit is raised unseen");
  if (obeyed) eachShownTo(client, [](Shown& shown) { shown.own_limit = true; });
  return true;
}

// The result of a piece of work. The first tick is judged as the loop judges it.
void World::workOn(const work::Any& work, bool done) {
  const OrderReply ok{true, ""}, no = refused(Refusal::kCannotStart, "it failed");
  const OrderReply reply = done ? ok : no;
  std::visit(
      Overloaded{[&](const work::None&) {},
                 [&](const work::ReadProfile& read) {
                   Profile profile = models("left", 1);
                   profile.name = read.name;
                   profile.parameters[kLimit] = 4.0;
                   feed(events::ProfileRead{reply, profile});
                 },
                 [&](const work::SaveProfile&) { feed(events::ProfileSaved{reply}); },
                 [&](const work::PublishScene&) { feed(events::ScenePublished{}); },
                 [&](const work::ReadModels& read) {
                   const std::string now_used = state_.scene->hand.name;
                   next_hand_ = read.first ? "right" : read.hand.empty() ? now_used : read.hand;
                   const UnderWay& turn = *state_.under_way;
                   load_ = {turn.task.order,
                            turn.task.asked,
                            turn.profile,
                            turn.visit,
                            next_hand_ != now_used,
                            state_.live && state_.run_state == RunState::kRendering && !fault_};
                   const int level = read.level == 0 ? state_.scene->level : read.level;
                   feed(events::ModelsRead{reply, scene(next_hand_, level),
                                           models(next_hand_, level), next_hand_ != now_used});
                 },
                 [&](const work::Rehearse&) { feed(events::Rehearsed{reply}); },
                 [&](const work::EndSession&) {
                   ended_ += std::get<work::EndSession>(state_.work).goes_on ? 0 : 1;
                   feed(events::LoopFinished{fault_, true});
                   feed(events::SessionEnded{fault_, fault_ ? Fault::kSpeedLimit : Fault::kNone});
                 },
                 [&](const work::Prepare&) { feed(events::Prepared{reply}); },
                 [&](const work::Begin&) {
                   // A loop that was asked to stop before it begins does not begin.
                   feed(events::Begun{stopping_ ? no : reply});
                 },
                 [&](const work::AwaitFirstTick&) {
                   const WaitingOrder& start = state_.under_way->start;
                   share();
                   OrderReply may =
                       PressPermit::refuse(start.order, start.asked_at, now(), state_.claim);
                   if (raised_)
                     may = refused(Refusal::kBasisChanged, "another client raised a limit");
                   if (may.accepted && !stopping_) {
                     judgeStart();
                     began_ = true;
                   }
                   feed(events::FirstTick{may});
                   law(may.accepted || stopping_, "a start without a permit goes on");
                 },
                 [&](const work::CloseUnused&) { feed(events::UnusedClosed{}); }},
      work);
}

bool World::work(bool done, bool throws) {
  const work::Any work = state_.work;
  if (std::holds_alternative<work::None>(work)) return false;
  // These cannot fail: the loop ends, the first tick is judged, unused files are closed.
  const bool sure = std::holds_alternative<work::EndSession>(work) ||
                    std::holds_alternative<work::AwaitFirstTick>(work) ||
                    std::holds_alternative<work::CloseUnused>(work) ||
                    std::holds_alternative<work::PublishScene>(work);
  if (sure && !done) return false;
  if (throws) {
    feed(events::WorkFailed{"out of memory"});
  } else {
    workOn(work, done);
  }
  return true;
}

bool World::happens(const Event& event) {
  broken_.clear();
  constexpr std::size_t kWaiting = 2;  // more of them add no kind of state
  const bool queues = event.step == Step::kArm || event.step == Step::kLoadLevel ||
                      event.step == Step::kLoadHand || event.step == Step::kOpenVisit ||
                      event.step == Step::kCloseVisit || event.step == Step::kLoadProfile;
  if (queues && state_.waiting.size() >= kWaiting) return false;
  const bool of_client = static_cast<int>(event.step) < kOfClients;
  Client& client = clients_[event.client];
  if (of_client && !client.connected) return false;
  if (of_client && event.step != Step::kFallsSilent && event.step != Step::kLeaves) {
    client.heard_ms = now_ms_;
  }
  const bool player = event.client == 2;
  switch (event.step) {
    case Step::kLook:
      client.shown = {state_.stops.count(),
                      state_.basis.number(),
                      ended_,
                      state_.visit.number,
                      state_.scene->hand.name,
                      state_.person.valueOf(state_.scene->parameters[0]),
                      event.client};
      return true;
    case Step::kArm:
      stop_ids_.fill(0);  // a stop after an order to arm is a new one
      pressed_[state_.orders + 1] = client.shown;
      ask(event.client, orders::Arm{client.shown.endings, client.shown.basis}, !player);
      return true;
    case Step::kStop:
      stop(event.client, orders::Stop{});
      stop_ids_[event.client] = order_ids_;
      return true;
    case Step::kEmergencyStop:
      stop(event.client, orders::EmergencyStop{});
      return true;
    case Step::kRepeatStop: {  // as pages do until they are answered
      if (stop_ids_[event.client] == 0) return false;
      repeated_id_ = stop_ids_[event.client];
      stop(event.client, orders::Stop{});
      repeated_id_ = 0;
      return true;
    }
    case Step::kRest:
      stop(event.client, orders::Rest{});
      return true;
    case Step::kLoadLevel:
      ask(event.client, orders::LoadExercise{.level = 3 - state_.scene->level}, !player);
      return true;
    case Step::kLoadHand:
      ask(event.client,
          orders::LoadExercise{.hand = state_.scene->hand.name == "left" ? "right" : "left"},
          !player);
      return true;
    case Step::kOpenVisit: {
      if (event.client != 1) return false;
      orders::OpenVisit open;
      open.visit = state_.visit.number == 0 ? 7 : state_.visit.number;
      open.exercise = "bar";
      open.hand = "left";
      open.parameters = {{kLimit, kVisitLimit_n}};
      ask(event.client, open);
      return true;
    }
    case Step::kCloseVisit:
      if (event.client != 1) return false;
      ask(event.client, orders::CloseVisit{state_.visit.number});
      return true;
    case Step::kLoadProfile:
      if (player) return false;
      ask(event.client, orders::LoadProfile{"p-1"});
      return true;
    case Step::kLowerLimit:
      return !player && setLimit(event.client, event.client == 0 ? 2.0 : kVisitLimit_n);
    case Step::kRaiseLimit:
      return !player && setLimit(event.client, 6.0);
    case Step::kGoesOn:
      goOn(event.client);
      return true;
    case Step::kLeaves:
      client.connected = false;
      client.claim = client.named_claim = 0;
      return true;
    case Step::kTakesControls:
      for (Client& other : clients_) other.claim = 0;
      client.claim = client.named_claim = ++claims_;
      ask(event.client, orders::UnattendedEnds{});
      return true;
    case Step::kFallsSilent:
      if (now_ms_ - client.heard_ms > 200) return false;
      client.heard_ms = now_ms_ - 201;
      return true;
    case Step::kTurn:
      if (state_.under_way || state_.waiting.empty()) return false;
      {
        const WaitingOrder turn = state_.waiting.front();
        turn_asked_ = turn.asked;
        feed(events::Turn{});
        judgeTurn(turn);
      }
      return true;
    case Step::kWorkDone:
      return work(true, false);
    case Step::kWorkRefused:
      return work(false, false);
    case Step::kWorkThrows:
      return work(false, true);
    case Step::kFault:
      if (!state_.live || fault_ || stopping_) return false;
      fault_ = true;
      if (!state_.under_way) feed(events::EndDue{true});
      return true;
    case Step::kPasses:
    case Step::kPassesLong: {
      const int passes_ms = event.step == Step::kPasses ? 300 : 3100;
      // Pages that are there send beats.
      for (Client& each : clients_) {
        if (each.connected && now_ms_ - each.heard_ms <= 200) each.heard_ms += passes_ms;
      }
      now_ms_ += passes_ms;
      if (stopping_ && !state_.under_way) feed(events::EndDue{true});
      return true;
    }
    case Step::kSteps:
      break;
  }
  return false;
}

std::string World::key() const {
  std::string out;
  const auto add = [&out](auto value) { out += std::to_string(static_cast<int>(value)) + ","; };
  const auto age = [this](Time at) {  // cut at 3 s of waiting and at 30 s of a start
    const auto passed = now() - at;
    return passed <= kLongestWait ? 0 : passed <= std::chrono::seconds(30) ? 1 : 2;
  };
  const auto task = [&](const WaitingOrder& t) {
    add(t.order.what.index());
    add(t.order.client);
    add(t.starts);
    add(t.refused_before);
    add(t.waited_s > kLongestWait);
    add(t.asked > last_stop_);
    add(doomed_.count(t.asked));
    if (const auto pressed = pressed_.find(t.asked); pressed != pressed_.end()) {
      add(pressed->second.ended == ended_);
      add(pressed->second.visit);
      add(pressed->second.limit_n);
      out += pressed->second.hand;
      add(pressed->second.own_hand);
      add(pressed->second.own_visit);
      add(pressed->second.own_limit);
    }
    add(age(t.asked_at));
    add(t.acknowledged_stop == state_.stops.count());
    add(t.person == state_.person.person());
    add(t.order.claim == 0 ? 0 : t.order.claim == state_.claim ? 1 : 2);
    if (const auto* arm = t.order.as<orders::Arm>()) {
      add(state_.basis.refuseOutdated(arm->basis_seen, t.order.client).accepted);
    }
    if (const auto* load = t.order.as<orders::LoadExercise>()) out += load->hand + ",";
  };
  for (const auto& c : clients_) {
    add(c.connected);
    add(c.claim == 0 ? 0 : c.claim == state_.claim ? 1 : 2);
    add(c.named_claim == 0 ? 0 : c.named_claim == state_.claim ? 1 : 2);
    add(c.shown.ended == ended_);
    add(stop_ids_[&c - clients_.data()] != 0);
    add(now_ms_ - c.heard_ms <= 200);
    add(c.shown.endings == state_.stops.count());
    add(state_.basis
            .refuseOutdated(c.shown.basis, static_cast<std::uint32_t>(&c - clients_.data()) + 1)
            .accepted);
    add(c.shown.visit);
    add(c.shown.limit_n);
    out += c.shown.hand;
    add(c.shown.own_hand);
    add(c.shown.own_visit);
    add(c.shown.own_limit);
  }
  add(fault_);
  add(stopping_);
  add(began_);
  add(raised_);
  add(limit_n_);
  for (const WaitingOrder& t : state_.waiting) add(limit_set_ > t.asked);
  if (state_.under_way) add(limit_set_ > state_.under_way->task.asked);
  const StationState& s = state_;
  for (const bool flag : {s.live, s.rehearsed, s.armed_for_client, s.attended, s.unattended,
                          s.keep_recording, s.renewing, s.starting.has_value()}) {
    add(flag);
  }
  add(s.run_state);
  add(s.latched);
  add(s.visit.number);
  add(s.scene->level);
  out += s.scene->hand.name + s.profile;
  add(s.person.valueOf(s.scene->parameters[0]));
  add(s.stops.rested(s.run_state));
  add(s.stops.restBeforeStart());
  add(s.work.index());
  for (const WaitingOrder& t : s.waiting) task(t);
  if (s.under_way) {
    const UnderWay& u = *s.under_way;
    out += "|";
    task(u.task);
    task(u.start);
    for (const bool flag :
         {u.loads, u.rendered, u.other_hand, u.rehearsed, u.for_client, u.preparing, u.had_session,
          u.profile.has_value(), u.visit.has_value()}) {
      add(flag);
    }
    add(u.before.run_state);
    add(u.before.rested);
    if (u.facts) out += u.facts->hand.name + std::to_string(u.facts->level);
    add(u.reply.refusal);
  }
  return out;
}

/// The program's events, and these of the clients.
std::vector<Event> eventsOf(int clients, const std::vector<Step>& steps) {
  std::vector<Event> events;
  for (int step = kOfClients; step < static_cast<int>(Step::kSteps); ++step) {
    events.push_back({static_cast<Step>(step), 0});
  }
  for (const Step step : steps) {
    for (int client = 0; client < clients; ++client) events.push_back({step, client});
  }
  return events;
}

/// Every event that may be tried.
std::vector<Event> allEvents(int clients) {
  std::vector<Event> events;
  for (int step = 0; step < static_cast<int>(Step::kSteps); ++step) {
    for (int client = 0; client < (step < kOfClients ? clients : 1); ++client) {
      events.push_back({static_cast<Step>(step), client});
    }
  }
  return events;
}

struct Search {
  std::size_t states = 0, steps = 0;
  std::set<std::string> verdicts;  ///< laws that were broken
  std::string example;             ///< shortest list of events that breaks one
  bool complete = false;           ///< no state beyond the depth is left
};

/// Explores breadth first. With `hashed` false no two states are taken as equal.
Search explore(const std::vector<Event>& events, int depth, bool hashed,
               std::size_t most_states = 3'000'000) {
  struct Node {
    World world;
    std::string path;
  };
  Search search;
  std::unordered_set<std::string> seen;
  std::vector<Node> level{{World{}, ""}};
  for (int i = 0; i < depth && !level.empty() && search.states < most_states; ++i) {
    std::vector<Node> next;
    for (const Node& node : level) {
      for (const Event& event : events) {
        World world = node.world;
        if (!world.happens(event)) continue;
        ++search.steps;
        if (!world.broken().empty()) {
          search.verdicts.insert(world.broken());
          if (search.example.empty()) {
            search.example = node.path + nameOf(event) + ": " + world.broken();
          }
          continue;
        }
        if (hashed && !seen.insert(world.key()).second) continue;
        ++search.states;
        next.push_back({std::move(world), node.path + nameOf(event) + ", "});
      }
    }
    level = std::move(next);
  }
  search.complete = level.empty();
  return search;
}

// Expected: the laws of docs/safety.md, which World states one by one.
TEST(Decide, EveryOrderOfFewEvents_KeepsTheLaws) {
  const Search search = explore(allEvents(kClients), kReducedCounts ? 3 : 5, true);
  EXPECT_TRUE(search.verdicts.empty()) << search.example;
  figure("states", static_cast<double>(search.states), "");
  figure("events tried in them", static_cast<double>(search.steps), "");
}

/// Events that a person's start depends on, explored until no new state is found.
struct Alphabet {
  const char* name;
  int clients;
  std::vector<Step> steps;
};

class DecideTogether : public testing::TestWithParam<Alphabet> {};

TEST_P(DecideTogether, AllStates_KeepTheLaws) {
  const Search search = explore(eventsOf(GetParam().clients, GetParam().steps), 1000, true);
  EXPECT_TRUE(search.verdicts.empty()) << search.example;
  EXPECT_TRUE(search.complete);
  figure("states", static_cast<double>(search.states), "");
  figure("events tried in them", static_cast<double>(search.steps), "");
}

/// The loads have 140,000 states and are explored with the large counts; the drawn lists load, too.
std::vector<Alphabet> alphabets() {
  std::vector<Alphabet> all{
      {"stops", 1, {Step::kLook, Step::kArm, Step::kStop, Step::kRest, Step::kLeaves}},
      {"limits", 1, {Step::kLook, Step::kArm, Step::kLowerLimit, Step::kRaiseLimit}}};
  if (!kReducedCounts) {
    all.push_back({"loads", 1, {Step::kLook, Step::kArm, Step::kLoadHand, Step::kStop}});
  }
  return all;
}

INSTANTIATE_TEST_SUITE_P(Of, DecideTogether, testing::ValuesIn(alphabets()),
                         [](const auto& info) { return std::string(info.param.name); });

// Taking states as equal hides nothing: without it the verdicts are the same.
TEST(Decide, StatesTakenAsEqual_GiveTheVerdictsOfAllStates) {
  const int depth = kReducedCounts ? 3 : 4;
  EXPECT_EQ(explore(allEvents(2), depth, false, 50'000'000).verdicts,
            explore(allEvents(2), depth, true, 50'000'000).verdicts);
}

TEST(Decide, LongDrawnLists_KeepTheLaws) {
  auto random = seededRandom(5801);
  const int lists = kReducedCounts ? 2'000 : 1'000'000;
  const std::vector<Event> events = allEvents(kClients);
  std::size_t adopted = 0, steps = 0;
  for (int list = 0; list < lists; ++list) {
    World world(random() % 2 == 0);
    std::string path;
    for (int i = 0; i < 60; ++i) {
      // Work goes on in every second event, or little would ever start.
      Event event = events[random() % events.size()];
      if (random() % 2 == 0) event = {world.state().under_way ? Step::kWorkDone : Step::kTurn, 0};
      if (event.step == Step::kLeaves && random() % 4 != 0) continue;
      if (event.step == Step::kArm && random() % 2 == 0) {
        (void)world.happens({Step::kLook, event.client});
      }
      if (!world.happens(event)) continue;
      ++steps;
      path += nameOf(event) + ", ";
      adopted += world.adopted() ? 1 : 0;
      ASSERT_EQ(world.broken(), "") << path;
    }
  }
  EXPECT_GT(adopted, static_cast<std::size_t>(lists) / 4);
  figure("events", static_cast<double>(steps), "");
  figure("sessions among them", static_cast<double>(adopted), "");
}

// Pressers who stay do start, whatever the others' orders to look, rest before, or load.
TEST(Decide, PresserWhoStays_Starts) {
  auto random = seededRandom(5802);
  const int draws = kReducedCounts ? 2'000 : 100'000;
  int started = 0;
  for (int draw = 0; draw < draws; ++draw) {
    World world(random() % 2 == 0);
    const int presser = static_cast<int>(random() % kClients);
    for (unsigned i = random() % 8; i > 0; --i) {  // whatever came before
      const std::vector<Event> events = allEvents(kClients);
      const Event event = events[random() % events.size()];
      if (event.step == Step::kLeaves) continue;
      (void)world.happens(event);
    }
    const auto settle = [&] {
      for (int i = 0; i < 60; ++i) {
        if (!world.happens({Step::kWorkDone, 0}) && !world.happens({Step::kTurn, 0}) &&
            (!world.state().live || !world.happens({Step::kPasses, 0}))) {
          break;
        }
      }
    };
    (void)world.happens({Step::kStop, 1});
    settle();
    ASSERT_FALSE(world.state().live);
    if (random() % 2 == 0) (void)world.happens({Step::kTakesControls, presser});
    if (world.lostControls(presser)) (void)world.happens({Step::kTakesControls, presser});
    (void)world.happens({Step::kLook, presser});
    (void)world.happens({Step::kArm, presser});
    const bool was_queued = world.unanswered() == 1;
    for (int i = 0; i < 30 && world.unanswered() > 0; ++i) {
      if (random() % 8 == 0) (void)world.happens({Step::kLook, static_cast<int>(random() % 3)});
      if (random() % 8 == 0) (void)world.happens({Step::kPasses, 0});
      if (!world.happens({Step::kTurn, 0})) (void)world.happens({Step::kWorkDone, 0});
      ASSERT_EQ(world.broken(), "");
    }
    const bool began =
        was_queued && world.lastReply().accepted && world.state().run_state == RunState::kRendering;
    started += began ? 1 : 0;
    ASSERT_TRUE(began) << world.lastReply().reason;
  }
  EXPECT_EQ(started, draws);
  figure("pressers who stayed", draws, "");
  figure("of them started", started, "");
}

}  // namespace
}  // namespace wholehand::test
