#include "station/server/raw_client.hpp"

#include <algorithm>
#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <stdexcept>
#include <sys/socket.h>
#include <unistd.h>

namespace wholehand::test {

namespace {

std::chrono::steady_clock::time_point after(std::chrono::milliseconds d) {
  return std::chrono::steady_clock::now() + d;
}

std::string lowered(std::string s) {
  std::transform(s.begin(), s.end(), s.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return s;
}

}  // namespace

RawSocket::RawSocket(std::uint16_t port, int receive_buffer) {
  handle_ = ::socket(AF_INET, SOCK_STREAM, 0);
  if (receive_buffer > 0) {
    ::setsockopt(handle_, SOL_SOCKET, SO_RCVBUF, &receive_buffer, sizeof receive_buffer);
  }
  const int yes = 1;
  ::setsockopt(handle_, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (::connect(handle_, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0) {
    throw std::runtime_error("no connection to the server");
  }
}

RawSocket::~RawSocket() {
  ::close(handle_);
}

void RawSocket::send(const std::string& bytes) {
  for (std::size_t sent = 0; sent < bytes.size();) {
    const ssize_t n = ::send(handle_, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL);
    if (n <= 0) return;  // closed by the other side: the next read shows it
    sent += static_cast<std::size_t>(n);
  }
}

bool RawSocket::fill(std::chrono::steady_clock::time_point until) {
  using std::chrono::milliseconds;
  const auto left =
      std::chrono::ceil<milliseconds>(until - std::chrono::steady_clock::now()).count();
  pollfd wait{handle_, POLLIN, 0};
  if (closed_ || left <= 0 || ::poll(&wait, 1, static_cast<int>(left)) <= 0) return false;
  std::string piece(65536, '\0');
  const ssize_t n = ::recv(handle_, piece.data(), piece.size(), 0);
  closed_ = n <= 0;
  if (!closed_) buffer_.append(piece, 0, static_cast<std::size_t>(n));
  return !closed_;
}

std::optional<std::string> RawSocket::receive(std::size_t bytes, std::chrono::milliseconds within) {
  const auto until = after(within);
  while (buffer_.size() < bytes) {
    if (!fill(until)) return std::nullopt;
  }
  std::string out = buffer_.substr(0, bytes);
  buffer_.erase(0, bytes);
  return out;
}

std::optional<std::string> RawSocket::receiveUntil(const std::string& end,
                                                   std::chrono::milliseconds within) {
  const auto until = after(within);
  std::size_t at = 0;
  while ((at = buffer_.find(end)) == std::string::npos) {
    if (!fill(until)) return std::nullopt;
  }
  return receive(at + end.size(), within);
}

HttpReply ask(RawSocket& socket, const std::string& request, std::chrono::milliseconds within) {
  socket.send(request);
  HttpReply reply;
  const auto head = socket.receiveUntil("\r\n\r\n", within);
  if (!head) return reply;
  reply.status = std::stoi(head->substr(9, 3));
  for (std::size_t begin = head->find("\r\n") + 2; begin + 2 < head->size();) {
    const std::size_t end = head->find("\r\n", begin);
    const std::string line = head->substr(begin, end - begin);
    const std::size_t colon = line.find(": ");
    if (colon != std::string::npos) {
      reply.headers[lowered(line.substr(0, colon))] = line.substr(colon + 2);
    }
    begin = end + 2;
  }
  const bool has_body = !request.starts_with("HEAD") && reply.status != 304 && reply.status != 101;
  if (has_body && reply.headers.contains("content-length")) {
    reply.body = socket.receive(std::stoul(reply.headers["content-length"]), within).value_or("");
  }
  return reply;
}

HttpReply get(std::uint16_t port, const std::string& target, const std::string& more_headers,
              const std::string& method) {
  RawSocket socket(port);
  const std::string host = more_headers.find("Host:") == std::string::npos
                               ? "Host: 127.0.0.1:" + std::to_string(port) + "\r\n"
                               : "";
  return ask(socket, method + " " + target + " HTTP/1.1\r\n" + host + more_headers + "\r\n");
}

WebSocket::WebSocket(std::uint16_t port, const std::string& more_headers, const std::string& target,
                     int receive_buffer)
    : socket_(port, receive_buffer) {
  const std::string host = more_headers.find("Host:") == std::string::npos
                               ? "Host: 127.0.0.1:" + std::to_string(port) + "\r\n"
                               : "";
  reply_ = ask(socket_, "GET " + target + " HTTP/1.1\r\n" + host +
                            "Upgrade: websocket\r\nConnection: Upgrade\r\n"
                            "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"
                            "Sec-WebSocket-Version: 13\r\n" +
                            more_headers + "\r\n");
}

void WebSocket::sendFrame(int opcode, const std::string& payload) {
  std::string frame;
  frame += static_cast<char>(0x80 | opcode);
  if (payload.size() < 126) {
    frame += static_cast<char>(0x80 | payload.size());
  } else {
    frame += static_cast<char>(0x80 | 126);
    frame += static_cast<char>(payload.size() >> 8U);
    frame += static_cast<char>(payload.size() & 0xFFU);
  }
  const std::string mask = "\x12\x34\x56\x78";
  frame += mask;
  for (std::size_t i = 0; i < payload.size(); ++i) {
    frame += static_cast<char>(payload[i] ^ mask[i % 4]);
  }
  socket_.send(frame);
}

std::optional<WebSocket::Frame> WebSocket::receive(std::chrono::milliseconds within) {
  const auto byteAt = [](const std::string& s, std::size_t i) {
    return static_cast<std::uint64_t>(static_cast<unsigned char>(s[i]));
  };
  while (true) {
    const auto head = socket_.receive(2, within);
    if (!head) return std::nullopt;
    std::uint64_t size = byteAt(*head, 1) & 0x7FU;
    if (size >= 126) {
      const auto more = socket_.receive(size == 126 ? 2 : 8, within);
      if (!more) return std::nullopt;
      size = 0;
      for (std::size_t i = 0; i < more->size(); ++i) size = size << 8U | byteAt(*more, i);
    }
    auto payload = socket_.receive(size, within);
    if (!payload) return std::nullopt;
    const int opcode = static_cast<int>(byteAt(*head, 0) & 0x0FU);
    if (opcode != 9) return Frame{opcode, std::move(*payload)};
    sendFrame(10, *payload);
  }
}

}  // namespace wholehand::test
