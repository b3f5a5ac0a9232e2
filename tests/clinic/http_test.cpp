#include "clinic/http_server.hpp"
#include "clinic/station_client.hpp"
#include "clinic_bench.hpp"

#include <arpa/inet.h>
#include <atomic>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/http/string_body.hpp>
#include <boost/beast/websocket.hpp>
#include <sys/socket.h>
#include <thread>
#include <unistd.h>
#include <wholehand_generated.h>

namespace wholehand::clinic {
namespace {

constexpr const char* kOrigin = "http://127.0.0.1:8787";

/// Sends bytes and reads the whole answer.
std::string answerTo(std::uint16_t port, const std::string& bytes) {
  const int socket = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(port);
  to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  std::string out;
  if (::connect(socket, reinterpret_cast<sockaddr*>(&to), sizeof to) == 0) {
    (void)::send(socket, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    char part[4096];
    for (ssize_t n = 0; (n = ::recv(socket, part, sizeof part, 0)) > 0;) out.append(part, n);
  }
  ::close(socket);
  return out;
}

std::string request(const std::string& first_line, const std::string& headers,
                    const std::string& body = {}) {
  return fmt::format("{} HTTP/1.1\r\n{}Content-Length: {}\r\n\r\n{}", first_line, headers,
                     body.size(), body);
}

TEST(Http, Requests_AreAnsweredOnlyForTheStationsPages) {
  Bench b(false);
  auto server = HttpServer::start(*b.clinic, 0, {kOrigin});
  ASSERT_TRUE(server.ok());
  const std::uint16_t port = (*server)->port();
  const std::string host = fmt::format("Host: 127.0.0.1:{}\r\n", port),
                    origin = fmt::format("Origin: {}\r\n", kOrigin);
  const std::string good = answerTo(port, request("GET /api/state", host + origin));
  EXPECT_TRUE(good.starts_with("HTTP/1.1 200")) << good;
  EXPECT_NE(good.find("Cache-Control: no-store"), std::string::npos);
  EXPECT_NE(good.find(fmt::format("Access-Control-Allow-Origin: {}", kOrigin)), std::string::npos);
  EXPECT_NE(good.find("\"clinic\":\"new\""), std::string::npos);
  const auto status = [&](const std::string& bytes) { return answerTo(port, bytes).substr(9, 3); };
  EXPECT_EQ(status(request("GET /api/state", host)), "403");
  EXPECT_EQ(status(request("GET /api/state", host + "Origin: http://evil.example\r\n")), "403");
  EXPECT_EQ(status(request("GET /api/state", "Host: evil.example\r\n" + origin)), "403");
  EXPECT_EQ(status(request("OPTIONS /api/patients", host + origin)), "204");
  EXPECT_EQ(status(request("GET /nothing", host + origin)), "404");
  EXPECT_EQ(status(request("PUT /api/state", host + origin)), "405");
  EXPECT_EQ(status("nonsense\r\n\r\n"), "400");
  EXPECT_EQ(
      status("POST /api/init HTTP/1.1\r\n" + host + origin + "Content-Length: 1048576\r\n\r\n"),
      "413");
  const Json init = {{"pass_phrase", "correct horse"},
                     {"tile", {{"name", "A"}, {"colour", "#0d6b5a"}, {"pin", "1234"}}}};
  const std::string begun = answerTo(port, request("POST /api/init", host + origin, init.dump()));
  EXPECT_NE(begun.find("recovery_code"), std::string::npos) << begun;
}

TEST(Http, ManyConnectionsAtOnce_AreEachAnsweredOrClosed) {
  Bench b;
  auto server = HttpServer::start(*b.clinic, 0, {kOrigin});
  ASSERT_TRUE(server.ok());
  const std::string bytes =
      request("GET /api/state", fmt::format("Host: localhost\r\nOrigin: {}\r\n", kOrigin));
  std::atomic<int> answered{0};
  std::vector<std::thread> clients;
  for (int i = 0; i < 16; ++i) {
    clients.emplace_back([&] {
      for (int k = 0; k < 10; ++k)
        answered += answerTo((*server)->port(), bytes).starts_with("HTTP/1.1 200") ? 1 : 0;
    });
  }
  for (std::thread& client : clients) client.join();
  EXPECT_EQ(answered, 160);
}

namespace net = boost::asio;
namespace beast = boost::beast;
namespace fb = wholehand::protocol;

void send(beast::websocket::stream<net::ip::tcp::socket>& socket,
          flatbuffers::FlatBufferBuilder& b) {
  socket.binary(true);
  socket.write(net::buffer(b.GetBufferPointer(), b.GetSize()));
}

constexpr double kSetLimit_n = 4.1;  // no number of single precision

/// A station that sends one scene and one state, and then answers `orders` orders: it refuses the
/// first and accepts the others.
void playStation(net::ip::tcp::acceptor& acceptor, int orders, std::string& head,
                 std::vector<std::string>& heard) {
  beast::websocket::stream<net::ip::tcp::socket> socket(acceptor.accept());
  beast::flat_buffer buffer;
  beast::http::request<beast::http::string_body> upgrade;
  beast::http::read(socket.next_layer(), buffer, upgrade);
  head =
      std::string(upgrade.target()) + " " + std::string(upgrade[beast::http::field::authorization]);
  socket.accept(upgrade);
  flatbuffers::FlatBufferBuilder scene;
  const auto name = scene.CreateString("effort_limit_arm_n");
  const auto unit = scene.CreateString("N");
  const fb::ParameterRange exact(0.05, 20.0, 20.0);
  const auto parameter = fb::CreateParameter(scene, name, fb::ParameterGroup::Patient, unit, 0.05F,
                                             20.0F, 20.0F, 1.0F, &exact, true);
  const auto parameters = scene.CreateVector(&parameter, 1);
  fb::SceneBuilder out(scene);
  out.add_parameters(parameters);
  out.add_visit(5);
  fb::FinishMessageBuffer(scene,
                          fb::CreateMessage(scene, 1, fb::Payload::Scene, out.Finish().Union()));
  send(socket, scene);
  flatbuffers::FlatBufferBuilder state;
  const auto settings = state.CreateVector(&kSetLimit_n, 1);
  fb::WorldStateBuilder now(state);
  now.add_settings(settings);
  fb::FinishMessageBuffer(
      state, fb::CreateMessage(state, 1, fb::Payload::WorldState, now.Finish().Union()));
  send(socket, state);
  for (int i = 0; i < orders; ++i) {
    beast::flat_buffer bytes;
    socket.read(bytes);
    const fb::Command* command = fb::GetMessage(bytes.cdata().data())->payload_as_Command();
    if (const fb::OpenVisit* open = command->order_as_OpenVisit()) {
      heard.push_back(fmt::format("open {} {} {} {} {} {}", open->visit(), open->item(),
                                  open->exercise()->str(), open->hand_file()->str(),
                                  fb::EnumNameHelp(open->help()),
                                  open->parameters()->Get(0)->value()));
    } else if (const fb::CloseVisit* close = command->order_as_CloseVisit()) {
      heard.push_back(fmt::format("close {}", close->visit()));
    }
    flatbuffers::FlatBufferBuilder reply;
    const auto reason = reply.CreateString(i == 0 ? "is armed" : "");
    fb::FinishMessageBuffer(
        reply, fb::CreateMessage(reply, 1, fb::Payload::Reply,
                                 fb::CreateReply(reply, command->id(), i != 0, reason).Union()));
    send(socket, reply);
  }
}

TEST(StationLink, OrdersAndReplies_ArePassedAndALostConnectionCountsAsSilence) {
  net::io_context io;
  net::ip::tcp::acceptor acceptor(io, {net::ip::address_v4::loopback(), 0});
  std::string head;
  std::vector<std::string> heard;
  std::thread station([&] { playStation(acceptor, 3, head, heard); });
  StationClient client(acceptor.local_endpoint().port(), "secret");
  while (client.scene().values.empty()) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  EXPECT_EQ(client.scene().visit, 5U);
  EXPECT_EQ(client.scene().values.at("effort_limit_arm_n"), kSetLimit_n);
  EXPECT_EQ(client.scene().limits.of("effort_limit_arm_n"), kSetLimit_n);
  EXPECT_EQ(client.scene().bounds.at("effort_limit_arm_n")[0],
            0.05);  // as the exercise file states it
  const VisitOrder order{
      9007199254740993ULL,          2, "cocktail-bar", 3, "", "visit-9-left.toml", "full",
      {{"effort_limit_arm_n", 4.5}}};
  const StationReply refused = client.open(order);
  EXPECT_EQ(refused.what, StationReply::Status::kRefused);
  EXPECT_EQ(refused.why, "is armed");
  EXPECT_EQ(client.open(order).what, StationReply::Status::kAccepted);
  EXPECT_EQ(client.close(order.visit).what, StationReply::Status::kAccepted);
  station.join();
  EXPECT_EQ(head, "/ws?role=therapist Bearer secret");
  EXPECT_EQ(heard, (std::vector<std::string>{
                       "open 9007199254740993 2 cocktail-bar visit-9-left.toml Full 4.5",
                       "open 9007199254740993 2 cocktail-bar visit-9-left.toml Full 4.5",
                       "close 9007199254740993"}));
  while (client.scene().received) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  EXPECT_EQ(client.close(1).what, StationReply::Status::kSilent);
}

}  // namespace
}  // namespace wholehand::clinic
