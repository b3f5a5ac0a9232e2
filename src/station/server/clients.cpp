#include "station/server/clients.hpp"

#include "loop/realtime/monotonic_clock.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

namespace wholehand {

void EventMailbox::put(const TickRecord& record, std::int64_t now_ns) {
  const std::lock_guard lock(mutex_);
  newest_ns_ = now_ns;
  arrivals_[record.tick % arrivals_.size()] = {record.tick, now_ns};
  if (record.tick <= newest_tick_) active_ = not_active_;  // a session began
  newest_tick_ = record.tick;
  active_.add(record);
  const int n = std::clamp(record.exercise.event_count, 0, kMaxExerciseEvents);
  for (int i = 0; i < n; ++i) {
    if (waiting_.size() == kCapacity) {
      ++dropped_;
    } else {
      waiting_.push_back({record.tick, record.exercise.events[i]});
    }
  }
}

void EventMailbox::describe(std::vector<std::string> axis_units,
                            std::vector<std::string> value_names) {
  const std::lock_guard lock(mutex_);
  if (axis_units == axis_units_ && value_names == value_names_) return;
  axis_units_ = std::move(axis_units);
  value_names_ = std::move(value_names);
  active_ = not_active_ = ActiveTime(axis_units_, value_names_);
}

ActivePeriods EventMailbox::active() const {
  const std::lock_guard lock(mutex_);
  return active_.periods();
}

void EventMailbox::fetch(std::vector<wire::NumberedEvent>& events) {
  events.clear();
  const std::lock_guard lock(mutex_);
  events.assign(waiting_.begin(), waiting_.end());
  waiting_.clear();
}

std::int64_t EventMailbox::arrivalOf(std::uint64_t tick) const {
  const std::lock_guard lock(mutex_);
  const Arrival& a = arrivals_[tick % arrivals_.size()];
  return a.tick == tick ? a.at_ns : newest_ns_;
}

std::int64_t EventMailbox::newest_ns() const {
  const std::lock_guard lock(mutex_);
  return newest_ns_;
}

std::uint64_t EventMailbox::dropped() const {
  const std::lock_guard lock(mutex_);
  return dropped_;
}

namespace {

/// Interval at which an unchanged state is sent again, so that clients see that the connection is
/// alive.
constexpr std::int64_t kRepeat_ns = 500'000'000;
/// Shortest interval between two rate-limit replies to a client.
constexpr std::int64_t kRateReply_ns = 1'000'000'000;

SharedBytes share(wire::Bytes bytes) {
  return std::make_shared<const wire::Bytes>(std::move(bytes));
}

/// Name of the counter for an unreadable message.
const char* counterOf(const Diagnostics& errors) {
  const std::string& key = errors.front().key;
  if (key == "size") return "oversized";
  if (key == "schema_version") return "schema_version";
  return "malformed";
}

/// A page that says so by another thread was not heard itself.
bool saysBusy(const Order& order) {
  const auto* beat = order.as<orders::Heartbeat>();
  return beat != nullptr && beat->busy;
}

bool sameState(const LoopStatus& a, const LoopStatus& b) {
  return a.session == b.session && a.endings == b.endings && a.basis == b.basis &&
         a.run_state == b.run_state && a.steering == b.steering && a.latched == b.latched &&
         a.rested == b.rested && a.arming == b.arming && a.rehearsed_ticks == b.rehearsed_ticks &&
         a.silent == b.silent && a.stop_pending == b.stop_pending &&
         a.stop_unconfirmed == b.stop_unconfirmed && a.parameters == b.parameters &&
         a.settings == b.settings;
}

/// Line of a game without a WebSocket. It sends nothing: the game sees the results of its orders in
/// the states.
class DatagramOnlyConnection final : public ClientConnection {
 public:
  void deliver(SharedBytes) override {}
  [[nodiscard]] bool offer(SharedBytes, std::int64_t) override { return true; }
  [[nodiscard]] std::size_t waiting() const override { return 0; }
  [[nodiscard]] std::int64_t writingSince_ns() const override { return 0; }
  [[nodiscard]] std::string address() const override { return "udp"; }
  void close(const std::string&) override {}
  void cut() override {}
};

using Shapes = std::vector<std::shared_ptr<const GameShapes>>;

/// The bodies, or an empty list for null.
template <class Bodies>
const Bodies& orNone(const std::shared_ptr<const Bodies>& bodies) {
  static const Bodies kNone;
  return bodies ? *bodies : kNone;
}

bool byId(const std::shared_ptr<const GameShapes>& a, const std::shared_ptr<const GameShapes>& b) {
  return a->id < b->id;
}

/// Shapes of the bodies, each once.
template <class Bodies>
Shapes shapesOf(const Bodies& bodies) {
  Shapes out;
  for (const auto& body : bodies) out.push_back(body.shapes);
  std::sort(out.begin(), out.end(), byId);
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

/// Adds to `out` the shapes of `now` that are neither in `before` nor in `out`.
void addNew(const Shapes& now, const Shapes& before, Shapes& out) {
  for (const auto& shapes : now) {
    const bool known = std::binary_search(before.begin(), before.end(), shapes, byId);
    if (!known && std::find(out.begin(), out.end(), shapes) == out.end()) out.push_back(shapes);
  }
}

bool same(const RegisteredBody& a, const RegisteredBody& b) {
  const auto place_of = [](const RegisteredBody& body) {
    const Vec3& p = body.pose.position_m;
    const QuatXyzw& q = body.pose.orientation_xyzw;
    return std::array{p.x, p.y, p.z, q.x, q.y, q.z, q.w};
  };
  if (a.shapes != b.shapes || a.generation != b.generation || a.slot != b.slot ||
      a.whereabouts != b.whereabouts) {
    return false;
  }
  return a.slot >= 0 || place_of(a) == place_of(b);  // states have the pose of slots
}

/// Bodies that changed, appeared or left. Both lists are sorted by number.
RegisteredBodies changesOf(const RegisteredBodies& before, const RegisteredBodies& now) {
  RegisteredBodies out;
  auto was = before.begin();
  const auto gone_below = [&](int number) {
    for (; was != before.end() && was->number < number; ++was) {
      out.push_back(*was);
      out.back().shapes = nullptr;
      out.back().slot = -1;
    }
  };
  for (const RegisteredBody& body : now) {
    gone_below(body.number);
    const bool known = was != before.end() && was->number == body.number;
    if (!known || !same(*was, body)) out.push_back(body);
    if (known) ++was;
  }
  gone_below(kLastNumber + 1);
  return out;
}

}  // namespace

Clients::Clients(ServerBackend& backend, EventMailbox& mailbox, Traffic& traffic,
                 RateLimitedLog& log, ControlHolder& controls, Access access, Post post,
                 Commissioning commissioning, UdpBridge* udp)
    : backend_(backend),
      mailbox_(mailbox),
      traffic_(traffic),
      log_(log),
      access_(std::move(access)),
      post_(std::move(post)),
      udp_(udp),
      controls_(controls),
      timeouts_(controls),
      commissioning_(std::move(commissioning)),
      record_(std::make_unique<TickRecord>()) {
  // A commissioning has no scene. Its pages, too, are told whether the device answers.
  if (!commissioning_) return;
  encoder_ = std::make_unique<wire::StateEncoder>(std::make_shared<const SceneFacts>());
}

std::uint32_t Clients::join(std::shared_ptr<ClientConnection> connection, Role role,
                            std::int64_t now_ns) {
  followScene();
  const std::uint32_t number = controls_.newClient();
  Client client;
  client.connection = std::move(connection);
  client.role = role;
  client.allowance_ns = now_ns;
  const std::string version = scene_ ? scene_->program_version : std::string();
  const UdpBridge::DatagramAccess access =
      udp_ != nullptr ? udp_->admit(number) : UdpBridge::DatagramAccess{};
  client.connection->deliver(
      share(wire::welcomeMessage(number, false, version, {access.port, access.key})));
  if (scene_message_) client.connection->deliver(scene_message_);
  if (commissioning_message_) client.connection->deliver(commissioning_message_);
  if (showsBodies()) client.connection->deliver(bodiesMessage());
  const auto entry = clients_.emplace(number, std::move(client)).first;
  if (role == Role::kTherapist) {
    sendControls();  // the new client may be a therapist
  } else {
    entry->second.connection->deliver(controlsFor(number, role));
  }
  traffic_.clients = count();
  ++traffic_.clients_seen;
  return number;
}

void Clients::leave(std::uint32_t client, std::int64_t now_ns) {
  const bool led_before = led();
  const auto entry = clients_.find(client);
  if (entry == clients_.end()) return;
  entry->second.requester->connected = false;
  clients_.erase(entry);
  if (udp_ != nullptr) udp_->dismiss(client);
  traffic_.clients = count();
  if (timeouts_.holds(client)) {
    log_.write(fmt::format("client {} left while it held the controls", client), now_ns);
  }
  timeouts_.left(client, now_ns);
  followControls(now_ns);
  if (led() != led_before) sendControls();
}

bool Clients::makeRoom(const std::string& newcomer, std::int64_t now_ns) {
  std::map<std::string, std::size_t> places{{newcomer, 1}};
  for (const auto& [number, client] : clients_) ++places[client.connection->address()];
  std::string crowded = newcomer;
  for (const auto& [address, count] : places) {
    if (count > places[crowded]) crowded = address;
  }
  const auto first = std::find_if(clients_.begin(), clients_.end(), [&](const auto& entry) {
    return !timeouts_.holds(entry.first) && entry.first != standalone_ &&
           entry.second.connection->address() == crowded;
  });
  if (first == clients_.end()) return false;
  const std::uint32_t number = first->first;
  log_.write(fmt::format("client {} gives its place to a new one of {}", number, newcomer), now_ns);
  ++traffic_.dropped["displaced"];
  first->second.connection->cut();
  leave(number, now_ns);
  return true;
}

void Clients::refuse(Entry client, std::uint32_t command, const char* counter,
                     const OrderReply& refusal, std::int64_t now_ns, bool reply) {
  ++traffic_.refused[counter];
  log_.write(fmt::format("client {}: command {} refused ({}): {}", client->first, command, counter,
                         refusal.reason),
             now_ns);
  if (reply) client->second.connection->deliver(share(wire::replyMessage(command, refusal)));
}

bool Clients::withinRate(Entry entry, std::size_t bytes, std::int64_t now_ns) {
  Client& c = entry->second;
  const double elapsed_s = 1e-9 * static_cast<double>(now_ns - c.allowance_ns);
  c.allowance_ns = now_ns;
  c.allowance = std::min(kMessagesPerSecond, c.allowance + kMessagesPerSecond * elapsed_s);
  const std::size_t messages = 1 + bytes / (kMessageSize + 1);
  const auto price = static_cast<double>(messages);
  if (c.allowance < price) return false;
  c.allowance -= price;
  return true;
}

void Clients::receive(std::uint32_t client, std::span<const std::uint8_t> message, bool text,
                      std::int64_t now_ns) {
  const Entry entry = clients_.find(client);
  if (entry == clients_.end()) return;
  const bool within_rate = withinRate(entry, message.size(), now_ns);
  const auto decoded = text ? Expected<Order>(Diagnostic{}) : wire::decode(message);
  if (!decoded || !saysBusy(*decoded)) entry->second.requester->heard_ns = now_ns;
  // Stops are exempt from the rate limit and from the order of command numbers.
  const bool stops = decoded && decoded->stops();
  // Heartbeats are exempt from the order of numbers: a page sends them from another thread than its
  // orders.
  const bool beat = decoded && decoded->is<orders::Heartbeat>();
  if (entry->second.closing && !stops) return;
  if (!within_rate && !stops) {
    refuseForRate(entry, decoded ? &*decoded : nullptr, now_ns);
  } else if (text) {
    refuseUnread(entry, 0, "text",
                 refused(Refusal::kUnreadable, "this is text; messages are binary"), now_ns);
  } else if (!decoded) {
    refuseUnread(entry, wire::commandIdOf(message), counterOf(decoded.errors()),
                 refused(wire::refusalOf(decoded.errors()), format(decoded.errors())), now_ns);
  } else if (decoded->id <= entry->second.last_command && !stops && !beat) {
    refuse(entry, decoded->id, "replayed",
           refused(Refusal::kReplayed,
                   fmt::format("command {} came after command {}: their numbers must rise",
                               decoded->id, entry->second.last_command)),
           now_ns);
  } else {
    if (!beat) entry->second.last_command = std::max(entry->second.last_command, decoded->id);
    apply(entry, *decoded, now_ns);
  }
  followControls(now_ns);
}

// Refuses an unreadable message. Without a command number the answer cannot be assigned to a
// request, so the connection is closed and the reason given.
void Clients::refuseUnread(Entry entry, std::uint32_t command, const char* counter,
                           const OrderReply& refusal, std::int64_t now_ns) {
  refuse(entry, command, counter, refusal, now_ns);
  if (command != 0) return;
  entry->second.closing = true;
  entry->second.connection->close(refusal.reason);
}

// A client that waits for an answer gets one with the command's number. Messages without answers,
// and clients that do not read, get one reply per second.
void Clients::refuseForRate(Entry entry, const Order* message, std::int64_t now_ns) {
  Client& client = entry->second;
  const bool waits =
      message != nullptr && !message->streams() && client.connection->waiting() < kMostWaiting / 4;
  const bool reply = waits || now_ns - client.last_rate_reply_ns > kRateReply_ns;
  if (reply) client.last_rate_reply_ns = now_ns;
  refuse(entry, message != nullptr ? message->id : 0, "rate",
         refused(Refusal::kTooMany,
                 fmt::format("{}: more than 400 messages in a second, those beyond are dropped",
                             message != nullptr ? message->row().name : "unreadable")),
         now_ns, reply);
}

void Clients::refuseOversized(std::uint32_t client, std::int64_t now_ns) {
  const Entry entry = clients_.find(client);
  if (entry == clients_.end()) return;
  ++traffic_.dropped["oversized"];
  refuse(entry, 0, "oversized",
         refused(Refusal::kUnreadable,
                 fmt::format("a message of more than {} bytes; the connection is closed",
                             wire::kLargestClientMessage)),
         now_ns, false);
}

void Clients::apply(Entry entry, const Order& order, std::int64_t now_ns) {
  const std::uint32_t client = entry->first;
  if (saysBusy(order)) return timeouts_.noteBusy(client, now_ns);
  timeouts_.noteMessage(client, now_ns);
  if (order.is<orders::Heartbeat>()) return;
  if (order.row().thread != orders::Thread::kServer) return applyOrder(entry, order, now_ns);
  changeHands(entry, order, now_ns);
}

void Clients::forward(Entry entry, Order order) {
  const std::uint32_t client = entry->first;
  order.claim = timeouts_.holds(client) ? timeouts_.claim() : 0;
  order.client = client;
  order.requester = entry->second.requester;
  order.may_raise_limits = entry->second.role != Role::kPlayer;
  std::weak_ptr<Clients> self = weak_from_this();
  backend_.order(order, [self, post = post_, client, command = order.id](OrderReply reply) {
    post([self, client, command, reply = std::move(reply)] {
      if (const auto clients = self.lock()) clients->answer(client, command, reply);
    });
  });
}

void Clients::answer(std::uint32_t client, std::uint32_t command, const OrderReply& reply) {
  const Entry entry = clients_.find(client);
  if (entry == clients_.end()) return;
  if (!reply.accepted) {
    refuse(entry, command, "order", reply, monotonicNow_ns());
  } else {
    entry->second.connection->deliver(share(wire::replyMessage(command, reply)));
  }
}

void Clients::orderQuietly(orders::Any what, std::uint32_t claim) {
  Order order{std::move(what)};
  order.claim = claim;
  backend_.order(order, [](const OrderReply&) {});
}

void Clients::followControls(std::int64_t now_ns) {
  const ControlTimeouts::Advice advice = timeouts_.advance(now_ns);
  for (auto& [number, client] : clients_) {
    client.requester->claim = timeouts_.holds(number) ? timeouts_.claim() : 0;
  }
  if (advice.give_back) {
    orderQuietly(orders::Steer{Steering::kVirtualPatient}, advice.claim);
  }
  if (advice.holder_alive) orderQuietly(orders::HolderAlive{*advice.holder_alive}, advice.claim);
  if (advice.unattended) orderQuietly(orders::Unattended{});
  if (advice.suspended_client != 0) {
    log_.write(fmt::format("client {} is silent", advice.suspended_client), now_ns);
  }
  if (advice.silent_client != 0) {
    log_.write(fmt::format("client {} was silent and lost the controls", advice.silent_client),
               now_ns);
  }
  if (advice.holder_changed && timeouts_.held()) orderQuietly(orders::UnattendedEnds{});
  if (advice.holder_changed) sendControls();
}

void Clients::sendControls() {
  for (auto& [number, client] : clients_)
    client.connection->deliver(controlsFor(number, client.role));
}

SharedBytes Clients::controlsFor(std::uint32_t client, Role role) const {
  wire::ControlsFacts facts;
  facts.held_by_you = timeouts_.holds(client);
  facts.held = timeouts_.held();
  facts.your_role = role;
  if (facts.held) facts.holder_role = roleOf(timeouts_.holder());
  facts.led = led();
  return share(wire::controlsMessage(facts));
}

void Clients::deliverToAll(const SharedBytes& message) {
  for (auto& [number, client] : clients_) client.connection->deliver(message);
}

void Clients::tick(std::int64_t now_ns) {
  // After a standstill of the program, queued messages are written before slow clients are judged.
  const bool late = now_ns - std::exchange(ticked_ns_, now_ns) > ControlTimeouts::kLate_ns;
  followControls(now_ns);
  if (!late) dropSlow(now_ns);
  // The status is read before the scene: a client that is shown a basis has already been sent its
  // scene, or a newer one.
  LoopStatus status;
  if (!clients_.empty()) status = backend_.status();
  followScene();
  followCommissioning(now_ns);
  const bool shows = !clients_.empty() && encoder_;
  // Bodies are reported before the events, so that a client knows which body has the slot that an
  // event names. They are read last, because an event may be newer than the status.
  if (shows) followBodies(backend_.status());
  sendEvents();
  if (shows) sendState(std::move(status), now_ns);
}

void Clients::followScene() {
  auto scene = backend_.scene();
  if (!scene || scene == scene_) return;
  scene_ = std::move(scene);
  std::vector<std::string> axis_units;
  for (const DeviceAxis& axis : scene_->device.axes) axis_units.emplace_back(axis.positionUnit());
  mailbox_.describe(std::move(axis_units), scene_->value_names);
  encoder_ = std::make_unique<wire::StateEncoder>(scene_);
  scene_message_ = share(wire::sceneMessage(*scene_));
  shown_ns_ = 0;  // the shown state belongs to the previous scene
  deliverToAll(scene_message_);
}

void Clients::followCommissioning(std::int64_t now_ns) {
  auto facts = commissioning_ ? commissioning_() : nullptr;
  const bool changed = facts != commissioning_shown_;
  if (!facts || (!changed && now_ns - commissioning_ns_ < kRepeat_ns)) return;
  if (changed) commissioning_message_ = share(wire::commissioningMessage(*facts));
  commissioning_shown_ = std::move(facts);
  commissioning_ns_ = now_ns;
  deliverToAll(commissioning_message_);
}

void Clients::sendEvents() {
  mailbox_.fetch(events_);
  if (!events_.empty() && !clients_.empty()) deliverToAll(share(wire::eventsMessage(events_)));
}

void Clients::sendState(LoopStatus status, std::int64_t now_ns) {
  if (!backend_.latest(*record_)) *record_ = TickRecord{};
  if (shown_ns_ == 0 || record_->tick != shown_tick_ || !sameState(status, shown_) ||
      now_ns - shown_ns_ > kRepeat_ns) {
    state_arrived_ns_ = mailbox_.arrivalOf(record_->tick);
    const auto bytes = encoder_->encode(*record_, status, wire::Detail::kFull, state_arrived_ns_,
                                        mailbox_.active());
    state_ = share({bytes.begin(), bytes.end()});
    ++state_number_;
    shown_ = std::move(status);
    // Restarts the age when the tick has not changed: an age measures the delivery of a record, not
    // the time that the loop stands still.
    if (record_->tick == shown_tick_) state_arrived_ns_ = 0;
    shown_tick_ = record_->tick;
    shown_ns_ = now_ns;
  }
  for (auto& [number, client] : clients_) {
    if (client.state == state_number_) continue;
    if (client.connection->offer(state_, state_arrived_ns_)) {
      client.state = state_number_;
    } else {
      ++traffic_.states_skipped;
    }
  }
  // Runs after the state that shows the ending was sent: a page uses that state to distinguish a
  // stop from a loss of controls.
  followEndings(shown_, now_ns);
}

void Clients::dropSlow(std::int64_t now_ns) {
  std::vector<std::uint32_t> slow;
  for (const auto& [number, client] : clients_) {
    const std::int64_t since_ns = client.connection->writingSince_ns();
    const bool stuck = since_ns != 0 && now_ns - since_ns > kDrainWithin_ns;
    const bool full = client.connection->waiting() > kMostWaiting;
    if (!stuck && !full) continue;
    ++traffic_.dropped[stuck ? "slow" : "backlog"];
    log_.write(fmt::format("client {} does not follow and is cut off", number), now_ns);
    slow.push_back(number);
  }
  for (const std::uint32_t number : slow) {
    clients_.at(number).connection->cut();
    leave(number, now_ns);
  }
}

// Permissions of orders, and steering.

bool Clients::led() const {
  return std::any_of(clients_.begin(), clients_.end(),
                     [](const auto& c) { return c.second.role == Role::kTherapist; });
}

Role Clients::roleOf(std::uint32_t client) const {
  const auto found = clients_.find(client);
  return found == clients_.end() ? Role::kUnspecified : found->second.role;
}

Standing Clients::standingOf(std::uint32_t client, const Order& order,
                             const LoopStatus& status) const {
  const auto* arm = order.as<orders::Arm>();
  Standing now;
  now.holds = timeouts_.holds(client);
  now.led = led();
  now.moves_person = status.device.has_value();
  now.own_rest = status.rested && !status.rest_before_start && resting_ == client &&
                 arm != nullptr && arm->acknowledged_stop == status.endings;
  now.therapist_paused = paused_in_ == status.session;
  now.rest_before_start = status.rest_before_start;
  now.run_state = status.run_state;
  return now;
}

void Clients::applyOrder(Entry entry, Order order, std::int64_t now_ns) {
  const std::uint32_t client = entry->first;
  // Aims are frequent, so they are judged without asking for the loop's status.
  const bool aim = order.is<orders::Aim>();
  const LoopStatus status = aim ? LoopStatus{} : backend_.status();
  const OrderReply may =
      mayOrder(entry->second.role, order,
               aim ? Standing{timeouts_.holds(client)} : standingOf(client, order, status));
  if (!may.accepted) {
    const char* counter = may.refusal == Refusal::kNotHolder ? "not_holder" : "role";
    return refuse(entry, order.id, counter, may, now_ns);
  }
  // A rest from a client without the controls counts as a plain stop, unless a rest is in force
  // already.
  if (order.is<orders::Rest>() && !timeouts_.holds(client) && !status.rested) {
    order.what = orders::Stop{};
  }
  if (auto* action = std::get_if<orders::Action>(&order.what)) {
    action->by_therapist = entry->second.role == Role::kTherapist;
  }
  noteOrder(entry, order, status, now_ns);
  const bool emergency = order.is<orders::EmergencyStop>();
  forward(entry, std::move(order));
  if (emergency) log_.write(fmt::format("client {}: emergency stop", client), now_ns);
}

void Clients::noteOrder(Entry entry, const Order& order, const LoopStatus& status,
                        std::int64_t now_ns) {
  timeouts_.attend(now_ns);
  const bool therapist = entry->second.role == Role::kTherapist;
  if (const auto* action = order.as<orders::Action>()) {
    paused_in_.reset();
    if (therapist && action->act == Act::kPause) paused_in_ = status.session;
  }
  // The right to resume belongs to the client that rested first, or whose rest cancelled an arming.
  if (order.is<orders::Rest>() && (!status.rested || status.arming)) {
    resting_ = entry->first;
    log_.write(fmt::format("client {} rests", entry->first), now_ns);
  }
  // A therapist who arms while nobody holds the controls counts as a live holder for a moment, so
  // that effort that faded with a lost holder returns.
  if (!order.is<orders::Arm>() || !therapist || timeouts_.held()) return;
  if (timeouts_.take(entry->first, now_ns).empty()) (void)timeouts_.release(entry->first);
  followControls(now_ns);
}

std::string Clients::takeControls(Entry entry, std::int64_t now_ns) {
  if (entry->second.role != Role::kTherapist) return timeouts_.take(entry->first, now_ns);
  timeouts_.takeOver(entry->first, now_ns);
  return {};
}

void Clients::changeHands(Entry entry, const Order& order, std::int64_t now_ns) {
  const std::uint32_t client = entry->first;
  const auto* take = order.as<orders::TakeControls>();
  if (const OrderReply may = mayOrder(entry->second.role, order, {}); !may.accepted) {
    return refuse(entry, order.id, "role", may, now_ns);
  }
  // A connected client has already shown its token. A wrong token here is an error to report.
  if (take && !take->token.empty() && !access_.tokenMatches(take->token)) {
    refuse(entry, order.id, "token", refused(Refusal::kWrongToken, "the token is wrong"), now_ns);
    return;
  }
  const std::string why = take ? takeControls(entry, now_ns) : timeouts_.release(client);
  if (!why.empty()) {
    refuse(entry, order.id, take ? "controls_held" : "not_holder",
           refused(take ? Refusal::kControlsHeld : Refusal::kNotHolder, why), now_ns);
    return;
  }
  log_.write(fmt::format("client {} ({}) {} the controls", client, nameOf(entry->second.role),
                         take ? "takes" : "gives back"),
             now_ns);
  entry->second.connection->deliver(
      std::make_shared<const wire::Bytes>(wire::replyMessage(order.id, {true, ""})));
}

// A player steers only while the loop renders. A stop takes the controls from the player, who takes
// them again with a button.
void Clients::followEndings(const LoopStatus& status, std::int64_t now_ns) {
  const bool ended = endings_ != 0 && status.endings != endings_;
  endings_ = status.endings;
  if (!ended || roleOf(timeouts_.holder()) != Role::kPlayer) return;
  log_.write(fmt::format("client {} gives back the controls: it was stopped", timeouts_.holder()),
             now_ns);
  (void)timeouts_.release(timeouts_.holder());
  followControls(now_ns);
}

// Messages that clients send by datagram: docs/udp.md.

void Clients::joinStandalone() {
  if (udp_ == nullptr || !udp_->awaitsStandalone()) return;
  standalone_ = controls_.newClient();
  clients_[standalone_].connection = std::make_shared<DatagramOnlyConnection>();
  udp_->admitStandalone(standalone_);
}

void Clients::receiveDatagram(std::uint32_t client, const Order& order, std::int64_t now_ns) {
  const Entry entry = clients_.find(client);
  if (entry == clients_.end()) return;
  if (!saysBusy(order)) entry->second.requester->heard_ns = now_ns;
  if (order.is<orders::Aim>()) {
    timeouts_.noteMessage(client, now_ns);
    aim(entry, order, now_ns);
  } else {
    apply(entry, order, now_ns);
  }
  followControls(now_ns);
}

// Aims arrive up to a thousand times a second, so only the first refused one is answered.
void Clients::aim(Entry entry, Order order, std::int64_t now_ns) {
  const std::uint32_t client = entry->first;
  const OrderReply may = mayOrder(entry->second.role, order, Standing{timeouts_.holds(client)});
  if (!may.accepted) {
    if (std::exchange(entry->second.aim_refused, true)) return;
    return refuse(entry, order.id, may.refusal == Refusal::kNotHolder ? "not_holder" : "role", may,
                  now_ns);
  }
  order.claim = timeouts_.claim();
  order.client = client;
  backend_.order(order, [self = weak_from_this(), post = post_, client,
                         id = order.id](const OrderReply& reply) {
    post([self, client, id, reply] {
      if (const auto clients = self.lock()) clients->aimed(client, id, reply);
    });
  });
}

void Clients::aimed(std::uint32_t client, std::uint32_t command, const OrderReply& reply) {
  const Entry entry = clients_.find(client);
  if (entry == clients_.end()) return;
  const bool reported = std::exchange(entry->second.aim_refused, !reply.accepted);
  if (!reply.accepted && !reported) refuse(entry, command, "order", reply, monotonicNow_ns());
}

// Bodies of a game as reported to all clients.

SharedBytes Clients::bodiesMessage() const {
  const GameBodies& bodies = orNone(bodies_shown_);
  const RegisteredBodies& registered = orNone(registered_shown_);
  Shapes shapes;
  addNew(shapesOf(bodies), {}, shapes);
  addNew(shapesOf(registered), {}, shapes);
  return std::make_shared<const wire::Bytes>(
      wire::gameBodiesMessage(bodies_session_, bodies, shapes, registered));
}

// Reports changed bodies. A client that joined since the last message already knows the same bodies
// as all others.
void Clients::followBodies(const LoopStatus& status) {
  if (status.bodies == bodies_shown_ && status.registered == registered_shown_) return;
  const auto bodies_before = std::exchange(bodies_shown_, status.bodies);
  const auto registered_before = std::exchange(registered_shown_, status.registered);
  bodies_session_ = status.session;
  const GameBodies &was = orNone(bodies_before), &bodies = orNone(bodies_shown_);
  const RegisteredBodies changes = changesOf(orNone(registered_before), orNone(registered_shown_));
  if (bodies.empty() && was.empty() && changes.empty()) return;
  Shapes shapes;
  addNew(shapesOf(bodies), shapesOf(was), shapes);
  addNew(shapesOf(orNone(registered_shown_)), shapesOf(orNone(registered_before)), shapes);
  deliverToAll(std::make_shared<const wire::Bytes>(
      wire::gameBodiesMessage(status.session, bodies, shapes, changes)));
}

}  // namespace wholehand
