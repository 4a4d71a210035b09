// generate --record, --reuse, --keep-beyond and --preset, judge --compare: what they write and what they say.
#include <doctest/doctest.h>

#include <motionlang/backend/eigen.hpp>

#include "../support/small_model.hpp"
#include "../support/temporary_folder.hpp"
#include "process.hpp"

namespace ml = motionlang;
using B = ml::EigenBackend<float>;

namespace {

/// A folder with a small model of twelve steps and two versions of a timeline of six texts.
struct Edited : TemporaryFolder {
  Edited() {
    const auto config = small::config(12);
    ml::save_stmc(*this / "model.safetensors", small::model<B>(config), config, {{"license", "MIT"}});
    ml::save_stmc(*this / "other.safetensors", small::model<B>(config, 2), config, {{"license", "MIT"}});
    write("before.txt", "walk forward");
    write("after.txt", "sit down");
  }
  void write(const std::string& file, const std::string& second) const {
    ml::write_file(
        *this / file,
        "sit down # 0 # 1\n" + second +
            " # 1 # 2\nwalk forward # 2 # 3\nraise both arms # 3 # 4\nsit down # 4 # 5\nwalk forward # 5 # 6\n");
  }
  Outcome generate(const std::string& timeline, const std::string& out, std::vector<std::string> more = {},
                   const std::string& model = "model.safetensors") const {
    more.insert(more.begin(), {"generate", "--timeline", timeline, "--model", model, "--out", out});
    return run(more, path);
  }
  std::string bytes(const std::string& file) const { return ml::read_file(*this / file); }
};

}  // namespace

TEST_CASE("a motion after an edit is that of a whole run, and the program says what was reused") {
  const Edited w;
  const std::vector<std::string> settings{"--seed", "5", "--preset", "fast", "--guidance", "2", "--overlap", "0.3"};
  auto recorded = settings;
  recorded.push_back("--record");
  const auto first = w.generate("before.txt", "a", recorded);
  REQUIRE_MESSAGE(first.code == 0, first.text);
  CHECK_FALSE(contains(first.text, "reused"));
  CHECK(w.generate("before.txt", "plain", settings).code == 0);
  CHECK_FALSE(std::filesystem::exists(w / "plain/before.steps.safetensors"));
  CHECK(w.bytes("plain/before.bvh") == w.bytes("a/before.bvh"));
  CHECK(ml::SafetensorsFile::open(w / "a/before.steps.safetensors").tensors().size() == 10 + 1);

  const auto again = w.generate("after.txt", "b", {"--reuse", "a"});
  REQUIRE_MESSAGE(again.code == 0, again.text);
  CHECK_MESSAGE(contains(again.text, "0 of 120 frames were reused; "), again.text);
  CHECK_MESSAGE(contains(again.text, "the motion equals that of a whole run, bit for bit"), again.text);
  CHECK_MESSAGE(contains(again.text, "after step 5 of 10 nothing could be reused"), again.text);
  CHECK(w.generate("after.txt", "whole", settings).code == 0);
  for (const char* extension : {".bvh", ".npz", ".html"})
    CHECK_MESSAGE(w.bytes(std::string("b/after") + extension) == w.bytes(std::string("whole/after") + extension),
                  extension);

  // and from there again, with a record that was made by --reuse: nothing edited, nothing made
  const auto same = w.generate("after.txt", "c", {"--reuse", "b/after.steps.safetensors"});
  CHECK_MESSAGE(contains(same.text, "120 of 120 frames were reused; 0 % of the work of a whole run"), same.text);
  CHECK(w.bytes("c/after.bvh") == w.bytes("b/after.bvh"));
}

TEST_CASE("samples are reused like any motion") {
  const Edited w;
  REQUIRE(w.generate("before.txt", "a", {"--record", "--preset", "fast", "--samples", "2"}).code == 0);
  const auto same = w.generate("before.txt", "b", {"--reuse", "a", "--samples", "2"});
  REQUIRE_MESSAGE(same.code == 0, same.text);
  CHECK_MESSAGE(contains(same.text, "240 of 240 frames were reused"), same.text);
  for (const char* file : {"/before_1.bvh", "/before_2.bvh"})
    CHECK(w.bytes(std::string("a") + file) == w.bytes(std::string("b") + file));
}

TEST_CASE("--keep-beyond keeps what is further away and the program says that it is not a whole run") {
  const Edited w;
  const std::vector<std::string> raw{"--no-smooth", "--no-fix-feet", "--no-fix-floor"};
  auto recorded = raw, kept = raw;
  recorded.push_back("--record");
  kept.insert(kept.end(), {"--reuse", "a", "--keep-beyond", "0.5"});
  CHECK(w.generate("before.txt", "a", recorded).code == 0);
  const auto out = w.generate("after.txt", "b", kept);
  REQUIRE_MESSAGE(out.code == 0, out.text);
  // made anew: 1 s, 5 frames of overlap and 10 further on each side
  CHECK_MESSAGE(contains(out.text, "70 of 120 frames were reused"), out.text);
  CHECK_MESSAGE(
      contains(out.text,
               "the motion differs from that of a whole run: frames further than 0.50 s from an edit were kept"),
      out.text);
}

TEST_CASE("records that do not fit are refused") {
  const Edited w;
  CHECK(w.generate("before.txt", "a", {"--record", "--steps", "2"}).code == 0);
  CHECK(w.generate("after.txt", "b", {"--reuse", "a", "--seed", "3"}).code == 2);
  CHECK(w.generate("after.txt", "b", {"--reuse", "a", "--preset", "fast"}).code == 2);
  CHECK(w.generate("after.txt", "b", {"--keep-beyond", "1"}).code == 2);
  CHECK(w.generate("after.txt", "b", {"--preset", "fast", "--steps", "3"}).code == 2);
  CHECK(w.generate("after.txt", "b", {"--reuse", "nowhere"}).code == 2);
  const auto multistep = w.generate("after.txt", "b", {"--record", "--sampler", "plms"});
  CHECK(multistep.code == 1);
  CHECK_MESSAGE(contains(multistep.text, "nothing of a run with the sampler plms can be kept"), multistep.text);
  const auto other = w.generate("after.txt", "b", {"--reuse", "a"}, "other.safetensors");
  CHECK(other.code == 1);
  CHECK_MESSAGE(contains(other.text, "a/before.steps.safetensors: made with weights of checksum"), other.text);
  std::filesystem::create_directory(w / "empty");
  const auto none = w.generate("after.txt", "b", {"--reuse", "empty"});
  CHECK(none.code == 1);
  CHECK_MESSAGE(contains(none.text, "empty: 0 files *.steps.safetensors, which a run with --record writes"), none.text);
  CHECK(w.generate("after.txt", "a", {"--record", "--steps", "2"}).code == 0);
  CHECK(contains(w.generate("after.txt", "b", {"--reuse", "a"}).text,
                 "a: 2 files *.steps.safetensors; name one of them"));
}

TEST_CASE("judge compares numbers of steps in a table") {
  const Edited w;
  const auto out = run({"judge", "--model", "model.safetensors", "--seeds", "2", "--compare", "12", "4"}, w.path);
  REQUIRE_MESSAGE(out.code == 0, out.text);
  for (const char* row : {"| ddpm | 12 | ", "| ddpm | 4 | ", "| ddim | 12 | ", "| ddim | 4 | ", "| plms | 12 | ",
                          "between two seeds: ddpm "})
    CHECK_MESSAGE(contains(out.text, row), row, " in ", out.text);
  CHECK(contains(out.text, "| 0 | "));  // the distance of the first from itself
  CHECK(run({"judge", "--compare", "10", "--steps", "4"}, w.path).code == 2);
  const auto more = run({"judge", "--model", "model.safetensors", "--compare", "4", "13"}, w.path);
  CHECK(more.code == 2);
  CHECK_MESSAGE(contains(more.text, "13 steps are asked for, this model has 12"), more.text);
  CHECK_FALSE(contains(more.text, "| sampler |"));  // before anything is made
}
