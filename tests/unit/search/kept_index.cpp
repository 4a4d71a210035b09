// An index file that is kept: made, taken up again, written only where it lacks something.
#include <doctest/doctest.h>

#include <motionlang/formats/motion_file.hpp>
#include <motionlang/search/kept_index.hpp>

#include "../../support/check_error.hpp"
#include "../../support/speed_encoder.hpp"
#include "../../support/synthetic_motion.hpp"
#include "../../support/temporary_folder.hpp"

namespace ml = motionlang;
namespace fs = std::filesystem;

namespace {

void update(ml::KeptIndex& kept, const fs::path& folder, const SpeedEncoder& encoder, bool written) {
  ml::IndexUpdate update(kept.index(), folder, encoder);
  update.run();
  CHECK(kept.needs_writing(update.report()) == written);
  if (written) CHECK_FALSE(kept.write());
}

}  // namespace

TEST_CASE("an index file is made, taken up, and written only where it lacks something") {
  const TemporaryFolder folder;
  const fs::path file = folder / "clips.index", clips = folder / "clips";
  fs::create_directories(clips);
  ml::write_motion(clips / "slow.bvh", synthetic::walk({.frames = 60, .fps = 20, .steps_per_second = 1}));
  const SpeedEncoder encoder;
  {
    ml::KeptIndex kept(file);
    CHECK_FALSE(kept.has_index());
    CHECK(kept.model_path("", folder / "models") == ml::indexed_path(folder / "models"));
    CHECK(kept.text_encoder("").empty());
    const ml::MomentOptions moments{.windows = {2}, .stride = 1};
    kept.take_model(encoder, &moments);
    REQUIRE(kept.has_index());
    CHECK(kept.index().model().windows == std::vector<ml::Index>{40});
    update(kept, clips, encoder, true);
  }
  const std::string before = ml::read_file(file);
  {
    ml::KeptIndex kept(file);
    REQUIRE(kept.has_index());
    CHECK(kept.index().count() == 1);
    CHECK(kept.model_path("", "other") == ml::indexed_path("models/speed"));
    CHECK(kept.model_path(folder / "given", "other") == ml::indexed_path(folder / "given"));
    kept.take_model(encoder);
    CHECK(kept.index().model().windows == std::vector<ml::Index>{40});  // those of the index
    update(kept, clips, encoder, false);
    const ml::MomentOptions usual;
    CHECK_ERROR(kept.take_model(encoder, &usual), "has moments of 1 other lengths or another stride");
  }
  CHECK(ml::read_file(file) == before);
  CHECK(encoder.asked == 1);

  ml::write_motion(clips / "fast.bvh", synthetic::walk({.frames = 60, .fps = 20, .steps_per_second = 3}));
  ml::KeptIndex kept(file, 1);  // a graph from the first clip on
  kept.take_model(encoder);
  update(kept, clips, encoder, true);
  CHECK(ml::MotionIndexFile::open(file).index().count() == 2);
  CHECK(kept.lacks_hnswlib() == !MOTIONLANG_HAS_HNSWLIB);
  CHECK(ml::has_graphs(ml::MotionIndexFile::open(file), 1) == bool(MOTIONLANG_HAS_HNSWLIB));
}

TEST_CASE("an index of another model is refused, one that has moved is noted") {
  const TemporaryFolder folder;
  const fs::path file = folder / "clips.index";
  ml::write_motion_index(file, ml::MotionIndex({.id = "another", .path = "models/other", .width = 2, .fps = 20}));
  ml::KeptIndex another(file);
  CHECK_ERROR(another.take_model(SpeedEncoder()), "[motionlang.config.102]");

  ml::IndexModel moved = ml::index_model(SpeedEncoder());
  moved.path = "/elsewhere/speed", moved.text_encoder = "/elsewhere/words";
  ml::write_motion_index(file, ml::MotionIndex(moved));
  ml::KeptIndex kept(file);
  CHECK(kept.text_encoder("") == "/elsewhere/words");
  CHECK_FALSE(kept.needs_writing({}));
  kept.take_model(SpeedEncoder());
  CHECK(kept.needs_writing({}));
  kept.write_without_graphs();
  CHECK(ml::read_motion_index(file).model().path == "models/speed");
}

TEST_CASE("an index in shards is made, taken up, and written only where it lacks something") {
  const TemporaryFolder folder;
  const fs::path file = folder / "clips.shards", clips = folder / "clips";
  fs::create_directories(clips);
  ml::write_motion(clips / "slow.bvh", synthetic::walk({.frames = 60, .fps = 20, .steps_per_second = 1}));
  const SpeedEncoder encoder;
  const auto updated = [&](ml::Index shard_bytes, bool written) {
    ml::KeptIndex kept(file, 100'000, shard_bytes);
    const bool was_there = kept.has_index();
    kept.take_model(encoder);
    ml::IndexUpdate update(kept.store(), clips, encoder);
    update.run();
    CHECK(kept.needs_writing(update.report()) == written);
    if (written) CHECK_FALSE(kept.write());
    CHECK_FALSE(kept.lacks_hnswlib());
    return was_there;
  };
  CHECK_FALSE(updated(1 << 20, true));
  CHECK(updated(0, false));
  ml::write_motion(clips / "fast.bvh", synthetic::walk({.frames = 60, .fps = 20, .steps_per_second = 3}));
  CHECK(updated(0, true));
  CHECK(ml::IndexShards::open(file)->clip_count() == 2);
  CHECK(ml::read_shard_list(file).shard_bytes == 1 << 20);

  ml::write_motion_index(folder / "one.index", ml::MotionIndex(ml::index_model(encoder)));
  CHECK_ERROR(ml::KeptIndex(folder / "one.index", 100'000, 1 << 20), "[motionlang.config.102]");
}
