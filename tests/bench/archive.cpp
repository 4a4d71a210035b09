// Search in an archive that lies on disk: shards with codes, against one flat index of the same rows in a mapped file.
//
//     bench_archive FOLDER ROWS [SHARD_MIB [THREADS]]     writes FOLDER (about 2.4 KB a row) unless it is there
//     /usr/bin/python3 tests/bench/peer_archive.py FOLDER [THREADS]     faiss over the same rows
//
// Every answer of the shards is compared with that of the flat index, and the program fails if one differs.
#include <fcntl.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <motionlang/core/rng.hpp>
#include <motionlang/search/index_shards.hpp>

#include "bench.hpp"

namespace {

namespace fs = std::filesystem;
namespace ml = motionlang;
using ml::Index;

constexpr Index width = 256, of_a_clip = 100, top = 10;

/// Vectors of moments that lie around thousands of centres, as motions do: half of a row is its centre.
std::vector<float> made_rows(Index clip, Index count, const ml::Philox& rng) {
  std::vector<float> out(static_cast<std::size_t>(count * width)), centre(static_cast<std::size_t>(width));
  rng.split("clips").split(static_cast<std::uint64_t>(clip)).normal(std::span(out));
  for (Index r = 0; r < count; ++r) {
    if (r % 10 == 0)
      rng.split("centres").split(static_cast<std::uint64_t>((clip * 7 + r) % 5000)).normal(std::span(centre));
    for (Index i = 0; i < width; ++i)
      out[static_cast<std::size_t>(r * width + i)] += centre[static_cast<std::size_t>(i)];
  }
  return out;
}

void write_floats(std::ofstream& out, std::span<const float> values) {
  out.write(reinterpret_cast<const char*>(values.data()), static_cast<std::streamsize>(values.size_bytes()));
}

void make(const fs::path& folder, Index rows, Index shard_bytes) {
  fs::create_directories(folder);
  const ml::Philox rng{.seed = 48};
  ml::ShardStore store(folder / "shards",
                       {.id = "bench", .path = "bench", .width = width, .fps = 20, .windows = {20}, .stride = 10},
                       shard_bytes);
  std::ofstream flat(folder / "rows.f32", std::ios::binary), queries(folder / "queries.f32", std::ios::binary);
  for (Index clip = 0; clip * of_a_clip < rows; ++clip) {
    const Index count = std::min(of_a_clip, rows - clip * of_a_clip);
    ml::EncodedClip c{
        .clip = {.path = "/archive/" + std::to_string(clip) + ".bvh", .end = 60, .fps = 20, .frames = 1200},
        .vector = {},
        .moments = {},
        .moment_vectors = made_rows(clip, count, rng)};
    c.vector.assign(c.moment_vectors.begin(), c.moment_vectors.begin() + width);
    for (Index m = 0; m < count; ++m) c.moments.push_back({10 * m, 20});
    write_floats(flat, ml::unit_rows(c.moment_vectors, width));
    store.add(std::move(c));
  }
  store.write();
  write_floats(queries, ml::unit_rows(made_rows(Index{1} << 40, 64, rng), width));
}

/// Forgets what the system has read of the files.
void forget(const fs::path& folder) {
  ::sync();
  for (const auto& entry : fs::directory_iterator(folder)) {
    const int fd = ::open(entry.path().c_str(), O_RDONLY);
    if (fd < 0) continue;
    ::posix_fadvise(fd, 0, 0, POSIX_FADV_DONTNEED);
    ::close(fd);
  }
}

std::span<const float> floats_of(const ml::MappedFile& file) {
  return {reinterpret_cast<const float*>(file.bytes().data()), file.bytes().size() / sizeof(float)};
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) return std::fprintf(stderr, "bench_archive FOLDER ROWS [SHARD_MIB [THREADS]]\n"), 2;
  const fs::path folder = argv[1];
  const Index rows = std::atol(argv[2]), shard_mib = argc > 3 ? std::atol(argv[3]) : 256;
  if (argc > 4) ml::set_thread_count(std::atoi(argv[4]));
  if (!fs::exists(folder / "shards")) {
    const double start = bench::now();
    make(folder, rows, shard_mib << 20);
    bench::report_value("archive", "written, s", bench::now() - start);
  }
  const auto queries_file = ml::MappedFile::open(folder / "queries.f32");
  const auto queries = floats_of(*queries_file);
  const std::string size = std::to_string(rows) + " rows, ";

  forget(folder / "shards");
  double start = bench::now();
  const auto shards = ml::IndexShards::open(folder / "shards");
  bench::report_value("archive", size + "open, s", bench::now() - start);
  const auto search = shards->vectors(ml::SearchFor::moments);
  if (search->count() != rows) return std::fprintf(stderr, "the folder has %td rows\n", search->count()), 1;
  start = bench::now();
  search->search(queries.first(static_cast<std::size_t>(width)), top);
  bench::report_value("archive", size + "first query from disk, s", bench::now() - start);
  std::size_t next = 0;
  const auto some = [&](std::size_t n) {
    next = next + 2 * n <= 64 ? next + n : 0;
    return queries.subspan(next * static_cast<std::size_t>(width), n * static_cast<std::size_t>(width));
  };
  const double work = 2e-9 * static_cast<double>(rows) * static_cast<double>(width);
  for (const std::size_t n : {std::size_t{1}, std::size_t{16}})
    bench::report("archive", size + std::to_string(n) + (n == 1 ? " query" : " queries"), work * static_cast<double>(n),
                  [&] { search->search(some(n), top); }, {.seconds = 10});

  const auto file = ml::MappedFile::open(folder / "rows.f32");
  const ml::VectorScan flat(floats_of(*file), width, file);
  const auto right = flat.search(queries, top), found = search->search(queries, top);
  Index different = 0;
  std::ofstream answers(folder / "answers.i64", std::ios::binary);
  for (std::size_t q = 0; q < right.size(); ++q) {
    different += found[q] != right[q] ? 1 : 0;
    different += search->search(queries.subspan(q * static_cast<std::size_t>(width), static_cast<std::size_t>(width)),
                                top)[0] != right[q]
                     ? 1
                     : 0;
    for (const ml::Neighbour& n : right[q]) {
      const std::int64_t index = n.index;
      answers.write(reinterpret_cast<const char*>(&index), sizeof index);
    }
  }
  std::printf("%td of %zu answers differ from those of the flat index\n", different, 2 * right.size());
  for (const std::size_t n : {std::size_t{1}, std::size_t{16}})
    bench::report("archive_flat", size + std::to_string(n) + (n == 1 ? " query" : " queries"),
                  work * static_cast<double>(n), [&] { flat.search(some(n), top); }, {.seconds = 10});
  return different == 0 ? 0 : 1;
}
