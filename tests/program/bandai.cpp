// examples/training/bandai_all.sh: every command runs on made-up clips with the names of the Bandai-Namco data set.
#include <doctest/doctest.h>

#include <algorithm>
#include <set>
#include <sstream>

#include <motionlang/file/file.hpp>
#include <motionlang/formats/bvh.hpp>

#include "../support/synthetic_motion.hpp"
#include "../support/temporary_folder.hpp"
#include "process.hpp"

namespace ml = motionlang;

namespace {

/// Five clips of each of six contents. The evaluator of Guo et al. takes two seconds or more.
struct BandaiClips : TemporaryFolder {
  BandaiClips() {
    std::filesystem::create_directories(*this / "clips");
    int k = 0;
    for (const std::string content :
         {"walk", "run", "walk-turn-left", "wave-left-hand", "raise-up-both-hands", "raise-up-right-hand"}) {
      for (int i = 1; i <= 5; ++i, ++k)
        ml::write_bvh(*this / ("clips/dataset-2_" + content + "_normal_00" + std::to_string(i) + ".bvh"),
                      synthetic::walk({.frames = 64 + k % 7, .fps = 30, .turn = 0.03 * k}));
    }
  }
  Outcome script(const std::string& out, const std::vector<std::string>& more) const {
    std::vector<std::string> arguments{MOTIONLANG_EXAMPLES "/training/bandai_all.sh", "clips", out, "--quick"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments, path);
  }
  std::string page(const std::string& out) const { return ml::read_file(*this / (out + "/page.md")); }
};

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> out;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) out.push_back(line);
  return out;
}

}  // namespace

TEST_CASE("the script measures all systems, and goes on where it stopped") {
  const BandaiClips w;
  const Outcome first = w.script("out", {"--only", "actor"});
  REQUIRE_MESSAGE(first.code == 0, first.text);
  CHECK(contains(first.text, "== actor_joints: "));
  CHECK(contains(w.page("out"), "| without inverse alignment | missing |"));
  CHECK_FALSE(contains(w.page("out"), "| rotations and joints | missing |"));

  const Outcome rest = w.script("out", {});
  REQUIRE_MESSAGE(rest.code == 0, rest.text);
  CHECK_FALSE(contains(rest.text, "== actor"));
  CHECK_FALSE(contains(rest.text, "== tables"));
  const std::string page = w.page("out");
  CHECK(contains(page, "Clips: 18 to train with, 6 for validation, 6 for tests."));
  CHECK_MESSAGE(!contains(page, "missing"), page);
  std::size_t columns = 0, rows = 0;
  for (const std::string& line : lines_of(page)) {  // every table is whole
    if (!line.starts_with("|")) {
      columns = 0;
      continue;
    }
    const auto cells = static_cast<std::size_t>(std::count(line.begin(), line.end(), '|'));
    if (columns == 0) columns = cells;
    CHECK_MESSAGE(cells == columns, line);
    ++rows;
  }
  CHECK(rows > 100);
  for (const char* system : {"| SINC without lerp |", "| DiffCollage, single track |", "| recorded |", "| joints |",
                             "| deterministic |", "| InfoNCE, not filtered |", "| independent |", "| SINC-STE, pairs |",
                             "| without motion tokens |", "| Transformer (T) |", "| mdm_smpl |"})
    CHECK_MESSAGE(contains(page, system), system);

  const Outcome again = w.script("out", {});
  REQUIRE_MESSAGE(again.code == 0, again.text);
  CHECK_MESSAGE(!contains(again.text, "== "), again.text);
  CHECK(w.page("out") == page);

  // the orderings compare two values of the tables
  const auto lines = lines_of(page);
  const auto orderings = std::find(lines.begin(), lines.end(), "## Orderings of the papers");
  REQUIRE(orderings != lines.end());
  CHECK(std::count_if(orderings, lines.end(), [](const std::string& l) {
          return l.ends_with("| yes |") || l.ends_with("| no |") || l.ends_with("| equal |");
        }) == 48);
  for (const auto& [gru, holds] :
       {std::pair{"80.5", "90.0 > 80.5 | yes |"}, {"97.0", "90.0 > 97.0 | no |"}, {"90.0", "90.0 > 90.0 | equal |"}}) {
    ml::write_file(w / "out/results/actor.txt",
                   std::string_view("  generated 90.0 +-1.5 0.1 +-0.0 6.0 +-0.1 1.0 +-0.0\n"));
    ml::write_file(w / "out/results/actor_gru.txt", std::string("  generated ") + gru + " +-1.5 0.1 +-0.0\n");
    REQUIRE(w.script("out", {}).code == 0);
    const std::string claim = std::string("| ACTOR 3.4, accuracy: Transformer, GRU | 91.1 > 87.3 | ") + holds;
    CHECK_MESSAGE(contains(w.page("out"), claim), claim);
  }
}

TEST_CASE("pairs stay in the parts of their clips; other lists of clips; what is wrong is refused") {
  const BandaiClips w;
  std::filesystem::create_directories(w / "lists");
  std::set<std::string> training;
  std::string train, val, test;
  for (const auto& file : std::filesystem::directory_iterator(w / "clips")) {
    const std::string name = file.path().stem().string();
    (name.ends_with("3") ? test : name.ends_with("4") ? val : train) += name + "\n";
    if (!name.ends_with("3") && !name.ends_with("4")) training.insert(name);
  }
  ml::write_file(w / "lists/train.txt", train), ml::write_file(w / "lists/val.txt", val);
  ml::write_file(w / "lists/test.txt", test);
  const Outcome made = w.script("out", {"--splits", "lists", "--only", ""});
  REQUIRE_MESSAGE(made.code == 0, made.text);
  CHECK(contains(w.page("out"), "Clips: 18 to train with, 6 for validation, 6 for tests."));
  const std::string list = ml::read_file(w / "out/splits/train.txt");
  CHECK(list.starts_with(train));
  int pairs = 0;
  for (const std::string table : {"after.tsv", "together.tsv"}) {
    for (const std::string& line : lines_of(ml::read_file(w / ("out/" + table)))) {
      std::vector<std::string> cells;
      std::istringstream in(line);
      for (std::string cell; std::getline(in, cell, '\t');) cells.push_back(cell);
      REQUIRE(cells.size() == 9);
      for (const std::string& clip : {cells[0], cells[1]})
        CHECK_MESSAGE(training.contains(clip) == (cells[8] == "train"), line);
      CHECK(contains(list, cells[2] + "\n") == (cells[8] == "train"));
      CHECK_MESSAGE(std::filesystem::exists(w / ("out/data/" + cells[2] + ".npz")), line);
      ++pairs;
    }
  }
  CHECK(pairs > 8);

  CHECK(w.script("out", {"--what"}).code == 2);
  std::filesystem::create_directories(w / "empty");
  CHECK(run({MOTIONLANG_EXAMPLES "/training/bandai_all.sh", "empty", "out2"}, w.path).code != 0);
}
