// Annotation JSON: entry by entry, published rules, what is refused; members of a large JSON file, lists of ids. With
// MOTIONLANG_DATA also the published annotations of KIT-ML, which are not part of the repository.
#include <doctest/doctest.h>

#include <cstdlib>
#include <filesystem>

#include <motionlang/datasets/annotations.hpp>
#include <motionlang/file/id_list.hpp>

#include "../../support/check_error.hpp"
#include "../../support/temporary_folder.hpp"

namespace ml = motionlang;
using Ids = std::vector<std::string>;

namespace {

const std::string two_motions = R"({
  "00002": {"path": "KIT/4/Walk02_poses", "duration": 5, "annotations": [
    {"seg_id": "00002_0", "text": "A person turns left. {\"[", "start": 1.999, "end": 4.05, "more": [1, {"x": "}"}]},
    {"seg_id": "00002_1", "text": "caf\u00e9", "start": 0, "end": 1.5}]},
  "M00001" : {"path": "M/CMU/1/01_01_poses", "duration": 12.5, "annotations": []}
})";

ml::AnnotationFile file(const std::string& text) { return ml::AnnotationFile::from_text(text, "a.json"); }

/// The text with `what` replaced.
std::string with(std::string text, std::string_view what, std::string_view instead) {
  const auto at = text.find(what);
  REQUIRE(at != text.npos);
  return text.replace(at, what.size(), instead);
}

}  // namespace

TEST_CASE("annotations: ids in the order of the file, entries when asked for") {
  const auto annotations = file(two_motions);
  CHECK(annotations.ids() == Ids{"00002", "M00001"});
  CHECK(annotations.has("M00001"));
  const ml::AnnotatedMotion motion = annotations.load("00002");
  CHECK(motion == ml::AnnotatedMotion{
                      "00002",
                      "KIT/4/Walk02_poses",
                      5,
                      {{"00002_0", "A person turns left. {\"[", 1.999, 4.05}, {"00002_1", "caf\xC3\xA9", 0, 1.5}}});
  CHECK(annotations.load("M00001").annotations.empty());
  CHECK(annotations.select(Ids{"none", "M00001", "00001", "00002"}) == Ids{"M00001", "00002"});
}

TEST_CASE("annotations: frames are cut off, not rounded") {
  const auto a = file(two_motions).load("00002").annotations[0];
  CHECK(ml::annotated_frames(a, 20, 100) == ml::FrameSlice{39, 81 - 39});
  CHECK(ml::annotated_frames(a, 20, 50) == ml::FrameSlice{39, 50 - 39});
  CHECK(ml::annotated_frames({"", "", 0, 1e300}, 20, 50) == ml::FrameSlice{0, 50});
  CHECK(ml::annotated_frames({"", "", 1e300, 1e300}, 20, 50) == ml::FrameSlice{});
}

TEST_CASE("annotations: training takes 2 to 10 seconds, a test split everything") {
  ml::AnnotatedMotion motion{
      "x", "p", 20, {{"0", "a", 0, 1.9}, {"1", "b", 1, 3}, {"2", "c", 0, 10}, {"3", "d", 0, 11}}};
  auto texts = [&](std::string_view split) {
    std::string out;
    for (const auto& a : ml::training_annotations(motion, split)) out += a.text;
    return out;
  };
  CHECK(texts("train") == "bc");
  CHECK(texts("all") == "bc");
  CHECK(texts("val_tiny") == "bc");
  CHECK(texts("test") == "abcd");
  CHECK(texts("nsim_test") == "abcd");
}

TEST_CASE("annotations: mirrored entries") {
  const auto m = ml::mirrored({"00001", "KIT/a", 2, {{"00001_0", "raises the left arm", 0, 2}}});
  CHECK(m == ml::AnnotatedMotion{"M00001", "M/KIT/a", 2, {{"M00001_0", "raises the right arm", 0, 2}}});
}

TEST_CASE("annotations: what was written is read again, in the published layout") {
  const TemporaryFolder folder;
  std::vector<ml::AnnotatedMotion> motions;
  const auto annotations = file(two_motions);
  for (const auto& id : annotations.ids()) motions.push_back(annotations.load(id));
  ml::write_annotations(folder / "a.json", motions);
  const auto again = ml::AnnotationFile::open(folder / "a.json");
  CHECK(again.ids() == annotations.ids());
  for (const auto& m : motions) CHECK(again.load(m.id) == m);
  const std::string text = ml::read_file(folder / "a.json");
  CHECK(text.starts_with(
      "{\n  \"00002\": {\n    \"path\": \"KIT/4/Walk02_poses\",\n    \"duration\": 5.0,\n    \"annotations\": [\n"
      "      {\n        \"seg_id\": \"00002_0\",\n"));
  CHECK(text.find("caf\\u00e9") != text.npos);
  CHECK(ml::annotations_json({}) == "{}");

  motions[1].id = "00002";
  CHECK_ERROR(ml::annotations_json(motions), "[motionlang.io.403] annotations: 00002: the id is repeated");
  motions[1].id = "\xFF";
  CHECK_ERROR(ml::annotations_json(motions), "[motionlang.io.403]");
  motions[1] = motions[0];
  motions[1].id = "x";
  motions[1].annotations[0].end = INFINITY;
  CHECK_ERROR(ml::write_annotations(folder / "a.json", motions),
              "[motionlang.io.403] annotations: x: from 1.999 to inf");
  CHECK(ml::read_file(folder / "a.json") == text);  // what was there is whole
}

TEST_CASE("annotations: refused with the place") {
  auto refused = [&](std::string_view what, std::string_view instead, const char* message) {
    const std::string text = with(two_motions, what, instead);
    CAPTURE(text);
    CHECK_ERROR(file(text).load("00002"), message);
  };
  refused("\"path\"", "\"Path\"", "[motionlang.config.107] a.json: 00002: has no member 'path'");
  refused("1.999", "\"1.999\"", "[motionlang.config.107] a.json: 00002: annotations[0].start: expected a number");
  refused("\"caf\\u00e9\"", "null", "[motionlang.config.107] a.json: 00002: annotations[1].text: expected a string");
  refused("1.999", "-1", "[motionlang.io.403] a.json: 00002: annotations[0]: from -1 to 4.05 seconds");
  refused("4.05", "1", "[motionlang.io.403] a.json: 00002: annotations[0]: from 1.999 to 1 seconds");
  refused("1.999", "1e999", "[motionlang.io.403] a.json:3:73: a number beyond the range of double");
  refused("1.999", "NaN", "[motionlang.io.403] a.json:3:");
  refused(", \"end\": 1.5", " \"end\": 1.5", "[motionlang.io.403] a.json:4:");
  CHECK_ERROR(file(two_motions).load("1"), "[motionlang.config.103] a.json: has no member '1'");
  CHECK_ERROR(ml::AnnotationFile::open("/nowhere/a.json"), "[motionlang.io.401]");
}

TEST_CASE("members of a JSON file: mistakes around the values show when it is opened") {
  auto refused = [](const std::string& text, const char* message) {
    CAPTURE(text);
    CHECK_ERROR(ml::JsonMembers::from_text(text, "m"), message);
  };
  refused("", "[motionlang.io.403] m:1:1: expected '{'");
  refused("[1]", "m:1:1: expected '{'");
  refused("{", "m:1:2: expected a name in quotes");
  refused("{\"a\"", "m:1:5: expected ':'");
  refused("{\"a\": 1,\n }", "m:2:2: expected a name in quotes");
  refused("{\"a\": }", "m:1:7: expected a value");
  refused("{\"a\": [1, {}", "m:1:13: the text ends inside of a value");
  refused("{\"a\": \"b\\\"", "m:1:7: a string has no end");
  refused("{\"a\": 1 \"b\": 2}", "m:1:9: expected '}'");
  refused("{\"a\": 1,\n\"\\u0061\": 2}", "m:2:1: the name 'a' is duplicated, first with the value at 1:7");
  refused("{\"a\": 1} x", "m:1:10: something follows the object");
  refused("{\"\x01\": 1}", "[motionlang.io.403] m:1:");
}

TEST_CASE("members of a JSON file: mistakes inside of a value show when it is loaded, the others load") {
  const auto file =
      ml::JsonMembers::from_text("\xEF\xBB\xBF{\"a\": tru, \"b\": [1, 2}, \"c\":-2.5e1\n,\"d\" : {\"x\": \"]\"}}", "m");
  CHECK(file.keys() == Ids{"a", "b", "c", "d"});
  CHECK_ERROR(file.load("a"), "[motionlang.io.403] m:1:");
  CHECK_ERROR(file.load("b"), "[motionlang.io.403] m:1:25");
  CHECK(file.load("c") == -25.0);
  CHECK(file.load("d")["x"] == "]");
  CHECK(ml::JsonMembers::from_text(" { } ").keys().empty());
}

TEST_CASE("lists of ids") {
  CHECK(ml::parse_ids("\xEF\xBB\xBF"
                      "000001\r\n M000001 \n\nset/clip 2\n000001") == Ids{"000001", "M000001", "set/clip 2", "000001"});
  CHECK(ml::parse_ids("").empty());
  for (const char* bad : {"/etc/x", "a/../b", "..", "a//b", "a/", "a\tb", "a\\b", "./a"}) {
    CAPTURE(bad);
    CHECK_ERROR(ml::parse_ids("ok\n" + std::string(bad), "l.txt"), "[motionlang.io.403] l.txt:2: ");
  }
  const TemporaryFolder folder;
  const Ids ids{"b", "a", "b"};
  ml::write_ids(folder / "train.txt", ids);
  CHECK(ml::read_file(folder / "train.txt") == "b\na\nb\n");
  CHECK(ml::read_ids(folder / "train.txt") == ids);
  CHECK_ERROR(ml::write_ids(folder / "train.txt", Ids{" a"}), "[motionlang.io.403]");
  CHECK(ml::mirrored_id("000001") == "M000001");
}

TEST_CASE("annotations: the published ones of KIT-ML") {
  const char* data = std::getenv("MOTIONLANG_DATA");
  const auto folder = std::filesystem::path(data ? data : "") / "text";
  if (data == nullptr || !std::filesystem::exists(folder / "kitml-annotations.json")) {
    MESSAGE("skipped: MOTIONLANG_DATA names no folder with text/kitml-annotations.json");
    return;
  }
  const auto annotations = ml::AnnotationFile::open(folder / "kitml-annotations.json");
  CHECK(annotations.ids().size() == 5766);
  std::vector<ml::AnnotatedMotion> motions;
  std::size_t texts = 0, most = 0, mirrored = 0, same = 0, compared = 0;
  for (const auto& id : annotations.ids()) {
    motions.push_back(annotations.load(id));
    texts += motions.back().annotations.size();
    most = std::max(most, motions.back().annotations.size());
    if (!id.starts_with("M")) continue;
    ++mirrored;
    const auto own = ml::mirrored(annotations.load(id.substr(1)));
    CHECK(own.path == motions.back().path);
    for (std::size_t i = 0; i < own.annotations.size(); ++i) {
      ++compared;
      same += own.annotations[i] == motions.back().annotations[i];
    }
  }
  CHECK(texts == 12164);
  CHECK(most == 19);
  CHECK(mirrored == 5766 / 2);
  CHECK(compared == 12164 / 2);
  // The published texts are exchanged inside of words, too: "upright" is "upleft", "degreeleftwards" is
  // "degreerightwards".
  MESSAGE("captions mirrored otherwise than published: ", compared - same, " of ", compared);
  CHECK(compared - same == 9);
  const bool same_bytes = ml::annotations_json(motions) == ml::read_file(folder / "kitml-annotations.json");
  CHECK(same_bytes);

  struct Split {
    const char* name;
    std::size_t ids, trained;
  };
  for (const auto& [name, ids, trained] : {Split{"train", 4688, 3846}, {"val", 292, 252}, {"test", 786, 786}}) {
    const auto split = ml::read_ids(folder / ("kitml-" + std::string(name) + ".txt"));
    CHECK(split.size() == ids);
    CHECK(annotations.select(split).size() == ids);
    std::size_t kept = 0;
    for (const auto& id : split) kept += !ml::training_annotations(annotations.load(id), name).empty();
    CHECK(kept == trained);
  }
}
