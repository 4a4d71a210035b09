// The commands check and info, and what is said about texts.
#include <doctest/doctest.h>

#include <motionlang/datasets/annotations.hpp>
#include <motionlang/datasets/humanml3d_folder.hpp>
#include <motionlang/features/motion_features.hpp>
#include <motionlang/formats/glb_reader.hpp>
#include <motionlang/kinematics/smooth_motion.hpp>

#include "../support/small_model.hpp"
#include "small_workplace.hpp"

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
  ml::write_file(w / "captions.tsv",
                 "a/one\t0\t30\tlegs\twalk along | someone walks\na/one\t20\t60\tlegs\tsit down\thold\n");
  const auto card = w.run({"info", "captions.tsv"});
  for (const char* text : {"    1 clips      2 segments     1.2 min     1.0 min without overlaps       3 captions",
                           "3 different captions, 6 different words, 2 verbs", " sit 1 walk 1\n"})
    CHECK_MESSAGE(contains(card.text, text), card.text);
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

TEST_CASE("a text of the same parts that begins before another ends takes over") {
  const Workplace w;
  ml::write_file(w / "overlap.txt", "walk # 0 # 0.6\nrun # 0.4 # 1\n");
  for (const auto& out : {w.run({"check", "overlap.txt"}), w.run({"check", "overlap.txt", "--no-cut-texts"}),
                          w.generate("out", {}, "overlap.txt")})
    CHECK_MESSAGE(out.code == 0, out.text);
  const auto check = w.run({"check", "overlap.txt"});
  CHECK_MESSAGE(contains(check.text, "legs       [0.00-0.40 walk] [0.40-1.00 run]\n"), check.text);
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
                           "  head       37-39, 46-48, 133-138, 151-156, 229-231, 238-240\n",  // STMC src/bptools.py
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
