// motionlang does not overwrite its input files: under another name, from folder into folder, of several kinds.
#include <doctest/doctest.h>

#include <motionlang/file/npy.hpp>
#include <motionlang/formats/bvh.hpp>
#include <motionlang/formats/glb.hpp>
#include <motionlang/kinematics/skeleton_tables.hpp>
#include <motionlang/weights/module_file.hpp>

#include "../support/rigs.hpp"
#include "../support/synthetic_motion.hpp"
#include "../support/temporary_folder.hpp"
#include "process.hpp"

namespace ml = motionlang;

namespace {

struct Originals : TemporaryFolder {
  void walk(const std::string& file, int frames = 20) const {
    std::filesystem::create_directories((*this / file).parent_path());
    ml::write_bvh(*this / file, synthetic::walk({.frames = frames}));
  }
  /// Refused for this file, which stays as it is.
  void keeps(const std::string& file, const std::vector<std::string>& arguments, int code = 2) const {
    const std::string before = ml::read_file(*this / file);
    const Outcome out = ::run(arguments, path);
    CHECK_MESSAGE(out.code == code, arguments[0], ": ", out.text);
    CHECK_MESSAGE(contains(out.text, file + " is an input"), out.text);
    CHECK(ml::read_file(*this / file) == before);
  }
};

}  // namespace

TEST_CASE("from folder into folder no original is written over") {
  const Originals w;
  w.walk("d/a/x.bvh", 10);
  w.walk("d/a/a/x.bvh", 20);
  w.keeps("d/a/x.bvh", {"convert", "d/a", "d", "--as", ".bvh"}, 1);
  w.keeps("d/a/x.bvh", {"doctor", "d/a", "--clean", "d"});
  ml::write_bvh(w / "d/page.bvh", synthetic::walk({.frames = 5}));
  w.keeps("d/page.bvh", {"join", "d/page.bvh", "d/a/x.bvh", "-o", "d/page.bvh"});
}

TEST_CASE("a link to an original is the original") {
  const Originals w;
  w.walk("walk.bvh");
  std::filesystem::create_symlink("walk.bvh", w / "link.bvh");
  w.keeps("link.bvh", {"convert", "walk.bvh", "link.bvh", "--mirror"});
  w.keeps("walk.bvh", {"convert", "link.bvh", "walk.bvh", "--mirror"});
  std::filesystem::create_hard_link(w / "walk.bvh", w / "same.bvh");
  w.keeps("same.bvh", {"convert", "walk.bvh", "same.bvh", "--mirror"});
}

TEST_CASE("a character, weights and texts are not written over") {
  const Originals w;
  w.walk("walk.bvh");
  ml::write_file(w / "hero.glb", rigs::glb_of(rigs::skeleton_of(ml::skeleton_table("Mixamo"), 0, 1, {}, "mixamorig:")));
  w.keeps("hero.glb", {"convert", "walk.bvh", "hero.glb", "--rig", "hero.glb", "--drop-animations"});

  ml::TensorStore store;
  store.add<double>("weight", ml::Shape{2}, std::vector<double>{1, 2}, ml::DType::F32);
  ml::write_safetensors(w / "m.safetensors", store.views());
  w.keeps("m.safetensors", {"convert", "m.safetensors", "m.safetensors", "--store", "F16"});

  ml::write_file(w / "babel.json", std::string_view(R"({"1": {"babel_sid": 1, "url": "", "feat_p": "X/f_poses.npz",
    "dur": 2.0, "seq_ann": {"labels": [{"raw_label": "walk", "proc_label": "walk", "seg_id": "a"}]},
    "frame_ann": null}})"));
  w.keeps("babel.json", {"convert", "babel.json", "babel.json"});
}

TEST_CASE("what an earlier run wrote is not an input: weights into their own folder, copies below the originals") {
  const Originals w;
  ml::TensorStore store;
  store.add<double>("weight", ml::Shape{2}, std::vector<double>{1, 2}, ml::DType::F32);
  std::filesystem::create_directories(w / "tm");
  ml::write_safetensors(w / "tm/model.safetensors", store.views());
  const std::vector<std::string> half{"convert", "tm", "tm/half.safetensors", "--store", "F16"};
  for (int i = 0; i < 2; ++i) {
    const Outcome out = run(half, w.path);
    CHECK_MESSAGE((out.code == 0 && contains(out.text, "1 tensor, 2 numbers")), out.text);
  }
  w.keeps("tm/model.safetensors", {"convert", "tm", "tm/model.safetensors", "--store", "F16"});
  ml::write_file(w / "tm/model.safetensors.index.json", std::string_view(R"({"weight_map": {"weight": "a.st"}})"));
  std::filesystem::rename(w / "tm/model.safetensors", w / "tm/a.st");
  std::filesystem::create_symlink("a.st", w / "tm/link.safetensors");
  w.keeps("tm/link.safetensors", {"convert", "tm", "tm/link.safetensors", "--store", "F16"});

  w.walk("d/x.bvh");
  w.walk("d/sub/y.bvh");
  const auto into = [&](std::vector<std::string> arguments, const std::string& folder, const std::string& text) {
    arguments.push_back("d/" + folder);
    for (int i = 0; i < 2; ++i) {
      const Outcome out = run(arguments, w.path);
      CHECK_MESSAGE((out.code == 0 && contains(out.text, text)), out.text);
      CHECK_MESSAGE(contains(out.text, "not read: d/" + folder + ", where results go") == (i == 1), out.text);
    }
  };
  into({"doctor", "d", "--clean"}, "clean", "2 motions, ");
  CHECK(std::filesystem::exists(w / "d/clean/sub/y.bvh"));
  std::filesystem::remove_all(w / "d/clean");
  into({"convert", "d", "--as", ".bvh"}, "again", "d/again: 2 of 2 files converted");
  CHECK(!std::filesystem::exists(w / "d/again/again"));
  std::filesystem::remove_all(w / "d/again");
  into({"convert", "d", "--features", "guoh3d"}, "set", "d/set: 2 of 2 files converted");
  std::filesystem::remove_all(w / "d/set");
  std::filesystem::create_directory_symlink("sub", w / "d/link");  // the folder, by whatever name
  const Outcome linked = run({"convert", "d", "d/link", "--as", ".bvh"}, w.path);
  CHECK_MESSAGE(contains(linked.text, "d/link: 1 of 1 file converted"), linked.text);
  for (const char* itself : {"d", "d/sub/.."}) {
    const Outcome out = run({"convert", "d", itself, "--as", ".bvh"}, w.path);
    CHECK_MESSAGE((out.code == 2 && contains(out.text, ".bvh files of d cannot go into the folder itself")), out.text);
  }
}

TEST_CASE("answers, questions and labels of body parts are not written over") {
  const Originals w;
  ml::write_file(w / "a.jsonl", std::string_view(R"({"label": "walk", "answer": "legs"})"
                                                 "\n"));
  ml::write_file(w / "labels.txt", std::string_view("walk\nwave\n"));
  w.keeps("a.jsonl", {"body-parts", "--answers", "a.jsonl", "--table", "a.jsonl"});
  w.keeps("a.jsonl", {"body-parts", "--labels", "labels.txt", "--answers", "a.jsonl", "--prompts", "a.jsonl"});
  w.keeps("labels.txt", {"body-parts", "--labels", "labels.txt", "--prompts", "labels.txt"});
}

TEST_CASE("an output that is an input is refused before a model is loaded") {
  const Originals w;
  w.walk("walk.bvh");
  std::filesystem::create_directories(w / "model");  // none
  ml::write_file(w / "model/opt.txt", std::string_view("---- Options\n---- End\n"));
  w.keeps("walk.bvh", {"convert", "walk.bvh", "walk.bvh", "--denoise", "model"});
  w.keeps("walk.bvh", {"describe", "walk.bvh", "--model", "model", "-o", "walk.bvh"});
  w.keeps("walk.bvh", {"tokens", "walk.bvh", "--model", "model", "--page", "walk.bvh"});
  w.keeps("walk.bvh", {"generate", "--text", "walk", "--keep", "walk.bvh", "--keep-parts", "legs", "--model", "model",
                       "--out", "."});
  ml::write_file(w / "two.txt", std::string_view("walk # 0 # 1\n\nsit down # 0 # 1\n"));
  w.walk("two_1.bvh");
  w.keeps("two_1.bvh", {"generate", "--timeline", "two.txt", "--keep", "two_1.bvh", "--keep-parts", "legs", "--model",
                        "model", "--out", "."});
  const Outcome other = run({"generate", "--timeline", "two.txt", "--keep", "walk.bvh", "--keep-parts", "legs",
                             "--model", "model", "--out", "."},
                            w.path);
  CHECK_MESSAGE((other.code == 1 && contains(other.text, "[motionlang.io.401] model")), other.text);
  const Outcome itself = run({"convert", ".", ".", "--as", ".bvh", "--denoise", "model"}, w.path);
  CHECK_MESSAGE((itself.code == 2 && contains(itself.text, "cannot go into the folder itself")), itself.text);
}

TEST_CASE("texts of two motions that would be one file are refused, those of no duration are reported") {
  const Originals w;
  const auto entry = [](const char* id, const char* times) {
    return ml::concat_text("\"", id, R"(": {"babel_sid": 7, "url": "", "feat_p": "X/f_poses.npz", "dur": 2.0,
      "seq_ann": null, "frame_ann": {"labels": [{"proc_label": "sit", )",
                           times, R"(}, {"proc_label": "walk", "start_t": 0, "end_t": 1}]}})");
  };
  ml::write_file(w / "babel.json", "{" + entry("7", R"("start_t": 0, "end_t": 0)") + "}");
  const Outcome one = run({"convert", "babel.json", "texts"}, w.path);
  CHECK_MESSAGE(one.code == 0, one.text);
  CHECK_MESSAGE(contains(one.text, "babel.json: 1 text of no duration is left out"), one.text);
  CHECK(ml::read_file(w / "texts/texts/00007.txt") == "walk##0.0#1.0\n");

  const std::string times = R"("start_t": 1, "end_t": 2)";
  ml::write_file(w / "babel.json", "{" + entry("M/1", times.c_str()) + "," + entry("M_1", times.c_str()) + "}");
  const Outcome two = run({"convert", "babel.json", "more"}, w.path);
  CHECK(two.code == 1);
  CHECK_MESSAGE(contains(two.text, "'M/1' and 'M_1' would both be the file M_1.txt"), two.text);
  CHECK(!std::filesystem::exists(w / "more"));
}

TEST_CASE("a clip of a data set is not replaced by that of another motion") {
  const Originals w;
  w.walk("walk.bvh", 40);
  REQUIRE(run({"convert", "walk.bvh", "set", "--features", "guoh3d"}, w.path).code == 0);
  CHECK(run({"convert", "walk.bvh", "set", "--features", "guoh3d"}, w.path).code == 0);  // the same again
  w.walk("walk.bvh", 60);
  const std::string before = ml::read_file(w / "set/new_joint_vecs/walk.npy");
  const Outcome other = run({"convert", "walk.bvh", "set", "--features", "guoh3d"}, w.path);
  CHECK(other.code == 1);
  CHECK_MESSAGE(contains(other.text,
                         "set/new_joint_vecs/walk.npy: the clip 'walk' exists already with another motion; --replace "
                         "overwrites it"),
                other.text);
  CHECK(ml::read_file(w / "set/new_joint_vecs/walk.npy") == before);

  std::filesystem::create_directories(w / "set/texts");
  ml::write_file(w / "set/texts/walk.txt", std::string_view("a person walks#a/DET person/NOUN walk/VERB#0.0#0.0\n"));
  const Outcome replaced = run({"convert", "walk.bvh", "set", "--features", "guoh3d", "--replace"}, w.path);
  CHECK_MESSAGE((replaced.code == 0 && contains(replaced.text, "clip walk, 59 frames at 20 per second, 1 caption")),
                replaced.text);
  CHECK(ml::read_npy(w / "set/new_joint_vecs/walk.npy").shape == std::vector<ml::Index>{59, 263});
  CHECK(ml::read_npy(w / "set/new_joints/walk.npy").shape.front() == 59);
  CHECK(ml::read_file(w / "set/all.txt") == "walk\n");
  const Outcome alone = run({"convert", "walk.bvh", "walk.npz", "--replace"}, w.path);
  CHECK_MESSAGE((alone.code == 2 && contains(alone.text, "--replace: is for clips of a data set")), alone.text);
}
