// A line that shows the progress of long work and its remaining time.
#pragma once

#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <string>

#include "interrupt.hpp"

namespace program {

/// On a terminal a bar that is redrawn; elsewhere a line from time to time. Returns false after Ctrl-C, so that it can
/// be passed to anything that takes a motionlang::Progress.
class ProgressBar {
 public:
  /// Set in processes that work for another one. They draw nothing, and that one decides when all stop.
  inline static bool quiet = false;

  explicit ProgressBar(std::string what, std::ptrdiff_t already_done = 0)
      : what_(std::move(what)), first_(already_done) {}
  ~ProgressBar() { finish(); }
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// Text after the bar, such as the loss.
  void note(std::string text) { note_ = std::move(text); }

  bool operator()(std::ptrdiff_t done, std::ptrdiff_t total) {
    using namespace std::chrono;
    if (quiet) return true;
    const auto now = steady_clock::now();
    const double pause = terminal_ ? 0.1 : 10;
    if (done == total || duration<double>(now - shown_).count() >= pause) {
      shown_ = now;
      draw(done, total, duration<double>(now - start_).count());
    }
    return !interrupted;
  }
  void finish() {
    if (terminal_ && drawn_) std::fputc('\n', stderr);
    drawn_ = false;
  }

  /// Minutes and seconds, or hours and minutes.
  static std::string clock(double seconds) {
    const auto s = static_cast<long>(seconds + 0.5);
    char text[32];
    if (s >= 3600)
      std::snprintf(text, sizeof text, "%ld:%02ld h", s / 3600, s / 60 % 60);
    else
      std::snprintf(text, sizeof text, "%ld:%02ld min", s / 60, s % 60);
    return text;
  }

 private:
  void draw(std::ptrdiff_t done, std::ptrdiff_t total, double elapsed) {
    const double share = total > 0 ? static_cast<double>(done) / static_cast<double>(total) : 1;
    const auto made = static_cast<double>(done - first_);
    const double left = made > 0 ? elapsed / made * static_cast<double>(total - done) : 0;
    constexpr int width = 30;
    const int filled = static_cast<int>(share * width);
    std::fprintf(stderr, "%s%s [%.*s%.*s] %3.0f %%  %s left%s%s%s", terminal_ ? "\r" : "", what_.c_str(), filled,
                 "##############################", width - filled, "..............................", share * 100,
                 clock(left).c_str(), note_.empty() ? "" : "  ", note_.c_str(), terminal_ ? "\033[K" : "\n");
    std::fflush(stderr);
    drawn_ = true;
  }

  std::string what_, note_;
  std::ptrdiff_t first_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now(), shown_{};
  bool terminal_ = ::isatty(2) != 0, drawn_ = false;
};

}  // namespace program
