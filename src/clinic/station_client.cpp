#include "clinic/station_client.hpp"

#include "station/server/wire.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/websocket/rfc6455.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <thread>
#include <utility>
#include <vector>
#include <wholehand_generated.h>

namespace wholehand::clinic {
namespace {

namespace net = boost::asio;
namespace beast = boost::beast;
namespace websocket = beast::websocket;
namespace fb = wholehand::protocol;
using Tcp = net::ip::tcp;
using ErrorCode = boost::system::error_code;

using Clock = std::chrono::steady_clock;
constexpr std::chrono::seconds kReplyWithin{5}, kConnectWithin{5}, kConnectAgain{1};
constexpr std::chrono::seconds kRehearsedWithin{20};
constexpr std::size_t kLargestMessage_bytes = std::size_t{64} << 20U;  // enough for a scene with
                                                                       // its meshes

using Socket = websocket::stream<beast::tcp_stream, false>;
using OrderPart = std::pair<fb::Order, flatbuffers::Offset<void>>;
using BuildOrder = std::function<OrderPart(flatbuffers::FlatBufferBuilder&)>;

fb::Help helpOf(const std::string& word) {
  if (word == "full") return fb::Help::Full;
  return word == "some" ? fb::Help::Some : fb::Help::None;
}

std::string wordOf(fb::Help help) {
  if (help == fb::Help::Unspecified) return {};
  if (help == fb::Help::Full) return "full";
  return help == fb::Help::Some ? "some" : "none";
}

std::string textOf(const flatbuffers::String* text) {
  return text == nullptr ? std::string{} : text->str();
}

}  // namespace

/// WebSocket connection to the station, one at a time. All calls of Beast run on its own thread.
class StationClient::Link {
 public:
  Link(std::uint16_t port, std::string token)
      : port_(port), token_(std::move(token)), again_(io_), thread_([this] {
          connect();
          io_.run();
        }) {}
  ~Link() {
    io_.stop();  // otherwise Beast's timers would run for seconds
    thread_.join();
  }
  Link(const Link&) = delete;
  Link& operator=(const Link&) = delete;

  [[nodiscard]] StationScene scene() const {
    const std::lock_guard lock(mutex_);
    return scene_;
  }

  [[nodiscard]] StationReply ask(const BuildOrder& build) {
    std::unique_lock lock(mutex_);
    if (!scene_.received) return {StationReply::Status::kSilent, "the station is not connected"};
    const std::uint32_t id = ++last_id_;
    flatbuffers::FlatBufferBuilder builder;
    const OrderPart order = build(builder);
    const auto command = fb::CreateCommand(builder, id, order.first, order.second);
    fb::FinishMessageBuffer(builder, fb::CreateMessage(builder, wire::kSchemaVersion,
                                                       fb::Payload::Command, command.Union()));
    std::vector<std::uint8_t> bytes(builder.GetBufferPointer(),
                                    builder.GetBufferPointer() + builder.GetSize());
    const std::uint64_t connection = connection_;
    replies_[id] = std::nullopt;
    net::post(io_, [this, bytes = std::move(bytes)]() mutable { send(std::move(bytes)); });
    const auto answered = [&] { return replies_[id].has_value() || connection != connection_; };
    const auto began = Clock::now();
    for (auto until = began + kReplyWithin; !received_.wait_until(lock, until, answered);) {
      // Waits longer while the station reports a rehearsal under way.
      const auto later = std::min(rehearsed_ + kReplyWithin, began + kRehearsedWithin);
      if (later <= until) break;
      until = later;
    }
    StationReply reply{StationReply::Status::kSilent,
                       "the station did not answer within 5 s; see its console"};
    if (connection != connection_) reply.why = "the connection to the station ended";
    if (replies_[id]) reply = *replies_[id];
    replies_.erase(id);
    return reply;
  }

 private:
  void connect() {
    buffer_.clear();
    outgoing_.clear();
    socket_ = std::make_unique<Socket>(io_);
    auto& stream = beast::get_lowest_layer(*socket_);
    stream.expires_after(kConnectWithin);
    stream.async_connect(Tcp::endpoint(net::ip::address_v4::loopback(), port_),
                         [this](ErrorCode error) { error ? lost() : shakeHands(); });
  }

  void shakeHands() {
    beast::get_lowest_layer(*socket_).expires_never();
    websocket::stream_base::timeout limits{};
    limits.handshake_timeout = kConnectWithin;
    limits.idle_timeout = std::chrono::seconds(20);
    limits.keep_alive_pings = true;
    socket_->set_option(limits);
    socket_->set_option(websocket::stream_base::decorator([this](websocket::request_type& request) {
      request.set(beast::http::field::user_agent, "wholehand-clinic");
      if (!token_.empty()) request.set(beast::http::field::authorization, "Bearer " + token_);
    }));
    socket_->read_message_max(kLargestMessage_bytes);
    socket_->binary(true);
    socket_->async_handshake(fmt::format("127.0.0.1:{}", port_), "/ws?role=therapist",
                             [this](ErrorCode error) { error ? lost() : read(); });
  }

  void read() {
    buffer_.clear();
    socket_->async_read(buffer_, [this](ErrorCode error, std::size_t) {
      if (error) return lost();
      const auto bytes = buffer_.cdata();
      receive(static_cast<const std::uint8_t*>(bytes.data()), bytes.size());
      read();
    });
  }

  void receive(const std::uint8_t* bytes, std::size_t size) {
    flatbuffers::Verifier verifier(bytes, size);
    if (size < 8 || !fb::MessageBufferHasIdentifier(bytes) || !fb::VerifyMessageBuffer(verifier)) {
      return;
    }
    const fb::Message* message = fb::GetMessage(bytes);
    if (const fb::Reply* reply = message->payload_as_Reply()) {
      const std::lock_guard lock(mutex_);
      const auto asked = replies_.find(reply->command());
      if (asked == replies_.end()) return;
      using Status = StationReply::Status;
      asked->second = {reply->accepted() ? Status::kAccepted : Status::kRefused,
                       textOf(reply->reason())};
      received_.notify_all();
    } else if (const fb::Scene* scene = message->payload_as_Scene()) {
      StationScene now;
      now.received = true;
      now.exercise = textOf(scene->exercise_name());
      now.level = scene->level();
      now.visit = scene->visit();
      now.item = scene->visit_item();
      now.recording = textOf(scene->recording());
      names_.clear();
      limits_.clear();
      if (scene->parameters() != nullptr) {
        for (const fb::Parameter* p : *scene->parameters()) {
          const std::string name = textOf(p->name());
          names_.push_back(name);
          if (const fb::ParameterRange* range = p->exact()) {
            now.bounds[name] = {range->lower(), range->upper()};
            now.initial[name] = range->initial();
          }
          if (p->bounds_effort()) limits_.insert(name);
        }
      }
      const std::lock_guard lock(mutex_);
      scene_ = std::move(now);
    } else if (const fb::WorldState* state = message->payload_as_WorldState()) {
      const std::lock_guard lock(mutex_);
      if (state->rehearsed_ticks() > 0) rehearsed_ = Clock::now();
      // Values arrive after the scene, in the order of its parameters.
      const auto* settings = state->settings();
      if (settings == nullptr || settings->size() != names_.size()) return;
      for (std::size_t i = 0; i < names_.size(); ++i) {
        scene_.values[names_[i]] = settings->Get(static_cast<unsigned>(i));
      }
      for (const std::string& name : limits_) scene_.limits.set(name, scene_.values[name]);
      scene_.help = wordOf(state->help());
    }
  }

  void send(std::vector<std::uint8_t> bytes) {
    outgoing_.push_back(std::move(bytes));
    if (outgoing_.size() == 1) write();
  }
  void write() {
    if (outgoing_.empty()) return;
    socket_->async_write(net::buffer(outgoing_.front()), [this](ErrorCode error, std::size_t) {
      if (error || outgoing_.empty()) return;  // read() reports the same error
      outgoing_.pop_front();
      write();
    });
  }

  void lost() {
    {
      const std::lock_guard lock(mutex_);
      scene_ = {};
      last_id_ = 0;
      ++connection_;
      received_.notify_all();
    }
    again_.expires_after(kConnectAgain);
    again_.async_wait([this](ErrorCode error) {
      if (!error) connect();
    });
  }

  const std::uint16_t port_;
  const std::string token_;
  net::io_context io_{1};
  net::steady_timer again_;
  std::unique_ptr<Socket> socket_;
  beast::flat_buffer buffer_;
  std::deque<std::vector<std::uint8_t>> outgoing_;
  std::vector<std::string> names_;  ///< names of the scene's parameters, in the order of their
                                    ///< values
  std::set<std::string> limits_;    ///< those that bound efforts
  mutable std::mutex mutex_;        ///< guards the members below
  std::condition_variable received_;
  StationScene scene_;
  Clock::time_point rehearsed_;  ///< time at which a rehearsal was last reported
  std::uint32_t last_id_ = 0;
  std::uint64_t connection_ = 0;  ///< number of the connection
  std::map<std::uint32_t, std::optional<StationReply>> replies_;
  std::thread thread_;  ///< last member: it uses the others
};

StationClient::StationClient(std::uint16_t port, std::string token)
    : link_(std::make_unique<Link>(port, std::move(token))) {}
StationClient::~StationClient() = default;

StationScene StationClient::scene() const {
  return link_->scene();
}

StationReply StationClient::open(const VisitOrder& order) {
  return link_->ask([&](flatbuffers::FlatBufferBuilder& b) -> OrderPart {
    std::vector<flatbuffers::Offset<fb::VisitParameter>> parameters;
    for (const auto& [name, value] : order.parameters) {
      parameters.push_back(fb::CreateVisitParameterDirect(b, name.c_str(), value));
    }
    const auto open = fb::CreateOpenVisitDirect(
        b, order.visit, order.item, order.exercise.c_str(), static_cast<std::uint16_t>(order.level),
        order.hand.c_str(), order.hand_file.c_str(), helpOf(order.help), &parameters,
        order.prescription_file.c_str());
    return {fb::Order::OpenVisit, open.Union()};
  });
}

StationReply StationClient::close(std::uint64_t visit) {
  return link_->ask([&](flatbuffers::FlatBufferBuilder& b) -> OrderPart {
    return {fb::Order::CloseVisit, fb::CreateCloseVisit(b, visit).Union()};
  });
}

}  // namespace wholehand::clinic
