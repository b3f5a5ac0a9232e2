#pragma once

#include "station/decide.hpp"

#include <array>
#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>

namespace wholehand::test::decisions {

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
  kPassesVeryLong,
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
    "0.3 s",        "3.1 s",
    "30.1 s"};

struct Event {
  Step step = Step::kTurn;
  int client = 0;
};

[[nodiscard]] std::string nameOf(const Event& event);

/// How a world is drawn.
struct WorldRules {
  bool rehearse = true;
  /// The first two clients may do the same, so that states differ by more than their names.
  bool alike = false;
  bool repeats = true;  ///< stops are repeated
};

/// Hash of a list of small numbers, by the finaliser of MurmurHash3 after each.
class Key {
 public:
  void add(std::uint64_t number) {
    value_ = (value_ ^ number) * 0xff51afd7ed558ccdULL;
    value_ ^= value_ >> 33U;
    value_ = value_ * 0xc4ceb9fe1a85ec53ULL;
    value_ ^= value_ >> 29U;
  }
  [[nodiscard]] std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0x9e3779b97f4a7c15ULL;
};

/// The station's state with the world around it: clients, loop, and what the laws remember.
class World {
 public:
  /// The first client is a therapist with the controls, the second a therapist without, the third
  /// a player.
  explicit World(const WorldRules& rules = {});

  [[nodiscard]] bool possible(const Event& event) const;
  /// False when the event is not possible; then nothing changes.
  [[nodiscard]] bool happens(const Event& event);
  /// Laws that the newest event broke; empty: none.
  [[nodiscard]] const std::string& broken() const { return broken_; }
  /// What the future of this state depends on, as a hash: counters by rank, times cut at what they
  /// are compared with, nothing of an order that can only be refused, or of what a client was shown
  /// once everything that names it is refused. With WorldRules::alike the first two clients have no
  /// names.
  [[nodiscard]] std::uint64_t key() const;
  [[nodiscard]] const StationState& state() const { return state_; }
  [[nodiscard]] std::size_t unanswered() const { return unanswered_.size(); }
  /// The client's orders still name controls that another has taken.
  [[nodiscard]] bool lostControls(int client) const {
    return clients_[client].named_claim != 0 && clients_[client].claim == 0;
  }
  [[nodiscard]] bool adopted() const { return adopted_; }
  [[nodiscard]] const OrderReply& lastReply() const { return last_reply_; }

 private:
  using Ranks = std::array<int, kClients>;  ///< of the clients, in a key
  /// True for an order that will be refused, whatever comes.
  [[nodiscard]] bool isRefusedForGood(const WaitingOrder& task, bool waits) const;
  void addClient(int client, Key& key) const;
  void addShown(const Shown& shown, Key& key) const;
  void addTask(const WaitingOrder& task, bool waits, const Ranks& ranks, Key& key) const;
  void addUnderWay(const Ranks& ranks, Key& key) const;
  void addStation(Key& key) const;
  [[nodiscard]] std::uint64_t keyBy(const Ranks& ranks) const;

  void carryOut(const Event& event);
  void forget();
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
  void setLimit(int client, double value_n);
  [[nodiscard]] double lowerLimit(int client) const;
  [[nodiscard]] double raisedLimit() const;
  void work(bool done, bool throws);
  void pass(int passes_ms);
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

  WorldRules rules_;
  StationState state_;
  std::array<Client, kClients> clients_;
  std::uint32_t claims_ = 0, order_ids_ = 0;
  int now_ms_ = 0;
  bool fault_ = false;     ///< the live loop has faulted
  bool stopping_ = false;  ///< the live loop was asked to stop
  bool raised_ = false;    ///< a client that did not press raised a limit since
  std::uint32_t presser_ = 0;
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

}  // namespace wholehand::test::decisions
