// BVH files: text to table, text to motion, and table to text, one thread, in MB/s of text. A made-up clip, and with an
// argument every .bvh file below that folder; of every file the fastest of five runs counts.
//
//     bench_files [FOLDER]
#include <filesystem>

#include <motionlang/file/file.hpp>
#include <motionlang/formats/bvh.hpp>

#include "../support/synthetic_motion.hpp"
#include "bench.hpp"

namespace ml = motionlang;

/// f(i) for all files, of which texts[i] counts.
template <class F>
void report(const char* set, const char* work, const std::vector<std::string>& texts, F f) {
  double megabytes = 0, seconds = 0;
  for (std::size_t i = 0; i < texts.size(); ++i) {
    megabytes += static_cast<double>(texts[i].size()) * 1e-6;
    seconds += bench::times_of([&] { f(i); }, 0, 5, 5).front();
  }
  std::printf("%s,%s,%zu files,%.1f MB,%.0f MB/s\n", set, work, texts.size(), megabytes, megabytes / seconds);
  std::fflush(stdout);
}

void measure(const char* set, const std::vector<std::string>& texts) {
  std::vector<ml::Bvh> files;
  std::vector<std::string> written;
  for (const std::string& text : texts) {
    files.push_back(ml::parse_bvh(text));
    written.push_back(ml::format_bvh(files.back()));
  }
  report(set, "text to table", texts, [&](std::size_t i) { ml::parse_bvh(texts[i]); });
  report(set, "text to motion", texts, [&](std::size_t i) { ml::to_motion(ml::parse_bvh(texts[i])); });
  report(set, "table to text", written, [&](std::size_t i) { ml::format_bvh(files[i]); });
}

int main(int argc, char** argv) {
  measure("made up", {ml::format_bvh(ml::to_bvh(synthetic::walk({.frames = 5000})))});
  if (argc < 2) return 0;
  std::vector<std::string> texts;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(argv[1])) {
    if (entry.path().extension() == ".bvh") texts.push_back(ml::read_file(entry.path()));
  }
  measure("folder", texts);
}
