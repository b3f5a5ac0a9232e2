#include "station/decide_world.hpp"

#include "station/press_permit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <utility>
#include <variant>

namespace wholehand::test::decisions {
namespace {

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

std::shared_ptr<const StationRules> stationRules(bool rehearse) {
  auto rules = std::make_shared<StationRules>();
  rules->rehearse = rehearse;
  rules->robot = true;
  rules->clinic = true;
  return rules;
}

}  // namespace

std::string nameOf(const Event& event) {
  const bool of_client = static_cast<int>(event.step) < kOfClients;
  const char* name = kNames[static_cast<std::size_t>(event.step)];
  return of_client ? fmt::format("{} {}", static_cast<char>('A' + event.client), name) : name;
}

World::World(const WorldRules& rules) : rules_(rules), state_(stationRules(rules.rehearse)) {
  state_.scene = scene("right", 1);
  state_.loaded = models("right", 1);
  for (int i = 0; i < kClients; ++i) clients_[i].shown.client = i;
  clients_[0].claim = clients_[0].named_claim = state_.claim = claims_ = 1;
}

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
    stopping_ = fault_ = raised_ = false;
    presser_ = state_.under_way->start.order.client;
    judgeStart();
  } else if (std::holds_alternative<effects::RetireRun>(effect) ||
             std::holds_alternative<effects::DropRun>(effect)) {
    has_loop_ = false;
    stopping_ = fault_ = false;
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

void World::setLimit(int client, double value_n) {
  const double before_n = limit_n_;
  const Client& by = clients_[client];
  const bool lost = by.named_claim != 0 && by.named_claim < state_.claim;
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
                   profile.parameters[kLimit] = rules_.alike ? kVisitLimit_n : 4.0;
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
                   }
                   feed(events::FirstTick{may});
                   law(may.accepted || stopping_, "a start without a permit goes on");
                 },
                 [&](const work::CloseUnused&) { feed(events::UnusedClosed{}); }},
      work);
}

void World::work(bool done, bool throws) {
  if (throws) {
    feed(events::WorkFailed{"out of memory"});
  } else {
    workOn(work::Any(state_.work), done);
  }
}

// Two limits are all that matters where clients are alike: what a visit brings, and the files'.
double World::raisedLimit() const {
  return rules_.alike ? kFileLimit_n : 6.0;
}

double World::lowerLimit(int client) const {
  return client == 0 && !rules_.alike ? 2.0 : kVisitLimit_n;
}

bool World::possible(const Event& event) const {
  const Client& client = clients_[event.client];
  if (static_cast<int>(event.step) < kOfClients && !client.connected) return false;
  const bool queues = state_.waiting.size() < (rules_.alike ? 1U : 2U);
  const bool player = event.client == 2, visits = event.client == 1 || rules_.alike;
  const bool works = !std::holds_alternative<work::None>(state_.work);
  // These cannot fail: the loop ends, the first tick is judged, unused files are closed.
  const bool sure = std::holds_alternative<work::EndSession>(state_.work) ||
                    std::holds_alternative<work::AwaitFirstTick>(state_.work) ||
                    std::holds_alternative<work::CloseUnused>(state_.work) ||
                    std::holds_alternative<work::PublishScene>(state_.work);
  switch (event.step) {
    case Step::kArm:
    case Step::kLoadLevel:
    case Step::kLoadHand:
      return queues;
    case Step::kOpenVisit:
    case Step::kCloseVisit:
      return queues && visits;
    case Step::kLoadProfile:
      return queues && !player;
    case Step::kRepeatStop:
      return stop_ids_[event.client] != 0;
    case Step::kLowerLimit:
      return !player && limit_n_ != lowerLimit(event.client);
    case Step::kRaiseLimit:
      return !player && limit_n_ != raisedLimit();
    case Step::kFallsSilent:
      return now_ms_ - client.heard_ms <= 200;
    case Step::kTurn:
      return !state_.under_way && !state_.waiting.empty();
    case Step::kWorkDone:
      return works;
    case Step::kWorkRefused:
    case Step::kWorkThrows:
      return works && !sure;
    case Step::kFault:
      return state_.live && !fault_ && !stopping_;
    case Step::kSteps:
      return false;
    default:
      return true;
  }
}

bool World::happens(const Event& event) {
  if (!possible(event)) return false;
  broken_.clear();
  const bool of_client = static_cast<int>(event.step) < kOfClients;
  if (of_client && event.step != Step::kFallsSilent && event.step != Step::kLeaves) {
    clients_[event.client].heard_ms = now_ms_;
  }
  carryOut(event);
  forget();
  return true;
}

void World::carryOut(const Event& event) {
  Client& client = clients_[event.client];
  const bool sets = event.client != 2;
  switch (event.step) {
    case Step::kLook:
      client.shown = {state_.stops.count(),
                      state_.basis.number(),
                      ended_,
                      state_.visit.number,
                      state_.scene->hand.name,
                      state_.person.valueOf(state_.scene->parameters[0]),
                      event.client};
      return;
    case Step::kArm:
      stop_ids_.fill(0);  // a stop after an order to arm is a new one
      pressed_[state_.orders + 1] = client.shown;
      return ask(event.client, orders::Arm{client.shown.endings, client.shown.basis}, sets);
    case Step::kStop:
      stop(event.client, orders::Stop{});
      stop_ids_[event.client] = order_ids_;
      return;
    case Step::kEmergencyStop:
      return stop(event.client, orders::EmergencyStop{});
    case Step::kRepeatStop:  // as pages do until they are answered
      repeated_id_ = stop_ids_[event.client];
      stop(event.client, orders::Stop{});
      repeated_id_ = 0;
      return;
    case Step::kRest:
      return stop(event.client, orders::Rest{});
    case Step::kLoadLevel:
      return ask(event.client, orders::LoadExercise{.level = 3 - state_.scene->level}, sets);
    case Step::kLoadHand: {
      const bool left = state_.scene->hand.name == "left";
      return ask(event.client, orders::LoadExercise{.hand = left ? "right" : "left"}, sets);
    }
    case Step::kOpenVisit: {
      orders::OpenVisit open;
      open.visit = state_.visit.number == 0 ? 7 : state_.visit.number;
      open.exercise = "bar";
      open.hand = "left";
      open.parameters = {{kLimit, kVisitLimit_n}};
      return ask(event.client, open);
    }
    case Step::kCloseVisit:
      return ask(event.client, orders::CloseVisit{state_.visit.number});
    case Step::kLoadProfile:
      return ask(event.client, orders::LoadProfile{"p-1"});
    case Step::kLowerLimit:
      return setLimit(event.client, lowerLimit(event.client));
    case Step::kRaiseLimit:
      return setLimit(event.client, raisedLimit());
    case Step::kGoesOn:
      return goOn(event.client);
    case Step::kLeaves:
      client.connected = false;
      client.claim = client.named_claim = 0;
      return;
    case Step::kTakesControls:
      for (Client& other : clients_) other.claim = 0;
      client.claim = client.named_claim = ++claims_;
      return ask(event.client, orders::UnattendedEnds{});
    case Step::kFallsSilent:
      client.heard_ms = now_ms_ - 201;
      return;
    case Step::kTurn: {
      const WaitingOrder turn = state_.waiting.front();
      turn_asked_ = turn.asked;
      feed(events::Turn{});
      return judgeTurn(turn);
    }
    case Step::kWorkDone:
      return work(true, false);
    case Step::kWorkRefused:
      return work(false, false);
    case Step::kWorkThrows:
      return work(false, true);
    case Step::kFault:
      fault_ = true;
      if (!state_.under_way) feed(events::EndDue{true});
      return;
    case Step::kPasses:
      return pass(300);
    case Step::kPassesLong:
      return pass(3'100);
    case Step::kPassesVeryLong:
      return pass(30'100);
    case Step::kSteps:
      return;
  }
}

// Pages that are there send beats. A loop that was asked to stop ends.
void World::pass(int passes_ms) {
  for (Client& each : clients_) {
    if (each.connected && now_ms_ - each.heard_ms <= 200) each.heard_ms += passes_ms;
  }
  now_ms_ += passes_ms;
  if (stopping_ && !state_.under_way) feed(events::EndDue{true});
}

// Keeps a world small: what nobody waits for any more is forgotten.
void World::forget() {
  std::erase_if(pressed_, [this](const auto& press) {
    const bool under_way = state_.under_way && state_.under_way->start.asked == press.first;
    return !under_way && asked_by_.count(press.first) == 0;
  });
}

}  // namespace wholehand::test::decisions
