// examples/training/REPRODUCE.md: its commands have the options that the page gives them, and those without data run.
#include <doctest/doctest.h>

#include <map>
#include <set>

#include <motionlang/file/file.hpp>

#include "small_workplace.hpp"

namespace {

const std::filesystem::path examples = MOTIONLANG_EXAMPLES;

/// The texts of a page between backticks, and its lines of code.
std::vector<std::string> code_of(const std::string& page) {
  std::vector<std::string> out;
  for (std::size_t at = 0; at < page.size();) {
    const std::size_t end = std::min(page.find('\n', at), page.size());
    const std::string line = page.substr(at, end - at);
    if (line.starts_with("    ")) out.push_back(line.substr(4));
    for (std::size_t open = line.find('`'); open != line.npos;) {
      const std::size_t close = line.find('`', open + 1);
      if (close == line.npos) break;
      out.push_back(line.substr(open + 1, close - open - 1));
      open = line.find('`', close + 1);
    }
    at = end + 1;
  }
  return out;
}

}  // namespace

TEST_CASE("every option of the page is one of its command") {
  const TemporaryFolder folder;
  const std::set<std::string> commands{
      "mtt",      "evaluate",    "generate",         "check",          "search",         "compose",
      "describe", "train-actor", "train-classifier", "train-mdm-smpl", "train-mdm",      "train-motiondiffuse",
      "study",    "study-count", "body-parts",       "tokens",         "train-evaluator"};
  std::map<std::string, std::string> help;
  std::map<std::string, int> seen;
  for (std::string code : code_of(ml::read_file(examples / "training/REPRODUCE.md"))) {
    if (code.starts_with("motionlang ")) code = code.substr(std::string("motionlang ").size());
    std::string command = code.substr(0, code.find(' '));
    if (!commands.contains(command) && command != "figure") continue;
    if (!help.contains(command)) help[command] = run({command, "--help"}, folder.path).text;
    if (command == "figure" && code.size() > command.size()) {  // each kind has options of its own
      const std::string kind = code.substr(7, code.find(' ', 7) - 7);
      command += " " + kind;
      if (!help.contains(command)) help[command] = run({"figure", kind, "--help"}, folder.path).text;
    }
    ++seen[command];
    for (std::size_t at = code.find("--"); at != code.npos; at = code.find("--", at + 2)) {
      const std::string option = code.substr(at, code.find_first_not_of("abcdefghijklmnopqrstuvwxyz-", at) - at);
      CHECK_MESSAGE(contains(help[command], option), code, ": ", command, " has no ", option);
    }
  }
  CHECK(seen["evaluate"] > 10);
  CHECK(seen["generate"] > 3);
  CHECK(seen["figure curves"] > 2);
}

TEST_CASE("the commands that need no data") {
  const TemporaryFolder folder;
  const std::string texts = (examples / "training/mtt_texts.txt").string();
  const Outcome drawn = run({"mtt", "--texts", texts, "--out", "mtt"}, folder.path);
  CHECK_MESSAGE((drawn.code == 0 && contains(drawn.text, "500 timelines of 24 texts")), drawn.text);
  const Outcome timeline =
      run({"figure", "timelines", (examples / "timelines/walk_and_raise_arms.txt").string(), "-o", "timeline.svg"},
          folder.path);
  CHECK_MESSAGE((timeline.code == 0 && std::filesystem::exists(folder / "timeline.svg")), timeline.text);
  const Outcome words =
      run({"figure", "words", (examples / "training/captions.tsv").string(), "-o", "words.svg"}, folder.path);
  CHECK_MESSAGE((words.code == 0 && std::filesystem::exists(folder / "words_verbs.svg")), words.text);
  const Outcome measured = run({"evaluate", (examples / "models/stmc_free.safetensors").string(), "--texts", texts,
                                "--first", "2", "--steps", "2"},
                               folder.path);
  REQUIRE_MESSAGE(measured.code == 0, measured.text);
  for (const char* row : {"one text", "DiffCollage, single track", "SINC without lerp", "SINC with lerp", "STMC"})
    CHECK_MESSAGE(contains(measured.text, std::string("\n  ") + row + " "), measured.text);
}
