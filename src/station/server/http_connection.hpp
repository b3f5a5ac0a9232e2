#pragma once

#include "station/server/clients.hpp"
#include "station/server/file_workers.hpp"
#include "station/server/http_line.hpp"
#include "station/server/logs.hpp"
#include "station/server/site.hpp"
#include "station/server/traffic.hpp"

#include <atomic>
#include <chrono>
#include <cstddef>
#include <functional>
#include <list>
#include <memory>
#include <optional>
#include <string>

namespace wholehand {

class HttpConnection;

/// State shared by all connections; outlives all their operations.
struct ConnectionContext {
  Site& site;
  Clients& clients;
  Traffic& traffic;
  RateLimitedLog& log;
  FileWorkers& pages;  ///< separate: the page with the stop button must not wait for recordings
  FileWorkers& recordings;  ///< may wait for a slow disk
  FileWorkers& replays;     ///< separate, because a replay must not wait for a download
  /// Runs a task on the server's thread; called from any thread.
  std::function<void(std::function<void()>)> post;
  std::size_t max_clients = 16;
  std::chrono::milliseconds disk_patience{};
  std::chrono::milliseconds report_patience{};
  std::size_t connections = 0;  ///< open plain HTTP connections
  std::size_t upgrading = 0;    ///< being upgraded to a WebSocket
  /// Those that may be closed to make room: waiting with a refusal, then for a request, longest
  /// first.
  std::list<HttpConnection*> idle = {};
};

/// Answers one browser over HTTP until the connection ends or becomes a WebSocket. Chooses who
/// makes each answer, and limits how long that may take. Server's thread only. It touches no file:
/// workers read files and hand over the data. Lives while an operation of its line is pending.
class HttpConnection : public std::enable_shared_from_this<HttpConnection> {
 public:
  /// @pre the context outlives it
  HttpConnection(std::unique_ptr<HttpLine> line, ConnectionContext& context);
  ~HttpConnection();
  HttpConnection(const HttpConnection&) = delete;
  HttpConnection& operator=(const HttpConnection&) = delete;

  /// Waits for a request and answers it.
  void read();
  /// Closes the connection while it waits for a request, or with a refusal.
  void hangUpIdle();

 private:
  /// Work that a worker does for this connection. Only one thread owns it at a time.
  struct Work {
    HttpRequest request;
    bool head = false;
    HttpAnswer answer;
    std::unique_ptr<FileReader> file;  ///< file being sent
    std::string piece;                 ///< its next piece
    bool no_memory = false;            ///< memory ran out for the answer, the file or the piece
    std::atomic<bool> given_up{false};
  };
  using Then = void (HttpConnection::*)();

  void stopWaiting();
  void closeFile();
  [[nodiscard]] HttpLine::Then next(Then then);
  [[nodiscard]] FileWorkers& workers();

  void haveRead(ReceivedRequest received);
  void refuseLate();
  void upgrade();
  [[nodiscard]] bool letWork(const std::shared_ptr<Work>& work, std::function<void(Work&)> job,
                             void (HttpConnection::*then)(Work&));
  void answerByWorker();
  void haveMade(Work& work);
  void giveUp(const std::shared_ptr<Work>& work);
  void answer(HttpAnswer a);
  void sendHeader(Work& work);
  void sendPiece(std::string piece);
  void readPiece();
  void havePiece(Work& work);
  void haveSentFile();
  void haveAnswered();

  std::unique_ptr<HttpLine> line_;
  ConnectionContext& context_;
  HttpRequest request_;
  Site::Route route_ = Site::Route::kNoFile;
  std::optional<std::list<HttpConnection*>::iterator> place_;  ///< set while it waits for a request
  std::shared_ptr<Work> work_;                                 ///< set while a worker owns it
  std::unique_ptr<FileReader> file_;                           ///< file being sent
  bool sending_ = false;                                       ///< the header of a file was sent
};

}  // namespace wholehand
