// A server of cpp-httplib whose connections have deadlines. The library's own limits are for each next byte, so a
// sender of one byte a second keeps a connection for ever. It also holds a line without an end in memory, however long.
// Here the head of a request, the whole request, and the waiting for a reader have limits.
#pragma once

#include <httplib.h>

#ifndef _WIN32
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>
#endif

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <string>

#include <motionlang/generate/studio_request.hpp>

namespace program {

namespace ml = motionlang;

/// One request and its answer over a socket, which the caller closes.
class StudioConnection final : public httplib::Stream {
 public:
  using Clock = std::chrono::steady_clock;

  StudioConnection(socket_t socket, const ml::StudioLimits& limits)
      : socket_(socket),
        began_(Clock::now()),
        end_(began_ + seconds(limits.head_seconds)),
        limits_(limits),
        left_(limits.head),
        patience_(seconds(limits.stalled_seconds)) {}

  /// The head is here: from now on the limits of the whole question count. It may come in chunks, which have heads.
  void head_is_read() {
    end_ = began_ + seconds(limits_.question_seconds);
    left_ = limits_.question + limits_.question / 16;
  }

  bool is_readable() const override { return at_ < size_ || waits(POLLIN, end_ - Clock::now()) > 0; }
  bool is_writable() const override { return takes_bytes() && is_open(); }

  ssize_t read(char* to, size_t size) override {
    if (at_ == size_) {
      if (Clock::now() > end_ || !is_readable()) return -1;
      const auto got = ::recv(socket_, held_.data(), held_.size(), 0);
      if (got <= 0) return static_cast<ssize_t>(got);
      if (static_cast<size_t>(got) > left_) return -1;
      left_ -= static_cast<size_t>(got);
      at_ = 0, size_ = static_cast<size_t>(got);
    }
    const size_t count = std::min(size, size_ - at_);
    std::memcpy(to, held_.data() + at_, count);
    at_ += count;
    return static_cast<ssize_t>(count);
  }
  /// Sends a part of it, as much as there is room for.
  ssize_t write(const char* from, size_t size) override {
    for (;;) {
      if (!takes_bytes()) return -1;
#ifdef _WIN32
      return ::send(socket_, from, static_cast<int>(std::min<size_t>(size, 1 << 16)), 0);
#else
      const auto sent = ::send(socket_, from, size, MSG_NOSIGNAL | MSG_DONTWAIT);
      if (sent >= 0 || (errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR)) return sent;
#endif
    }
  }

  // Later versions of the library ask for more than 0.11 does.
  void get_remote_ip_and_port(std::string& ip, int& port) const override { ip.clear(), port = 0; }
  void get_local_ip_and_port(std::string& ip, int& port) const override { ip.clear(), port = 0; }
  socket_t socket() const override { return socket_; }
  virtual bool wait_readable() const { return is_readable(); }
  virtual bool wait_writable() const { return is_writable(); }
  virtual time_t duration() const {
    return std::chrono::duration_cast<std::chrono::milliseconds>(Clock::now() - began_).count();
  }

 private:
  static Clock::duration seconds(double s) {
    return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(s));
  }
  /// The answer of poll after at most this time.
  int waits(short what, Clock::duration most) const {
    const auto ms = std::chrono::duration_cast<std::chrono::milliseconds>(most).count();
    const int limit = static_cast<int>(std::clamp<long long>(ms, 0, 60'000));
    pollfd about{};
    about.fd = socket_, about.events = what;
#ifdef _WIN32
    return WSAPoll(&about, 1, limit);
#else
    int out = 0;
    do out = ::poll(&about, 1, limit);
    while (out < 0 && errno == EINTR);
    return out;
#endif
  }
  /// Waits until the reader makes room. The patience is for all of the answer.
  bool takes_bytes() const {
    const auto began = Clock::now();
    const bool out = waits(POLLOUT, patience_) > 0;
    patience_ = std::max(patience_ - (Clock::now() - began), Clock::duration::zero());
    return out;
  }
  bool is_open() const {
    char next = 0;
    return waits(POLLIN, Clock::duration::zero()) <= 0 || ::recv(socket_, &next, 1, MSG_PEEK) > 0;
  }

  socket_t socket_;
  Clock::time_point began_, end_;
  const ml::StudioLimits& limits_;
  size_t left_;  // bytes that may still come
  mutable Clock::duration patience_;
  std::array<char, 8192> held_{};
  size_t at_ = 0, size_ = 0;
};

/// Takes one request of each connection, within the limits. They must outlive it.
template <class Server>
class TimedServer final : public Server {
 public:
  explicit TimedServer(const ml::StudioLimits& limits) : limits_(limits) {}

 private:
  bool process_and_close_socket(socket_t socket) override {
    bool answered = false;
    {
      StudioConnection connection(socket, limits_);
      if (connection.is_readable()) answered = process(connection);
    }
#ifdef _WIN32
    ::shutdown(socket, SD_BOTH);
    ::closesocket(socket);
#else
    ::shutdown(socket, SHUT_RDWR);
    ::close(socket);
#endif
    return answered;
  }
  template <class Connection>
  bool process(Connection& connection) {
    bool closed = false;
    const auto head_is_read = [&](httplib::Request&) { connection.head_is_read(); };
    if constexpr (requires { this->process_request(connection, true, closed, head_is_read); })
      return this->process_request(connection, true, closed, head_is_read);
    else  // of later versions
      return this->process_request(connection, std::string(), 0, std::string(), 0, true, closed, head_is_read);
  }

  const ml::StudioLimits& limits_;
};

}  // namespace program
