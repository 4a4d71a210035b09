// motionlang remember: recordings and their captions go into weights, and generate follows them.
#include <doctest/doctest.h>

#include <motionlang/text/known_captions.hpp>

#include "../support/captioned_clips.hpp"
#include "small_workplace.hpp"

namespace {

/// Weights that know two captions, and the clips of captioned_clips.hpp.
struct Learned : Workplace {
  captioned::Clips clips;

  Learned() {
    const auto config = small::config(5);
    const auto model = small::model<B>(config);
    const std::vector<std::string> texts{"walk forward", "sit down"};
    const ml::KnownCaptions known(ml::TextTable::encoded(texts, ml::text_vectors(model.text_encoder)),
                                  {{3, true, ""}, {2, false, "sit"}}, 0.5);
    ml::save_stmc(*this / "learned.safetensors", model, config, {{"license", "MIT"}}, ml::DType::F32, known);
  }
  Outcome remember(const std::string& output, std::vector<std::string> more = {},
                   const std::string& model = "learned.safetensors") const {
    more.insert(more.begin(), {"remember", "--model", model, "--captions", clips.captions.string(), "--data",
                               clips.folder.path.string(), "--output", output});
    return run(more);
  }
  std::string swing(const std::string& out, const std::string& model, const std::string& recall) const {
    const Outcome made = run({"generate", "--text", "a person swings the arms slowly", "--seconds", "2", "--model",
                              model, "--out", out, "--recall", recall, "--no-smooth"});
    REQUIRE_MESSAGE(made.code == 0, made.text);
    for (const auto& [name, contents] : files(out)) {
      if (name.ends_with(".bvh")) return contents;
    }
    return "";
  }
};

}  // namespace

TEST_CASE("remember: generate follows the recordings, as far as --recall says") {
  const Learned w;
  const Outcome made = w.remember("with.safetensors");
  REQUIRE_MESSAGE(made.code == 0, made.text);
  CHECK_MESSAGE(contains(made.text, "with.safetensors remembers 3 motions"), made.text);
  CHECK_MESSAGE(contains(made.text, "4 captions of 6 captions recall one"), made.text);
  const std::string without = w.swing("a", "learned.safetensors", "1"), none = w.swing("b", "with.safetensors", "0"),
                    all = w.swing("c", "with.safetensors", "1");
  CHECK(!all.empty());
  CHECK(none == without);  // the network alone
  CHECK(all != none);
  const Outcome judged = w.run({"judge", "--model", "with.safetensors", "--recall", "0.5", "--seeds", "1"});
  CHECK_MESSAGE(judged.code == 0, judged.text);
}

TEST_CASE("remember: words choose recordings, and what does not fit is refused") {
  const Learned w;
  const Outcome some = w.remember("some.safetensors", {"--words", "swing,circle"});
  REQUIRE_MESSAGE(some.code == 0, some.text);
  CHECK_MESSAGE(contains(some.text, "remembers 2 motions"), some.text);
  const Outcome none = w.remember("none.safetensors", {"--words", "fly"});
  CHECK(none.code == 1);
  CHECK_MESSAGE(contains(none.text, "no caption has \"fly\""), none.text);
  CHECK_FALSE(std::filesystem::exists(w / "none.safetensors"));
  const Outcome unknown = w.remember("none.safetensors", {}, "model.safetensors");
  CHECK(unknown.code == 1);
  CHECK_MESSAGE(contains(unknown.text, "the model knows no captions"), unknown.text);
  CHECK(w.remember(w.clips.captions.string()).code == 2);  // it would overwrite what it reads
}
