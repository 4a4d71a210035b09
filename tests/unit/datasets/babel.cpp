// BABEL and raw KIT-ML: entries in all their forms, stretches as TEACH and SINC take them, what is refused.
#include <doctest/doctest.h>

#include <motionlang/datasets/babel.hpp>
#include <motionlang/datasets/babel_segment.hpp>
#include <motionlang/datasets/kit_recordings.hpp>

#include "../../support/check_error.hpp"
#include "../../support/temporary_folder.hpp"

namespace ml = motionlang;
using Ids = std::vector<std::string>;
using Segments = std::vector<ml::BabelSegment>;

namespace {

/// The structure of the published files: labels out of order and overlapping, an integer time, a null category, a label
/// that ends after the motion, a sequence without stretches.
const std::string train =
    R"({"4242": {"babel_sid": 4242, "url": "https://x", "feat_p": "CMU/CMU/141/141_05_poses.npz", "dur": 3.83,
  "seq_ann": {"babel_lid": "l1", "anntr_id": "a1", "mul_act": true, "labels": [
    {"raw_label": "Walk and wave", "proc_label": "walk, wave", "seg_id": "s0", "act_cat": ["walk", "wave"]}]},
  "frame_ann": {"babel_lid": "l2", "anntr_id": "a2", "mul_act": false, "labels": [
    {"raw_label": "sit", "proc_label": "sit  donw", "seg_id": "s1", "act_cat": ["sit"], "start_t": 2, "end_t": 3.834},
    {"raw_label": "T", "proc_label": "t-pose", "seg_id": "s2", "act_cat": null, "start_t": 0, "end_t": 1.0},
    {"raw_label": "to", "proc_label": "transition", "seg_id": "s3", "act_cat": ["transition"], "start_t": 0.9, "end_t": 1.4},
    {"raw_label": "none", "proc_label": "", "seg_id": "s4", "act_cat": [], "start_t": 0.5, "end_t": 3},
    {"raw_label": "point", "proc_label": "look", "seg_id": "s5", "act_cat": null, "start_t": 1.01, "end_t": 1.03},
    {"raw_label": "walk", "proc_label": "walk", "seg_id": "s6", "act_cat": null, "start_t": 1.3, "end_t": 2.5}]}},
 "7": {"babel_sid": 7, "url": "", "feat_p": "p", "dur": 1, "seq_ann": {"babel_lid": "l", "anntr_id": "a", "mul_act": false,
  "labels": []}, "frame_ann": null},
 "8": {"babel_sid": 8, "url": "", "feat_p": "p", "dur": 1},
 "9": {"babel_sid": 9, "url": "", "feat_p": "p", "dur": 2.5, "frame_anns": [], "seq_anns": [
  {"babel_lid": "e1", "anntr_id": "a", "mul_act": null, "labels": [{"raw_label": "r", "proc_label": "p", "seg_id": "s", "act_cat": null}]},
  {"babel_lid": "e2", "anntr_id": "b", "mul_act": true, "labels": []}]}})";

ml::BabelFile file(const std::string& text = train) { return ml::BabelFile::from_text(text, "train.json"); }

std::string with(std::string text, std::string_view what, std::string_view instead) {
  const auto at = text.find(what);
  REQUIRE(at != text.npos);
  return text.replace(at, what.size(), instead);
}

}  // namespace

TEST_CASE("BABEL: all texts of a sequence as an annotated motion, which is written and read back") {
  const ml::AnnotatedMotion m = ml::annotated_motion(file().load("4242"), {{"donw", "down"}});
  CHECK(m == ml::AnnotatedMotion{"04242",
                                 "CMU/141/141_05_poses",
                                 3.83,
                                 {{"04242_0", "walk, wave", 0, 3.83, "s0"},
                                  {"04242_1", "sit down", 2, 3.834, "s1"},
                                  {"04242_2", "t-pose", 0, 1, "s2"},
                                  {"04242_3", "transition", 0.9, 1.4, "s3"},
                                  {"04242_4", "look", 1.01, 1.03, "s5"},
                                  {"04242_5", "walk", 1.3, 2.5, "s6"}}});
  const ml::AnnotatedMotion extra = ml::annotated_motion(file().load("9"));
  CHECK(extra == ml::AnnotatedMotion{"00009", "p", 2.5, {{"00009_0", "p", 0, 2.5, "s"}}});
  const std::vector both{m, extra};
  const auto again = ml::AnnotationFile::from_text(ml::annotations_json(both), "again.json");
  CHECK(again.ids() == Ids{"04242", "00009"});
  CHECK(again.load("04242") == m);
  CHECK(again.load("00009") == extra);
  CHECK(ml::annotated_motion(file().load("8")).annotations.empty());
  CHECK_ERROR(ml::annotated_motion(file(with(train, R"("dur": 2.5)", R"("dur": 0)")).load("9")), "BABEL: 9: no dur");
  CHECK_ERROR(ml::annotated_motion(file(with(train, R"("p", "dur": 2.5)", R"("", "dur": 2.5)")).load("9")),
              "BABEL: 9: no feat_p");
}

TEST_CASE("BABEL: entries as they stand") {
  CHECK(file().ids() == Ids{"4242", "7", "8", "9"});
  const ml::BabelSequence s = file().load("4242");
  CHECK(s.babel_sid == 4242);
  CHECK(s.feat_p == "CMU/CMU/141/141_05_poses.npz");
  CHECK(s.dur == 3.83);
  REQUIRE(s.sequence_annotations.size() == 1);
  CHECK(s.sequence_annotations[0] ==
        ml::BabelAnnotation{"l1", "a1", true, {{"Walk and wave", "walk, wave", "s0", {"walk", "wave"}, 0, 3.83}}});
  REQUIRE(s.frame_annotations.size() == 1);
  const auto& labels = s.frame_annotations[0].labels;
  REQUIRE(labels.size() == 6);
  CHECK(labels[0] == ml::BabelLabel{"sit", "sit  donw", "s1", {"sit"}, 2, 3.834});
  CHECK(labels[1] == ml::BabelLabel{"T", "t-pose", "s2", {}, 0, 1});
}

TEST_CASE("BABEL: null, left out, and several annotations") {
  const auto seven = file().load("7"), test = file().load("8"), extra = file().load("9");
  CHECK(seven.sequence_annotations.size() == 1);
  CHECK(seven.frame_annotations.empty());
  CHECK(test.sequence_annotations.empty());  // the test file has no labels
  CHECK(test.frame_annotations.empty());
  REQUIRE(extra.sequence_annotations.size() == 2);
  CHECK(extra.sequence_annotations[0].labels[0].end == 2.5);
  CHECK_FALSE(extra.sequence_annotations[0].mul_act);
  CHECK(extra.sequence_annotations[1].anntr_id == "b");
  CHECK(extra.frame_annotations.empty());
}

TEST_CASE("BABEL: stretches of a motion are sorted, cut at its end, cleaned, and without excluded labels") {
  const auto labels = file().load("4242").frame_annotations[0].labels;
  const ml::SpellingTable spelling{{"donw", "down"}};
  CHECK(ml::babel_segments(labels, 30, 114, spelling) == Segments{{39, 75, "walk"}, {60, 114, "sit down"}});
  CHECK(ml::babel_segments(labels, 30, 1000) == Segments{{39, 75, "walk"}, {60, 115, "sit donw"}});
  CHECK(ml::babel_segments(labels, 30, 1000, spelling, {.keep_transitions = true})[0] ==
        ml::BabelSegment{27, 42, "transition"});
  CHECK(ml::babel_segments(labels, 30, 60) == Segments{{39, 60, "walk"}});
  CHECK(ml::babel_segments(labels, 30, 0).empty());
  CHECK(ml::babel_segments(labels, 100, 1000)[0] == ml::BabelSegment{101, 103, "look"});
  CHECK_ERROR(ml::babel_segments(labels, 0, 60), "[motionlang.config.101] babel_intervals");
  for (const char* excluded : {"t-pose", "a-pose", "a pose", "t pose", "tpose", "apose", "transition"}) {
    CHECK(ml::is_babel_excluded(excluded));
  }
  CHECK_FALSE(ml::is_babel_excluded("transition to sit"));
}

TEST_CASE("BABEL: cleaning of labels") {
  const ml::SpellingTable spelling{{"onn", "on"}, {"downn", "down on the floor"}, {"round", "around"}, {"uh", ""}};
  CHECK(ml::clean_babel_label("  stand onn  one leg ", spelling) == "stand on one leg");
  CHECK(ml::clean_babel_label("lie downn", spelling) == "lie down on the floor");
  CHECK(ml::clean_babel_label("turn round and round", spelling) == "turn around and around");
  CHECK(ml::clean_babel_label("plain") == "plain");
  CHECK(ml::clean_babel_label(" \t ").empty());
  CHECK(ml::clean_babel_label("walk uh on", spelling) == "walk  on");
  CHECK(ml::clean_babel_label("uh uh run", spelling) == "  run");
  CHECK(ml::clean_babel_label("uh", spelling).empty());
  CHECK(ml::clean_babel_label("run\u00A0\u3000fast\x1C", spelling) == "run fast");
  CHECK(ml::clean_babel_label("\xFF onn", spelling) == "\xFF on");
}

TEST_CASE("BABEL: refused with the place") {
  auto refused = [](std::string_view what, std::string_view instead, const char* message) {
    const std::string text = with(train, what, instead);
    CAPTURE(what);
    CHECK_ERROR(file(text).load("4242"), message);
  };
  refused("4242,", "\"4242\",", "[motionlang.config.107] train.json: 4242: babel_sid: expected an integer");
  refused("\"start_t\": 2", "\"start\": 2", "train.json: 4242: frame_ann.labels[0]: has no member 'start_t'");
  refused("3.834", "1", "[motionlang.io.403] train.json: 4242: frame_ann.labels[0]: from 2 to 1 seconds");
  refused("0.9", "-0.9", "[motionlang.io.403] train.json: 4242: frame_ann.labels[2]: from -0.9");
  refused("[\"sit\"]", "[1]",
          "[motionlang.config.107] train.json: 4242: frame_ann.labels[0].act_cat[0]: expected a string");
  refused("3.83,", "-3.83,", "[motionlang.io.403] train.json: 4242: dur is -3.83");
  refused("\"mul_act\": true", "\"mul_act\": tru", "[motionlang.io.403] train.json:2:");
  CHECK_ERROR(file().load("1"), "[motionlang.config.103] train.json: has no member '1'");
  CHECK_ERROR(ml::BabelFile::open("/nowhere/train.json"), "[motionlang.io.401]");
}

TEST_CASE("raw KIT-ML: texts and joints") {
  const TemporaryFolder folder;
  std::string head = "index", line = "0", other = "1";
  for (int i = 0; i < 63; ++i) {
    head += ml::concat_text(",c", i);
    line += ml::concat_text(",", i, ".5");
    other += ml::concat_text(", -", i, "e1 ");
  }
  ml::write_file(folder / "00017_meta.json", "{\"nb_annotations\": 2, \"source\": {}}");
  ml::write_file(folder / "00017_annotations.json", "[\"A person waves.\", \"someone greets\"]");
  ml::write_file(folder / "00017_fke.csv", head + "\r\n" + line + "\r\n" + other + "\r\n\r\n");
  ml::write_file(folder / "00003_meta.json", "{\"nb_annotations\": 0}");
  ml::write_file(folder / "00003_fke.csv", head + "\n");
  const ml::KitRecordings data(folder.path);
  CHECK(data.ids() == Ids{"00003", "00017"});
  const ml::KitRecording waving = data.load("00017");
  CHECK(waving.annotations == Ids{"A person waves.", "someone greets"});
  CHECK(waving.frames() == 2);
  CHECK(ml::KitRecording::fps == 100);
  CHECK(waving.joints[20] == ml::Vec3<double>{60.5, 61.5, 62.5});
  CHECK(waving.joints[21] == ml::Vec3<double>{0, -10, -20});
  CHECK(data.load("00003").annotations.empty());  // TEMOS leaves it out
  CHECK(data.load("00003").frames() == 0);

  CHECK_ERROR(ml::parse_kit_joints(head + "\n" + line + ",9", "k.csv"),
              "[motionlang.io.403] k.csv:2: 65 numbers, 64 are");
  CHECK_ERROR(ml::parse_kit_joints(head + "\n" + line + "\n0,1", "k.csv"), "[motionlang.io.403] k.csv:3: 2 numbers");
  CHECK_ERROR(ml::parse_kit_joints(head + "\n" + with(line, ",7.5", ",x"), "k.csv"), "k.csv:2: 'x' is not a number");
  CHECK_ERROR(ml::parse_kit_joints(head + "\n" + with(line, ",7.5", ",nan"), "k.csv"),
              "k.csv:2: 'nan' is not a number");
  CHECK_ERROR(ml::parse_kit_joints(" \n", "k.csv"), "[motionlang.io.402] k.csv");
  ml::write_file(folder / "00017_annotations.json", "[\"A person waves.\"]");
  CHECK_ERROR(data.load("00017"), "00017_annotations.json: 1 text, ");
  ml::write_file(folder / "00017_annotations.json", "[1, 2]");
  CHECK_ERROR(data.load("00017"), "00017_annotations.json: [0]: expected a string");
  CHECK_ERROR(data.load("00018"), "[motionlang.io.401]");
  CHECK_ERROR(data.load("../00017"), "[motionlang.io.403]");
  CHECK_ERROR(ml::KitRecordings(folder / "none").ids(), "[motionlang.io.401]");
}
