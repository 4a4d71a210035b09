// Timing for the benchmarks: what a program is asked for, medians, and one line per measurement in the form that run.py
// reads.
#pragma once

#include <cstdio>
#include <cstdlib>
#include <set>
#include <string>
#include <vector>

#include <motionlang/backend/precision.hpp>

#include "again.hpp"
#include "peak.hpp"

namespace bench {

namespace ml = motionlang;

/// [THREADS] [--fp32 | --bf16 | --bf16x3] [WORK ...]: all threads of the machine, products in fp32 and all works unless
/// said.
struct Arguments {
  std::set<std::string> works;

  Arguments(int argc, char** argv) {
    for (int i = 1; i < argc; ++i) {
      const std::string word = argv[i];
      if (const auto precision = word.starts_with("--") ? ml::precision_named(word.substr(2)) : std::nullopt)
        ml::set_product_precision(*precision);
      else if (i == 1)
        ml::set_thread_count(std::atoi(argv[i]));
      else
        works.insert(word);
    }
  }
  bool asked(const std::string& work) const { return works.empty() || works.contains(work); }
};

/// Seconds that f takes, in ascending order: at least `least` runs, up to `most` while `seconds` have not passed.
template <class F>
std::vector<double> times_of(F f, double seconds, int least, int most) {
  std::vector<double> times;
  for (const double start = now();
       std::ssize(times) < least || (now() - start < seconds && std::ssize(times) < most);) {
    const double before = now();
    f();
    times.push_back(now() - before);
  }
  std::sort(times.begin(), times.end());
  return times;
}

/// How a measurement is done, and what it is called.
struct Manner {
  double seconds = 3;
  int least = 5;
  std::string variant = "motionlang";  // another name: a peer
};

inline constexpr int most_runs = 300;

/// The fastest run of a turn, and the peak beside it.
struct Turn {
  double seconds = 0, peak = 0;

  bool operator<(const Turn& other) const { return seconds * peak < other.seconds * other.peak; }
};
/// Times of a work, in ascending order, and the turn whose share of the peak is the median.
struct Timed {
  std::vector<double> times;
  Turn turn;
};

/// f in turns of 5 ms with the peak: the clock of a processor, and what the neighbours leave of it, changes from one
/// moment to the next, by a tenth and more.
template <class F>
Timed time_beside_peak(F f, const Manner& manner) {
  Timed out;
  std::vector<Turn> turns;
  double before = peak_gflops(ml::product_precision());
  const double start = now();
  const auto runs = [&] { return static_cast<int>(out.times.size()); };
  while (runs() < manner.least || (now() - start < manner.seconds && runs() < most_runs)) {
    const auto times = times_of(f, 0.005, 1, most_runs - runs());
    const double after = peak_gflops(ml::product_precision());
    turns.push_back({times.front(), std::max(before, after)});
    out.times.insert(out.times.end(), times.begin(), times.end());
    before = after;
  }
  std::sort(out.times.begin(), out.times.end());
  std::sort(turns.begin(), turns.end());
  out.turn = turns[turns.size() / 2];
  return out;
}

/// work,config,variant,threads,min_ms,median_ms,p90_ms,gflop,gflops,peak. Returns the median in seconds.
/// gflop          1e9 multiplications and additions of one run; 0: nobody counts them
/// gflops, peak   what is compared: the speed of the turn whose share of the peak is the median, and the peak beside it
template <class F>
double report(const std::string& work, const std::string& config, double gflop, F f, const Manner& manner = {}) {
  f();
  f();  // pools fill
  const Timed t =
      gflop > 0 ? time_beside_peak(f, manner) : Timed{times_of(f, manner.seconds, manner.least, most_runs), {}};
  const double median = t.times[t.times.size() / 2];
  std::printf("%s,%s,%s,%d,%.4f,%.4f,%.4f,%.3f,%.1f,%.1f\n", work.c_str(), config.c_str(), manner.variant.c_str(),
              ml::thread_count(), t.times.front() * 1e3, median * 1e3, t.times[t.times.size() * 9 / 10] * 1e3, gflop,
              gflop > 0 ? gflop / t.turn.seconds : 0, t.turn.peak);
  std::fflush(stdout);
  return median;
}

/// A number that is not a time: memory in MB, a factor, milliseconds of something that happens once. Its place is
/// that of the times.
inline void report_value(const std::string& work, const std::string& config, double value) {
  std::printf("%s,%s,motionlang,%d,%.4f,%.4f,%.4f,0,0,0\n", work.c_str(), config.c_str(), ml::thread_count(), value,
              value, value);
  std::fflush(stdout);
}

/// Multiplications and additions of encoder layers on sequences of `tokens`, in 1e9.
inline double encoder_gflop(double tokens, double d, double ff, double layers) {
  return (2 * tokens * d * 4 * d + 4 * tokens * tokens * d + 4 * tokens * d * ff) * layers * 1e-9;
}

}  // namespace bench
