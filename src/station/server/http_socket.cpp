#include "station/server/sockets.hpp"

#include <array>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core/buffers_to_string.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/websocket/rfc6455.hpp>
#include <optional>
#include <utility>

namespace wholehand {

namespace {

namespace beast = boost::beast;
namespace http = boost::beast::http;

/// Timeout for the next request, or for a piece of an answer to be taken.
constexpr std::chrono::seconds kPatience{30};
constexpr std::uint32_t kLargestHeader_bytes = 16 * 1024;
constexpr unsigned kVersion = 11;  ///< HTTP 1.1

class HttpSocket final : public HttpLine {
 public:
  explicit HttpSocket(Tcp::socket socket)
      : stream_(std::move(socket)), timer_(stream_.get_executor()) {}

  void read(std::function<void(ReceivedRequest)> then) override {
    parser_.emplace();
    parser_->header_limit(kLargestHeader_bytes);
    parser_->body_limit(std::uint64_t{0});  // uploads are refused
    stream_.expires_after(kPatience);
    http::async_read(stream_, buffer_, *parser_,
                     [this, then = std::move(then)](ErrorCode error, std::size_t) {
                       const bool malformed = isMalformed(error);
                       if (!error || malformed) then(received(error, malformed));
                     });
  }

  void send(HttpAnswer answer, Then then) override {
    Header header = dressed(answer);
    if (answer.status != 304) header.content_length(answer.body.size());
    if (head_) answer.body.clear();
    write(textOf(header), std::move(answer.body), std::move(then));
  }

  void sendHeader(const HttpAnswer& answer, std::uint64_t size, Then then) override {
    Header header = dressed(answer);
    header.content_length(size);
    write(textOf(header), {}, std::move(then));
  }

  void sendPiece(std::string piece, Then then) override {
    write({}, std::move(piece), std::move(then));
  }

  void upgrade(std::string cookie, std::size_t largest_bytes,
               std::function<void(std::unique_ptr<WebSocketStream>)> then) override {
    stream_.expires_never();
    acceptWebSocket(stream_.release_socket(), parser_->get(), std::move(cookie), largest_bytes,
                    std::move(then));
  }

  void setTimer(std::chrono::milliseconds after, Then then) override {
    stream_.expires_never();
    timer_.expires_after(after);
    timer_.async_wait([then = std::move(then)](ErrorCode error) {
      if (!error) then();
    });
  }
  void cancelTimer() override { timer_.cancel(); }

  bool headOnly() const override { return head_; }
  bool keepsAlive() const override { return keep_alive_; }
  void keepNoLonger() override { keep_alive_ = false; }

  std::string peer() const override {
    ErrorCode error;
    const auto endpoint = stream_.socket().remote_endpoint(error);
    return error ? std::string("a client that is gone") : endpoint.address().to_string();
  }

  void finish() override {
    ErrorCode ignored;
    stream_.socket().shutdown(Tcp::socket::shutdown_send, ignored);
  }
  void close() override { stream_.close(); }

 private:
  using Header = http::response<http::empty_body>;

  static bool isMalformed(ErrorCode error) {
    return error.category() == http::make_error_code(http::error{}).category() &&
           error != http::error::end_of_stream;
  }

  ReceivedRequest received(ErrorCode error, bool malformed) {
    const auto& header = parser_->get();
    keep_alive_ = !error && header.keep_alive();
    head_ = header.method() == http::verb::head;
    version_ = malformed ? kVersion : header.version();
    ReceivedRequest h;
    if (malformed) {
      h.what = error == http::error::body_limit     ? ReceivedRequest::Kind::kHasBody
               : error == http::error::header_limit ? ReceivedRequest::Kind::kTooLarge
                                                    : ReceivedRequest::Kind::kMalformed;
    }
    h.upgrade = boost::beast::websocket::is_upgrade(header);
    h.request.get = head_ || header.method() == http::verb::get;
    h.request.target = header.target();
    h.request.host = header[http::field::host];
    h.request.origin = header[http::field::origin];
    h.request.authorization = header[http::field::authorization];
    h.request.cookie = header[http::field::cookie];
    h.request.if_none_match = header[http::field::if_none_match];
    return h;
  }

  Header dressed(const HttpAnswer& a) const {
    Header header;
    header.result(static_cast<unsigned>(a.status));
    header.version(version_);
    header.keep_alive(keep_alive_);
    header.set(http::field::server, "wholehand");
    if (!a.content_type.empty()) header.set(http::field::content_type, a.content_type);
    for (const auto& [name, value] : a.headers) header.set(name, value);
    return header;
  }

  static std::string textOf(const Header& header) {
    const http::fields::writer writer(header, header.version(), header.result_int());
    return beast::buffers_to_string(writer.get());
  }

  void write(std::string header, std::string body, Then then) {
    header_ = std::move(header);
    body_ = std::move(body);
    stream_.expires_after(kPatience);
    const std::array<net::const_buffer, 2> both{net::buffer(header_), net::buffer(body_)};
    net::async_write(stream_, both, [then = std::move(then)](ErrorCode error, std::size_t) {
      if (!error) then();
    });
  }

  beast::tcp_stream stream_;
  net::steady_timer timer_;
  beast::flat_buffer buffer_;
  std::optional<http::request_parser<http::empty_body>> parser_;
  std::string header_, body_;  ///< answer being sent
  bool keep_alive_ = false, head_ = false;
  unsigned version_ = kVersion;
};

}  // namespace

std::unique_ptr<HttpLine> openHttpLine(Tcp::socket socket) {
  return std::make_unique<HttpSocket>(std::move(socket));
}

}  // namespace wholehand
