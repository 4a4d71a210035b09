// The whole job with the bundled weights: a timeline of 6 s, all steps. Prints the real-time factor (time taken / length of the
// motion), the time from the start of the program to the end of the first denoising step, and the peak memory beyond the weights.
//   usage: bench_generate MODEL.safetensors [threads]
#include <sys/resource.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include <motionlang/stmc.hpp>

#include "bench.hpp"

namespace ml = motionlang;
using B = ml::EigenBackend<float>;

int main(int argc, char** argv) {
  const double start = bench::now();
  if (argc < 2) return std::fprintf(stderr, "usage: bench_generate MODEL.safetensors [threads]\n"), 2;
  if (argc > 2) ml::set_thread_count(std::atoi(argv[2]));
  const auto stmc = ml::load_stmc<B>(argv[1]);
  const auto timeline = ml::parse_timeline(
      "walk forward # 0.0 # 6.0 # legs\n"
      "raise both arms # 2.0 # 5.0 # left arm # right arm\n");
  double first = 0;
  ml::StmcOptions options;
  auto progress = [&](ml::Index, ml::Index) {
    if (first == 0) first = bench::now() - start;
    return true;
  };
  options.progress = progress;
  const auto features = stmc.generate(timeline, ml::Philox{.seed = 7}, options);
  const double took = bench::now() - start, length = static_cast<double>(features.size(0)) / 20;
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  const double memory = static_cast<double>(usage.ru_maxrss) / 1024;
  const double weights = static_cast<double>(std::filesystem::file_size(argv[1])) / (1 << 20);
  std::printf("motion %.2f s in %.2f s: real-time factor %.2f (target < 1)\n", length, took, took / length);
  std::printf("first denoising step done %.3f s after the start (target < 0.3)\n", first);
  std::printf("peak memory %.0f MB, weights file %.0f MB: %.0f MB more (target < 200)\n", memory, weights, memory - weights);
}
