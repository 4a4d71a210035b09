// Searches and updates of an index by several processes: the bytes and the answers of one.
#include <doctest/doctest.h>

#include <motionlang/core/rng.hpp>
#include <motionlang/formats/motion_file.hpp>
#include <motionlang/train/shared_index.hpp>
#include <motionlang/train/shared_search.hpp>

#include "../../support/check_error.hpp"
#include "../../support/indexed_motions.hpp"
#include "../../support/speed_encoder.hpp"
#include "../../support/synthetic_motion.hpp"
#include "../../support/temporary_folder.hpp"
#include "../../support/thread_processes.hpp"

namespace ml = motionlang;
using ml::Index;

TEST_CASE(
    "several processes find in shards what one finds, also of equal vectors and with more processes than shards") {
  const TemporaryFolder folder;
  const auto model = synthetic::action_model();
  ml::ShardStore store(folder / "shards", model, 16 << 10);
  ml::MotionIndex flat(model);
  ml::Philox rng{.seed = 5};
  for (int i = 0; i < 120; ++i) {
    const Index first = rng.below(8), second = rng.below(8);
    const auto clip = synthetic::acted_clip("clip" + std::to_string(i), {{first, 40}, {second, 30 + 10 * (i % 3)}},
                                            model, {first, second});
    store.add(clip), flat.add(clip);
  }
  store.write();
  const auto shards = ml::IndexShards::open(folder / "shards");
  REQUIRE(shards->list().shards.size() >= 4);
  const ml::MotionSearch wanted(flat);
  for (const Index processes : {1, 2, 3, 40}) {
    run_processes(processes, [&](const ThreadProcess& process) {
      const ml::AnyCommunicator all(process);
      const auto search = ml::open_shared_search(shards, all);
      for (const Index k : {0, 1, 10, 500}) {
        for (const Index action : {0, 3}) {
          const auto query = synthetic::action_vector(action);
          CHECK(search.clips(query, k) == wanted.clips(query, k));
          CHECK(search.moments(query, k) == wanted.moments(query, k));
          CHECK(search.captions(query, k) == wanted.captions(query, k));
        }
      }
    });
  }
}

TEST_CASE("processes that search shards compare their lists, and all search the queries of the first one") {
  const TemporaryFolder folder;
  const auto model = synthetic::action_model();
  const auto write = [&](const char* name, Index last) {
    ml::ShardStore store(folder / name, model, 16 << 10);
    for (Index i = 0; i < 60; ++i)
      store.add(synthetic::acted_clip("clip" + std::to_string(i), {{i < 59 ? i % 8 : last, 40}}, model));
    store.write();
    return ml::IndexShards::open(folder / name);
  };
  const auto shards = write("shards", 1), others = write("others", 2);
  CHECK(shards->list().shards.size() == others->list().shards.size());
  run_processes(3, [&](const ThreadProcess& process) {
    const ml::AnyCommunicator all(process);
    CHECK_ERROR(ml::open_shared_search(process.rank() == 2 ? others : shards, all), "[motionlang.io.403] ");
    CHECK_ERROR(ml::open_shared_search(process.rank() == 2 ? others : shards, all),
                ": rank 2 of 3 has other shards than rank 0");
  });
  const auto wanted = ml::open_motion_search(shards).clips(synthetic::action_vector(3), 20);
  run_processes(3, [&](const ThreadProcess& process) {
    const ml::AnyCommunicator all(process);
    const auto search = ml::open_shared_search(shards, all);
    CHECK(search.clips(synthetic::action_vector(process.rank() == 0 ? 3 : 5), 20) == wanted);
  });
}

TEST_CASE("several processes index a folder: the same file as one, with problems and captions in their order") {
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder / "clips");
  for (int i = 0; i < 40; ++i)
    ml::write_motion(folder / ("clips/clip" + std::to_string(i) + ".bvh"),
                     synthetic::walk({.frames = 50 + i, .fps = 20, .steps_per_second = 1 + 0.05 * i}));
  ml::write_file(folder / "clips/broken.bvh", std::string_view("HIERARCHY and nothing else"));
  ml::write_file(folder / "captions.tsv",
                 std::string_view("clip3.bvh\t0.5\t2\tlegs\twalk 3\nclip3.bvh\twalk 4 | walk 5\nclip7\twalk 9\n"));
  const auto made = [&](const ml::AnyCommunicator& all) -> std::pair<std::vector<std::byte>, ml::IndexReport> {
    const SpeedEncoder encoder;
    const ml::MotionReadOptions read;
    if (all.rank() > 0)
      return ml::encode_for_first(all, encoder, read), std::pair<std::vector<std::byte>, ml::IndexReport>();
    ml::MotionIndex index(ml::index_model(encoder));
    ml::IndexOptions options{.captions = ml::read_captions(folder / "captions.tsv", folder / "clips"), .read = read};
    ml::IndexUpdate update(index, folder / "clips", encoder, std::move(options));
    ml::SharedFileEncoder shared(all, encoder, index.model(), read);
    Index last = 0;
    auto progress = [&](Index done, Index total) {
      CHECK(done > last);
      CHECK(total == 41);
      last = done;
      return true;
    };
    update.run(progress, &shared);
    CHECK(last == 41);
    return {ml::motion_index_bytes(index), update.report()};
  };
  const auto [bytes, report] = made(ml::AnyCommunicator());
  CHECK(report.added == 41);
  REQUIRE(report.skipped.size() == 1);
  for (const Index processes : {2, 3}) {
    run_processes(processes, [&](const ThreadProcess& process) {
      const auto [same, other] = made(ml::AnyCommunicator(process));
      if (process.rank() > 0) return;
      CHECK(same == bytes);
      CHECK(other.skipped == report.skipped);
      CHECK(other.added == report.added);
    });
  }
}
