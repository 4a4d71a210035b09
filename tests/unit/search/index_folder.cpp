// The index of a folder: what an update reads, keeps, renames, removes and skips; and a search in one call. The encoder
// counts how often it is asked, so that a test sees which files were read again.
#include <doctest/doctest.h>

#include <algorithm>

#include <motionlang/core/parallel.hpp>
#include <motionlang/formats/glb.hpp>
#include <motionlang/search/index_folder.hpp>
#include <motionlang/search/text_answer.hpp>

#include "../../support/check_error.hpp"
#include "../../support/speed_encoder.hpp"
#include "../../support/synthetic_motion.hpp"
#include "../../support/temporary_folder.hpp"

namespace ml = motionlang;
namespace fs = std::filesystem;
using ml::Index;

namespace {

void write_clip(const fs::path& path, double steps) {
  ml::write_motion(path, synthetic::walk({.frames = 60, .fps = 20, .steps_per_second = steps}));
}
std::vector<std::string> names(const ml::MotionIndex& index) {
  std::vector<std::string> out;
  for (const auto& c : index.clips()) out.push_back(fs::path(c.path).filename().string());
  std::sort(out.begin(), out.end());
  return out;
}

}  // namespace

TEST_CASE("an update reads what is new or has changed, and nothing else") {
  const TemporaryFolder folder;
  fs::create_directories(folder / "sub");
  write_clip(folder / "slow.bvh", 1);
  write_clip(folder / "sub/fast.npz", 3);
  ml::write_file(folder / "broken.bvh", std::string_view("HIERARCHY"));
  ml::write_file(folder / "LICENSE", std::string_view("# CC0\nmore"));
  const SpeedEncoder encoder;
  ml::MotionIndex index(ml::index_model(encoder));
  CHECK(index.model().windows == std::vector<Index>{20, 40, 60});
  CHECK(index.model().stride == 10);
  CHECK(ml::index_model(encoder, {.windows = {}}).windows.empty());

  auto report = ml::update_index(index, folder.path, encoder);
  CHECK(report.added == 2);
  REQUIRE(report.skipped.size() == 1);
  CHECK(report.skipped[0].find("broken.bvh: [motionlang.io.") != std::string::npos);
  CHECK(report.changed());
  CHECK(names(index) == std::vector<std::string>{"fast.npz", "slow.bvh"});
  const std::string moments = std::to_string(index.moments().size());
  CHECK(ml::describe_update(index, report) ==
        "2 clips, " + moments + " moments (2 added, 0 removed, 0 renamed, 0 unchanged, 1 skipped)\n");
  const std::string list = ml::listed_clips(index);
  CHECK(std::count(list.begin(), list.end(), '\n') == 2);
  CHECK(list.find("slow.bvh\t0.00\t3.00\t20\t60\t\tCC0\n") != std::string::npos);
  CHECK(index.clips()[0].license == "CC0");
  CHECK(index.clips()[0].end == doctest::Approx(3));
  CHECK_FALSE(index.moments().empty());
  CHECK(encoder.asked == 2);

  report = ml::update_index(index, folder.path, encoder);
  CHECK(encoder.asked == 2);
  CHECK(report.unchanged == 2);
  CHECK_FALSE(report.changed());

  fs::rename(folder / "sub/fast.npz", folder / "sub/quick.npz");
  report = ml::update_index(index, folder.path, encoder);
  CHECK(encoder.asked == 2);
  CHECK(report.renamed == 1);
  CHECK(names(index) == std::vector<std::string>{"quick.npz", "slow.bvh"});

  ml::write_file(folder / "LICENSE", std::string_view("MIT"));
  report = ml::update_index(index, folder.path, encoder);
  CHECK(report.relicensed == 2);
  CHECK(index.clips()[0].license == "MIT");
  CHECK(ml::update_index(index, folder.path, encoder, {.license = "own"}).relicensed == 2);

  fs::remove(folder / "sub/quick.npz");
  report = ml::update_index(index, folder.path, encoder, {.again = true});
  CHECK(report.removed == 2);
  CHECK(report.added == 1);
  CHECK(encoder.asked == 3);
  CHECK(ml::remove_below(index, folder / "nothing") == 0);
  CHECK(ml::remove_below(index, folder.path) == 1);
  CHECK_ERROR(ml::update_index(index, folder / "nothing", encoder), "[motionlang.io.401]");
}

TEST_CASE("captions name the parts of a clip that are indexed, and clips that are not there are reported") {
  const TemporaryFolder folder;
  write_clip(folder / "a.bvh", 2);
  const SpeedEncoder encoder;
  ml::MotionIndex index(ml::index_model(encoder, {.windows = {}}));
  ml::IndexOptions options;
  ml::ClipLine inside, elsewhere;
  inside.clip = "a", inside.start = 0.5, inside.end = 1.5, inside.texts = {"walk 1", "walk 2"};
  inside.file = ml::indexed_path(folder / "a.bvh");
  elsewhere.clip = "b", elsewhere.end = 1, elsewhere.texts = {"walk 3"};
  options.captions = {inside, elsewhere};
  const auto report = ml::update_index(index, folder.path, encoder, options);
  CHECK(report.added == 1);
  CHECK(report.unknown_clips == std::vector<std::string>{(ml::indexed_path(folder.path) / "b").string()});
  REQUIRE(index.count() == 1);
  CHECK(index.clips()[0].start == 0.5);
  CHECK(index.clips()[0].end == doctest::Approx(1.5));
  CHECK(index.clips()[0].captions == std::vector<std::string>{"walk 1", "walk 2"});
  CHECK(index.caption_clips().size() == 2);
  CHECK(ml::update_index(index, folder.path, encoder, options).unchanged == 1);
}

TEST_CASE("an update that is stopped keeps what was encoded") {
  const TemporaryFolder folder;
  const int many = static_cast<int>(8 * ml::thread_count()) + 1;
  for (int i = 0; i < many; ++i) write_clip(folder / ("c" + std::to_string(i) + ".npz"), 1);
  const SpeedEncoder encoder;
  ml::MotionIndex index(ml::index_model(encoder));
  ml::IndexUpdate update(index, folder.path, encoder);
  CHECK(update.files() == many);
  CHECK(update.fresh_files() == many);
  Index last = 0;
  const auto stop = [&](Index done, Index total) {
    CHECK(total == many);
    last = done;
    return false;
  };
  CHECK_THROWS_AS(update.run(stop), ml::cancelled);
  CHECK(last == many - 1);
  CHECK(index.count() == many - 1);
  CHECK(update.report().added == many - 1);
  CHECK(ml::update_index(index, folder.path, encoder).added == 1);
}

TEST_CASE("a search in one call gives what the classes give") {
  const TemporaryFolder folder;
  write_clip(folder / "slow.bvh", 0.5);
  write_clip(folder / "fast.bvh", 3);
  const SpeedEncoder encoder;
  ml::MotionIndex index(ml::index_model(encoder));
  ml::update_index(index, folder.path, encoder);
  ml::write_motion_index(folder / "moves.index", index);
  const auto file = ml::MotionIndexFile::open(folder / "moves.index");
  const ml::MotionSearch classes(file.index());
  const std::string text = "walk 9";
  const auto query = encoder.encode_texts(std::span(&text, 1));
  const auto hits = ml::search(file, query, {.top = 1});
  REQUIRE(hits.size() == 1);
  CHECK(hits == classes.clips(query, 1));
  CHECK(fs::path(ml::clip_of(file.index(), hits[0]).path).filename() == "fast.bvh");
  CHECK(ml::score_of(hits[0]) == doctest::Approx((static_cast<double>(hits[0].score) + 1) / 2));
  CHECK(ml::search(file, query, {.top = 4, .what = ml::SearchFor::moments}) == classes.moments(query, 4));
  CHECK(ml::search(classes, query, {.top = 4, .what = ml::SearchFor::moments, .most_overlap = 1}) ==
        classes.moments(query, 4, 1));
  CHECK(ml::search(file, query, {.what = ml::SearchFor::captions}).empty());
  CHECK(ml::gallery_size(index, ml::SearchFor::clips) == 2);
  CHECK(ml::gallery_size(index, ml::SearchFor::moments) == std::ssize(index.moments()));
  CHECK(ml::gallery_size(index, ml::SearchFor::captions) == 0);
  CHECK_ERROR(ml::search(file, query, {.top = -1}), "[motionlang.config.101]");

  const ml::Motion fast = ml::read_motion(folder / "fast.bvh");
  CHECK(fs::path(ml::clip_of(index, ml::search(file, ml::encode_motion(encoder, fast))[0]).path).filename() ==
        "fast.bvh");
}

TEST_CASE("the answer to a text: scores on a scale, unknown words, and whether anything shows it") {
  const TemporaryFolder folder;
  write_clip(folder / "slow.bvh", 1);
  write_clip(folder / "fast.bvh", 3);
  SpeedEncoder encoder;
  ml::MotionIndex index(ml::index_model(encoder));
  ml::update_index(index, folder.path, encoder);
  const ml::MotionSearch moves(index);

  const auto plain = ml::answer_text(moves, encoder, "walk 3", {.top = 2});
  REQUIRE(plain.hits.size() == 2);
  CHECK(plain.hits == ml::search(moves, encoder.encode_texts(std::vector<std::string>{"walk 3"}), {.top = 2}));
  CHECK_FALSE(plain.calibrated);
  CHECK(plain.shown);
  CHECK(plain.unheard.empty());
  CHECK(plain.scores[0] == ml::score_of(plain.hits[0]));

  const double nearest = static_cast<double>(plain.hits[0].score);
  encoder.scale = {.shares = {0, 1}, .cosines = {-1, 1}, .least = nearest - 0.01};
  const auto shown = ml::answer_text(moves, encoder, "walk 3", {.top = 2});
  CHECK(shown.calibrated);
  CHECK(shown.shown);
  CHECK(shown.hits == plain.hits);
  CHECK(shown.scores[0] == doctest::Approx((nearest + 1) / 2));
  encoder.scale.least = nearest + 0.01;
  CHECK_FALSE(ml::answer_text(moves, encoder, "walk 3").shown);
  CHECK_FALSE(ml::answer_text(moves, encoder, "walk 3", {.top = 0}).shown);
  const auto captions = ml::answer_text(moves, encoder, "walk 3", {.what = ml::SearchFor::captions});
  CHECK(captions.shown);
  CHECK_FALSE(captions.calibrated);

  encoder.scale.least = -1;
  encoder.meanings = {{"run", {"walk 3"}}, {"hurry 2", {"walk 1", "walk 7"}}, {"walk 3", {}}};
  CHECK(ml::answer_text(moves, encoder, "run", {.top = 2}).hits == plain.hits);
  const auto unlike = ml::answer_text(moves, encoder, "walk 3", {.top = 2});
  CHECK(unlike.hits == plain.hits);  // nothing is like it; the nearest are found all the same
  CHECK_FALSE(unlike.shown);
  const auto both = ml::answer_text(moves, encoder, "hurry 2", {.top = 2});
  const auto one = ml::unit_rows(encoder.encode_texts(std::vector<std::string>{"walk 1"}), 2),
             other = ml::unit_rows(encoder.encode_texts(std::vector<std::string>{"walk 7"}), 2);
  CHECK(both.hits == ml::search(moves, std::vector{(one[0] + other[0]) / 2, (one[1] + other[1]) / 2}, {.top = 2}));

  const auto of_captions = ml::answer_text(moves, encoder, "walk 3", {.what = ml::SearchFor::captions});
  CHECK(of_captions.shown);  // captions are compared with the text itself
  encoder.known = ml::KnownWords({"walk", "3"});
  const auto misspelled = ml::answer_text(moves, encoder, "run", {.top = 2});
  CHECK(misspelled.unheard.size() == 1);
  CHECK(misspelled.shown);  // no word of it is known, but it means a text that is
  encoder.meanings.clear();
  CHECK(ml::answer_text(moves, encoder, "walk 3").unheard.empty());
  const auto partly = ml::answer_text(moves, encoder, "xylo 3 \xC3\xA9\xC3\xA9");
  CHECK(partly.shown);
  REQUIRE(partly.unheard.size() == 2);
  CHECK(partly.unheard[0].word == "xylo");
  CHECK(partly.unheard[1].word == "\xC3\xA9\xC3\xA9");
  CHECK_FALSE(ml::answer_text(moves, encoder, "xylo 9").shown);  // no word of it is known
  CHECK_ERROR(ml::encode_together(encoder, {}), "[motionlang.shape.203]");
}

TEST_CASE("captions of an animation of a file with several go to that one alone") {
  const TemporaryFolder folder;
  std::vector<ml::Motion> two{synthetic::walk({.frames = 60, .fps = 20, .steps_per_second = 1}),
                              synthetic::walk({.frames = 60, .fps = 20, .steps_per_second = 3})};
  two[0].name = "Slow", two[1].name = "Fast";
  ml::write_glb(folder / "two.glb", two);
  const SpeedEncoder encoder;
  ml::MotionIndex index(ml::index_model(encoder, {.windows = {}}));
  ml::write_file(folder / "captions.tsv", std::string_view("two.glb#Fast\t0\t2\tlegs\twalk 3\n"));
  ml::IndexOptions options;
  options.captions = ml::read_captions(folder / "captions.tsv", ml::indexed_path(folder.path));
  const auto report = ml::update_index(index, folder.path, encoder, options);
  CHECK(report.added == 1);
  REQUIRE(index.count() == 1);
  CHECK(index.clips()[0].name == "Fast");
  CHECK(index.clips()[0].captions == std::vector<std::string>{"walk 3"});
  CHECK(index.clips()[0].end == doctest::Approx(2));
}

TEST_CASE("a clip of more than ten seconds has the mean of the directions of its parts") {
  const SpeedEncoder encoder;
  std::vector<float> rows(300, 1.0f);
  std::fill(rows.begin() + 150, rows.end(), 3.0f);
  const auto vector = ml::encode_clip(encoder, rows);
  const std::vector<ml::FrameSlice> halves{{0, 150}, {150, 150}};
  const auto unit = ml::unit_rows(encoder.encode_windows(rows, halves), 2);
  CHECK(vector[0] == doctest::Approx((unit[0] + unit[2]) / 2));
  CHECK(vector[1] == doctest::Approx((unit[1] + unit[3]) / 2));
  CHECK(ml::encode_clip(encoder, std::span(rows).first(150)) ==
        encoder.encode_windows(rows, std::span(halves).first(1)));
}
