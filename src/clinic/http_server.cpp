#include "clinic/http_server.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/strand.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/http/string_body.hpp>
#include <boost/beast/http/write.hpp>
#include <charconv>
#include <chrono>
#include <optional>
#include <string_view>
#include <thread>
#include <utility>

namespace wholehand::clinic {
namespace {

namespace net = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
using Tcp = net::ip::tcp;
using ErrorCode = boost::system::error_code;

constexpr std::uint64_t kLargestBody_bytes = 64 * 1024;
constexpr std::uint32_t kLargestHeader_bytes = 16 * 1024;
/// A header that is too large is refused after this time, because a client that repeats it at once
/// occupies the processors of this machine.
constexpr std::chrono::milliseconds kTooLargeWait{500};
constexpr std::chrono::seconds kPatience{10};
/// More threads than pages, so that a note does not wait behind lists for one.
constexpr int kMostConnections = 64, kThreads = 16;
constexpr unsigned kTooLarge = 413;

int hexDigit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  return c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
}

/// Decodes the value of a query; malformed escapes stay unchanged.
std::string decoded(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool pair = text[i] == '%' && i + 2 < text.size();
    const int high = pair ? hexDigit(text[i + 1]) : -1, low = pair ? hexDigit(text[i + 2]) : -1;
    if (high >= 0 && low >= 0) {
      out += static_cast<char>(high * 16 + low);
      i += 2;
    } else {
      out += text[i] == '+' ? ' ' : text[i];
    }
  }
  return out;
}

/// Reads the parts "find=TEXT" and "page=NUMBER" of a query.
void readQuery(std::string_view query, Request& request) {
  while (!query.empty()) {
    const std::size_t end = std::min(query.find('&'), query.size());
    const std::string_view part = query.substr(0, end);
    query.remove_prefix(std::min(end + 1, query.size()));
    constexpr std::string_view kFind = "find=", kPage = "page=";
    if (part.starts_with(kFind)) request.find = decoded(part.substr(kFind.size()));
    if (part.starts_with(kPage)) {
      std::from_chars(part.data() + kPage.size(), part.data() + part.size(), request.page);
    }
  }
}

/// True when the Host names this machine, with any port. Under DNS rebinding it names another host.
bool hostAllowed(std::string_view host) {
  const std::size_t colon = host.rfind(':');
  const bool port = colon != std::string_view::npos && host.find(']', colon) == host.npos;
  const std::string_view name = port ? host.substr(0, colon) : host;
  return name == "127.0.0.1" || name == "localhost" || name == "[::1]";
}

std::string refusal(const char* code, const std::string& why) {
  return Json({{"refused", code}, {"why", why}}).dump();
}

/// A connection that handles one request and its answer.
class Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(Tcp::socket socket, Clinic& clinic, const std::vector<std::string>& origins,
             std::atomic<int>& open)
      : stream_(std::move(socket)),
        later_(stream_.get_executor()),
        clinic_(clinic),
        origins_(origins),
        open_(open) {}
  ~Connection() { --open_; }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  void run() {
    parser_.body_limit(kLargestBody_bytes);
    parser_.header_limit(kLargestHeader_bytes);
    stream_.expires_after(kPatience);
    http::async_read(
        stream_, buffer_, parser_,
        [self = shared_from_this()](ErrorCode error, std::size_t) { self->received(error); });
  }

 private:
  using Fields = http::request<http::string_body>;

  void received(ErrorCode error) {
    const Fields& request = parser_.get();
    response_.version(11);
    response_.keep_alive(false);
    response_.set(http::field::server, "wholehand-clinic");
    response_.set(http::field::cache_control, "no-store");
    response_.set("X-Content-Type-Options", "nosniff");
    response_.set(http::field::vary, "Origin");
    const std::string origin(request[http::field::origin]);
    const bool ours = std::find(origins_.begin(), origins_.end(), origin) != origins_.end();
    if (ours) {
      response_.set(http::field::access_control_allow_origin, origin);
      response_.set(http::field::access_control_expose_headers, "Content-Disposition");
    }
    if (error == http::error::header_limit) {
      later_.expires_after(kTooLargeWait);
      later_.async_wait([self = shared_from_this()](ErrorCode) {
        self->send(431, refusal("bad_value", "the header is too large"));
      });
    } else if (error == http::error::body_limit) {
      send(kTooLarge, refusal("bad_value", "the body has more than 65536 bytes"));
    } else if (error.category() == http::make_error_code(http::error{}).category()) {
      if (error != http::error::end_of_stream) send(400, refusal("bad_value", "this is no HTTP"));
    } else if (error) {
      return;  // the client is gone or took too long
    } else if (!hostAllowed(request[http::field::host])) {
      send(403, refusal("bad_value", "the header Host names another machine than this one"));
    } else if (!ours) {
      send(403, refusal("bad_value", "the header Origin is not the station's; --origin adds one"));
    } else if (request.method() == http::verb::options) {
      response_.set(http::field::access_control_allow_methods, "GET, POST, PUT, DELETE");
      response_.set(http::field::access_control_allow_headers,
                    "Authorization, Content-Type, Idempotency-Key");
      response_.set(http::field::access_control_max_age, "600");
      send(204, {});
    } else {
      answer(request);
    }
  }

  void answer(const Fields& request) {
    const std::string_view target(request.target().data(), request.target().size());
    const std::size_t question = std::min(target.find('?'), target.size());
    Request r;
    r.method = std::string(request.method_string());
    r.path = target.substr(0, question);
    readQuery(target.substr(std::min(question + 1, target.size())), r);
    const std::string bearer(request[http::field::authorization]);
    constexpr std::string_view kBearer = "Bearer ";
    if (bearer.starts_with(kBearer)) r.token = bearer.substr(kBearer.size());
    r.key = std::string(request["Idempotency-Key"]);
    r.body = request.body();
    Answer a = clinic_.answer(r);
    response_.set(http::field::content_type, a.type);
    if (!a.file.empty()) {
      response_.set(http::field::content_disposition,
                    fmt::format("attachment; filename=\"{}\"", a.file));
    }
    send(static_cast<unsigned>(a.status), std::move(a.body));
  }

  void send(unsigned status, std::string body) {
    response_.result(status);
    if (!body.empty() && response_.find(http::field::content_type) == response_.end()) {
      response_.set(http::field::content_type, "application/json");
    }
    response_.body() = std::move(body);
    response_.prepare_payload();
    stream_.expires_after(kPatience);
    http::async_write(stream_, response_, [self = shared_from_this()](ErrorCode, std::size_t) {
      ErrorCode ignored;
      self->stream_.socket().shutdown(Tcp::socket::shutdown_send, ignored);
    });
  }

  beast::tcp_stream stream_;
  net::steady_timer later_;
  beast::flat_buffer buffer_;
  http::request_parser<http::string_body> parser_;
  http::response<http::string_body> response_;
  Clinic& clinic_;
  const std::vector<std::string>& origins_;
  std::atomic<int>& open_;
};

}  // namespace

class HttpServer::Listener {
 public:
  Listener(Clinic& clinic, std::vector<std::string> origins)
      : clinic_(clinic), origins_(std::move(origins)) {}
  ~Listener() {
    io_.stop();
    for (std::thread& thread : threads_) thread.join();
  }
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;

  ErrorCode start(std::uint16_t port) {
    const Tcp::endpoint endpoint(net::ip::address_v4::loopback(), port);
    ErrorCode error;
    acceptor_.open(endpoint.protocol(), error);
    if (!error) acceptor_.set_option(net::socket_base::reuse_address(true), error);
    if (!error) acceptor_.bind(endpoint, error);
    if (!error) acceptor_.listen(kMostConnections, error);
    if (error) return error;
    accept();
    for (int i = 0; i < kThreads; ++i) threads_.emplace_back([this] { io_.run(); });
    return {};
  }
  [[nodiscard]] std::uint16_t port() const { return acceptor_.local_endpoint().port(); }

 private:
  void accept() {
    acceptor_.async_accept(net::make_strand(io_), [this](ErrorCode error, Tcp::socket socket) {
      if (error == net::error::operation_aborted) return;
      if (!error && open_ < kMostConnections) {
        ++open_;
        std::make_shared<Connection>(std::move(socket), clinic_, origins_, open_)->run();
      }
      accept();
    });
  }

  Clinic& clinic_;
  const std::vector<std::string> origins_;
  std::atomic<int> open_{0};
  net::io_context io_;
  Tcp::acceptor acceptor_{io_};
  std::vector<std::thread> threads_;
};

HttpServer::HttpServer(std::unique_ptr<Listener> listener) : listener_(std::move(listener)) {}
HttpServer::~HttpServer() = default;

std::uint16_t HttpServer::port() const {
  return listener_->port();
}

Expected<std::unique_ptr<HttpServer>> HttpServer::start(Clinic& clinic, std::uint16_t port,
                                                        const std::vector<std::string>& origins) {
  auto listener = std::make_unique<Listener>(clinic, origins);
  if (const ErrorCode error = listener->start(port)) {
    return keyFault("", "--port", std::to_string(port), "cannot be listened on: " + error.message(),
                    "give another port, or 0");
  }
  return std::unique_ptr<HttpServer>(new HttpServer(std::move(listener)));
}

}  // namespace wholehand::clinic
