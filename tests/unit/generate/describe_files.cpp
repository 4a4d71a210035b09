// Files to describe, and the table of captions. What a model says about them: tests/program/official_folders.cpp.
#include <motionlang/backend/eigen.hpp>
#include <motionlang/generate/describe_files.hpp>

#include <doctest/doctest.h>

#include <motionlang/file/json.hpp>
#include <motionlang/formats/bvh.hpp>

#include "../../support/check_error.hpp"
#include "../../support/official_tm2t.hpp"
#include "../../support/synthetic_motion.hpp"
#include "../../support/temporary_folder.hpp"

namespace ml = motionlang;
namespace fs = std::filesystem;

TEST_CASE("files to describe are named as a table of captions does") {
  const TemporaryFolder folder;
  fs::create_directories(folder / "clips/sub");
  for (const char* name : {"clips/a.bvh", "clips/b.bvh", "clips/b.glb", "clips/sub/a.npz", "clips/readme.txt", "c.bvh"})
    ml::write_file(folder / name, std::string_view("x"));
  const auto files = ml::files_to_describe(std::vector{(folder / "clips").string(), (folder / "c.bvh").string()});
  std::vector<std::string> clips;
  for (const auto& f : files) clips.push_back(f.clip + (f.in_folder ? " below" : ""));
  CHECK(clips == std::vector<std::string>{"a below", "b.bvh below", "b.glb below", "sub/a below", "c"});
  ml::require_different_clips(files);
  const auto twice = ml::files_to_describe(std::vector(2, (folder / "c.bvh").string()));
  CHECK_ERROR(ml::require_different_clips(twice), "would both be 'c.bvh' in the table");
  CHECK_ERROR(ml::require_different_clips(twice), "[motionlang.config.102] `out`: ");
}

namespace {

ml::DescribedMotionPart part(const char* path, const char* clip, const char* name, std::vector<std::string> texts) {
  ml::DescribedMotionPart p{{0.5, 2}, {path, clip}, name};
  for (std::string& text : texts) p.texts.push_back({.text = std::move(text), .log_probability = -1.5});
  return p;
}

}  // namespace

TEST_CASE("the table has a line for each part with words, of files with one motion") {
  const std::vector described{part("a.bvh", "a", "", {"a person walks", "", "someone walks"}),
                              part("b.bvh", "b", "", {""}), part("c.glb", "c", "first", {"a jump"})};
  std::vector<std::string> problems{"earlier"};
  CHECK(ml::caption_table(described, "M2T", problems) ==
        "# clip\tstart\tend\tparts\tcaptions, by M2T\n"
        "a\t0.5\t2\t" +
            ml::join_text(ml::body_part_names) + "\ta person walks | someone walks\n");
  CHECK(problems == std::vector<std::string>{"earlier", "b.bvh: no words, not in the table",
                                             "c.glb (first): one of several motions, not in the table"});
}

TEST_CASE("descriptions are lines, or a list in JSON") {
  const std::vector described{part("a.bvh", "a", "", {"a person walks", "someone \"walks\""}),
                              part("c.glb", "c", "fir\nst", {})};
  CHECK(ml::described_text(described) ==
        "   0.50    2.00 s  a.bvh\n    -1.50  \"a person walks\"\n    -1.50  \"someone \"walks\"\"\n"
        "   0.50    2.00 s  c.glb (fir?st)\n");
  const auto read = nlohmann::json::parse(ml::described_json(described));
  REQUIRE(read.size() == 2);
  CHECK(read[0]["path"] == "a.bvh");
  CHECK(read[0]["descriptions"][1]["text"] == "someone \"walks\"");
  CHECK(read[0]["descriptions"][0]["log_probability"] == -1.5);
  CHECK(read[1]["name"] == "fir\nst");
  CHECK(read[1]["descriptions"].empty());
  CHECK(nlohmann::json::parse(ml::described_json({})).empty());
}

TEST_CASE("files are described one after the other; one that fails is a problem, the only one an error") {
  using B = ml::EigenBackend<float>;
  const TemporaryFolder folder;
  ml::write_bvh(folder / "a.bvh", synthetic::walk({.frames = 42}));
  ml::write_file(folder / "b.bvh", std::string_view("x"));
  const auto files = ml::files_to_describe(std::vector{folder.path.string()});
  REQUIRE(files.size() == 2);
  const ml::MotionDescriber<B> describer(ml::Tm2tRun<B>{.model = official::tm2t(official::small_tm2t()),
                                                        .words = {official::tm2t_words, official::tm2t_vectors(), 4}});
  ml::DescribedFiles all;
  ml::describe_files(describer, files, {}, {}, all);
  CHECK(all.done == 2);
  REQUIRE(all.parts.size() == 1);
  CHECK(all.parts[0].file.clip == "a");
  REQUIRE(all.problems.size() == 1);
  CHECK(all.problems[0].find("b.bvh: [motionlang.io.") != std::string::npos);
  ml::DescribedFiles none, some;
  CHECK_THROWS_AS(ml::describe_files(describer, std::span(files).last(1), {}, {}, none), ml::io_error);
  auto stop = [](ml::Index, ml::Index) { return false; };
  CHECK_THROWS_AS(ml::describe_files(describer, files, {}, {}, some, {}, stop), ml::cancelled);
  CHECK(some.done == 1);
  CHECK(some.parts.size() == 1);
}
