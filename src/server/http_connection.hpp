#pragma once

#include "server/beast.hpp"
#include "server/clients.hpp"
#include "server/http_text.hpp"
#include "server/polite_log.hpp"
#include "server/site.hpp"
#include "server/websocket_line.hpp"

#include <fmt/format.h>

#include <chrono>
#include <list>
#include <memory>
#include <optional>
#include <string>
#include <variant>

namespace wholehand {

class HttpConnection;

/// What every connection shares; outlives all their operations.
struct Premises {
  Site& site;
  Clients& clients;
  Traffic& traffic;
  PoliteLog& log;
  net::thread_pool& workers;
  std::size_t max_clients = 16;
  std::size_t connections = 0;           ///< over plain HTTP, now
  std::size_t jobs = 0;                  ///< given to the workers and not done
  std::size_t upgrading = 0;             ///< on the way to a WebSocket
  std::list<HttpConnection*> idle = {};  ///< that wait for a request, the longest first
};

/// One browser's connection over HTTP, request after request, until it becomes a WebSocket or ends.
/// Part of server.cpp; lives while one of its operations does.
class HttpConnection : public std::enable_shared_from_this<HttpConnection> {
 public:
  HttpConnection(Tcp::socket socket, Premises& premises)
      : stream_(std::move(socket)), premises_(premises) {
    ++premises_.connections;
  }
  ~HttpConnection() {
    stopWaiting();
    --premises_.connections;
  }
  HttpConnection(const HttpConnection&) = delete;
  HttpConnection& operator=(const HttpConnection&) = delete;

  void read() {
    parser_.emplace();
    parser_->header_limit(16 * 1024);
    parser_->body_limit(std::uint64_t{0});  // nobody has anything to upload
    stream_.expires_after(kPatience);
    place_ = premises_.idle.insert(premises_.idle.end(), this);
    http::async_read(
        stream_, buffer_, *parser_,
        [self = shared_from_this()](ErrorCode error, std::size_t) { self->haveRead(error); });
  }

  /// Ends it while it waits for a request.
  void hangUpIdle() {
    stopWaiting();
    stream_.close();
  }

 private:
  using Parser = http::request_parser<http::empty_body>;
  using TextResponse = http::response<http::string_body>;
  using FileResponse = http::response<http::file_body>;

  /// For the next request, or for a piece of an answer to be taken.
  static constexpr std::chrono::seconds kPatience{30};
  static constexpr std::size_t kMostJobs = 16;

  void stopWaiting() {
    if (place_) premises_.idle.erase(*place_);
    place_.reset();
  }

  void haveRead(ErrorCode error) {
    stopWaiting();
    const bool nonsense = error.category() == http::make_error_code(http::error{}).category() &&
                          error != http::error::end_of_stream;
    if (error && !nonsense) return;
    const auto& header = parser_->get();
    keep_alive_ = !error && header.keep_alive();
    head_ = header.method() == http::verb::head;
    version_ = header.version();
    request_ = HttpRequest{};
    request_.get = head_ || header.method() == http::verb::get;
    request_.target = header.target();
    request_.host = header[http::field::host];
    request_.origin = header[http::field::origin];
    request_.authorization = header[http::field::authorization];
    request_.cookie = header[http::field::cookie];
    request_.if_none_match = header[http::field::if_none_match];
    ++premises_.traffic.http_requests;
    if (nonsense) {
      version_ = 11;
      answer(plain(error == http::error::body_limit ? 413 : 400, "malformed_http",
                   "This is not a request that can be answered."));
    } else if (websocket::is_upgrade(header) && request_.path() == "/ws") {
      upgrade();
    } else if (Site::mayTakeSeconds(request_)) {
      answerByWorker();
    } else {
      answer(premises_.site.answer(request_));
    }
  }

  static HttpAnswer plain(int status, const char* reason, const char* why) {
    HttpAnswer a;
    a.status = status;
    a.content_type = "text/html; charset=utf-8";
    a.body = plainPage(reason, std::string("<p>") + why + "</p>");
    a.refused = reason;
    return a;
  }

  void upgrade() {
    HttpAnswer verdict = premises_.site.mayConnect(request_);
    if (verdict.status != 200) {
      answer(std::move(verdict));
    } else if (premises_.clients.count() + premises_.upgrading >= premises_.max_clients) {
      answer(plain(503, "too_many_clients", "As many clients as may be are connected."));
    } else {
      stream_.expires_never();
      auto line = std::make_shared<WebSocketLine>(stream_.release_socket(), premises_.clients,
                                                  premises_.traffic);
      line->accept(parser_->get(), premises_.site.cookieFor(request_), premises_.upgrading);
    }
  }

  void answerByWorker() {
    if (premises_.jobs >= kMostJobs) {
      answer(plain(503, "busy", "Too much is being read or drawn at present. Try again soon."));
      return;
    }
    ++premises_.jobs;
    stream_.expires_never();
    net::post(premises_.workers, [self = shared_from_this()]() mutable {
      HttpAnswer made;
      try {
        made = self->premises_.site.answer(self->request_);
      } catch (const std::exception& e) {
        made = plain(500, "exception", "This could not be made.");
      }
      // Not copied: the worker must not be the last to know the connection, and so end it.
      const auto executor = self->stream_.get_executor();
      net::post(executor, [self = std::move(self), made = std::move(made)]() mutable {
        --self->premises_.jobs;
        self->answer(std::move(made));
      });
    });
  }

  void answer(HttpAnswer a) {
    if (!a.refused.empty()) {
      ++premises_.traffic.refused[a.refused];
      premises_.log.write(
          fmt::format("{} refused ({}): {}", peer(), a.refused, printable(request_.path())),
          monotonicNow_ns());
    }
    if (a.file.empty()) {
      sendText(std::move(a));
    } else {
      sendFile(a);
    }
  }

  std::string peer() const {
    ErrorCode error;
    const auto endpoint = stream_.socket().remote_endpoint(error);
    return error ? std::string("a client that is gone") : endpoint.address().to_string();
  }

  template <class Response>
  void dress(Response& response, const HttpAnswer& a) const {
    response.result(static_cast<unsigned>(a.status));
    response.version(version_);
    response.keep_alive(keep_alive_);
    response.set(http::field::server, "wholehand");
    if (!a.content_type.empty()) response.set(http::field::content_type, a.content_type);
    for (const auto& [name, value] : a.headers) response.set(name, value);
  }

  void sendText(HttpAnswer a) {
    TextResponse response;
    dress(response, a);
    if (a.status != 304) response.content_length(a.body.size());
    if (!head_) response.body() = std::move(a.body);
    send(std::move(response));
  }

  void sendFile(const HttpAnswer& a) {
    FileResponse response;
    dress(response, a);
    ErrorCode error;
    response.body().open(a.file.c_str(), beast::file_mode::scan, error);
    if (error) {  // deleted since it was found
      answer(plain(404, "vanished", "This file is not there any more."));
      return;
    }
    response.content_length(response.body().size());
    if (head_) {
      TextResponse bare;
      bare.base() = response.base();
      send(std::move(bare));
    } else {
      send(std::move(response));
    }
  }

  template <class Body>
  void send(http::response<Body> response) {
    auto outgoing = std::make_shared<Outgoing<Body>>(std::move(response));
    sendSome(std::move(outgoing));
  }

  /// A response and how far it has gone.
  template <class Body>
  struct Outgoing {
    explicit Outgoing(http::response<Body> r) : response(std::move(r)), serializer(response) {}
    http::response<Body> response;
    http::response_serializer<Body> serializer;
  };

  // In pieces, so that patience is counted anew with each that was taken.
  template <class Body>
  void sendSome(std::shared_ptr<Outgoing<Body>> outgoing) {
    stream_.expires_after(kPatience);
    auto& serializer = outgoing->serializer;
    http::async_write_some(stream_, serializer,
                           [self = shared_from_this(), outgoing = std::move(outgoing)](
                               ErrorCode error, std::size_t) mutable {
                             const bool closes = error == http::error::end_of_stream;
                             if (error && !closes) return;
                             if (!closes && !outgoing->serializer.is_done()) {
                               self->sendSome(std::move(outgoing));
                             } else if (closes || !self->keep_alive_) {
                               self->hangUp();
                             } else {
                               self->read();
                             }
                           });
  }

  void hangUp() {
    ErrorCode ignored;
    stream_.socket().shutdown(Tcp::socket::shutdown_send, ignored);
  }

  beast::tcp_stream stream_;
  Premises& premises_;
  beast::flat_buffer buffer_;
  std::optional<Parser> parser_;
  HttpRequest request_;
  std::optional<std::list<HttpConnection*>::iterator> place_;  ///< while it waits
  bool keep_alive_ = false, head_ = false;
  unsigned version_ = 11;
};

}  // namespace wholehand
