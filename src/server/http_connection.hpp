#pragma once

#include "server/beast.hpp"
#include "server/http_text.hpp"
#include "server/premises.hpp"
#include "server/websocket_line.hpp"

#include <fmt/format.h>

#include <atomic>
#include <chrono>
#include <list>
#include <memory>
#include <optional>
#include <string>

namespace wholehand {

/// One browser's connection over HTTP, request after request, until it becomes a WebSocket or ends.
/// Part of server.cpp; lives while one of its operations does. Its thread touches no file: workers
/// do, and hand over what they have read. A worker that a disk holds up is waited for so long.
class HttpConnection : public std::enable_shared_from_this<HttpConnection> {
 public:
  HttpConnection(Tcp::socket socket, Premises& premises)
      : stream_(std::move(socket)), patience_(stream_.get_executor()), premises_(premises) {
    ++premises_.connections;
  }
  ~HttpConnection() {
    stopWaiting();
    closeFile();
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
  using FileHeader = http::response<http::empty_body>;

  /// For the next request, or for a piece of an answer to be taken.
  static constexpr std::chrono::seconds kPatience{30};

  /// What a worker does for it. Both threads have it in turns.
  struct Work {
    HttpRequest request;
    bool head = false;
    HttpAnswer answer;
    std::unique_ptr<FileReader> file;  ///< being sent
    std::string piece;                 ///< of it
    std::atomic<bool> given_up{false};
  };

  void stopWaiting() {
    if (place_) premises_.idle.erase(*place_);
    place_.reset();
  }

  void closeFile() {
    if (file_) workers().close(std::move(file_));
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
    needs_ = Site::needsOf(request_);
    if (nonsense) {
      version_ = 11;
      answer(plainRefusal(error == http::error::body_limit ? 413 : 400, "malformed_http",
                          "This is not a request that can be answered."));
    } else if (websocket::is_upgrade(header) && request_.path() == "/ws") {
      upgrade();
    } else if (needs_ != Site::Needs::kNoFile) {
      answerByWorker();
    } else {
      answer(premises_.site.answer(request_));
    }
  }

  void upgrade() {
    HttpAnswer verdict = premises_.site.mayConnect(request_);
    if (verdict.status != 200) {
      answer(std::move(verdict));
    } else if (premises_.clients.count() + premises_.upgrading >= premises_.max_clients) {
      answer(plainRefusal(503, "too_many_clients", "As many clients as may be are connected."));
    } else {
      stream_.expires_never();
      auto line = std::make_shared<WebSocketLine>(stream_.release_socket(), premises_.clients,
                                                  premises_.traffic);
      line->accept(parser_->get(), premises_.site.cookieFor(request_), premises_.upgrading);
    }
  }

  [[nodiscard]] FileWorkers& workers() {
    return needs_ == Site::Needs::kPage ? premises_.pages : premises_.recordings;
  }

  // What a worker does touches this connection only through its thread: it may be gone by then, and
  // the worker must not be the last to know it.
  template <class Job, class Then>
  [[nodiscard]] bool letWork(const std::shared_ptr<Work>& work, Job job, Then then) {
    stream_.expires_never();
    work_ = work;
    auto done = [weak = weak_from_this(), work, then, &desk = workers()] {
      const auto self = weak.lock();
      if (self && self->work_ == work) {
        self->patience_.cancel();
        self->work_.reset();
        ((*self).*then)(*work);
      }
      desk.close(std::move(work->file));
    };
    if (!workers().post([work, job, done, executor = stream_.get_executor()] {
          if (!work->given_up) job(*work);
          net::post(executor, done);
        })) {
      work_.reset();
      return false;
    }
    const bool draws = needs_ == Site::Needs::kReport;
    patience_.expires_after(draws ? premises_.report_patience : premises_.disk_patience);
    patience_.async_wait([self = shared_from_this(), work](ErrorCode error) {
      if (!error) self->giveUp(work);
    });
    return true;
  }

  void answerByWorker() {
    auto work = std::make_shared<Work>();
    work->request = request_;
    work->head = head_;
    const auto job = [&site = premises_.site](Work& w) {
      try {
        w.answer = site.answer(w.request);
      } catch (const std::exception&) {
        w.answer = plainRefusal(500, "exception", "This could not be made.");
      }
      if (w.answer.file.empty()) return;
      w.file = FileReader::open(w.answer.file);
      if (w.file && !w.head) w.piece = w.file->next();
    };
    if (!letWork(work, job, &HttpConnection::haveMade)) {
      answer(
          plainRefusal(503, "busy", "Too much is being read or drawn at present. Try again soon."));
    }
  }

  void haveMade(Work& work) {
    if (work.answer.file.empty()) {
      answer(std::move(work.answer));
    } else if (!work.file) {  // deleted since it was found
      answer(plainRefusal(404, "vanished", "This file is not there any more."));
    } else {
      sendHeader(work);
    }
  }

  // The disk does not answer. The worker goes on waiting for it; its work is thrown away.
  void giveUp(const std::shared_ptr<Work>& work) {
    if (work_ != work) return;
    work_->given_up = true;
    work_.reset();
    keep_alive_ = false;
    if (sending_) {
      stream_.close();
    } else {
      answer(plainRefusal(503, "disk", "The disk does not answer, or the report is too large."));
    }
  }

  void answer(HttpAnswer a) {
    if (!a.refused.empty()) {
      ++premises_.traffic.refused[a.refused];
      premises_.log.write(
          fmt::format("{} refused ({}): {}", peer(), a.refused, printable(request_.path())),
          monotonicNow_ns());
    }
    sendText(std::move(a));
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
    auto response = std::make_shared<TextResponse>();
    dress(*response, a);
    if (a.status != 304) response->content_length(a.body.size());
    if (!head_) response->body() = std::move(a.body);
    stream_.expires_after(kPatience);
    http::async_write(stream_, *response,
                      [self = shared_from_this(), response](ErrorCode error, std::size_t) {
                        const bool closes = error == http::error::end_of_stream;
                        if (closes) self->keep_alive_ = false;
                        if (!error || closes) self->haveAnswered();
                      });
  }

  // The header, then the file in pieces, so that patience is counted anew with each that was taken.
  void sendHeader(Work& work) {
    auto header = std::make_shared<FileHeader>();
    dress(*header, work.answer);
    header->content_length(work.file->size());
    file_ = std::move(work.file);
    piece_ = std::move(work.piece);
    sending_ = true;
    auto serializer = std::make_shared<http::response_serializer<http::empty_body>>(*header);
    stream_.expires_after(kPatience);
    http::async_write_header(
        stream_, *serializer,
        [self = shared_from_this(), header, serializer](ErrorCode error, std::size_t) {
          if (error) return;
          if (self->head_) return self->haveSentFile();
          self->sendPiece();
        });
  }

  void sendPiece() {
    stream_.expires_after(kPatience);
    net::async_write(stream_, net::buffer(piece_),
                     [self = shared_from_this()](ErrorCode error, std::size_t) {
                       if (!error) self->readPiece();
                     });
  }

  void readPiece() {
    if (file_->left() == 0) return haveSentFile();
    auto work = std::make_shared<Work>();
    work->file = std::move(file_);
    const auto job = [](Work& w) { w.piece = w.file->next(); };
    if (!letWork(work, job, &HttpConnection::havePiece)) {
      file_ = std::move(work->file);
      stream_.close();  // what was promised cannot be sent
    }
  }

  void havePiece(Work& work) {
    if (work.piece.empty()) return stream_.close();  // the file has become shorter
    file_ = std::move(work.file);
    piece_ = std::move(work.piece);
    sendPiece();
  }

  void haveSentFile() {
    closeFile();
    sending_ = false;
    haveAnswered();
  }

  void haveAnswered() {
    if (keep_alive_) return read();
    ErrorCode ignored;
    stream_.socket().shutdown(Tcp::socket::shutdown_send, ignored);
  }

  beast::tcp_stream stream_;
  net::steady_timer patience_;  ///< with the disk
  Premises& premises_;
  beast::flat_buffer buffer_;
  std::optional<Parser> parser_;
  HttpRequest request_;
  Site::Needs needs_ = Site::Needs::kNoFile;
  std::optional<std::list<HttpConnection*>::iterator> place_;  ///< while it waits
  std::shared_ptr<Work> work_;                                 ///< while a worker has it
  std::unique_ptr<FileReader> file_;                           ///< being sent
  std::string piece_;                                          ///< of it
  bool sending_ = false;                                       ///< the header of a file has gone
  bool keep_alive_ = false, head_ = false;
  unsigned version_ = 11;
};

}  // namespace wholehand
