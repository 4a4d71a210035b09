// Prompts from captions, from a file, and their motions.
#include <motionlang/generate/gallery_prompts.hpp>

#include <doctest/doctest.h>

#include <limits>

#include <motionlang/file/file.hpp>

#include "../../support/check_error.hpp"
#include "../../support/temporary_folder.hpp"
#include "../../support/word_count_encoder.hpp"
#include "fake_models.hpp"

namespace ml = motionlang;

namespace {

ml::ClipLine line(double seconds, std::vector<std::string> texts) {
  ml::ClipLine out;
  out.start = 1, out.end = 1 + seconds, out.texts = std::move(texts);
  return out;
}

}  // namespace

TEST_CASE("a prompt for each verb: the caption of most segments, of these the shortest; half of the lengths") {
  const std::vector<ml::ClipLine> captions{
      line(2.4, {"walk on", "a person walks", "slowly walk ahead"}),
      line(2.6, {"walk straight on", "walk on", "be idle"}),
      line(9, {"walk straight on", "walk in a circle", "walk"}),
      line(0.5, {"kick a ball hard", "kick twice", "kick hard", "walking on"}),
      line(std::numeric_limits<double>::infinity(), {"wave"}),
  };
  const std::vector<ml::GalleryPrompt> expected{
      {"walk", "walk on", 2.5}, {"kick", "kick hard", 2}, {"wave", "wave", 4}};
  CHECK(ml::gallery_prompts(captions) == expected);
  CHECK(ml::gallery_prompts(captions, 2) == std::vector<ml::GalleryPrompt>{expected[0]});
  CHECK(ml::gallery_prompts(std::span<const ml::ClipLine>()).empty());
}

TEST_CASE("prompts of the captions that a model remembers; those that are far from them are taken out") {
  const std::vector<std::string> texts{"walk straight on", "a person walks", "walk on",    "kick",
                                       "kick hard",        "be hard",        "raise again"};
  const std::vector<ml::KnownAction> actions(6, {2, true, ""});  // "raise again" was tried, and no caption says it
  fake::Model model;
  model.learned = ml::KnownCaptions(ml::TextTable::encoded(texts, counted::vectors), actions, 0.5, {0.1});
  const auto prompts = ml::gallery_prompts(model.learned);
  CHECK(prompts == std::vector<ml::GalleryPrompt>{{"kick", "kick"}, {"walk", "walk on"}});
  CHECK(ml::gallery_prompts(model.learned, 3).empty());
  CHECK(ml::gallery_prompts(ml::KnownCaptions()).empty());
  CHECK(ml::write_gallery_prompts(prompts) == "kick # 4\nwalk on # 4\n");

  std::vector<ml::GalleryPrompt> list{{"walk", "walk on"}, {"moonwalk", "moonwalk"}};
  CHECK(ml::take_unknown_prompts(list, model) == std::vector<ml::GalleryPrompt>{{"moonwalk", "moonwalk"}});
  CHECK(list.size() == 1);
}

TEST_CASE("prompts are written and read again; a file without any is an error") {
  const std::vector<ml::GalleryPrompt> prompts{{"walk", "Walk on, and on", 2.5}, {"kick", "kick", 4}};
  const std::string text = ml::write_gallery_prompts(prompts);
  CHECK(text == "Walk on, and on # 2.5\nkick # 4\n");
  CHECK(ml::parse_gallery_prompts(text) == prompts);
  CHECK(ml::parse_gallery_prompts("walk # 2.3")[0].seconds == 2.3);
  const std::vector<ml::GalleryPrompt> two{{"walk", "walk # on", 2}}, broken{{"walk", "walk\non", 2}};
  CHECK_THROWS_WITH_AS(ml::write_gallery_prompts(two),
                       doctest::Contains("101] write_gallery_prompts: the text 'walk # on'"), ml::config_error);
  CHECK_THROWS_AS(ml::write_gallery_prompts(broken), ml::config_error);
  CHECK_THROWS_WITH_AS(ml::parse_gallery_prompts("\n", "mine.txt"), doctest::Contains("mine.txt: no line"),
                       ml::timeline_error);
  CHECK_THROWS_WITH_AS(ml::parse_gallery_prompts("walk # soon", "mine.txt"), doctest::Contains("mine.txt:1:"),
                       ml::timeline_error);
}

TEST_CASE("prompts with unknown words are taken out, if the model lists its words") {
  std::vector<ml::GalleryPrompt> prompts{{"walk", "walk on"}, {"fly", "fly on"}, {"walk", "walk"}};
  fake::Model model;
  CHECK(ml::take_unknown_prompts(prompts, model).empty());
  CHECK(prompts.size() == 3);
  model.known = ml::KnownWords({"walk", "on"});
  const auto unknown = ml::take_unknown_prompts(prompts, model);
  REQUIRE(unknown.size() == 1);
  CHECK(unknown[0].text == "fly on");
  CHECK(prompts.size() == 2);
}

TEST_CASE("a motion for each prompt, as the text alone makes it; progress counts prompts and stops") {
  const std::vector<ml::GalleryPrompt> prompts{{"1", "0.5"}, {"2", "1.5"}};
  const fake::Latent model;
  std::vector<ml::Index> done;
  auto note = [&](ml::Index now, ml::Index total) {
    done.push_back(now);
    return total == 2;
  };
  ml::GenerateOptions options{.seed = 5};
  options.progress = note;
  const auto motions = ml::gallery_motions(model, prompts, options);
  REQUIRE(motions.size() == 2);
  CHECK(done.back() == 2);
  for (std::size_t i = 0; i < 2; ++i) {
    CHECK(motions[i].name == prompts[i].text);
    const ml::Motion alone = ml::generate_motion(model, ml::whole_body_timeline(prompts[i].text, 80), {.seed = 5});
    CHECK(synthetic::largest_distance(motions[i], alone) == 0);
  }
  auto stop = [](ml::Index, ml::Index) { return false; };
  options.progress = stop;
  CHECK_THROWS_AS(ml::gallery_motions(model, prompts, options), ml::cancelled);
}

TEST_CASE("a gallery is a page of all motions and a picture of the first ones, beside a list of prompts") {
  const TemporaryFolder folder;
  const std::vector<ml::Motion> motions{synthetic::walk({.frames = 20}), synthetic::walk({.frames = 30})};
  const std::vector<ml::GalleryPrompt> prompts{{"walk", "walk forward", 1}, {"run", "run fast", 2}};
  ml::write_gallery(folder.path, motions, prompts, {.title = "Two verbs", .pictured = 1});
  const std::string page = ml::read_file(folder / "gallery.html"), picture = ml::read_file(folder / "gallery.svg");
  CHECK(page.find("Two verbs") != page.npos);
  CHECK(page.find("run fast") != page.npos);
  CHECK(picture.find("walk forward") != picture.npos);
  CHECK(picture.find("run fast") == picture.npos);
  CHECK_ERROR(ml::write_gallery(folder.path, motions, std::span(prompts).first(1)), "[motionlang.shape.204]");
  CHECK(ml::gallery_list_beside(folder.path).empty());
  ml::write_file(folder / "gallery.txt", std::string_view("walk # 2\n"));
  CHECK(ml::gallery_list_beside(folder.path) == folder / "gallery.txt");
  CHECK(ml::gallery_list_beside(folder / "stmc.safetensors") == folder / "gallery.txt");
}
