// Timing for the benchmarks: medians, and one line per measurement in the form that run.py reads.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <string>
#include <vector>

#include <motionlang/core/parallel.hpp>

namespace bench {

inline double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Seconds that f takes, in ascending order: at least `least` runs, up to `most` while `seconds` have not passed.
template <class F>
std::vector<double> times_of(F f, double seconds, int least, int most) {
  std::vector<double> times;
  for (const double start = now(); std::ssize(times) < least || (now() - start < seconds && std::ssize(times) < most);) {
    const double before = now();
    f();
    times.push_back(now() - before);
  }
  std::sort(times.begin(), times.end());
  return times;
}

/// work,config,variant,threads,min_ms,median_ms,p90_ms,gflop,gflops. Returns the median in seconds.
template <class F>
double report(const std::string& work, const std::string& config, const std::string& variant, double gflop, F f,
              double seconds = 3, int least = 5) {
  f();
  f();  // pools fill
  const auto times = times_of(f, seconds, least, 300);
  const double median = times[times.size() / 2];
  std::printf("%s,%s,%s,%d,%.3f,%.3f,%.3f,%.3f,%.1f\n", work.c_str(), config.c_str(), variant.c_str(),
              motionlang::thread_count(), times.front() * 1e3, median * 1e3, times[times.size() * 9 / 10] * 1e3, gflop,
              gflop / median);
  std::fflush(stdout);
  return median;
}

/// Multiplications and additions of encoder layers on sequences of `tokens`, in 1e9.
inline double encoder_gflop(double tokens, double d, double ff, double layers) {
  return (2 * tokens * d * 4 * d + 4 * tokens * tokens * d + 4 * tokens * d * ff) * layers * 1e-9;
}

}  // namespace bench
