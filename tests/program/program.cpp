// The motionlang program: help, exit codes, files that it writes, noise from outside, Ctrl-C.
#include <doctest/doctest.h>
#include <sys/wait.h>  // WEXITSTATUS

#include <algorithm>

#include <motionlang/backend/eigen.hpp>
#include <motionlang/datasets/annotations.hpp>
#include <motionlang/datasets/humanml3d_folder.hpp>
#include <motionlang/features/motion_features.hpp>
#include <motionlang/file/id_list.hpp>
#include <motionlang/formats/amass.hpp>
#include <motionlang/formats/glb_reader.hpp>
#include <motionlang/formats/glb_writer.hpp>
#include <motionlang/formats/motion_npy.hpp>
#include <motionlang/kinematics/blend.hpp>
#include <motionlang/kinematics/foot_lock.hpp>
#include <motionlang/kinematics/motion_tools.hpp>
#include <motionlang/kinematics/smooth_motion.hpp>

#include "../../examples/motionlang/training_commands.hpp"
#include "../support/captioned_clips.hpp"
#include "../support/mdm_results.hpp"
#include "../support/octahedra_body.hpp"
#include "../support/rigs.hpp"
#include "../support/small_model.hpp"
#include "process.hpp"

namespace ml = motionlang;
using B = ml::EigenBackend<float>;

namespace {

constexpr const char* timeline_text =
    "walk forward # 0 # 1 # legs\n"
    "raise both arms # 0.2 # 0.8 # left arm # right arm\n";

/// A folder with a small model and a timeline of 20 frames.
struct Workplace : TemporaryFolder {
  explicit Workplace(ml::Index diffusion_steps = 5) {
    const auto config = small::config(diffusion_steps);
    ml::save_stmc(*this / "model.safetensors", small::model<B>(config), config, {{"license", "MIT"}});
    ml::write_file(*this / "two.txt", timeline_text);
  }
  Outcome run(const std::vector<std::string>& arguments, const std::string& interrupt_at = "",
              const std::string& input = "/dev/null") const {
    return ::run(arguments, path, interrupt_at, input);
  }
  Outcome generate(const std::string& out, std::vector<std::string> more = {}, const std::string& timeline = "two.txt",
                   const std::string& interrupt_at = "") const {
    more.insert(more.begin(), {"generate", "--timeline", timeline, "--model", "model.safetensors", "--out", out});
    return run(more, interrupt_at);
  }
  /// Names of the files in a folder, and their contents.
  std::map<std::string, std::string> files(const std::string& folder) const {
    std::map<std::string, std::string> out;
    if (!std::filesystem::exists(*this / folder)) return out;
    for (const auto& f : std::filesystem::directory_iterator(*this / folder))
      out[f.path().filename().string()] = ml::read_file(f.path());
    return out;
  }
};

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

}  // namespace

TEST_CASE("help names every command and option, and the exit codes") {
  const TemporaryFolder folder;
  const auto all = run({"--help"}, folder.path);
  CHECK(all.code == 0);
  for (const char* word : {"generate", "check", "info", "train", "judge", "convert", "compose", "join", "doctor",
                           "strip", "view", "describe", "Exit codes: 0 ", "1 ", "2 ", "3 ", "130 "})
    CHECK_MESSAGE(contains(all.text, word), word);
  const std::map<std::string, std::vector<std::string>> options{
      {"generate", {"--timeline",  "--model",   "--out",         "--seed",    "--steps",           "--sampler",
                    "--guidance",  "--overlap", "--noise",       "--rig",     "--drop-animations", "--in-turn",
                    "--cut-texts", "--smooth",  "--fix-feet",    "--backend", "--threads",         "--preset",
                    "--record",    "--reuse",   "--keep-beyond", "--keep",    "--keep-seconds",    "--keep-parts",
                    "--samples",   "--towards"}},
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
        "--compare"}},
      {"train",
       {"--data",        "--captions",       "--out",      "--steps",      "--batch",       "--lr",
        "--width",       "--feed-forward",   "--layers",   "--vocabulary", "--dropout",     "--velocity-weight",
        "--text-weight", "--text-steps",     "--denoiser", "--seed",       "--license",     "--provenance",
        "--commit",      "--save-minutes",   "--fresh",    "--threads",    "--noise-focus", "--root-weight",
        "--foot-weight", "--other-settings", "--recompute"}}};
  for (const auto& [command, names] : options) {
    const auto help = run({command, "--help"}, folder.path);
    CHECK(help.code == 0);
    for (const std::string& name : names) CHECK_MESSAGE(contains(help.text, name), name, " in: ", help.text);
  }
}

TEST_CASE("a subcommand of a build with training is reported with the command that makes one") {
  const TemporaryFolder folder;
  CHECK(program::no_subcommand("dance") == "there is no subcommand 'dance'");
  for (const std::string_view name : program::training_commands) {
    const std::string command(name), text = program::no_subcommand(command);
    CHECK_MESSAGE(contains(text, "'" + command + "' needs a program that is built with training"), text);
    CHECK_MESSAGE(contains(text, "cmake --preset release -DMOTIONLANG_TRAINING=ON && cmake --build build/release"),
                  text);
    CHECK_MESSAGE(run({command, "--help"}, folder.path).code == 0, command);  // tests are built with training
  }
  CHECK_MESSAGE(contains(run({"dance"}, folder.path).text, "there is no subcommand 'dance'"), "dance");
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
  const std::string before = ml::read_file(w / "walk.bvh");
  const std::vector<std::pair<std::vector<std::string>, std::string>> refused{
      {{"convert", "walk.bvh", "x.glb", "--rate", "60"}, "--rate is for .npy, .amc and .npz files"},
      {{"strip", "walk.bvh", "x.svg", "--up", "z"}, "--up is for .npy files"},
      {{"convert", "walk.bvh", "x.glb", "--asf", "two.txt"}, "--asf is for AMC files; walk.bvh is not one"},
      {{"convert", "walk.bvh", "./walk.bvh", "--mirror"}, "./walk.bvh is what is read"},
      {{"join", "other.bvh", "walk.bvh", "-o", "walk.bvh"}, "walk.bvh is what is read"},
      {{"compose", "walk.bvh", "other.bvh", "--second", "left arm", "-o", "walk.bvh"}, "walk.bvh is what is read"},
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

TEST_CASE("convert says what is strange about a motion: a T-pose in front, a doll") {
  const Workplace w;
  const ml::Motion walk = synthetic::walk({.frames = 40});
  ml::Motion pose = ml::crop(walk, 0, 1);
  std::fill(pose.local.begin(), pose.local.end(), ml::Quaternion<double>::identity());
  ml::write_bvh(w / "posed.bvh", ml::concatenate(pose, walk));
  const auto posed = w.run({"convert", "posed.bvh", "x.glb"});
  CHECK_MESSAGE(
      contains(posed.text, "posed.bvh: begins with 1 frame of a T-pose that was put in front; --from 0.05 leaves"),
      posed.text);
  CHECK(!contains(w.run({"convert", "posed.bvh", "x.bvh", "--from", "0.05"}).text, "T-pose"));
  CHECK(!contains(w.run({"convert", "x.bvh", "x.glb"}).text, "T-pose"));
  CHECK(!contains(w.run({"convert", "x.bvh", "x.glb"}).text, " large"));
  const auto doll = w.run({"convert", "x.bvh", "x.glb", "--scale", "0.001"});
  CHECK_MESSAGE((doll.code == 0 && contains(doll.text, "x.bvh: the figure is 0.1")), doll.text);
}

TEST_CASE("a long text is made in parts, and the program says so") {
  const Workplace w;
  const auto text = [&](const std::vector<std::string>& more) {
    std::vector<std::string> all{"generate",          "--text", "walk", "--seconds",   "17",           "--model",
                                 "model.safetensors", "--out",  "long", "--no-smooth", "--no-fix-feet"};
    all.insert(all.end(), more.begin(), more.end());
    const auto out = w.run(all);
    REQUIRE_MESSAGE(out.code == 0, out.text);
    return std::pair(out.text, ml::read_file(w / "long/walk.bvh"));
  };
  const auto [told, parts] = text({});
  CHECK_MESSAGE(contains(told, "'walk': 17 s are made in parts of at most 8 s"), told);
  const auto [untold, whole] = text({"--no-cut-texts"});
  CHECK(!contains(untold, "in parts"));
  CHECK(parts != whole);
  ml::write_file(w / "parts.txt", "walk # 0 # 5.65\nwalk # 5.65 # 11.3\nwalk # 11.3 # 17\n");
  REQUIRE(w.run({"generate", "--timeline", "parts.txt", "--model", "model.safetensors", "--out", "long", "--no-smooth",
                 "--no-fix-feet"})
              .code == 0);
  CHECK(ml::read_file(w / "long/parts.bvh") == parts);
  CHECK(contains(w.run({"check", "parts.txt"}).text, "3 texts\n"));
  ml::write_file(w / "whole.txt", "walk # 0 # 17\n");
  CHECK(contains(w.run({"check", "whole.txt"}).text, "1 text cut into 3"));
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

TEST_CASE("check and info show what a file holds") {
  const Workplace w;
  const auto check = w.run({"check", "two.txt"});
  CHECK(check.code == 0);
  for (const char* word : {"20 frames", "walk forward", "left arm, right arm", "two.txt is a valid timeline file"})
    CHECK_MESSAGE(contains(check.text, word), word, " in ", check.text);
  const auto model = w.run({"info", "model.safetensors"});
  CHECK(model.code == 0);
  for (const char* word : {"60 tensors", "license", "denoiser.registers", "F16", "(2, 32)"})
    CHECK_MESSAGE(contains(model.text, word), word, " in ", model.text);
  CHECK(contains(w.run({"info", "two.txt"}).text, "2 texts, 1.00 s"));
  ml::write_file(w / "pieces.txt",
                 "walk # 0 # 6 # legs\nraise both arms # 2 # 4 # left arm # right arm\n\nrun # 0 # 2\n");
  const auto pieces = w.run({"check", "pieces.txt"});
  for (const char* line :
       {"timeline 0: 120 frames, 6.00 s, 2 texts cut into 4\n", "timeline 1: 40 frames, 2.00 s, 1 text\n"})
    CHECK_MESSAGE(contains(pieces.text, line), pieces.text);
  CHECK(!contains(pieces.text, "moves nothing"));
  ml::write_file(w / "odd.txt", "walk \x1b[31mred # 0 # 2\n");  // what a terminal would obey
  for (const char* command : {"check", "info"}) {
    const auto odd = w.run({command, "odd.txt"});
    CHECK_MESSAGE((contains(odd.text, "walk ?[31mred") && !contains(odd.text, "\x1b")), odd.text);
  }
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

TEST_CASE("a text that others hide at all times is reported with its line") {
  const Workplace w;
  ml::write_file(w / "hidden.txt", "walk # 0 # 3 # legs\nrun # 1 # 2 # legs\nhop # 1 # 2 # legs\n");
  for (const auto& out : {w.run({"check", "hidden.txt"}), w.run({"check", "hidden.txt", "--no-cut-texts"}),
                          w.generate("out", {}, "hidden.txt")}) {
    CHECK(out.code == 0);
    CHECK_MESSAGE(contains(out.text, "hidden.txt:2:1: 'run' moves nothing: other texts take all its body parts\n"),
                  out.text);
    CHECK_MESSAGE(!contains(out.text, "'hop' moves nothing"), out.text);
  }
}

TEST_CASE("a text of one arm that takes the whole body from another is reported with its line") {
  const Workplace w;
  ml::write_file(w / "arm.txt", "walk # 0 # 3\nwave with the right hand # 1 # 2\n");
  for (const auto& out : {w.run({"check", "arm.txt"}), w.generate("out", {}, "arm.txt")}) {
    CHECK(out.code == 0);
    CHECK_MESSAGE(contains(out.text,
                           "arm.txt:2:1: 'wave with the right hand' moves the whole body, also while 'walk' lasts; "
                           "with '# right arm' it would leave that the rest\n"),
                  out.text);
  }
  ml::write_file(w / "arm.txt", "walk # 0 # 3\nwave with the right hand # 1 # 2 # right arm\nrun # 2.5 # 4\n");
  CHECK(!contains(w.run({"check", "arm.txt"}).text, "moves the whole body"));
}

TEST_CASE("the actions of a sentence one after the other") {
  const Workplace w;
  ml::write_file(w / "long.txt", "walk, then turn # 0 # 2\n");
  const auto check = w.run({"check", "long.txt", "--in-turn"});
  for (const char* line :
       {"'walk, then turn': 2 s for 'walk', then 'turn'\n", "  0.00 -   1.00 s  walk ", "  1.00 -   2.00 s  turn "})
    CHECK_MESSAGE(contains(check.text, line), check.text);
  const auto text = [&](const char* out, std::initializer_list<std::string> options) {
    std::vector<std::string> all{"generate", "--model", "model.safetensors", "--text", "walk; walk", "--seconds", "2",
                                 "--out",    out};
    all.insert(all.end(), options);
    return w.run(all);
  };
  CHECK(text("turns", {"--in-turn"}).code == 0);
  CHECK(text("one", {}).code == 0);
  CHECK(ml::read_file(w / "turns" / "walk_walk.bvh") != ml::read_file(w / "one" / "walk_walk.bvh"));
  ml::write_file(w / "turns.txt", "walk # 0 # 1\nwalk # 1 # 2\n");
  CHECK(w.run({"generate", "--model", "model.safetensors", "--timeline", "turns.txt", "--out", "lines"}).code == 0);
  CHECK(ml::read_file(w / "turns" / "walk_walk.bvh") == ml::read_file(w / "lines" / "turns.bvh"));
}

TEST_CASE("what a model of ours does not take is refused") {
  const Workplace w;
  const auto bytes = w.run({"generate", "--model", "model.safetensors", "--text", "walk \xFF", "--seconds", "1"});
  CHECK(bytes.code == 2);
  CHECK_MESSAGE(contains(bytes.text, "is not UTF-8"), bytes.text);
  const auto sources =
      w.run({"generate", "--model", "model.safetensors", "--text", "walk", "--seconds", "1", "--statistics", "."});
  CHECK(sources.code == 2);
  CHECK_MESSAGE(
      contains(
          sources.text,
          "[motionlang.config.102] model.safetensors: --text-encoder, --statistics and --tokenizer are for published"),
      sources.text);
  CHECK(w.run({"generate", "--model", "model.safetensors", "--text", "walk", "--drop-animations"}).code == 2);
}

TEST_CASE("a text of the same parts that begins before another ends takes over") {
  const Workplace w;
  ml::write_file(w / "overlap.txt", "walk # 0 # 0.6\nrun # 0.4 # 1\n");
  for (const auto& out : {w.run({"check", "overlap.txt"}), w.run({"check", "overlap.txt", "--no-cut-texts"}),
                          w.generate("out", {}, "overlap.txt")})
    CHECK_MESSAGE(out.code == 0, out.text);
  const auto check = w.run({"check", "overlap.txt"});
  CHECK_MESSAGE(contains(check.text, "legs       [0.00-0.40 walk] [0.40-1.00 run]\n"), check.text);
}

TEST_CASE("an array of positions is written on SMPL's joints, in whatever order the motion has them") {
  const Workplace w;
  const ml::Motion walk = synthetic::walk({.frames = 10});
  ml::write_bvh(w / "deep.bvh", walk);  // depth first
  REQUIRE(w.run({"convert", "deep.bvh", "deep.npy"}).code == 0);
  const auto found = ml::read_joints_npy(w / "deep.npy").positions, wanted = walk.positions();
  REQUIRE(found.size() == wanted.size());
  for (std::size_t i = 0; i < wanted.size(); ++i) CHECK(ml::norm(found[i] - wanted[i]) < 1e-5);
}

TEST_CASE("info --features: ranges, meanings, units and body parts") {
  const TemporaryFolder folder;
  const auto info = [&](const std::string& name) { return run({"info", "--features", name}, folder.path); };
  const auto guo = info("guoh3d");
  CHECK(guo.code == 0);
  for (const char* line : {"guoh3d: 263 numbers in a frame, 20 frames per second, skeleton of 24 joints\n",
                           "  0        rad/frame    half the turn of the heading to the next frame\n",
                           "  3        m            height of the root above the floor\n",
                           "  4-66     m            each of joints 1-21: position",
                           "  193-258  m/frame      each of joints 0-21: velocity to the next frame",
                           "  head       37-39, 46-48, 133-138, 151-156, 229-231, 238-240\n",  // stmc.md 2
                           "   15 head                     neck\n"})
    CHECK_MESSAGE(contains(guo.text, line), line, " in ", guo.text);
  const auto actor = info("actor");
  CHECK_MESSAGE(contains(actor.text, "  0-5      1            joint 0: rotation in the world"), actor.text);

  const auto list = info("list");
  CHECK(list.code == 0);
  for (const ml::MotionFeatures& f : ml::all_motion_features)
    CHECK_MESSAGE(contains(list.text, std::string(f.name) + ": " + std::to_string(f.width) + " numbers"), list.text);
  const auto unknown = info("guo");
  CHECK(unknown.code == 2);
  CHECK_MESSAGE(contains(unknown.text, "--features: guo not in {guoh3d,kit,rifke"), unknown.text);
  ml::write_file(folder / "two.txt", timeline_text);
  const std::vector<std::string> nothing{"info"}, both{"info", "two.txt", "--features", "kit"};
  for (const auto& wrong : {nothing, both}) {
    const auto out = run(wrong, folder.path);
    CHECK(out.code == 2);
    CHECK_MESSAGE(contains(out.text, "xactly 1 option"), out.text);
  }
}

TEST_CASE("a timeline from standard input is read as one of a file") {
  const Workplace w;
  const auto told = [](const Outcome& o, const std::string& source) {
    CHECK_MESSAGE(o.code == 0, o.text);
    CHECK_MESSAGE(contains(o.text, source), o.text);
    return o.text.substr(0, o.text.find(source));
  };
  CHECK(told(w.run({"check", "-"}, "", "two.txt"), "standard input is a valid timeline file") ==
        told(w.run({"check", "two.txt"}), "two.txt is a valid timeline file"));
  CHECK(told(w.run({"info", "-"}, "", "two.txt"), "raise both arms") ==
        told(w.run({"info", "two.txt"}), "raise both arms"));
  told(w.generate("of_file"), "two.html");
  told(w.run({"generate", "--timeline", "-", "--model", "model.safetensors", "--out", "of_input"}, "", "two.txt"),
       "timeline.html");
  CHECK(w.files("of_input").at("timeline.bvh") == w.files("of_file").at("two.bvh"));

  ml::write_file(w / "wrong.txt", "walk # 0 # 1\nwalk # 1 # x # legs\n");
  const auto wrong = w.run({"check", "-"}, "", "wrong.txt");
  CHECK(wrong.code == 3);
  CHECK_MESSAGE(contains(wrong.text, "[motionlang.timeline.502] standard input:2:12: 'x' is not a time"), wrong.text);
  for (const char* command : {"generate", "check", "info"})
    CHECK_MESSAGE(contains(w.run({command, "--help"}).text, "standard input"), command);
}

TEST_CASE("words that the model never learned are reported, if its weights list those that it learned") {
  const Workplace w;
  CHECK(!contains(w.generate("no_list").text, "never learned"));
  const auto config = small::config(5);
  ml::save_stmc(w / "listed.safetensors", small::model<B>(config), config,
                {{"text.words", "arms\nboth\nforward\nperson\nraise\nwalk"}});
  const auto told = [&](std::vector<std::string> what) {
    what.insert(what.begin(), {"generate", "--model", "listed.safetensors", "--out", "listed"});
    const auto out = w.run(what);
    CHECK_MESSAGE(out.code == 0, out.text);
    return out.text;
  };
  CHECK(!contains(told({"--timeline", "two.txt"}), "the model"));
  CHECK(contains(told({"--text", "Walk forwad", "--seconds", "1"}),
                 "'Walk forwad': the model never learned the word 'forwad' (did you mean 'forward'?)\n"));
  CHECK(contains(told({"--text", "\xD0\xB8\xD0\xB4\xD0\xB8", "--seconds", "1"}), "the model reads no word of it"));
  const std::string mixed = told({"--text", "walk \xC3\xA9t\xC3\xA9 \xE2\x80\x94 forward", "--seconds", "1"});
  CHECK_MESSAGE(contains(mixed, "forward': the model reads a-z and 0-9, not all of '\xC3\xA9t\xC3\xA9'\n"), mixed);
  std::string longer = "walk";
  for (int i = 0; i < 70; ++i) longer += " walk";
  const std::string cut = told({"--text", longer, "--seconds", "1"});
  CHECK_MESSAGE(contains(cut, "walk': the model reads the first "), cut);
  ml::write_file(w / "three.txt", "walk # 0 # 1 # legs\nwave # 0 # 1 # left arm\n\nwave, wave a flag # 0 # 1\n");
  const std::string lines = told({"--timeline", "three.txt"});
  CHECK_MESSAGE(contains(lines, "'wave': the model never learned the word 'wave'\n"), lines);
  CHECK_MESSAGE(contains(lines, "'wave, wave a flag': the model never learned the words 'wave', 'a', 'flag'\n"), lines);
}

TEST_CASE("weights are stored in another type; what the file says of the model stays") {
  const Workplace w;
  CHECK(w.run({"convert", "model.safetensors", "wide.safetensors", "--store", "F32"}).code == 0);
  const auto half = w.run({"convert", "wide.safetensors", "half.safetensors", "--store", "bf16"});
  CHECK_MESSAGE(half.code == 0, half.text);
  CHECK(contains(half.text, "60 tensors"));
  const auto about = w.run({"info", "half.safetensors"});
  for (const char* word : {"BF16", "license", "MIT"})
    CHECK_MESSAGE(contains(about.text, word), word, " in ", about.text);
  const auto size = [&](const char* file) { return std::filesystem::file_size(w / file); };
  CHECK(size("wide.safetensors") > 3 * size("half.safetensors") / 2);
  CHECK(ml::load_stmc<B>((w / "half.safetensors").string()).fps ==
        ml::load_stmc<B>((w / "model.safetensors").string()).fps);
  const auto motion = w.run({"convert", "model.safetensors", "motion.bvh", "--store", "F16"});
  CHECK(motion.code != 0);
  CHECK_MESSAGE(contains(motion.text, "--store: is for weights"), motion.text);
  CHECK(contains(w.run({"convert", "model.safetensors", "m.safetensors", "--mirror"}).text,
                 "--mirror: is not for weights"));
}

TEST_CASE("weights may ask for a sampler and a number of steps; the command line goes first") {
  const Workplace w;
  auto made = [&](const std::string& out, const std::vector<std::string>& more) {
    const auto done = w.generate(out, more);
    REQUIRE_MESSAGE(done.code == 0, done.text);
    return w.files(out).at("two.bvh");
  };
  const auto full = made("full", {}), ddim = made("ddim", {"--sampler", "ddim", "--steps", "3"});
  auto config = small::config(5);
  config.sampler = ml::SamplingOptions::Sampler::ddim, config.sampling_steps = 3;
  ml::save_stmc(w / "model.safetensors", small::model<B>(config), config, {{"license", "MIT"}});
  CHECK(made("asked", {}) == ddim);
  CHECK(made("asked-full", {"--preset", "full"}) == full);
  CHECK(made("asked-steps", {"--steps", "5"}) == made("full-ddim", {"--sampler", "ddim", "--steps", "0"}));
  CHECK(made("asked-sampler", {"--sampler", "ddpm"}) == made("other", {"--sampler", "ddpm", "--steps", "3"}));
}

TEST_CASE("generate writes every output, and the same bytes for the same seed") {
  const Workplace w;
  const auto first = w.generate("a", {"--seed", "4", "--threads", "1"});
  REQUIRE_MESSAGE(first.code == 0, first.text);
  const auto a = w.files("a");
  for (const char* extension : {".bvh", ".glb", ".npz", ".npy", ".svg", ".html"})
    CHECK_MESSAGE(a.contains(std::string("two") + extension), extension);
  CHECK(a.size() == 6);
  CHECK(ml::read_bvh_motion(w / "a/two.bvh").frames() == 20);
  for (const char* command : {"view", "strip"}) CHECK(w.run({command, "a/two.bvh"}).code == 0);
  for (const char* file : {"a/two.bvh.html", "a/two.bvh.svg"}) CHECK_MESSAGE(std::filesystem::remove(w / file), file);
  CHECK(w.files("a") == a);  // the page and the strip with the tracks as well
  CHECK(w.run({"info", "a/two.glb"}).code == 0);
  CHECK(contains(w.run({"info", "a/two.npz"}).text, "20 frames"));
  const auto joints = w.run({"info", "a/two.npy"});
  CHECK_MESSAGE(
      contains(joints.text,
               "joint positions, 20 frames of 24 joints\n  read as Z up and turned to Y up, joints are within x "),
      joints.text);

  CHECK(w.generate("b", {"--seed", "4", "--threads", "2"}).code == 0);
  CHECK(w.files("b") == a);
  CHECK(w.generate("c", {"--seed", "5"}).code == 0);
  CHECK(w.files("c").at("two.bvh") != a.at("two.bvh"));
  for (const char* backend : {"xtensor", "reference"}) {
    CHECK(w.generate(backend, {"--seed", "4", "--backend", backend}).code == 0);
    const auto same = ml::read_bvh_motion(w / (std::string(backend) + "/two.bvh"));
    CHECK(synthetic::largest_distance(same, ml::read_bvh_motion(w / "a/two.bvh")) < 1e-3);
  }
}

TEST_CASE("several timelines and plain texts: a motion each, one page") {
  const Workplace w;
  ml::write_file(w / "list.txt", "walk forward # 0.5\nsit down # 0.4\n");
  const auto out =
      w.generate("out", {"--sampler", "ddim", "--steps", "2", "--guidance", "1", "--overlap", "0"}, "list.txt");
  REQUIRE_MESSAGE(out.code == 0, out.text);
  const auto files = w.files("out");
  CHECK(files.size() == 11);
  CHECK(files.contains("list_0.bvh"));
  CHECK(files.contains("list_1.glb"));
  CHECK(files.contains("list.html"));
}

TEST_CASE("generate --samples: different motions, of which the first is the one without samples; one page") {
  const Workplace w;
  REQUIRE(w.generate("one", {"--seed", "4"}).code == 0);
  const auto made = w.generate("three", {"--seed", "4", "--samples", "3"});
  REQUIRE_MESSAGE(made.code == 0, made.text);
  const auto files = w.files("three");
  CHECK(files.size() == 3 * 5 + 1);
  for (const char* file : {"two_1.bvh", "two_2.glb", "two_3.svg", "two_3.npz", "two.html"})
    CHECK_MESSAGE(files.contains(file), file);
  for (const char* name : {"\"two_1\"", "\"two_2\"", "\"two_3\""})
    CHECK_MESSAGE(contains(files.at("two.html"), name), name);
  const auto sample = [&](const std::string& file) { return ml::read_bvh_motion(w / file); };
  CHECK(synthetic::largest_distance(sample("three/two_1.bvh"), sample("one/two.bvh")) < 1e-3);
  CHECK(synthetic::largest_distance(sample("three/two_1.bvh"), sample("three/two_2.bvh")) > 1e-3);
  CHECK(synthetic::largest_distance(sample("three/two_2.bvh"), sample("three/two_3.bvh")) > 1e-3);

  ml::write_file(w / "list.txt", "walk forward # 0.5\nsit down # 0.4\n");
  REQUIRE(w.generate("list", {}, "list.txt").code == 0);
  REQUIRE(w.generate("lists", {"--samples", "2"}, "list.txt").code == 0);
  CHECK(w.files("lists").size() == 4 * 5 + 1);
  for (const std::string timeline : {"list_0", "list_1"}) {
    const auto alone = sample("list/" + timeline + ".bvh"), first = sample("lists/" + timeline + "_1.bvh"),
               second = sample("lists/" + timeline + "_2.bvh");
    CHECK(synthetic::largest_distance(first, alone) < 1e-3);
    CHECK(second.frames() == first.frames());
    CHECK(synthetic::largest_distance(second, first) > 1e-3);
  }
  CHECK(w.generate("none", {"--samples", "0"}).code == 2);
}

TEST_CASE("generate does not write over what it keeps") {
  const Workplace w;
  std::filesystem::create_directories(w / "out");
  ml::write_bvh(w / "out/two.bvh", synthetic::walk({.frames = 40}));
  const std::string before = ml::read_file(w / "out/two.bvh");
  const Outcome over = w.generate("out", {"--keep", "out/two.bvh", "--keep-parts", "legs"});
  CHECK(over.code == 2);
  CHECK_MESSAGE(contains(over.text, "out/two.bvh is what is read"), over.text);
  CHECK(ml::read_file(w / "out/two.bvh") == before);
}

TEST_CASE("generate --keep: frames and body parts of a motion stay, in their place") {
  const Workplace w;
  ml::write_bvh(w / "walk.bvh", synthetic::walk({.frames = 40, .turn = 0.5}));
  const auto walk = ml::read_bvh_motion(w / "walk.bvh");
  const std::vector<std::string> as_made{"--keep", "walk.bvh", "--no-smooth", "--no-fix-feet"};
  const auto keeping = [&](const std::string& out, std::vector<std::string> what) {
    what.insert(what.end(), as_made.begin(), as_made.end());
    const Outcome made = w.generate(out, what);
    REQUIRE_MESSAGE(made.code == 0, made.text);
    return ml::read_bvh_motion(w / (out + "/two.bvh"));
  };
  const auto turn = [&](const ml::Motion& m, ml::Index frame, const char* joint) {
    return ml::distance(m.rotations(frame)[static_cast<std::size_t>(m.skeleton[joint])],
                        walk.rotations(frame)[static_cast<std::size_t>(walk.skeleton[joint])]);
  };
  const ml::Motion begun = keeping("begun", {"--keep-seconds", "0-0.25,0.8-1"}),
                   steps = keeping("steps", {"--keep-parts", "legs"});
  REQUIRE((begun.frames() == 20 && steps.frames() == 20));
  for (const ml::Index f : {0, 4, 10, 17}) {
    CAPTURE(f);
    const bool kept = f != 10;
    for (const char* joint : {"left_knee", "right_shoulder", "spine3"}) CHECK((turn(begun, f, joint) < 1e-3) == kept);
    CHECK(turn(steps, f, "left_knee") < 1e-3);
    CHECK(turn(steps, f, "right_shoulder") > 1e-2);
    const auto apart = steps.root_at(f) - walk.root_at(f);
    CHECK(std::hypot(apart.x, apart.z) < 1e-3);
  }
  // in whatever order, with spaces
  CHECK(synthetic::largest_distance(keeping("again", {"--keep-seconds", "0.8-1, 0-0.25"}), begun) < 1e-3);
  // a T-pose that was put in front is no part of it
  ml::Motion pose = ml::crop(walk, 0, 1);
  std::fill(pose.local.begin(), pose.local.end(), ml::Quaternion<double>::identity());
  ml::write_bvh(w / "exported.bvh", ml::concatenate(pose, walk));
  const Outcome performed = w.generate(
      "performed", {"--keep", "exported.bvh", "--keep-seconds", "0-0.25,0.8-1", "--no-smooth", "--no-fix-feet"});
  CHECK_MESSAGE(contains(performed.text, "exported.bvh: left out is 1 frame of an inserted T-pose"), performed.text);
  CHECK(synthetic::largest_distance(ml::read_bvh_motion(w / "performed/two.bvh"), begun) < 1e-3);
  // the way comes to another place, and the program says so
  const auto apart = begun.root_at(16) - walk.root_at(16);
  REQUIRE(std::hypot(apart.x, apart.z) > 0.1);
  CHECK_MESSAGE(contains(performed.text, "--keep: kept frames are up to "), performed.text);
  // what is made goes on where what is kept ends, and comes to where it begins again
  REQUIRE(w.generate("fitted", {"--keep", "walk.bvh", "--keep-seconds", "0-0.25,0.8-1", "--no-fix-feet"}).code == 0);
  const ml::Motion fitted = ml::read_bvh_motion(w / "fitted/two.bvh");
  const auto largest_step = [](const ml::Motion& m, ml::Index frame) {
    double out = 0;
    for (std::size_t j = 1; j < m.rotations(frame).size(); ++j)
      out = std::max(out, ml::distance(m.rotations(frame - 1)[j], m.rotations(frame)[j]));
    return out;
  };
  for (const ml::Index f : {5, 16}) CHECK(largest_step(fitted, f) < 0.7 * largest_step(begun, f));
  // how far kept frames are from where they were is measured when feet are fixed, at the farthest of them
  const Outcome steady = w.generate("steady", {"--keep", "walk.bvh", "--keep-seconds", "0-0.25,0.8-1"});
  const ml::Motion fixed = ml::read_bvh_motion(w / "steady/two.bvh");
  double farthest = 0;
  for (const ml::Index f : {0, 1, 2, 3, 4, 16, 17, 18, 19}) {
    const auto d = fixed.root_at(f) - walk.root_at(f);
    farthest = std::max(farthest, std::hypot(d.x, d.z));
  }
  const auto said_of = [](const Outcome& out) {
    const std::string up_to = "kept frames are up to ";
    REQUIRE_MESSAGE(contains(out.text, up_to), out.text);
    return std::stod(out.text.substr(out.text.find(up_to) + up_to.size()));
  };
  CHECK((said_of(steady) > farthest - 1e-4 && said_of(steady) < farthest + 0.011));
  CHECK(std::abs(said_of(performed) - said_of(steady)) > 0.02);  // as it was before feet were fixed
  CHECK(turn(begun, 0, "pelvis") < 1e-3);
  CHECK(std::hypot(begun.root_at(4).x - walk.root_at(4).x, begun.root_at(4).z - walk.root_at(4).z) < 1e-3);

  const auto refused = [&](const std::vector<std::string>& what, const char* text) {
    auto all = what;
    all.insert(all.end(), {"--keep", "walk.bvh"});
    const Outcome o = w.generate("no", all);
    CHECK_MESSAGE((o.code == 2 && contains(o.text, text)), o.text);
  };
  refused({}, "say what is kept: --keep-seconds or --keep-parts");
  refused({"--keep-parts", "tail"}, "--keep-parts: 'tail' is not one of left arm");
  refused({"--keep-seconds", "3-1"}, "'3-1' is no stretch of time like 0-1.5");
  for (const char* none : {"-1", "-1-1", "1-", "1", "-", "nan-1", "0-inf", "0-1x"})
    refused({std::string("--keep-seconds=") + none}, "is no stretch of time like 0-1.5");
  refused({"--keep-seconds", "0-1.5"},
          "0-1.5 is frames 0:30 at 20 per second; the motion to keep has 40, the timeline 20");
  refused({"--keep-seconds", "0.5-0.51"}, "0.5-0.51 is frames 10:10 at 20 per second");
  refused({"--keep-parts", "legs", "--record"}, "--record");
}

TEST_CASE("a diffusion model has no latents: it does not go from text to text, and does not denoise a motion") {
  const Workplace w;
  const std::string is =
      " is for models with one latent for every motion (ACTOR, TEMOS, TMR, SINC); this is a diffusion model";
  const auto towards = w.run({"generate", "--text", "walk", "--towards", "run", "--model", "model.safetensors"});
  CHECK(towards.code == 2);
  CHECK_MESSAGE(contains(towards.text, "[motionlang.config.102] model.safetensors: --towards" + is), towards.text);
  CHECK(w.generate("out", {"--towards", "run"}).code == 2);
  CHECK(w.files("out").empty());

  ml::write_bvh(w / "walk.bvh", synthetic::walk({.frames = 40}));
  const auto denoise = w.run({"convert", "walk.bvh", "clean.bvh", "--denoise", "model.safetensors"});
  CHECK(denoise.code == 2);
  CHECK_MESSAGE(contains(denoise.text, "[motionlang.config.102] model.safetensors: --denoise" + is), denoise.text);
  CHECK(!std::filesystem::exists(w / "clean.bvh"));
}

TEST_CASE("noise from outside gives the motion of the seed that it was drawn with") {
  const Workplace w;
  const auto model = ml::load_stmc<B>((w / "model.safetensors").string());
  ml::TensorStore store;
  const ml::Shape shape{1, 20, 205};
  for (int draw = 0; draw <= 5; ++draw) {
    const auto z = model.noise({.seed = 4}, draw, shape);
    store.add<float>("noise/00" + std::to_string(draw), shape, z.span(), ml::DType::F32);
  }
  ml::write_safetensors(w / "noise.safetensors", store.views());
  CHECK(w.generate("seed", {"--seed", "4"}).code == 0);
  const auto noise = w.generate("noise", {"--noise", "noise.safetensors"});
  REQUIRE_MESSAGE(noise.code == 0, noise.text);
  for (const char* file : {"two.bvh", "two.glb", "two.npz", "two.npy"})
    CHECK_MESSAGE(w.files("noise").at(file) == w.files("seed").at(file), file);
  CHECK(contains(w.files("seed").at("two.html"), "seed 4, model model"));
  CHECK(contains(w.files("noise").at("two.html"), "noise noise.safetensors, model model"));

  const auto both = w.generate("both", {"--noise", "noise.safetensors", "--seed", "4"});
  CHECK(both.code != 0);
  CHECK_MESSAGE(contains(both.text, "--seed excludes --noise"), both.text);
  ml::write_file(w / "longer.txt", "walk forward # 0 # 2 # legs\n");
  const auto wrong = w.generate("wrong", {"--noise", "noise.safetensors"}, "longer.txt");
  CHECK(wrong.code == 1);
  CHECK_MESSAGE(contains(wrong.text, "noise/000 is (1, 20, 205), this timeline needs (1, 40, 205)"), wrong.text);
}

TEST_CASE("feet are put right unless that is switched off") {
  const Workplace w;
  CHECK(w.generate("on", {"--seed", "4"}).code == 0);
  CHECK(w.generate("off", {"--seed", "4", "--no-fix-feet"}).code == 0);
  const auto on = ml::read_amass(w / "on/two.npz").motion, off = ml::read_amass(w / "off/two.npz").motion;
  CHECK(synthetic::largest_distance(on, ml::fix_feet(off)) < 1e-3);
}

TEST_CASE("trembling is taken away, and then feet are put right, unless that is switched off") {
  const Workplace w;
  CHECK(w.generate("on", {"--seed", "4"}).code == 0);
  CHECK(w.generate("own", {"--seed", "4", "--no-fix-feet", "--no-smooth"}).code == 0);
  const auto on = ml::read_amass(w / "on/two.npz").motion, own = ml::read_amass(w / "own/two.npz").motion;
  CHECK(synthetic::largest_distance(on, ml::fix_feet(ml::smooth_motion(own))) < 1e-3);
  CHECK(synthetic::largest_distance(on, ml::fix_feet(own)) > 1e-3);
}

TEST_CASE("convert, strip: whole folders, and the files that fail are reported") {
  const Workplace w;
  const auto walk = synthetic::walk({.frames = 40});
  std::filesystem::create_directories(w / "in/a/b");
  ml::write_bvh(w / "in/walk.bvh", walk);
  ml::write_bvh(w / "in/a/walk.bvh", walk);
  REQUIRE(w.run({"convert", "in/walk.bvh", "in/a/walk.npz"}).code == 0);  // the same name beside it
  REQUIRE(w.run({"convert", "in/walk.bvh", "in/a/b/walk.glb"}).code == 0);
  const auto out = w.run({"convert", "in", "out", "--as", ".bvh", "--mirror"});
  CHECK_MESSAGE(out.code == 0, out.text);
  CHECK_MESSAGE(contains(out.text, "out: 4 of 4 files converted"), out.text);
  const auto expected = ml::mirror(ml::read_bvh_motion(w / "in/walk.bvh"));
  for (const std::string name : {"out/walk.bvh", "out/a/walk.bvh"})
    CHECK_MESSAGE(synthetic::largest_distance(ml::read_bvh_motion(w / name), expected) < 1e-3, name);
  for (const char* name : {"out/a/walk_2.bvh", "out/a/b/walk.bvh"}) CHECK(std::filesystem::exists(w / name));

  ml::write_file(w / "in/broken.bvh", std::string_view("HIERARCHY\nROOT"));
  const auto some = w.run({"convert", "in", "strips", "--as", ".svg"});
  CHECK(some.code == 1);
  CHECK_MESSAGE(contains(some.text, "in/broken.bvh: [motionlang."), some.text);
  CHECK_MESSAGE(contains(some.text, "strips: 4 of 5 files converted"), some.text);
  std::filesystem::remove(w / "in/broken.bvh");
  CHECK(contains(w.run({"strip", "in"}).text, "in: 4 of 4 files converted"));
  for (const char* strip : {"in/walk.bvh.svg", "in/a/walk.npz.svg", "in/a/b/walk.glb.svg"})
    CHECK_MESSAGE(ml::read_file(w / strip).starts_with("<svg"), strip);
  const auto set = w.run({"convert", "in", "set", "--features", "guoh3d"});
  CHECK_MESSAGE(contains(set.text, "set: 4 of 4 files converted"), set.text);
  CHECK(ml::read_ids(w / "set/all.txt").size() == 4);
  CHECK(w.run({"convert", "in", "kit", "--features", "kit"}).code == 0);
  CHECK(ml::HumanMl3dFolder(w / "kit", ml::kit_ml_form).features("walk").size() % 251 == 0);

  std::filesystem::create_symlink(w / "in/walk.bvh", w / "in/a/linked.bvh");  // stays in its place
  CHECK(w.run({"convert", "in/", "npz", "--as", ".npz"}).code == 0);
  CHECK(std::filesystem::exists(w / "npz/a/linked.npz"));

  const auto no_kind = w.run({"convert", "in", "out"}),
             no_folder = w.run({"convert", "in/walk.bvh", "x.bvh", "--as", ".bvh"});
  CHECK(no_kind.code == 2);
  CHECK_MESSAGE(contains(no_kind.text, "in is a folder"), no_kind.text);
  CHECK(no_folder.code == 2);
  for (const char* itself : {"in", "in/a/..", "./in/../in"}) {
    const auto refused = w.run({"convert", "in", itself, "--as", ".bvh"});
    CHECK(refused.code == 2);
    CHECK_MESSAGE(contains(refused.text, "[motionlang.config.102]"), refused.text);
  }
  CHECK(w.run({"convert", "in", "in2", "--as", ".bvh"}).code == 0);
}

TEST_CASE("convert makes loops in place") {
  const Workplace w;
  ml::write_bvh(w / "walk.bvh", synthetic::walk({.frames = 40}));
  const auto out = w.run({"convert", "walk.bvh", "loop.bvh", "--in-place", "--loop", "0.3", "--smooth"});
  REQUIRE_MESSAGE(out.code == 0, out.text);
  const auto walk = ml::read_bvh_motion(w / "walk.bvh"), loop = ml::read_bvh_motion(w / "loop.bvh");
  CHECK(loop.frames() == 34);
  const auto expected = ml::make_loop(ml::in_place(ml::smooth_motion(walk)), 6).motion;
  CHECK(synthetic::largest_distance(loop, expected) < 1e-3);
}

TEST_CASE("convert: from one format to the others and back, cut, resampled, mirrored; strip and view") {
  const Workplace w;
  ml::write_bvh(w / "walk.bvh", synthetic::walk({.frames = 40}));
  const auto walk = ml::read_bvh_motion(w / "walk.bvh");  // joints depth first, as in the file
  for (const std::string there : {"walk.glb", "walk.npz"}) {
    const auto first = w.run({"convert", "walk.bvh", there, "--fps", "20"});
    REQUIRE_MESSAGE(first.code == 0, first.text);
    const auto second = w.run({"convert", there, "back.bvh", "--fps", "20"});
    REQUIRE_MESSAGE(second.code == 0, second.text);
    CHECK(synthetic::largest_distance(ml::read_bvh_motion(w / "back.bvh"), walk) < 1e-3);
  }
  const auto part =
      w.run({"convert", "walk.bvh", "part.bvh", "--from", "0.5", "--to", "1.5", "--fps", "40", "--mirror"});
  CHECK_MESSAGE(contains(part.text, "part.bvh: 39 frames at 40 per second, 0.97 s, 24 joints"), part.text);
  const auto expected = ml::mirror(ml::resample(ml::crop(walk, 10, 30), 40));
  CHECK(synthetic::largest_distance(ml::read_bvh_motion(w / "part.bvh"), expected) < 1e-3);

  CHECK(w.run({"strip", "walk.bvh"}).code == 0);
  CHECK(w.run({"view", "walk.bvh", "page.html"}).code == 0);
  CHECK(ml::read_file(w / "walk.bvh.svg").starts_with("<svg"));
  CHECK(w.run({"strip", "walk.bvh", "-o", "walk.PNG"}).code == 0);
  CHECK(ml::read_file(w / "walk.PNG").starts_with("\x89PNG"));
  ml::write_npz(w / "body.npz", octahedra::arrays());
  for (const char* out : {"body.glb", "body.html", "body.obj"}) {
    const auto made = w.run({"convert", "walk.bvh", out, "--body", "body.npz", "--betas", "1"});
    CHECK_MESSAGE(made.code == 0, made.text);
    CHECK_MESSAGE(contains(made.text, "1 motion on SMPL of 144 vertices"), made.text);
  }
  CHECK(ml::read_file(w / "body_0001.obj").starts_with("v "));
  const auto free = w.run({"convert", "walk.bvh", "free.obj", "--body", "free"});
  CHECK_MESSAGE(contains(free.text, "free.obj in 40 files, one for each frame: 1 motion on the free body of"),
                free.text);
  CHECK(ml::read_file(w / "free_0001.obj").starts_with("v "));
  CHECK(contains(ml::read_file(w / "body.html"), "\"triangles\""));
  CHECK(w.run({"view", "walk.bvh", "page.html", "--body", "body.npz"}).code == 0);
  CHECK(contains(w.run({"convert", "walk.bvh", "x.bvh", "--body", "body.npz"}).text,
                 "on a body are written to .glb and .html"));
  for (const char* features :
       {"guoh3d", "kit", "rifke", "rifke64", "smplvelp", "smplvelp-published", "smplrifke", "actor"}) {
    CAPTURE(features);
    CHECK(w.run({"convert", "walk.bvh", "rows.npy", "--features", features}).code == 0);
    CHECK(w.run({"convert", "rows.npy", "again.bvh"}).code == 0);  // back to another format
    CHECK(ml::read_bvh_motion(w / "again.bvh").frames() > 3);
  }
  CHECK(contains(w.run({"convert", "walk.bvh", "rows.npy", "--features", "smplvelp"}).text,
                 "rows.npy: 25 rows of 135 numbers at 12.5 per second, 2.00 s"));
  CHECK(contains(w.run({"convert", "walk.bvh", "rows.npy", "--features", "smplvelp", "--fps", "30"}).text,
                 "rows.npy: 59 rows of 135 numbers at 30 per second, 1.97 s"));
  CHECK(ml::read_npy(w / "rows.npy").shape == std::vector<ml::Index>{59, 135});
  const auto unknown_features = w.run({"convert", "walk.bvh", "rows.npy", "--features", "poses"});
  CHECK_MESSAGE(contains(unknown_features.text, "--features: poses not in {guoh3d,"), unknown_features.text);
  CHECK(contains(ml::read_file(w / "page.html"), "<html"));
  for (const char* file : {"walk.npz", "walk.bvh"})
    CHECK_MESSAGE(contains(w.run({"info", file}).text, "sliding at"), file);
  const auto page = w.run({"info", "page.html"});
  CHECK(page.code == 1);
  CHECK_MESSAGE(contains(page.text, "page.html: shown are weights, motions and timelines, not '.html'"), page.text);

  const auto unknown = w.run({"convert", "walk.bvh", "walk.fbx"});
  CHECK(unknown.code == 2);
  CHECK_MESSAGE(
      contains(unknown.text, "written to .bvh, .glb, .npz, .npy, .html, .svg and .png, not '.fbx': Blender makes"),
      unknown.text);
  const auto empty = w.run({"convert", "walk.bvh", "none.bvh", "--from", "5"});
  CHECK(empty.code == 2);
  CHECK_MESSAGE(contains(empty.text, "nothing of the 2 s is between 5 and"), empty.text);
  CHECK(!std::filesystem::exists(w / "none.bvh"));
}

TEST_CASE("convert: feet that are fixed stand on the floor, whatever height the file gives its root at rest") {
  const Workplace w;
  auto sunk = synthetic::walk({.frames = 40});
  for (auto& r : sunk.root) r.y -= 0.3;
  ml::write_bvh(w / "sunk.bvh", sunk);
  REQUIRE(ml::read_bvh_motion(w / "sunk.bvh").skeleton.offset(0) == ml::Vec3<double>{});
  const auto out = w.run({"convert", "sunk.bvh", "fixed.npz", "--fix-feet"});
  REQUIRE_MESSAGE(out.code == 0, out.text);
  double lowest = 9;
  for (const auto& p : ml::read_amass(w / "fixed.npz").motion.positions()) lowest = std::min(lowest, p.y);
  CHECK(std::abs(lowest) < 0.02);
}

TEST_CASE("convert: several motions of a file, of which one that fails stops no other") {
  const Workplace w;
  std::vector<ml::Motion> several{synthetic::walk({.frames = 40, .fps = 30}), synthetic::walk({.frames = 1, .fps = 30}),
                                  synthetic::walk({.frames = 20, .fps = 30})};
  several[1].name = "pose", several[2].name = "short walk";
  ml::write_glb(w / "three.glb", several);
  const auto looped = w.run({"convert", "three.glb", "loop.bvh", "--loop", "0.2"});
  CHECK(looped.code == 1);
  CHECK_MESSAGE(contains(looped.text, "pose: [motionlang.config.101] make_loop: 6 frames to blend in a clip of 1"),
                looped.text);
  CHECK_MESSAGE(contains(looped.text, "1 of the 3 motions of three.glb could not be made"), looped.text);
  CHECK(std::filesystem::exists(w / "loop_short walk.bvh"));
  CHECK(!std::filesystem::exists(w / "loop_pose.bvh"));

  CHECK_MESSAGE(
      contains(w.run({"convert", "three.glb", "again.glb", "--mirror"}).text, "again.glb: 3 motions, 24 joints"),
      "all go to one file");
  CHECK(ml::GlbFile::open(w / "again.glb").animation_names() == std::vector<std::string>{"walk", "pose", "short walk"});
  CHECK(w.run({"view", "three.glb"}).code == 0);
  const auto page = ml::read_file(w / "three.glb.html");
  for (const char* name : {"\"walk\"", "\"pose\"", "\"short walk\""}) CHECK(contains(page, name));
}

TEST_CASE("convert --skeleton: the result is on the joints of another motion, of its units") {
  const Workplace w;
  ml::write_bvh(w / "walk.bvh", synthetic::walk({.frames = 20}));
  ml::Motion hero{rigs::skeleton_of(ml::skeleton_table("Mixamo"), 0, 1, {}, "mixamorig:"), 30, {}, {}, "hero"};
  hero.root.assign(2, {0, 1, 0});
  hero.local.assign(2 * hero.skeleton.names.size(), ml::Quaternion<double>::identity());
  ml::write_bvh(w / "hero.bvh", hero, {.scale = 10});
  const Outcome made = w.run({"convert", "walk.bvh", "out.bvh", "--skeleton", "hero.bvh", "--units", "10"});
  REQUIRE_MESSAGE(made.code == 0, made.text);
  const ml::Motion out = ml::read_bvh_motion(w / "out.bvh", {.scale = 0.1}),
                   like = ml::read_bvh_motion(w / "hero.bvh", {.scale = 0.1});
  CHECK(out.frames() == 20);
  REQUIRE(out.skeleton.names == like.skeleton.names);
  for (int j = 1; j < out.skeleton.size(); ++j)
    CHECK(ml::norm(out.skeleton.offset(j) - like.skeleton.offset(j)) < 1e-4);
  const auto knee = static_cast<std::size_t>(ml::find_joint(out.skeleton, "LeftLeg"));
  CHECK(ml::distance(out.rotations(0)[knee], out.rotations(9)[knee]) > 0.05);
  CHECK_MESSAGE(contains(w.run({"convert", "walk.bvh", "out.npy", "--skeleton", "hero.bvh"}).text,
                         "--skeleton: is for results on any joints"),
                "npy");
}

TEST_CASE("convert: texts of BABEL become annotations, and these files of captions") {
  const Workplace w;
  ml::write_file(w / "babel.json", std::string_view(R"({
    "42": {"babel_sid": 42, "url": "", "feat_p": "X/X/s/f_poses.npz", "dur": 12.0,
      "seq_ann": {"labels": [{"raw_label": "walk", "proc_label": "walk and wave", "seg_id": "a", "act_cat": null}]},
      "frame_ann": {"labels": [{"proc_label": "sit down", "start_t": 7, "end_t": 9.5}]}},
    "43": {"babel_sid": 43, "url": "", "feat_p": "X/X/s/g_poses.npz", "dur": 1.5, "seq_ann": null}})"));
  const auto out = w.run({"convert", "babel.json", "annotations.json"});
  CHECK_MESSAGE(out.code == 0, out.text);
  CHECK_MESSAGE(contains(out.text, "annotations.json: 2 texts of 1 motion"), out.text);
  const auto made = ml::AnnotationFile::open(w / "annotations.json");
  CHECK(made.ids() == std::vector<std::string>{"00042"});
  CHECK(made.load("00042") ==
        ml::AnnotatedMotion{
            "00042", "X/s/f_poses", 12, {{"00042_0", "walk and wave", 0, 12, "a"}, {"00042_1", "sit down", 7, 9.5}}});
  REQUIRE(w.run({"convert", "annotations.json", "again.json"}).code == 0);
  CHECK(ml::read_file(w / "again.json") == ml::read_file(w / "annotations.json"));
  const auto texts = w.run({"convert", "annotations.json", "set"});
  CHECK_MESSAGE(contains(texts.text, "set/texts: 2 texts of 1 motion"), texts.text);
  CHECK(ml::read_file(w / "set/texts/00042.txt") == "walk and wave##0.0#0.0\nsit down##7.0#9.5\n");
  REQUIRE(w.run({"convert", "babel.json", "direct"}).code == 0);
  CHECK(w.files("direct/texts") == w.files("set/texts"));

  const auto other = w.run({"convert", "babel.json", "out.bvh"}),
             option = w.run({"convert", "babel.json", "out.json", "--mirror"});
  CHECK(other.code == 1);
  CHECK_MESSAGE(contains(other.text, "are written to .json or, as files of captions, into a folder, not '.bvh'"),
                other.text);
  CHECK(option.code == 2);
  CHECK_MESSAGE(contains(option.text, "--mirror: is not for texts of motions"), option.text);
  ml::write_file(w / "sharp.json", std::string_view(R"({"1": {"path": "p", "duration": 1, "annotations": [
    {"seg_id": "1_0", "text": "one", "start": 0, "end": 1},
    {"seg_id": "1_1", "text": "a # b", "start": 0, "end": 1}]}})"));
  const auto sharp = w.run({"convert", "sharp.json", "none"});
  CHECK_MESSAGE(contains(sharp.text, "[motionlang.timeline.510] 1.txt: 'a # b' cannot stand in a file of captions"),
                sharp.text);
  CHECK(!std::filesystem::exists(w / "none"));
}

TEST_CASE("convert: every ROOT of a BVH file is a motion; bones that stretch are reported") {
  const Workplace w;
  ml::write_file(w / "pair.bvh",
                 std::string_view(
                     "HIERARCHY ROOT a { OFFSET 0 0 0 CHANNELS 1 Xposition JOINT arm { OFFSET 0 100 0 CHANNELS 1 "
                     "Yposition } JOINT leg { OFFSET 0 -100 0 } } ROOT b { OFFSET 0 0 0 CHANNELS 1 Yposition JOINT c { "
                     "OFFSET 100 0 0 } } MOTION Frames: 2 Frame Time: 0.05\n0 100 5\n100 150 5\n"));
  const std::string told =
      "pair.bvh: left out is how 'arm' moves away from the joint before: bones keep their mean length";
  const auto out = w.run({"convert", "pair.bvh", "one.bvh"});
  REQUIRE_MESSAGE(out.code == 0, out.text);
  CHECK_MESSAGE(contains(out.text, told), out.text);
  CHECK(ml::read_bvh_motion(w / "one_a.bvh").root_at(1).x == doctest::Approx(1));
  const auto second = ml::read_bvh_motion(w / "one_b.bvh");
  CHECK(second.skeleton.names == std::vector<std::string>{"b", "c"});
  CHECK(second.root_at(1).y == doctest::Approx(0.05));
  CHECK(!contains(w.run({"convert", "one_a.bvh", "again.bvh"}).text, "left out"));
  CHECK(w.run({"convert", "pair.bvh", "figure.glb"}).code == 0);  // a GLB file has one skeleton
  CHECK(ml::GlbFile::open(w / "figure_b.glb").skeleton().names == second.skeleton.names);
  CHECK(w.run({"view", "pair.bvh"}).code == 0);
  const auto page = ml::read_file(w / "pair.bvh.html");
  for (const char* name : {"\"a\"", "\"b\""}) CHECK_MESSAGE(contains(page, name), name);
  const auto seen = w.run({"info", "pair.bvh"});
  CHECK_MESSAGE((contains(seen.text, told) && contains(seen.text, "2 roots\n  0 a, ")), seen.text);
  std::filesystem::create_directories(w / "data");
  std::filesystem::rename(w / "pair.bvh", w / "data/pair.bvh");
  const auto checked = w.run({"doctor", "data", "--all"});
  for (const char* name : {"pair.bvh a: ", "pair.bvh b: "}) CHECK_MESSAGE(contains(checked.text, name), checked.text);
}

TEST_CASE("convert: joints of a GLB file that move along their bones are reported, also on a character") {
  const Workplace w;
  ml::write_file(w / "rig.glb", rigs::glb_of(rigs::skeleton_of(ml::skeleton_table("Mixamo"), 0, 1, {}, "mixamorig:")));
  ml::write_glb(w / "walk.glb", synthetic::walk({.frames = 40}));
  CHECK(!contains(w.run({"convert", "walk.glb", "walk.bvh"}).text, "left out"));
  std::string bytes = ml::read_file(w / "walk.glb");
  const std::string_view root = R"("target":{"node":0,"path":"translation"})",
                         spine = R"("target":{"node":3,"path":"translation"})";
  REQUIRE(contains(bytes, std::string(root)));
  ml::write_file(w / "stretched.glb", bytes.replace(bytes.find(root), root.size(), spine));
  const std::string told =
      "stretched.glb: left out is how 'spine1' moves away from the joint before: bones keep their length at rest\n";
  for (const auto& command : {std::vector<std::string>{"convert", "stretched.glb", "out.bvh"},
                              {"convert", "stretched.glb", "out.glb", "--rig", "rig.glb"},
                              {"info", "stretched.glb"}}) {
    const auto out = w.run(command);
    CHECK(out.code == 0);
    CHECK_MESSAGE(contains(out.text, told), out.text);
  }
}

TEST_CASE("--joints says which joint is which, of motions and of the character") {
  const Workplace w;
  auto walk = synthetic::walk({.frames = 20});
  std::string lines;
  for (std::string& name : walk.skeleton.names) {
    lines += name + "\tBip_" + name + "\n";
    name = "Bip_" + name;
  }
  ml::write_bvh(w / "bip.bvh", walk);
  ml::write_file(w / "bip.tsv", lines);
  ml::write_file(w / "short.tsv", "pelvis\tBip_pelvis\n\nleft_hip\thip.L\n");
  ml::write_bvh(w / "walk.bvh", synthetic::walk({.frames = 20}));
  const auto refused = w.run({"convert", "bip.bvh", "out.bvh", "--smpl"});
  CHECK(refused.code != 0);
  CHECK_MESSAGE(contains(refused.text, "'Bip_pelvis'); the closest, SMPL, needs a joint 'pelvis'"), refused.text);
  CHECK_MESSAGE(contains(refused.text, "--joints FILE"), refused.text);
  const auto wrong = w.run({"convert", "bip.bvh", "out.bvh", "--joints", "short.tsv"});
  CHECK(wrong.code != 0);
  CHECK_MESSAGE(contains(wrong.text, "short.tsv:3: the skeleton has no joint 'hip.L'"), wrong.text);
  const auto made = w.run({"convert", "bip.bvh", "out.bvh", "--joints", "bip.tsv"});
  CHECK_MESSAGE(made.code == 0, made.text);
  ml::Motion out = ml::read_bvh_motion(w / "out.bvh"), wanted = ml::read_bvh_motion(w / "walk.bvh");
  ml::place_on_floor(out), ml::place_on_floor(wanted);
  CHECK(synthetic::largest_distance(out, wanted) < 1e-4);

  ml::write_file(w / "bip.glb", rigs::glb_of(walk.skeleton));
  CHECK(contains(w.run({"convert", "walk.bvh", "on_bip.glb", "--rig", "bip.glb"}).text, "--joints FILE"));
  const auto on_rig = w.run({"convert", "walk.bvh", "on_bip.glb", "--rig", "bip.glb", "--joints", "bip.tsv"});
  CHECK_MESSAGE(on_rig.code == 0, on_rig.text);
  CHECK_MESSAGE(contains(on_rig.text, "SMPL -> bip.tsv: 24 of 24 joints follow"), on_rig.text);
  CHECK(
      contains(w.run({"generate", "--text", "a person walks", "--joints", "bip.tsv"}).text, "--joints requires --rig"));
}

TEST_CASE("convert: options that would be left out are refused; the message says how joints follow") {
  const Workplace w;
  ml::write_file(w / "rig.glb", rigs::glb_of(rigs::skeleton_of(ml::skeleton_table("Mixamo"), 0, 1, {}, "mixamorig:")));
  ml::write_bvh(w / "walk.bvh", synthetic::walk({.frames = 40}));
  const std::vector<std::pair<std::vector<std::string>, std::string>> refused{
      {{"--rig", "rig.glb", "--features", "guoh3d"}, "--rig excludes --features"},
      {{"--rig", "rig.glb", "--body", "free"}, "--rig excludes --body"},
      {{"--body", "free", "--features", "guoh3d"}, "--body excludes --features"},
      {{"--betas", "1"}, "--betas requires --body"},
      {{"--drop-animations"}, "--drop-animations requires --rig"},
      {{"--action", "walk"}, "--action requires --denoise"},
      {{"--statistics", "."}, "--statistics requires --denoise"}};
  for (auto [options, message] : refused) {
    options.insert(options.begin(), {"convert", "walk.bvh", "out.glb"});
    const auto out = w.run(options);
    CHECK(out.code == 2);
    CHECK_MESSAGE(contains(out.text, message), out.text);
  }
  const auto endless = w.run({"convert", "walk.bvh", "out.bvh", "--fps", "1e300"});
  CHECK(endless.code == 1);
  CHECK_MESSAGE(contains(endless.text, "[motionlang.config.101] resample: 'walk' of 2 s at 1e+300"), endless.text);

  REQUIRE(w.run({"convert", "walk.bvh", "mixamo.glb", "--rig", "rig.glb", "--drop-animations"}).code == 0);
  CHECK(contains(w.run({"convert", "mixamo.glb", "smpl.bvh", "--smpl"}).text, "Mixamo -> SMPL: "));
  CHECK(contains(w.run({"convert", "mixamo.glb", "smpl.npz"}).text, "Mixamo -> SMPL: "));
  CHECK(contains(w.run({"convert", "mixamo.glb", "rows.npy", "--features", "rifke"}).text, "Mixamo -> SMPL: "));
  CHECK(!contains(w.run({"convert", "walk.bvh", "smpl.npz"}).text, "SMPL -> SMPL"));
}

TEST_CASE("convert: clips are added to a data set in HumanML3D's or KIT-ML's form, captions that are there are kept") {
  const Workplace w;
  std::vector<ml::Motion> two(2, synthetic::walk({.frames = 40, .fps = 30}));
  ml::write_glb(w / "walk.glb", two);
  const auto out = w.run({"convert", "walk.glb", "set", "--features", "guoh3d"});
  REQUIRE_MESSAGE(out.code == 0, out.text);
  CHECK_MESSAGE(contains(out.text, "set: clip walk_2, 26 frames at 20 per second, 0 captions"), out.text);
  ml::write_file(w / "set/texts/walk.txt", "a person walks.#a/DET person/NOUN walk/VERB#0.0#0.0\n");
  CHECK(contains(w.run({"convert", "walk.glb", "set", "--features", "guoh3d"}).text,
                 "set: clip walk, 26 frames at 20 per second, 1 caption"));
  const ml::HumanMl3dFolder set(w / "set");
  CHECK(set.ids() == std::vector<std::string>{"walk", "walk_2"});
  const auto clip = set.load("walk");
  CHECK(clip.frames == 26);
  CHECK(clip.is_finite());
  CHECK(clip.captions.at(0).text == "a person walks.");
  CHECK(w.run({"convert", "walk.glb", "set", "--features", "rifke"}).code == 1);

  const auto kit = w.run({"convert", "walk.glb", "kit", "--features", "kit"});
  REQUIRE_MESSAGE(kit.code == 0, kit.text);
  CHECK_MESSAGE(contains(kit.text, "kit: clip walk_2, 16 frames at 12.5 per second, 0 captions"), kit.text);
  const auto on_kit = ml::HumanMl3dFolder(w / "kit", ml::kit_ml_form).load("walk");
  CHECK(on_kit.frames == 16);
  CHECK(on_kit.joints[1] > 300);  // height of the root in KIT's units, 640 in a metre
  CHECK(synthetic::largest_distance(ml::read_motion_npy(w / "kit/new_joints/walk.npy"),
                                    ml::read_motion_npy(w / "kit/new_joint_vecs/walk.npy")) < 1e-3);
  const auto guoh3d_into_kit = w.run({"convert", "walk.glb", "kit", "--features", "guoh3d"});
  CHECK(guoh3d_into_kit.code == 1);
  CHECK_MESSAGE(contains(guoh3d_into_kit.text,
                         "kit/new_joint_vecs/walk.npy: rows of 251 numbers (kit), the new clip has "
                         "rows of 263 (guoh3d)"),
                guoh3d_into_kit.text);
  CHECK(ml::read_ids(w / "kit/all.txt").size() == 2);
  std::filesystem::remove(w / "kit/all.txt");  // the form is that of any clip
  CHECK(w.run({"convert", "walk.glb", "kit", "--features", "guoh3d"}).code == 1);

  // as motions the clips of a data set are read once: not its joints as well
  REQUIRE(w.run({"convert", "kit", "from_kit", "--as", ".bvh"}).code == 0);
  CHECK(std::filesystem::exists(w / "from_kit/new_joint_vecs/walk.bvh"));
  CHECK(!std::filesystem::exists(w / "from_kit/new_joints"));
}

TEST_CASE("convert and generate put motions on a character") {
  const Workplace w;
  ml::write_file(w / "rig.glb", rigs::glb_of(rigs::skeleton_of(ml::skeleton_table("Mixamo"), 0, 1, {}, "mixamorig:")));
  ml::write_bvh(w / "walk.bvh", synthetic::walk({.frames = 40}));
  const auto out = w.run({"convert", "walk.bvh", "walk.glb", "--rig", "rig.glb"});
  REQUIRE_MESSAGE(out.code == 0, out.text);
  CHECK_MESSAGE(contains(out.text, "SMPL -> Mixamo: 24 of"), out.text);
  CHECK(ml::GlbFile::open(w / "walk.glb").animation_names() == std::vector<std::string>{"idle", "walk"});
  const auto alone = w.run({"convert", "walk.glb", "alone.glb", "--rig", "rig.glb", "--drop-animations"});
  REQUIRE_MESSAGE(alone.code == 0, alone.text);
  CHECK_MESSAGE(contains(alone.text, "all joints follow"), alone.text);  // it is on the character's skeleton now
  CHECK(ml::GlbFile::open(w / "alone.glb").animation_names() == std::vector<std::string>{"idle", "walk"});
  CHECK(
      contains(w.run({"convert", "walk.bvh", "walk.npz", "--rig", "rig.glb"}).text, "is written to .glb, not '.npz'"));
  CHECK(!std::filesystem::exists(w / "walk.npz"));

  // The same as .gltf, whose data are in it: as the character, and as the motion.
  ml::write_file(w / "rig.gltf", rigs::gltf_of(ml::MappedFile::open(w / "rig.glb")->bytes()));
  REQUIRE(w.run({"convert", "walk.bvh", "same.glb", "--rig", "rig.gltf"}).code == 0);
  CHECK(w.files(".").at("same.glb") == w.files(".").at("walk.glb"));
  REQUIRE(w.run({"convert", "rig.gltf", "idle.bvh"}).code == 0);
  REQUIRE(w.run({"convert", "rig.glb", "idle2.bvh"}).code == 0);
  CHECK(ml::read_file(w / "idle.bvh") == ml::read_file(w / "idle2.bvh"));

  const auto made = w.generate("out", {"--rig", "rig.glb"});
  REQUIRE_MESSAGE(made.code == 0, made.text);
  CHECK(ml::GlbFile::open(w / "out/two.glb").animation_names() == std::vector<std::string>{"idle", "two"});
}

TEST_CASE("doctor reports numbers that are not finite; info says what is wrong with binary files") {
  const Workplace w;
  std::filesystem::create_directories(w / "data");
  std::vector<float> joints(2 * 22 * 3, 1);
  joints[70] = std::numeric_limits<float>::quiet_NaN();
  ml::write_npy(w / "data/nan.npy", ml::NpyArray::of(std::span<const float>(joints), {2, 22, 3}));
  const auto seen = w.run({"doctor", "data"});
  CHECK_MESSAGE(contains(seen.text, "nan.npy: not finite: [motionlang.numeric.301]"), seen.text);
  ml::write_file(w / "zeros", std::string(100, '\0'));
  const auto told = w.run({"info", "zeros"});
  CHECK(told.code == 1);
  CHECK_MESSAGE(contains(told.text, "zeros: byte 8"), told.text);
}

TEST_CASE("an .npz file with the names of smplx and without a rate: --rate says it, but not another than the file's") {
  const Workplace w;
  const auto array = [](ml::Index columns) {
    const std::vector<double> values(static_cast<std::size_t>(4 * columns), 0.1);
    return ml::NpyArray::of(std::span<const double>(values), {4, columns});
  };
  std::vector<ml::NamedArray> arrays{{"global_orient", array(3)}, {"body_pose", array(69)}, {"transl", array(3)}};
  std::filesystem::create_directories(w / "data");
  ml::write_npz(w / "data/none.npz", arrays);
  arrays.push_back({"fps", ml::NpyArray::scalar(60.0)});
  ml::write_npz(w / "data/own.npz", arrays);
  const auto none = w.run({"convert", "data/none.npz", "a.bvh"});
  CHECK(none.code == 1);
  CHECK_MESSAGE(contains(none.text, "[motionlang.io.406] data/none.npz: no frame rate"), none.text);
  CHECK_MESSAGE(contains(none.text, "--rate says it"), none.text);
  for (const std::vector<std::string>& more : {std::vector<std::string>{}, {"--body", "free"}}) {
    std::vector<std::string> words{"convert", "data/none.npz", "a.glb", "--rate", "30"};
    words.insert(words.end(), more.begin(), more.end());
    const auto given = w.run(words);
    CHECK_MESSAGE(given.code == 0, given.text);
    CHECK(ml::GlbFile::open(w / "a.glb").motion(0).fps == doctest::Approx(30));
    words[1] = "data/own.npz";
    const auto both = w.run(words);
    CHECK(both.code != 0);
    CHECK_MESSAGE(contains(both.text, "[motionlang.config.102] data/own.npz: has 60 frames per second, --rate says 30"),
                  both.text);
  }
  CHECK(contains(w.run({"convert", "data/own.npz", "own.npz"}).text, "4 frames at 60 per second"));
  CHECK(contains(w.run({"info", "data/own.npz"}).text, "data/own.npz: 4 frames, 60 frames per second"));
  REQUIRE(w.run({"convert", "data", "out", "--as", ".npz", "--rate", "30"}).code == 0);  // a folder of both
  CHECK(ml::read_amass(w / "out/none.npz").motion.fps == 30);
  CHECK(ml::read_amass(w / "out/own.npz").motion.fps == 60);
}

TEST_CASE("results of MDM: every motion, named by its text") {
  const Workplace w;
  std::vector<float> values(2 * 22 * 3 * 10);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<float>(i / 10 % 66) / 66;  // stands
  const auto motion = ml::NpyArray::of(std::span<const float>(values), {2, 22, 3, 10});
  std::filesystem::create_directories(w / "mdm");
  ml::write_file(w / "mdm/results.npy",
                 mdm::results(motion, {"a person waves / sits", "a person waves / sits"}, {10, 6}));
  const auto seen = w.run({"info", "mdm/results.npy"});
  CHECK_MESSAGE(
      contains(seen.text, "2 motions\n  0 a person waves / sits, 0.50 s\n  1 a person waves / sits_2, 0.30 s\n"),
      seen.text);
  CHECK(contains(seen.text, "10 frames, 20 frames per second, 0.50 s, 24 joints"));
  const auto made = w.run({"convert", "mdm/results.npy", "x.bvh", "--rate", "30"});
  REQUIRE_MESSAGE(made.code == 0, made.text);
  CHECK(contains(made.text, "x_a person waves _ sits.bvh: 10 frames at 30 per second"));
  CHECK(ml::read_bvh_motion(w / "x_a person waves _ sits_2.bvh").frames() == 6);
  const auto page = w.run({"view", "mdm/results.npy"});
  CHECK_MESSAGE(contains(page.text, "mdm/results.npy.html: 2 motions, 24 joints"), page.text);
  const auto all = w.run({"convert", "mdm", "all", "--as", ".bvh"});
  CHECK_MESSAGE(contains(all.text, "all: 1 of 1 file converted"), all.text);
  ml::write_npy(w / "bare.npy", motion);
  CHECK(contains(w.run({"convert", "bare.npy", "bare.bvh"}).text, "bare_1.bvh: 10 frames at 20 per second"));
}

TEST_CASE("convert: what an AMASS file has besides the joints goes into another one, or is reported") {
  const Workplace w;
  std::vector<double> poses(2 * 156), trans(6), betas{1.5, -2};
  poses[100] = 0.5;
  const std::vector<ml::NamedArray> arrays{{"poses", ml::NpyArray::of(std::span<const double>(poses), {2, 156})},
                                           {"trans", ml::NpyArray::of(std::span<const double>(trans), {2, 3})},
                                           {"betas", ml::NpyArray::of(std::span<const double>(betas), {2})},
                                           {"gender", ml::NpyArray::text("female")},
                                           {"mocap_framerate", ml::NpyArray::scalar(60.0)}};
  ml::write_npz(w / "a.npz", arrays);
  const auto same = w.run({"convert", "a.npz", "b.npz"});
  CHECK_MESSAGE(contains(same.text, "a.npz: left out are hands and face; --body shows them"), same.text);
  const auto back = ml::read_amass(w / "b.npz");
  CHECK(back.body.gender == "female");
  CHECK(back.body.betas == betas);
  CHECK(contains(w.run({"convert", "a.npz", "b.bvh"}).text, "left out are hands, face and betas"));

  std::filesystem::create_directories(w / "data");
  ml::write_npz(w / "data/a.npz", arrays);
  ml::write_npz(w / "data/b.npz", arrays);
  ml::write_bvh(w / "data/c.bvh", synthetic::walk({.frames = 10, .fps = 30}));
  const auto folder = w.run({"convert", "data", "out", "--as", ".bvh"});
  CHECK_MESSAGE(
      contains(folder.text,
               "data/a.npz: left out are hands, face and betas; --body shows them (and of 1 more)\nout: 3 of 3 files"),
      folder.text);
}

TEST_CASE("doctor: finds what is broken in a folder, writes a page and a mended copy") {
  const Workplace w;
  const auto walk = synthetic::walk({.frames = 60, .fps = 30});
  std::filesystem::create_directories(w / "data/deep");
  ml::write_bvh(w / "data/sound.bvh", walk);
  ml::write_bvh(w / "data/deep/large.bvh", walk, {.scale = 10000});
  auto spiked = walk;
  spiked.root[30].x += 0.5;
  ml::write_glb(w / "data/spiked.glb", spiked);
  std::string nan = ml::read_file(w / "data/sound.bvh");
  std::string row = "nan";
  for (int i = 1; i < 3 + 3 * 24; ++i) row += " 0";
  nan.replace(nan.find("MOTION"), std::string::npos, "MOTION\nFrames: 1\nFrame Time: 0.05\n" + row + "\n");
  ml::write_file(w / "data/nan.bvh", nan);
  ml::write_file(w / "data/notes.txt", "no motion");

  const auto seen = w.run({"doctor", "data", "--report", "page.html", "--clean", "clean", "--all"});
  REQUIRE_MESSAGE(seen.code == 0, seen.text);
  for (const char* text :
       {"sound.bvh: good", "deep/large.bvh: scale: ", "x 0.01 (", "spiked.glb spiked: spike: 1 frame",
        "nan.bvh: unreadable: [motionlang.io.403]", "4 motions, 1 without a finding"})
    CHECK_MESSAGE(contains(seen.text, text), text, " in ", seen.text);
  const auto page = ml::read_file(w / "page.html");
  CHECK(contains(page, "4 motions: 1 without a finding, 2 with findings, 1 unreadable."));
  CHECK(contains(page, "<svg"));

  const auto clean = w.run({"doctor", "clean"});
  CHECK_MESSAGE(contains(clean.text, "3 motions, 3 without a finding"), clean.text);
  CHECK(synthetic::largest_distance(ml::read_bvh_motion(w / "clean/deep/large.bvh"),
                                    ml::read_bvh_motion(w / "data/sound.bvh")) < 1e-3);
  // Copies of animations of one name, which is a path besides, stay apart and in the folder.
  std::vector<ml::Motion> two(2, walk);
  two[0].name = two[1].name = "../walk";
  std::filesystem::create_directories(w / "named");
  ml::write_glb(w / "named/a.glb", two);
  CHECK(w.run({"doctor", "named", "--clean", "kept"}).code == 0);
  for (const char* copy : {"kept/a.glb .._walk.bvh", "kept/a.glb .._walk_2.bvh"})
    CHECK_MESSAGE(std::filesystem::exists(w / copy), copy);
  // A copy of a.npz and the file a.npz.bvh, too.
  std::filesystem::create_directories(w / "alike");
  ml::write_amass(w / "alike/a.npz", walk);
  ml::write_bvh(w / "alike/a.npz.bvh", walk);
  CHECK(w.run({"doctor", "alike", "--clean", "both"}).code == 0);
  for (const char* copy : {"both/a.npz.bvh", "both/a.npz_2.bvh"})
    CHECK_MESSAGE(std::filesystem::exists(w / copy), copy);
  const auto over = w.run({"doctor", "data", "--clean", "data/deep/.."});
  CHECK(over.code == 2);
  CHECK_MESSAGE(contains(over.text, "is the folder of the originals"), over.text);
  std::filesystem::create_symlink("loop.bvh", w / "clean/loop.bvh");  // to itself
  std::filesystem::create_directory_symlink(".", w / "clean/again");
  const auto circle = w.run({"doctor", "clean"});
  CHECK(circle.code == 0);
  CHECK_MESSAGE(contains(circle.text, "skipped: clean/loop.bvh: "), circle.text);
  CHECK_MESSAGE(contains(circle.text, "3 motions, 3 without a finding"), circle.text);
  CHECK(w.run({"doctor", "nowhere"}).code == 2);
  std::filesystem::create_directories(w / "empty");
  CHECK(contains(w.run({"doctor", "empty"}).text, "no .bvh, .amc, .npz, .npy, .glb or .vrma file below 'empty'"));
}

TEST_CASE("doctor: a jump tells a wrong frame rate, and the copy has the right one") {
  const Workplace w;
  auto jump = synthetic::jump(60);
  jump.fps = 120;
  std::filesystem::create_directories(w / "data");
  ml::write_bvh(w / "data/a.bvh", jump);
  ml::write_amass(w / "data/b.npz", jump);
  jump.fps = 30;
  ml::write_bvh(w / "data/c.bvh", jump);
  const auto seen = w.run({"doctor", "data", "--clean", "clean"});
  for (const char* text :
       {"2 times too fast, 60 frames per second, not 120", "2 times too slow, 60 frames per second, not 30",
        "     3  fall           bodies fall faster or slower than they do"})
    CHECK_MESSAGE(contains(seen.text, text), text, " in ", seen.text);
  for (const char* copy : {"clean/a.bvh", "clean/b.npz.bvh", "clean/c.bvh"})
    CHECK(ml::read_bvh_motion(w / copy).fps == doctest::Approx(60).epsilon(1e-4));
  CHECK(contains(w.run({"doctor", "clean"}).text, "3 motions, 3 without a finding"));
}

TEST_CASE("doctor: arrays of joints and features except mean and deviation; AMC files with a skeleton from elsewhere") {
  const Workplace w;
  for (const char* folder : {"set", "one", "two"}) std::filesystem::create_directories(w / folder);
  auto walk = synthetic::walk({.frames = 60});
  ml::write_joints_npy(w / "set/joints.npy", walk);
  CHECK(w.run({"convert", "set/joints.npy", "set/rows.npy", "--features", "guoh3d"}).code == 0);
  const std::vector<float> numbers(263, 1), unknown(40);
  ml::write_npy(w / "set/Mean.npy", ml::NpyArray::of(std::span<const float>(numbers), {263}));
  ml::write_npy(w / "set/odd.npy", ml::NpyArray::of(std::span<const float>(unknown), {2, 20}));
  const auto set = w.run({"doctor", "set", "--all"});
  for (const char* text :
       {"joints.npy: good", "rows.npy: good", "odd.npy: unreadable: [motionlang.io.407]", "3 motions, 2 without"})
    CHECK_MESSAGE(contains(set.text, text), text, " in ", set.text);

  const std::string asf =
      ":version 1.10\n:name n\n:units\nmass 1.0\nlength 0.45\nangle deg\n:root\naxis XYZ\norder TX TY TZ RZ RY RX\n"
      "position 0 0 0\norientation 0 0 0\n:bonedata\nbegin\nid 1\nname thigh\ndirection 1 0 0\nlength 2\naxis 0 0 0 "
      "XYZ\n"
      "dof rx\nlimits (-180 180)\nend\n:hierarchy\nbegin\nroot thigh\nend\n";
  const std::string amc = ":FULLY-SPECIFIED\n:DEGREES\n1\nroot 0 1 0 0 0 0\nthigh 10\n2\nroot 0 1 0 0 0 0\nthigh 20\n";
  ml::write_file(w / "one/13_30.amc", amc);
  ml::write_file(w / "body.asf", asf);
  const std::string missing =
      "there is no skeleton one/13.asf, nor just one other .asf file beside it: convert, strip, view, doctor, "
      "index, search and describe take it by --asf FILE";
  CHECK(contains(w.run({"doctor", "one"}).text, "unreadable: [motionlang.io.401] one/13_30.amc: " + missing));
  const auto alone = w.run({"convert", "one/13_30.amc", "leg.bvh"});
  CHECK(alone.code == 1);
  CHECK_MESSAGE(contains(alone.text, missing), alone.text);
  CHECK(w.run({"convert", "one/13_30.amc", "leg.bvh", "--asf", "body.asf"}).code == 0);
  const auto given = w.run({"doctor", "one", "--asf", "body.asf", "--all"});
  CHECK_MESSAGE((contains(given.text, "1 motion, ") && !contains(given.text, "unreadable")), given.text);
  ml::write_file(w / "two/13_30.amc", amc);
  ml::write_file(w / "two/body.asf", asf);  // the only one there
  const auto made = w.run({"convert", "two/13_30.amc", "leg.bvh", "--rate", "60"});
  CHECK_MESSAGE(contains(made.text, "leg.bvh: 2 frames at 60 per second, 0.03 s, 2 joints"), made.text);

  std::string smaller = asf;  // for those that have none: others keep their own
  smaller.replace(smaller.find("0.45"), 4, "0.90");
  ml::write_file(w / "smaller.asf", smaller);
  std::filesystem::rename(w / "one", w / "two/one");
  REQUIRE(w.run({"convert", "two", "legs", "--as", ".bvh", "--asf", "smaller.asf"}).code == 0);
  const auto height = [&](const char* file) { return ml::read_bvh_motion(w / file).root_at(0).y; };
  CHECK(height("legs/13_30.bvh") == doctest::Approx(2 * height("legs/one/13_30.bvh")).epsilon(1e-3));
}

TEST_CASE("Ctrl-C while generating: 130, and no file") {
  const Workplace w(1000);
  ml::write_file(w / "long.txt", "walk forward # 0 # 45 # legs\n");
  const auto stopped = w.generate("out", {}, "long.txt", "generating");
  CHECK(stopped.code == 130);
  CHECK_MESSAGE(contains(stopped.text, "stopped"), stopped.text);
  CHECK(w.files("out").empty());
}

TEST_CASE("Ctrl-C while training: 130 and a checkpoint, from which the same command goes on") {
  const captioned::Clips clips;
  auto train = [&](const std::string& steps, const std::string& interrupt_at = "") {
    return run({"train",
                "--data",
                ".",
                "--captions",
                "captions.tsv",
                "--out",
                "run",
                "--steps",
                steps,
                "--batch",
                "2",
                "--width",
                "16",
                "--feed-forward",
                "24",
                "--layers",
                "1",
                "--vocabulary",
                "40",
                "--text-steps",
                "5"},
               clips.folder.path, interrupt_at);
  };
  const auto stopped = train("5000", "training [");
  CHECK_MESSAGE(stopped.code == 130, stopped.text);
  CHECK(contains(stopped.text, "the same command goes on from run/checkpoint.safetensors"));
  const auto names = [&] {
    std::vector<std::string> out;
    for (const auto& f : std::filesystem::directory_iterator(clips.folder / "run")) out.push_back(f.path().filename());
    std::sort(out.begin(), out.end());
    return out;
  };
  CHECK(names() == std::vector<std::string>{"checkpoint.safetensors", "loss.svg"});
  const auto whole = train("20");
  REQUIRE_MESSAGE(whole.code == 0, whole.text);
  CHECK(contains(whole.text, "going on at step"));
  CHECK(names() == std::vector<std::string>{"checkpoint.safetensors", "loss.svg", "stmc.safetensors"});
  CHECK(run({"info", "run/stmc.safetensors"}, clips.folder.path).code == 0);
  const auto made = run({"generate", "--model", "run/stmc.safetensors", "--text", "Someone walks to the river",
                         "--seconds", "1", "--preset", "fast", "--out", "made"},
                        clips.folder.path);
  CHECK_MESSAGE(made.code == 0, made.text);
  CHECK_MESSAGE(contains(made.text, "the model never learned the word 'river'\n"), made.text);
}
