// Words and verbs of data sets.
#include <motionlang/datasets/word_counts.hpp>

#include <doctest/doctest.h>

#include <motionlang/file/file.hpp>

#include "../../support/temporary_folder.hpp"

namespace ml = motionlang;

TEST_CASE("words are in lower case, without punctuation, and counted") {
  const std::vector<std::string> texts{"A man walks, then WALKS back.", "walk-in 'the' person's caf\u00E9 2x", "-"};
  const auto counts = ml::word_counts(texts);
  CHECK(counts.at("walks") == 2);
  CHECK(counts.at("walk-in") == 1);
  CHECK(counts.at("the") == 1);
  CHECK(counts.at("person's") == 1);
  CHECK(counts.at("caf\u00E9") == 1);
  CHECK(counts.at("2x") == 1);
  CHECK(counts.size() == 10);
  CHECK(ml::words_at_least(counts, 1) == 10);
  CHECK(ml::words_at_least(counts, 2) == 1);
  CHECK(ml::words_at_least(counts, 3) == 0);
}

TEST_CASE("verbs of commands, and texts with any of their forms") {
  const std::vector<std::string> commands{"walk along", "hop", "a person jumps", "wave"};
  const auto verbs = ml::commanded_verbs(commands);
  CHECK(verbs == std::vector<std::string>{"hop", "walk", "wave"});
  const std::vector<std::string> texts{"a man walks and is walking", "she hopped", "waving and hopping", "he stands"};
  const auto counts = ml::verb_counts(texts, verbs);
  CHECK(counts == std::map<std::string, std::size_t>{{"hop", 2}, {"walk", 1}, {"wave", 1}});
}

TEST_CASE("texts of captions and of annotations") {
  const TemporaryFolder folder;
  ml::write_file(folder / "c.tsv",
                 std::string_view("# comment\nclip\t0\t2\tlegs\twalk | walk on\nclip\t2\t3\tlegs\thop\n"));
  CHECK(ml::texts_of_data(folder / "c.tsv").texts == std::vector<std::string>{"walk", "walk on", "hop"});
  ml::write_file(folder / "a.json", std::string_view(R"({"000000": {"path": "a", "duration": 5, "annotations": [
                   {"seg_id": "000000_0", "text": "a man kicks.", "start": 0.0, "end": 5.0}]}})"));
  CHECK(ml::texts_of_data(folder / "a.json").texts == std::vector<std::string>{"a man kicks."});

  // A folder in the form of HumanML3D has parts of speech, and so action phrases.
  std::filesystem::create_directories(folder / "kit/texts");
  ml::write_file(folder / "kit/train.txt", std::string_view("00001\nM00001\n"));
  ml::write_file(folder / "kit/val.txt", std::string_view(""));
  ml::write_file(folder / "kit/test.txt", std::string_view("00002\nM00003\n"));
  ml::write_file(folder / "kit/texts/M00003.txt", std::string_view("hop#hop/VERB#0.0#0.0\n"));
  ml::write_file(folder / "kit/texts/00001.txt",
                 std::string_view("a man walks slowly#a/DET man/NOUN walk/VERB slowly/ADV#0.0#0.0\n"));
  ml::write_file(
      folder / "kit/texts/00002.txt",
      std::string_view("he kicks a ball and jumps#he/PRON kick/VERB a/DET ball/NOUN and/CCONJ jump/VERB#0.0#0.0\n"));
  const auto kit = ml::texts_of_data(folder / "kit");
  CHECK(kit.texts == std::vector<std::string>{"a man walks slowly", "he kicks a ball and jumps", "hop"});
  CHECK(kit.phrases == std::vector<std::string>{"walk slowly", "kick ball", "jump", "hop"});
  ml::write_file(folder / "kit/all.txt", std::string_view("00002\n"));
  CHECK(ml::texts_of_data(folder / "kit").texts.size() == 1);
}
