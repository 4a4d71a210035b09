// How clips are split, what is left out of a data set, and the configuration of both.
#include <doctest/doctest.h>

#include <motionlang/datasets/clip_split.hpp>
#include <motionlang/datasets/data_config.hpp>
#include <motionlang/datasets/left_out.hpp>

#include "../../support/check_error.hpp"
#include "../../support/temporary_folder.hpp"

namespace ml = motionlang;

TEST_CASE("clips are split by their shares, each once, in whatever order they come") {
  std::vector<std::string> clips;
  for (int i = 0; i < 40; ++i) clips.push_back("clip" + std::to_string(i));
  const ml::DataConfig config{.test_share = 0.25, .validation_share = 0.1};
  const ml::ClipSplit split("", config, clips);
  std::array<int, 3> count{};
  for (const std::string& clip : clips) ++count[static_cast<std::size_t>(split.of(clip))];
  CHECK(count == std::array{26, 4, 10});
  CHECK(split.of("another") == -1);

  std::vector<std::string> others(clips.rbegin(), clips.rend());
  others.push_back("clip3");  // a second segment of a clip
  const ml::ClipSplit same("", config, others);
  ml::DataConfig other_seed = config;
  other_seed.split_seed = 2;
  const ml::ClipSplit different("", other_seed, clips);
  bool differs = false;
  for (const std::string& clip : clips) {
    CHECK(same.of(clip) == split.of(clip));
    differs = differs || different.of(clip) != split.of(clip);
  }
  CHECK(differs);
}

TEST_CASE("lists of ids split clips, whose names may have an extension") {
  const TemporaryFolder folder;
  ml::write_file(folder / "train.txt", std::string_view("a\nsub/b\n"));
  ml::write_file(folder / "test.txt", std::string_view("c.bvh\n"));
  const ml::ClipSplit split(folder.path, {}, {"a.bvh", "z.bvh"});
  CHECK(split.of("a.bvh") == 0);
  CHECK(split.of("a") == 0);
  CHECK(split.of("sub/b.npz") == 0);
  CHECK(split.of("c.bvh") == 2);
  CHECK(split.of("c") == -1);
  CHECK(split.of("z.bvh") == -1);
  CHECK(split.of("a.txt") == -1);  // no file of motion
  CHECK_ERROR(ml::ClipSplit(folder / "nowhere", {}, {}), "[motionlang.io.401]");
}

TEST_CASE("what is left out is counted by reason, with the first names") {
  ml::LeftOut out;
  CHECK(out.text() == "0 left out");
  out.add("too short", "a");
  out.add("too short", "a", 2);
  out.add("too short", "b", 0);
  CHECK(out.text() == "3 left out: 3 too short (a)");
  ml::LeftOut more;
  for (const char* name : {"b", "c", "d", "e", "f"}) more.add("too short", name);
  more.add("without a label", "g");
  out.add(more);
  CHECK(out.text() == "9 left out: 8 too short (a, b, c, d, e, ...), 1 without a label (g)");
}

TEST_CASE("a configuration of data refuses shares and times that cannot be") {
  ml::DataConfig config;
  config.require_sound();
  config.test_share = 1;
  CHECK_ERROR(config.require_sound(), "test_share is 1, expected 0 or more, and less than 1");
  config = {.max_seconds = 0};
  CHECK_ERROR(config.require_sound(), "[motionlang.config.101] max_seconds is 0, expected a number above 0");
}
