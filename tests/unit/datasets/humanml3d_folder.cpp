// Folders in the form of HumanML3D and KIT-ML: captions, clips, items of the published loaders, index.csv, writing.
#include <doctest/doctest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <numeric>

#include <motionlang/datasets/humanml3d_folder.hpp>
#include <motionlang/datasets/humanml3d_texts.hpp>
#include <motionlang/features/statistics.hpp>
#include <motionlang/file/id_list.hpp>
#include <motionlang/file/npy.hpp>

#include "../../support/check_error.hpp"
#include "../../support/temporary_folder.hpp"

namespace ml = motionlang;
using Ids = std::vector<std::string>;
using Captions = std::vector<ml::MotionCaption>;

namespace {

std::vector<float> numbers(std::size_t n, float first = 0) {
  std::vector<float> out(n);
  std::iota(out.begin(), out.end(), first);
  return out;
}

ml::HumanMl3dClip clip(const std::string& id, ml::Index frames, const ml::HumanMl3dForm& form = {}) {
  const auto n = static_cast<std::size_t>(frames);
  return {id,
          frames,
          numbers(n * static_cast<std::size_t>(form.width())),
          numbers(3 * n * static_cast<std::size_t>(form.joints), 0.5f),
          {{"a man kicks.", {{"a", "DET"}, {"man", "NOUN"}, {"kick", "VERB"}}, 0, 0}, {"he stands", {}, 1, 2.25}}};
}

ml::MotionCaption timed(double start, double end) { return {"text", {}, start, end}; }

}  // namespace

TEST_CASE("captions: four fields, split off from the right") {
  const auto captions = ml::parse_captions(
      "a man kicks.#a/DET man/NOUN kick/VERB#0.0#0.0\r\n"
      "  step #1, step #2 #step/NOUN  step/NOUN#1.5#nan\n"
      "too#short\n\n"
      "and/or plain#and/or/CCONJ plain#NaN#3\n"
      "#x/X#0#0");
  CHECK(captions == Captions{{"a man kicks.", {{"a", "DET"}, {"man", "NOUN"}, {"kick", "VERB"}}, 0, 0},
                             {"step #1, step #2", {{"step", "NOUN"}, {"step", "NOUN"}}, 1.5, 0},
                             {"and/or plain", {{"and/or", "CCONJ"}, {"plain", ""}}, 0, 3},
                             {"", {{"x", "X"}}, 0, 0}});
  CHECK(captions[0].of_whole_clip());
  CHECK_FALSE(captions[1].of_whole_clip());
  for (const char* time : {"", "soon", "1.5s", "-1", "inf", "1 2"}) {
    CAPTURE(time);
    CHECK_ERROR(ml::parse_captions("a#a/X#0#0\nb#b/X#0#" + std::string(time), "t.txt"),
                "[motionlang.io.403] t.txt:2: '");
  }
}

TEST_CASE("captions: what was written is read again, what others would misread is refused") {
  const Captions captions{{"a man kicks.", {{"a", "DET"}, {"kick", "VERB"}}, 0, 0},
                          {"no words", {}, 0.1, 7},
                          {"untagged", {{"untagged", ""}, {"either/or", "CCONJ"}}, 0, 1e-7}};
  const std::string text = ml::format_captions(captions);
  CHECK(text.starts_with("a man kicks.#a/DET kick/VERB#0.0#0.0\nno words##0.1#7.0\n"));
  CHECK(ml::parse_captions(text) == captions);
  for (const ml::MotionCaption& bad : {ml::MotionCaption{"step #1", {}},
                                       {"a\nb", {}},
                                       {" a", {}},
                                       {"a", {{"b c", "X"}}},
                                       {"a", {{"b", "X#"}}},
                                       {"a", {{"", ""}}},
                                       {"a", {{"b", "x/y"}}},
                                       {"a", {{"b/c", ""}}}}) {
    CHECK_ERROR(ml::format_captions(Captions{bad}), "[motionlang.timeline.510]");
  }
  CHECK_ERROR(ml::format_captions(Captions{{"step #1", {}}}, "t.txt"),
              "[motionlang.timeline.510] t.txt: 'step #1' is not allowed");
  CHECK_ERROR(ml::format_captions(Captions{timed(-1, 0)}), "[motionlang.io.403] captions: '");
  CHECK_ERROR(ml::format_captions(Captions{timed(0, NAN)}), "[motionlang.io.403]");
}

TEST_CASE("captions: mirrored with their words") {
  const auto m =
      ml::mirrored(ml::MotionCaption{"turns counter-clockwise, left",
                                     {{"turn", "VERB"}, {"counter", "ADV"}, {"clockwise", "ADV"}, {"left", "ADV"}},
                                     1,
                                     2});
  CHECK(m ==
        ml::MotionCaption{"turns clockwise, right", {{"turn", "VERB"}, {"clockwise", "ADV"}, {"right", "ADV"}}, 1, 2});
}

TEST_CASE("HumanML3D items: the published loaders' lengths and cuts") {
  using Items = std::vector<ml::HumanMl3dItem>;
  const Captions captions{timed(0, 0), timed(1, 3.5), timed(0, 1.99), timed(5, 4), timed(0, 0), timed(2, 100)};
  CHECK(ml::humanml3d_items(captions, 100) ==
        Items{{{20, 50}, {1}}, {{40, 60}, {5}}, {{0, 100}, {0, 4}}});  // 39 frames are too few, 5 to 4 is nothing
  CHECK(ml::humanml3d_items(captions, 39).empty());
  CHECK(ml::humanml3d_items(captions, 200).empty());  // with its parts
  CHECK(ml::humanml3d_items(Captions{timed(0, 0)}, 199) == Items{{{0, 199}, {0}}});
  CHECK(ml::humanml3d_items(Captions{timed(0, 1.99)}, 100, ml::kit_ml_form) == Items{{{0, 39}, {0}}});  // 20 per second
  CHECK(ml::humanml3d_items({}, 100).empty());
}

TEST_CASE("HumanML3D folder: what was written is read again") {
  for (const ml::HumanMl3dForm& form : {ml::humanml3d_form, ml::kit_ml_form}) {
    const TemporaryFolder temporary;
    const auto folder = temporary / "set";
    std::vector<ml::HumanMl3dClip> clips{clip("000001", 3, form), clip("M000001", 0, form)};
    clips[0].features[7] = -1.5f;
    ml::FeatureStatistics statistics;
    for (const auto& c : clips) {
      ml::write_humanml3d_clip(folder, c, form);
      statistics.add_finite(std::span<const float>(c.features), form.width());
    }
    const auto mean = statistics.mean(), deviation = statistics.population_deviation();
    const std::vector<float> m(mean.begin(), mean.end()), d(deviation.begin(), deviation.end());
    ml::write_humanml3d_statistics(folder, m, d, form);
    ml::write_ids(folder / "all.txt", Ids{"000001", "M000001"});

    const ml::HumanMl3dFolder data(folder, form);
    CHECK(data.ids() == Ids{"000001", "M000001"});
    for (const auto& c : clips) CHECK(data.load(c.id) == c);
    CHECK(data.mean() == m);
    CHECK(data.deviation() == d);
    CHECK(data.load("000001").is_finite());
    clips[0].joints[5] = NAN;
    CHECK_FALSE(clips[0].is_finite());
    CHECK(std::distance(std::filesystem::directory_iterator(folder), {}) == 6);  // no temporary files are left
  }
  CHECK(ml::humanml3d_form.width() == 263);
  CHECK(ml::kit_ml_form.width() == 251);
}

TEST_CASE("HumanML3D folder: what is refused") {
  const TemporaryFolder folder;
  ml::write_humanml3d_clip(folder.path, clip("a", 3));
  const ml::HumanMl3dFolder data(folder.path), kit(folder.path, ml::kit_ml_form);
  CHECK_ERROR(kit.features("a"), "a.npy: an array (3, 263), expected (3, 251)");
  CHECK_ERROR(kit.joints("a"), "[motionlang.io.407]");
  CHECK_ERROR(data.load("b"), "[motionlang.io.401]");
  CHECK_ERROR(data.load("../a"), "[motionlang.io.403]");
  CHECK_ERROR(data.ids("train"), "[motionlang.io.401]");
  CHECK_ERROR(data.mean(), "[motionlang.io.401]");
  ml::write_npy(folder / "Mean.npy", ml::NpyArray::scalar(1.0f));
  CHECK_ERROR(data.mean(), "Mean.npy: an array (), expected (263)");
  ml::write_file(folder / "new_joints/a.npy", "\x93NUMPY");
  CHECK_ERROR(data.load("a"), "[motionlang.io.402]");
  auto longer = clip("a", 4);
  ml::write_npy(folder / "new_joints/a.npy", ml::NpyArray::of(std::span<const float>(longer.joints), {4, 22, 3}));
  CHECK_ERROR(data.load("a"), ": clip 'a' has 3 frames of features and 4 of");

  longer.frames = 5;
  CHECK_ERROR(ml::write_humanml3d_clip(folder.path, longer), "[motionlang.shape.205]");
  CHECK_ERROR(ml::write_humanml3d_clip(folder.path, clip("b/c", 1)), "[motionlang.io.403]");
  auto odd = clip("d", 1);
  odd.captions = {{"step #1", {}}};
  CHECK_ERROR(ml::write_humanml3d_clip(folder.path, odd), "texts/d.txt: 'step #1'");
  CHECK_ERROR(ml::write_humanml3d_statistics(folder.path, numbers(3), numbers(263)), "[motionlang.shape.205]");
  CHECK_ERROR(ml::write_humanml3d_clip(folder / "no/such/place", clip("a", 1)),
              "[motionlang.io.401] cannot make the folder");
  ml::write_file(folder / "file", "");
  CHECK_ERROR(ml::make_folder(folder / "file"), "[motionlang.io.401]");
}

TEST_CASE("index.csv") {
  const auto rows = ml::parse_humanml3d_index(
      "source_path,start_frame,end_frame,new_name\r\n./pose_data/KIT/3/a_poses.npy,0,117,000000.npy\r\n"
      "./pose_data/humanact12/b.npy, 5 , -1 ,000001.npy\r\n");
  CHECK(rows == std::vector<ml::HumanMl3dSource>{{"./pose_data/KIT/3/a_poses.npy", 0, 117, "000000.npy"},
                                                 {"./pose_data/humanact12/b.npy", 5, -1, "000001.npy"}});
  auto refused = [](const std::string& row, const char* message) {
    CHECK_ERROR(ml::parse_humanml3d_index("source_path,start_frame,end_frame,new_name\n" + row, "i.csv"), message);
  };
  refused("a,1,2", "[motionlang.io.403] i.csv:2: 3 fields, 4 are expected");
  refused("a,1,2,b,c", "i.csv:2: 5 fields");
  refused("\na,x,2,b", "i.csv:3: 'x' is not a frame");
  refused("a,1,-2,b", "i.csv:2: '-2' is not a frame");
  refused("a,1,2.5,b", "i.csv:2: '2.5' is not a frame");
  CHECK_ERROR(ml::parse_humanml3d_index("a,1,2,b", "i.csv"), "[motionlang.io.403] i.csv:1: expected 'source_path");
  CHECK_ERROR(ml::parse_humanml3d_index("", "i.csv"), "[motionlang.io.403] i.csv:1");
  CHECK_ERROR(ml::read_humanml3d_index("/nowhere/index.csv"), "[motionlang.io.401]");
}

TEST_CASE("HumanML3D folder: the published clip, written and read again") {
  const char* variable = std::getenv("MOTIONLANG_DATA");
  const auto published = std::filesystem::path(variable ? variable : "") / "humanml3d";
  if (variable == nullptr || !std::filesystem::exists(published / "new_joint_vecs_012314.npy")) {
    MESSAGE("skipped: MOTIONLANG_DATA names no folder with humanml3d/new_joint_vecs_012314.npy");
    return;
  }
  const TemporaryFolder folder;
  const auto features = ml::read_npy(published / "new_joint_vecs_012314.npy");
  const ml::HumanMl3dClip c{
      "012314", 170, features.to<float>(), ml::read_npy(published / "new_joints_012314.npy").to<float>(), {}};
  ml::write_humanml3d_clip(folder.path, c);
  CHECK(ml::HumanMl3dFolder(folder.path).load("012314") == c);
  CHECK(ml::read_file(folder / "new_joint_vecs/012314.npy") == ml::read_file(published / "new_joint_vecs_012314.npy"));
  const auto mean = ml::read_npy(published / "Mean.npy").to<float>(),
             deviation = ml::read_npy(published / "Std.npy").to<float>();
  ml::write_humanml3d_statistics(folder.path, mean, deviation);
  CHECK(ml::HumanMl3dFolder(folder.path).deviation() == deviation);
}
