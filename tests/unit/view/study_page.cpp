// The page of a study: self-contained, with every motion once, and without names of systems and files.
#include <motionlang/view/study_page.hpp>

#include <doctest/doctest.h>

#include <vector>

#include <motionlang/file/json.hpp>

#include "../../support/markup.hpp"
#include "../../support/page_data.hpp"
#include "../../support/synthetic_motion.hpp"

namespace ml = motionlang;
using nlohmann::json;

namespace {

/// Reads "NAME FRAMES" as a walk of as many frames; notes what is read.
struct Files {
  std::vector<std::string> read{};
  ml::StudyFiles files() {
    return {.motion =
                [this](const std::string& file) {
                  read.push_back(file);
                  ml::Motion out = synthetic::walk({.frames = std::stoi(file.substr(file.find(' ')))});
                  out.name = file;
                  return out;
                },
            .timeline =
                [](const std::string& file) {
                  return std::vector<ml::Track>{{file, 0, 2, {"legs"}}};
                }};
  }
};

const char* const table =
    "role\ttext\ttimeline\tsecret\tother\n"
    "\twalk </script>\tone\tsecret/a 10\tother/b 20\n"
    "catch secret\tturn\t\tsecret/a 10\tother/c 30\n";

}  // namespace

TEST_CASE("a page of pairs: trials in the order of the seed, motions once, nothing that tells the systems") {
  const ml::Study study = ml::parse_study(table, ml::StudyKind::pairs);
  Files files;
  const ml::StudyPageOptions options{.seed = 0xFFFFFFFFFFFFFFFFu, .no_preference = true};
  const std::string page = ml::study_html(study, files.files(), options);
  CHECK(files.read.size() == 3);  // secret/a is read once
  for (const char* word :
       {"http:", "https:", "src=", "href=", "@import", "url(", "import(", "secret", "other/", "catch secret"})
    CHECK_MESSAGE(page.find(word) == std::string::npos, word);
  CHECK(occurrences(page, "</script>") == 2);
  const json data = data_of(page);
  CHECK(data["kind"] == "pairs");
  CHECK(data["seed"] == "18446744073709551615");
  CHECK(data["none"] == true);
  CHECK(data["question"] == "Which motion corresponds better to the text?");
  CHECK(data["study"].get<std::string>().size() == 16);
  const auto trials = ml::study_trials(study, options.seed);
  REQUIRE(data["trials"].size() == trials.size());
  for (std::size_t t = 0; t < trials.size(); ++t) {
    const json& shown = data["trials"][t];
    const ml::StudyItem& item = study.items[trials[t].item];
    CHECK(shown["text"] == item.text);
    CHECK(shown["tracks"].size() == (item.timeline.empty() ? 0 : 1));
    REQUIRE(shown["motions"].size() == 2);
    for (std::size_t i = 0; i < 2; ++i) {  // the motions stand where the seed puts their systems
      const std::string& file = item.choices[static_cast<std::size_t>(trials[t].shown[i])];
      const json& motion = data["motions"][shown["motions"][i].get<std::size_t>()];
      CHECK(motion["frames"] == std::stoi(file.substr(file.find(' '))));
      CHECK(motion["name"] == "");
    }
  }
  // Without texts it asks for realism, and shows no timeline.
  const json hidden = data_of(ml::study_html(study, files.files(), {.show_text = false}));
  CHECK(hidden["question"] == "Which motion is more realistic?");
  CHECK(hidden["none"] == false);
  for (const json& t : hidden["trials"]) CHECK((t["text"] == "" && t["tracks"].empty()));
}

TEST_CASE("descriptions are ranked below their motion; ratings show one motion") {
  Files files;
  const ml::Study ranking =
      ml::parse_study("motion\tmine\tyours\nm 10\ta man walks\ta man runs\n", ml::StudyKind::ranking);
  const json ranked = data_of(ml::study_html(ranking, files.files(), {}));
  CHECK(ranked["trials"][0]["motions"].size() == 1);
  CHECK(ranked["trials"][0]["texts"].size() == 2);
  CHECK(ranked["question"] == "Which texts describe the motion best?");
  const json rated = data_of(ml::study_html(ml::parse_study(table, ml::StudyKind::rating), files.files(),
                                            {.title = "Mine", .question = "Good?", .instructions = "Look."}));
  CHECK(rated["trials"].size() == 4);
  for (const json& t : rated["trials"]) CHECK((t["motions"].size() == 1 && t["texts"].empty()));
  CHECK((rated["title"] == "Mine" && rated["question"] == "Good?" && rated["instructions"] == "Look."));
}
