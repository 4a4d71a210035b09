// motionlang gallery: a page and a picture of the verbs of a model.
#include <doctest/doctest.h>

#include <algorithm>
#include <set>

#include <motionlang/generate/gallery_prompts.hpp>

#include "../support/markup.hpp"
#include "small_workplace.hpp"

TEST_CASE("gallery: prompts of a file, a page and a picture") {
  const Workplace w;
  ml::write_file(w / "prompts.txt", std::string_view("walk forward # 1\nraise both arms # 0.5\nfly # 1\n"));
  const auto gallery = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"gallery", "--model", "model.safetensors"});
    return w.run(more);
  };
  const Outcome made = gallery({"--prompts", "prompts.txt", "--out", "g", "--poses", "1", "--columns", "3"});
  REQUIRE_MESSAGE(made.code == 0, made.text);
  const auto files = w.files("g");
  REQUIRE(files.size() == 2);
  CHECK(is_well_formed(files.at("gallery.svg")));
  const int motions = occurrences(files.at("gallery.svg"), "class=\"pose\"");
  CHECK(motions == 3);  // this model lists no words, so it knows all of them
  CHECK(contains(made.text, "3 motions, 0 prompts left out"));
  CHECK(contains(files.at("gallery.html"), "raise both arms"));
  CHECK(contains(files.at("gallery.html"), "Prompts of prompts.txt"));
  CHECK_FALSE(contains(files.at("gallery.html"), "Every verb that the model knows"));
  const Outcome again = gallery({"--prompts", "prompts.txt", "--out", "h", "--poses", "1", "--columns", "3"});
  REQUIRE(again.code == 0);
  CHECK(w.files("h") == files);
  CHECK(gallery({"--prompts", "none.txt"}).code == 2);
}

TEST_CASE("gallery --list: the bundled prompts are verbs of the captions") {
  const Workplace w;
  const std::filesystem::path examples = MOTIONLANG_EXAMPLES;
  const auto listed = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"gallery", "--list"});
    const Outcome out = w.run(more);
    REQUIRE_MESSAGE(out.code == 0, out.text);
    return ml::parse_gallery_prompts(out.text);
  };
  const auto verbs_of = [](const std::vector<ml::GalleryPrompt>& prompts) {
    std::set<std::string> out;
    for (const ml::GalleryPrompt& p : prompts) out.insert(p.verb);
    return out;
  };
  const std::string captions = (examples / "training/captions.tsv").string();
  const auto bundled = verbs_of(listed({})), all = verbs_of(listed({"--captions", captions}));
  CHECK(bundled.size() > 250);
  CHECK(std::includes(all.begin(), all.end(), bundled.begin(), bundled.end()));
  CHECK(verbs_of(listed({"--captions", captions, "--least", "20"})).size() < bundled.size() / 4);
  CHECK(ml::write_gallery_prompts(listed({})) == ml::read_file(examples / "models/gallery.txt"));
}
