// Options, exit codes, help, folders for results.
#include <doctest/doctest.h>
#include <sys/wait.h>  // WEXITSTATUS

#include <motionlang/datasets/annotations.hpp>
#include <motionlang/datasets/humanml3d_folder.hpp>
#include <motionlang/formats/amass.hpp>
#include <motionlang/formats/bvh.hpp>
#include <motionlang/formats/glb_reader.hpp>
#include <motionlang/kinematics/motion_tools.hpp>

#include "../support/synthetic_motion.hpp"
#include "small_workplace.hpp"

TEST_CASE("help names every command and option, and the exit codes") {
  const TemporaryFolder folder;
  const auto all = run({"--help"}, folder.path);
  CHECK(all.code == 0);
  for (const char* word : {"generate", "check", "info", "train", "judge", "convert", "compose", "join", "doctor",
                           "strip", "view", "describe", "Exit codes: 0 ", "1 ", "2 ", "3 ", "130 "})
    CHECK_MESSAGE(contains(all.text, word), word);
  const std::map<std::string, std::vector<std::string>> options{
      {"generate", {"--timeline",  "--model",   "--out",         "--seed",        "--steps",           "--sampler",
                    "--guidance",  "--overlap", "--noise",       "--rig",         "--drop-animations", "--in-turn",
                    "--cut-texts", "--smooth",  "--fix-feet",    "--backend",     "--threads",         "--preset",
                    "--record",    "--reuse",   "--keep-beyond", "--keep",        "--keep-seconds",    "--keep-parts",
                    "--samples",   "--towards", "--mode",        "--noise-factor"}},
      {"mtt", {"--texts", "--out", "--seed", "--count"}},
      {"check", {"timeline", "--fps", "--overlap", "--model", "--cut-texts", "--in-turn"}},
      {"info", {"file", "--features"}},
      {"convert",
       {"input",
        "output",
        "--scale",
        "--asf",
        "--fps",
        "--from",
        "--to",
        "--speed",
        "--units",
        "--smpl",
        "--mirror",
        "--smooth",
        "--in-place",
        "--loop",
        "--fix-feet",
        "--rig",
        "--drop-animations",
        "--tensors",
        "--features",
        "--rate",
        "--as",
        "--denoise",
        "--action",
        "--text-encoder",
        "--statistics",
        "--store",
        "--body",
        "--betas",
        "--hands",
        "--replace"}},
      {"compose", {"motions", "--first", "--second", "--table", "--center", "--output", "--units", "--scale", "--asf"}},
      {"join", {"motions", "--blend", "--output", "--units", "--scale", "--asf"}},
      {"doctor", {"folder", "--report", "--clean", "--strips", "--scale", "--rate", "--up", "--asf", "--all"}},
      {"strip", {"input", "output", "--as"}},
      {"view", {"input", "output", "--body", "--betas"}},
      {"judge",
       {"--model", "--seeds", "--steps", "--sampler", "--guidance", "--backend", "--details", "--smooth", "--fix-feet",
        "--fix-floor", "--overlay-arms", "--compare", "--bench", "--seconds", "--clips", "--captions", "--strips"}},
      {"train",
       {"--data",        "--captions",       "--out",      "--steps",      "--batch",       "--lr",
        "--width",       "--feed-forward",   "--layers",   "--vocabulary", "--dropout",     "--velocity-weight",
        "--text-weight", "--text-steps",     "--start",    "--seed",       "--license",     "--provenance",
        "--commit",      "--save-minutes",   "--fresh",    "--threads",    "--noise-focus", "--root-weight",
        "--foot-weight", "--other-settings", "--recompute"}}};
  for (const auto& [command, names] : options) {
    const auto help = run({command, "--help"}, folder.path);
    CHECK(help.code == 0);
    for (const std::string& name : names) CHECK_MESSAGE(contains(help.text, name), name, " in: ", help.text);
  }
}

TEST_CASE("the subcommands of training are there; an unknown one is reported") {
  const TemporaryFolder folder;  // examples/CMakeLists.txt tests the messages of a program without training
  for (const std::string command :
       {"train-tmr", "train-temos", "train-sinc", "train-teach", "train-tm2t", "train-actor", "train-classifier",
        "train-evaluator", "train-mdm-smpl", "train-mdm", "train-motiondiffuse", "train-mdm-actions", "evaluate"})
    CHECK_MESSAGE(run({command, "--help"}, folder.path).code == 0, command);
  CHECK(contains(run({"dance"}, folder.path).text, "there is no subcommand 'dance'"));
}

TEST_CASE("exit codes") {
  const Workplace w;
  CHECK(w.run({}).code == 2);
  CHECK(w.run({"dance"}).code == 2);
  CHECK(w.run({"generate"}).code == 2);
  CHECK(w.generate("out", {"--sampler", "best"}).code == 2);
  CHECK(w.generate("out", {"--steps", "many"}).code == 2);

  const auto missing = w.run({"generate", "--timeline", "two.txt", "--model", "nowhere.safetensors"});
  CHECK(missing.code == 1);
  CHECK(contains(missing.text, "nowhere.safetensors"));
  const auto steps = w.generate("out", {"--steps", "6"});
  CHECK(steps.code == 2);
  CHECK_MESSAGE(contains(steps.text, "6 steps are asked for, this model has 5"), steps.text);
  CHECK(w.generate("out", {}, "nowhere.txt").code == 1);

  ml::write_file(w / "wrong.txt", "walk # 0 # 1\nw\xC3\xA4lk # 1 # x # legs\n");
  for (const auto& wrong : {w.run({"check", "wrong.txt"}), w.generate("out", {}, "wrong.txt")}) {
    CHECK(wrong.code == 3);
    CHECK_MESSAGE(contains(wrong.text, "[motionlang.timeline.502] wrong.txt:2:12: 'x' is not a time"), wrong.text);
  }
  CHECK(w.files("out").empty());
  const auto no_folder = w.generate("wrong.txt");  // a file
  CHECK(no_folder.code == 1);
  CHECK_MESSAGE(contains(no_folder.text, "[motionlang.io.401] --out wrong.txt: "), no_folder.text);
  const auto action = w.run({"generate", "--action", "walk", "--model", "model.safetensors", "--out", "out"});
  CHECK(action.code == 2);
  CHECK_MESSAGE(contains(action.text, "[motionlang.config.102] --action is for models of actions"), action.text);
  // files are named by the text, in any script
  CHECK(w.run({"generate", "--text", "w\xC3\xA4lk, \xE6\xAD\xA9\xE3\x81\x8F", "--seconds", "1", "--model",
               "model.safetensors", "--out", "named"})
            .code == 0);
  CHECK(w.files("named").contains("w\xC3\xA4lk_\xE6\xAD\xA9\xE3\x81\x8F.bvh"));

  // as a whole too long for the model, but not where the arms cut it, as 'generate' does
  ml::write_file(w / "long.txt", "walk # 0 # 60 # legs\nraise both arms # 25 # 35 # left arm # right arm\n");
  CHECK(w.run({"check", "long.txt", "--model", "model.safetensors"}).code == 0);
  const auto whole = w.run({"check", "long.txt", "--model", "model.safetensors", "--no-cut-texts"});
  CHECK(whole.code == 3);
  CHECK_MESSAGE(contains(whole.text, "[motionlang.timeline.508]"), whole.text);
  CHECK_MESSAGE(contains(whole.text, "(line 1, column 1)"), whole.text);
}

TEST_CASE("options that make no sense are refused before any work, and the message says what is wanted") {
  const Workplace w;
  ml::write_bvh(w / "walk.bvh", synthetic::walk({.frames = 40}));
  const std::vector<std::pair<std::vector<std::string>, std::string>> refused{
      {{"dance"}, "there is no subcommand 'dance'"},
      {{"generate", "--text", ""}, "--text: is empty"},
      {{"generate", "--text", "walk", "--seconds", "nan"}, "--seconds: 'nan' is not a number from 0.05 to 3600"},
      {{"generate", "--text", "walk", "--overlap", "-1"}, "--overlap: '-1' is not 0 or a number above it"},
      {{"generate", "--text", "walk", "--seconds", "1", "--seed", "-1"},
       "--seed: '-1' is not a whole number from 0 to 18446744073709551615"},
      {{"generate", "--text", "walk", "--seconds", "1", "--out", ""}, "--out:"},
      {{"judge", "--seeds", "0"}, "--seeds: '0' is not a number above 0"},
      {{"check", "two.txt", "--fps", "inf"}, "--fps: 'inf' is not a number above 0"},
      {{"convert", "walk.bvh", "out.bvh", "--fps", "nan"}, "--fps: 'nan' is not a number above 0"},
      {{"convert", "walk.bvh", "out.bvh", "--from", "nan"}, "--from: 'nan' is not 0 or a number above it"},
      {{"strip", "walk.bvh", "out.html"}, "out.html ends in '.html', not in '.svg' or '.png'"},
      {{"view", "walk.bvh", "out.bvh"}, "out.bvh ends in '.bvh', not in '.html'"}};
  for (const auto& [arguments, message] : refused) {
    const auto out = w.run(arguments);
    CHECK_MESSAGE(out.code == 2, out.text);
    CHECK_MESSAGE(contains(out.text, message), out.text);
  }
  for (const char* file : {"out.bvh", "out.html"}) CHECK(!std::filesystem::exists(w / file));
  for (const auto& arguments : {std::vector<std::string>{"convert", "walk.bvh", "nowhere/out.bvh"},
                                std::vector<std::string>{"doctor", ".", "--report", "nowhere/out.html"}}) {
    const auto out = w.run(arguments);
    CHECK(out.code == 1);
    CHECK_MESSAGE(contains(out.text, "[motionlang.io.401] " + arguments.back() + ": there is no folder nowhere"),
                  out.text);
  }
}

TEST_CASE("options that say nothing about a file, and results in the place of what is read, are refused") {
  const Workplace w;
  ml::write_bvh(w / "walk.bvh", synthetic::walk({.frames = 40}));
  ml::write_bvh(w / "other.bvh", synthetic::walk({.frames = 40, .turn = 1}));
  ml::write_amass(w / "walk.npz", synthetic::walk({.frames = 40}));
  const std::string before = ml::read_file(w / "walk.bvh");
  const std::vector<std::pair<std::vector<std::string>, std::string>> refused{
      {{"convert", "walk.bvh", "x.glb", "--rate", "60"}, "--rate is for .npy, .amc and .npz files"},
      {{"strip", "walk.npz", "x.svg", "--up", "z"}, "--up is for other files than AMASS"},
      {{"convert", "walk.bvh", "x.glb", "--asf", "two.txt"}, "--asf is for AMC files; walk.bvh is not one"},
      {{"convert", "walk.bvh", "./walk.bvh", "--mirror"}, "./walk.bvh is an input"},
      {{"join", "other.bvh", "walk.bvh", "-o", "walk.bvh"}, "walk.bvh is an input"},
      {{"compose", "walk.bvh", "other.bvh", "--second", "left arm", "-o", "walk.bvh"}, "walk.bvh is an input"},
      {{"doctor", ".", "--report", "walk.bvh"}, "its name ends in .html"},
      {{"search", "two.txt", "walk", "--from", "1"}, "--from requires --like"},
      {{"search", "two.txt", "walk", "--overlap", "0.5"}, "--overlap requires --moments"}};
  for (const auto& [arguments, message] : refused) {
    const auto out = w.run(arguments);
    CHECK_MESSAGE((out.code == 2 && contains(out.text, "[motionlang.config.10") != contains(out.text, "requires")),
                  out.text);
    CHECK_MESSAGE(contains(out.text, message), out.text);
  }
  CHECK(ml::read_file(w / "walk.bvh") == before);
}

TEST_CASE("a folder for results that cannot be made is refused before anything is read") {
  const Workplace w;
  ml::write_bvh(w / "walk.bvh", synthetic::walk({.frames = 40}));
  ml::write_file(w / "no_table.tsv", "nothing that could be read\n");
  for (const auto& arguments :
       {std::vector<std::string>{"doctor", ".", "--clean", "two.txt"},
        std::vector<std::string>{"train", "--data", ".", "--captions", "no_table.tsv", "--out", "two.txt"},
        std::vector<std::string>{"train", "--data", ".", "--captions", "no_table.tsv", "--out", "two.txt/run"}}) {
    const auto out = w.run(arguments);
    CHECK(out.code == 1);
    const std::string option = arguments[arguments.size() - 2];
    CHECK_MESSAGE(contains(out.text, "[motionlang.io.401] " + option + " " + arguments.back() + ": "), out.text);
  }
  CHECK(ml::read_file(w / "two.txt") == timeline_text);
}

TEST_CASE("a run that fails leaves no empty folder, and takes none away") {
  const Workplace w;
  const auto fails = [&](const std::string& out) {
    CHECK(w.run({"generate", "--model", "none.safetensors", "--text", "walk", "--out", out}).code == 1);
  };
  fails("new/folder/");
  fails("new/" + std::string(300, 'a'));  // longer than a name can be
  CHECK(!std::filesystem::exists(w / "new"));
  std::filesystem::create_directories(w / "mine");
  fails("mine/../mine/new");
  CHECK(std::filesystem::is_empty(w / "mine"));
  fails("mine");
  CHECK(std::filesystem::exists(w / "mine"));
}

TEST_CASE("standard output that cannot be written is an error") {
  if (!std::filesystem::exists("/dev/full")) return;
  const Workplace w;
  const std::string two = (w / "two.txt").string(), told = (w / "told.txt").string();
  const int status =
      std::system(("'" MOTIONLANG_PROGRAM "' check '" + two + "' > /dev/full 2> '" + told + "'").c_str());
  CHECK(WEXITSTATUS(status) == 1);
  CHECK(ml::read_file(told) == "[motionlang.io.401] standard output cannot be written\n");
}
