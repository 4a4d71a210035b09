// examples/training/REPRODUCE.md: its commands have the options that the page gives them, and those without data run.
#include <doctest/doctest.h>

#include <map>
#include <regex>

#include <motionlang/file/file.hpp>

#include "../support/official_folders.hpp"
#include "official_workplace.hpp"
#include "small_workplace.hpp"
#include "training_clips.hpp"

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
  const std::string commands = run({"--help"}, folder.path).text;
  std::map<std::string, std::string> help;
  std::map<std::string, int> seen;
  for (std::string code : code_of(ml::read_file(examples / "training/REPRODUCE.md"))) {
    if (code.starts_with("motionlang ")) code = code.substr(std::string("motionlang ").size());
    std::string command = code.substr(0, code.find(' '));
    if (command.empty() || !contains(commands, "\n  " + command + " ")) continue;
    if (!help.contains(command)) help[command] = run({command, "--help"}, folder.path).text;
    if (command == "figure" && code.size() > command.size()) {  // each kind has options of its own
      const std::string kind = code.substr(7, code.find(' ', 7) - 7);
      command += " " + kind;
      if (!help.contains(command)) help[command] = run({"figure", kind, "--help"}, folder.path).text;
    }
    ++seen[command];
    for (std::size_t at = code.find("--"); at != code.npos; at = code.find("--", at + 2)) {
      const std::string option = code.substr(at, code.find_first_not_of("abcdefghijklmnopqrstuvwxyz-", at) - at);
      CHECK_MESSAGE(std::regex_search(help[command], std::regex(option + "(?![a-z-])")), code, ": ", command,
                    " has no ", option);
    }
  }
  CHECK(seen["evaluate"] > 10);
  CHECK(seen["train-temos"] > 1);
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

TEST_CASE("the settings that the tables vary train another model") {
  const Clips clips;
  const std::string page = ml::read_file(examples / "training/REPRODUCE.md");
  using Settings = std::vector<std::string>;
  for (const auto& [command, settings] :
       {std::pair<std::string, Settings>{
            "train-actor", {"losses.kl=0.1", "network.num_layers=2", "optimiser.batch=3", "clips.translation=false"}},
        {"train-temos",
         {"losses.kl=0.1", "losses.latent=0.1", "network.num_layers=2", "network.motion_decoder=gru",
          "optimiser.batch=3"}},
        {"train-tmr",
         {"losses.temperature=0.5", "losses.contrastive=1", "losses.contrastive_loss=none", "optimiser.batch=3",
          "network.latent_dim=4"}}}) {
    const auto trained = [&](const std::string& setting) {
      const std::string out = command + setting;
      Settings more{"--set", "optimiser.epochs=1"};
      if (command != "train-actor") more.insert(more.end(), {"--set", "losses.threshold=0"});
      if (!setting.empty()) more.insert(more.end(), {"--set", setting});
      const auto done = clips.train(command, out, more);
      REQUIRE_MESSAGE(done.code == 0, done.text);
      return clips.weights(out);
    };
    const auto usual = trained("");
    for (const std::string& setting : settings) {
      CHECK_MESSAGE(contains(page, setting.substr(0, setting.find('='))), setting);
      CHECK_MESSAGE(trained(setting) != usual, command, " ", setting);
    }
  }
}

TEST_CASE("TEMOS with BERT and with RoBERTa: table 4.9") {
  const Clips clips;
  write_language_model<ml::Bert<B>>(
      clips / "bert", "bert",
      {.vocabulary = 12, .width = 8, .heads = 2, .d_ff = 12, .layers = 1, .positions = 16, .token_types = 2});
  ml::write_file(
      clips / "bert/vocab.txt",
      std::string_view("[PAD]\n[UNK]\n[CLS]\n[SEP]\n[MASK]\na\nperson\nsomeone\nwalks\nturns\nahead\nleft\n"));
  write_roberta(clips / "roberta");
  for (const std::string encoder : {"bert", "roberta"}) {
    CAPTURE(encoder);
    const auto trained =
        clips.train("train-temos", "of_" + encoder,
                    {"--set", "text.encoder=distilbert", "--text-encoder", encoder, "--set", "optimiser.epochs=1"});
    CHECK_MESSAGE(trained.code == 0, trained.text);
    const auto measured = run({"evaluate", "of_" + encoder + "/model", "--data", ".", "--captions", "captions.tsv",
                               "--text-encoder", encoder, "--samples", "2"},
                              clips.path);
    CHECK_MESSAGE(measured.code == 0, measured.text);
  }
}

TEST_CASE("table 6.1 of a published MDM-SMPL, MDM and MotionDiffuse") {
  const OfficialWorkplace w;
  const auto sizes = official::small();
  official::write_stmc_run(w / "stmc", sizes);
  official::write_mdm_run(w / "mdm", sizes);
  official::write_motiondiffuse_run(w / "motiondiffuse", sizes);
  official::write_clip(w / "clip", sizes);
  const std::string texts = (examples / "training/mtt_texts.txt").string();
  for (const std::string model : {"stmc", "mdm", "motiondiffuse"}) {
    CAPTURE(model);
    std::vector<std::string> line{"evaluate", model, "--texts", texts, "--text-encoder", "clip",
                                  "--seed",   "10",  "--first", "2",   "--steps",        "2"};
    if (model == "mdm") line.insert(line.end(), {"--statistics", "mdm"});
    const std::string measured = w.did(line);
    CHECK_MESSAGE(contains(measured, "\n  STMC "), measured);
  }
}
