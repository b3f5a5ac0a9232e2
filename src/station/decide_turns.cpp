#include "loop/core/printable.hpp"
#include "station/decider.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <variant>

namespace wholehand {
namespace {

namespace fs = std::filesystem;

OrderReply visitOpen(std::uint64_t visit) {
  return refused(Refusal::kVisitOpen,
                 fmt::format("visit {} is open: close it in the clinic's records first", visit));
}

/// True for the plain name of a file that ends in .toml, without a folder.
bool isTomlName(const std::string& text) {
  const fs::path name(text);
  return !name.empty() && name.filename() == name && name.extension() == ".toml";
}

/// True while the live session renders and nothing is known to end it.
bool renders(const StationState& state) {
  return state.live && state.run_state == RunState::kRendering && !state.loop_ends;
}

PersonLimits limitsNow(const StationState& state) {
  return state.person.limits(state.scene->parameters);
}

}  // namespace

Profile profileNow(const StationState& state) {
  Profile profile = state.loaded;
  profile.help = state.person.help();
  for (const PublishedParameter& parameter : state.scene->parameters) {
    profile.parameters[parameter.name] = state.person.valueOf(parameter);
  }
  return profile;
}

void Decider::on(const events::Turn&) {
  if (s_.under_way || s_.waiting.empty()) return;
  UnderWay& turn = s_.under_way.emplace();
  turn.task = std::move(s_.waiting.front());
  s_.waiting.pop_front();
  turn.task.waited_s = now_ - turn.task.asked_at;
  turn.start = turn.task;
  turn.person_before = s_.person.person();
  turn.had_session = s_.live;
  if (turn.task.starts && !s_.live) s_.starting = turn.task;
  takeTurn(turn);
}

void Decider::takeTurn(UnderWay& turn) {
  OrderReply may = mayStillDo(s_, turn.task, now_);
  if (!may.accepted) return finish(may);
  if (turn.task.order.is<orders::Arm>()) return start(true);
  may = std::visit(Overloaded{[&](const orders::LoadExercise& order) { return load(order); },
                              [&](const orders::SaveProfile& order) { return saveProfile(order); },
                              [&](const orders::LoadProfile& order) { return loadProfile(order); },
                              [&](const orders::OpenVisit& order) { return openVisit(order); },
                              [&](const orders::CloseVisit& order) { return closeVisit(order); },
                              [&](const auto&) { return notHere(turn.task.order); }},
                   turn.task.order.what);
  const bool works = !std::holds_alternative<work::None>(s_.work);
  if (!may.accepted || !works) finish(may);
}

// Ends what is under way. If an order is refused, the later orders of the same client are refused
// too, because they build on it.
void Decider::finish(OrderReply reply) {
  const UnderWay done = std::move(*s_.under_way);
  s_.under_way.reset();
  s_.work = work::None{};
  s_.starting.reset();
  if (done.kind == UnderWay::Kind::kRenewal) {
    s_.renewing = false;
    if (!reply.accepted) s_.stops.keepRestPending();
    return;
  }
  if (done.kind == UnderWay::Kind::kFirstStart) return answer(kFirstStart, std::move(reply));
  if (done.kind == UnderWay::Kind::kEnd) return;
  const Order& order = done.task.order;
  // A client that loads a person and then arms means that person. Another client's order to arm
  // does not know of the load, and is refused.
  for (WaitingOrder& next : s_.waiting) {
    const bool same = next.order.client == order.client && next.person == done.person_before;
    if (next.starts && same) next.person = s_.person.person();
  }
  if (!reply.accepted && order.client != 0) {
    // Orders given after the stop that cancelled this one are not refused: their sender knew of the
    // stop.
    const bool cancelled = done.task.starts && s_.stops.stoppedSince(done.task.asked);
    const std::uint64_t seen = cancelled ? s_.stops.newestStop() : UINT64_MAX;
    for (WaitingOrder& next : s_.waiting) {
      next.refused_before |= next.order.client == order.client && next.asked < seen;
    }
  }
  answer(done.task.asked, std::move(reply));
}

void Decider::on(const events::WorkFailed& event) {
  if (!s_.under_way) return;
  const OrderReply reply = refused(Refusal::kFailed, "failed: " + event.why);
  effects_.emplace_back(effects::Log{"an order " + reply.reason});
  UnderWay& failed = *s_.under_way;
  if (std::holds_alternative<work::CloseUnused>(s_.work)) return finish(failed.reply);
  if (failed.had_session && !s_.live) s_.stops.keepRestPending();
  if (failed.preparing) return restore(reply);
  finish(reply);
}

// An order that changes the hand is refused in a visit. Another exercise or level is allowed.
OrderReply Decider::load(const orders::LoadExercise& order) {
  if (s_.visit.number != 0 && !order.hand.empty() && order.hand != s_.loaded.hand) {
    return visitOpen(s_.visit.number);
  }
  s_.work = work::ReadModels{order.exercise, order.hand, "", order.level};
  return {true, ""};
}

OrderReply Decider::saveProfile(const orders::SaveProfile& order) {
  Profile profile = s_.under_way->task.profile;
  profile.name = order.name;
  if (profile.exercise.empty()) {
    return refused(Refusal::kOther, "a profile needs an exercise; load one first");
  }
  if (s_.visit.number != 0) return visitOpen(s_.visit.number);
  s_.work = work::SaveProfile{profile};
  return {true, ""};
}

void Decider::on(const events::ProfileSaved& event) {
  if (!event.reply.accepted) return finish(event.reply);
  const WaitingOrder& task = s_.under_way->task;
  const std::string name = task.order.as<orders::SaveProfile>()->name;
  effects_.emplace_back(effects::Log{"profile " + name + " is saved"});
  if (task.person == s_.person.person()) s_.profile = name;
  s_.work = work::PublishScene{};
}

// Refused while armed: a person must not suddenly feel another person's limits.
OrderReply Decider::loadProfile(const orders::LoadProfile& order) {
  if (s_.live) return refused(Refusal::kArmedAlready, "it is armed: stop, then load the profile");
  if (s_.visit.number != 0) return visitOpen(s_.visit.number);
  s_.work = work::ReadProfile{order.name};
  return {true, ""};
}

void Decider::on(const events::ProfileRead& event) {
  if (!event.reply.accepted) return finish(event.reply);
  const Profile& profile = event.profile;
  if (profile.device != s_.loaded.device) {
    return finish(refused(Refusal::kOtherProfile,
                          fmt::format("the profile {} is for the device {}, this is {}",
                                      profile.name, profile.device, s_.loaded.device)));
  }
  s_.under_way->profile = profile;
  s_.work = work::ReadModels{profile.exercise, profile.hand, "", profile.level};
}

// Refused while armed: a person must not suddenly feel another person's limits.
OrderReply Decider::openVisit(const orders::OpenVisit& order) {
  if (!s_.rules->clinic) {
    return refused(Refusal::kNotHere, "no visits here: the program runs without --clinic");
  }
  if (s_.live) return refused(Refusal::kArmedAlready, "it is armed: stop, then open the visit");
  if (order.visit == 0) return refused(Refusal::kOther, "a visit has a number other than 0");
  if (s_.visit.number != 0 && s_.visit.number != order.visit) return visitOpen(s_.visit.number);
  if (order.exercise.empty()) return refused(Refusal::kOther, "a visit names its exercise");
  if (order.hand.empty() && !isTomlName(order.hand_file)) {
    return refused(Refusal::kUnknownHand,
                   fmt::format("\"{}\" is no hand file: a visit names one of the hands, or a file "
                               "name that ends in .toml",
                               printable(order.hand_file)));
  }
  if (!order.prescription_file.empty() && !isTomlName(order.prescription_file)) {
    return refused(Refusal::kCannotLoad,
                   fmt::format("\"{}\" is no prescription file: a file name that ends in .toml",
                               printable(order.prescription_file)));
  }
  Profile settings;
  settings.help = order.help;
  settings.parameters = order.parameters;
  s_.under_way->profile = settings;
  s_.under_way->visit = Visit{order.visit, order.item};
  s_.work = work::ReadModels{order.exercise, order.hand, order.hand.empty() ? order.hand_file : "",
                             order.level,    false,      order.prescription_file};
  return {true, ""};
}

OrderReply Decider::closeVisit(const orders::CloseVisit& order) {
  if (s_.visit.number == 0) return {true, ""};  // the client missed an earlier answer
  if (s_.visit.number != order.visit) return visitOpen(s_.visit.number);
  if (s_.live) return refused(Refusal::kArmedAlready, "it is armed: stop, then close the visit");
  s_.under_way->profile = Profile{};
  s_.under_way->visit = Visit{};
  s_.work = work::ReadModels{.first = true};
  return {true, ""};
}

OrderReply Decider::fitsModels(const Profile& profile, const std::string& whose) const {
  const UnderWay& load = *s_.under_way;
  for (const auto& parameter : profile.parameters) {
    const std::string& name = parameter.first;  // clang 14 cannot capture structured bindings
    const double value = parameter.second;
    const auto& parameters = load.facts->parameters;
    const auto known = std::find_if(parameters.begin(), parameters.end(),
                                    [&](const PublishedParameter& p) { return p.name == name; });
    if (known == parameters.end()) {
      return refused(Refusal::kUnknownParameter,
                     fmt::format("{} sets {}, which the exercise {} does not have", whose, name,
                                 load.loaded.exercise));
    }
    if (!(value >= known->lower && value <= known->upper)) {
      return refused(Refusal::kOutOfRange,
                     fmt::format("{} sets {} = {}, which must be in [{}, {}] {}", whose, name,
                                 value, known->lower, known->upper, known->unit));
    }
  }
  return {true, ""};
}

OrderReply Decider::fitsRead(const events::ModelsRead& read) const {
  const UnderWay& load = *s_.under_way;
  if (load.visit && load.visit->number != 0) {
    return fitsModels(*load.profile, fmt::format("visit {}", load.visit->number));
  }
  if (!load.profile || load.visit) return {true, ""};
  const Profile& profile = *load.profile;
  if (read.loaded.side != profile.side) {
    return refused(Refusal::kOtherProfile,
                   fmt::format("the profile {} is for a {} hand, its hand {} is a {} one",
                               profile.name, profile.side, profile.hand, read.loaded.side));
  }
  return fitsModels(profile, "the profile " + profile.name);
}

void Decider::on(const events::ModelsRead& event) {
  UnderWay& load = *s_.under_way;
  OrderReply reply = event.reply;
  if (!reply.accepted) {
    const bool unknown =
        reply.refusal == Refusal::kUnknownExercise || reply.refusal == Refusal::kUnknownHand;
    if (load.profile && !load.visit && unknown) {
      reply.reason = fmt::format("the profile {}: {}", load.profile->name, reply.reason);
    }
    return finish(reply);
  }
  load.loads = true;
  load.facts = event.facts;
  load.loaded = event.loaded;
  load.other_hand = event.other_hand;
  load.rendered = renders(s_);
  load.had_session = s_.live;
  if (OrderReply fits = fitsRead(event); !fits.accepted) return finish(fits);
  load.start.starts = true;
  load.start.person = s_.person.person();
  // A load that cannot be rendered stops no session and opens no visit.
  const bool opens = load.task.order.is<orders::OpenVisit>();
  if (s_.rules->rehearse && (load.rendered || opens)) {
    s_.work = work::Rehearse{true};
    return;
  }
  endForLoad();
}

void Decider::on(const events::Rehearsed& event) {
  UnderWay& under_way = *s_.under_way;
  const bool next = std::get<work::Rehearse>(s_.work).next;
  OrderReply may = mayStillDo(s_, under_way.start, now_);
  if (next) {  // a stop cancels the rehearsal; the models are then loaded without one
    if (!event.reply.accepted && may.accepted) return finish(event.reply);
    under_way.rehearsed = event.reply.accepted;
    return endForLoad();
  }
  if (!may.accepted) return finishStart(may);
  if (!event.reply.accepted) return finishStart(event.reply);
  s_.rehearsed = true;  // valid until something else is loaded
  prepare();
}

void Decider::endForLoad() {
  UnderWay& load = *s_.under_way;
  if (OrderReply may = mayStillDo(s_, load.task, now_); !may.accepted) return finish(may);
  if (load.rendered) s_.starting = load.start;
  if (!s_.live) return useModels();
  beginStop(false);
  s_.work = work::EndSession{true};
}

// Puts the models read into use, with the person whom they are for. Rendering continues only if it
// was on until now and nobody stopped it. A stop or a fault remains in force. No limit rises
// without a press of Start.
void Decider::useModels() {
  UnderWay& load = *s_.under_way;
  const std::string visit_line = changePerson(load);
  effects_.emplace_back(effects::UseModels{});
  load.start.person = s_.person.person();
  if (s_.starting) s_.starting->person = load.start.person;
  const bool again = load.rendered && mayStillDo(s_, load.start, now_).accepted && !any(s_.latched);
  if (load.had_session && !again) s_.stops.keepRestPending();
  if (!visit_line.empty()) effects_.emplace_back(effects::Log{visit_line});
  if (!again) return finish({true, ""});
  start(true);
}

// The person and the published scene change together. Returns a line about the visit.
std::string Decider::changePerson(const UnderWay& load) {
  const std::shared_ptr<const SceneFacts> before = s_.scene;
  const PersonLimits limits_before = limitsNow(s_);
  const Order& order = load.task.order;
  if (load.profile || load.other_hand) {
    const bool another_visit =
        load.visit && (load.visit->number != s_.visit.number || load.visit->number == 0);
    const bool may_raise = (load.visit ? another_visit : order.may_raise_limits) && !load.rendered;
    s_.person.changePerson({load.profile ? &*load.profile : nullptr, load.task.asked,
                            load.visit.has_value(), may_raise},
                           s_.rules->first_parameters, s_.scene->parameters);
    s_.stops.changePerson();
    s_.profile = load.profile ? load.profile->name : "";
  }
  std::string line;
  if (load.visit) {
    line = load.visit->number == 0
               ? fmt::format("visit {} is closed", s_.visit.number)
               : fmt::format("visit {}, item {}", load.visit->number, load.visit->item);
    s_.visit = *load.visit;
  }
  auto facts = std::make_shared<SceneFacts>(*load.facts);
  facts->profile = s_.profile;
  facts->visit = s_.visit;
  facts->session = s_.session;
  s_.scene = std::move(facts);
  s_.loaded = load.loaded;
  s_.rehearsed = load.rehearsed;
  const std::string what = Basis::differences(*before, limits_before, *s_.scene, limitsNow(s_));
  if (!what.empty()) s_.basis.change(order.client, what);
  return line;
}

}  // namespace wholehand
