// Files of word vectors, and the published tables from which they are selected.
#include <doctest/doctest.h>

#include <motionlang/backend/eigen.hpp>
#include <motionlang/file/file.hpp>
#include <motionlang/generate/stmc_motion_model.hpp>
#include <motionlang/generate/text_warnings.hpp>
#include <motionlang/weights/stmc_file.hpp>
#include <motionlang/weights/word_vector_file.hpp>
#include <motionlang/weights/word_vector_source.hpp>

#include "../../support/check_error.hpp"
#include "../../support/small_model.hpp"
#include "../../support/temporary_folder.hpp"

namespace ml = motionlang;
using B = ml::EigenBackend<float>;
using Words = std::vector<std::string>;

namespace {

/// The commonest first, with what no text says: marks, names with dots.
constexpr const char* glove_text =
    "the 1 1\n"
    ", 5 5\n"
    "walk 3 -1\n"
    "u.s. 9 9\n"
    "stroll 2 0\n"
    "pirouette 0 4\n";

}  // namespace

TEST_CASE("the commonest words and those of texts are taken, without their mean") {
  const TemporaryFolder folder;
  const auto path = folder / "glove.txt";
  ml::write_file(path, std::string_view(glove_text));
  const auto table = ml::select_word_vectors(path, {.commonest = 2, .also = {"A pirouette, and a jete"}});
  CHECK(table.words() == Words{"pirouette", "the", "walk"});
  // means of the three: 4/3, 4/3
  CHECK(table.vector(*table.find("walk"))[0] == doctest::Approx(3 - 4.0 / 3).epsilon(0.01));
  CHECK(table.vector(*table.find("pirouette"))[1] == doctest::Approx(4 - 4.0 / 3).epsilon(0.01));

  const std::string json =
      R"({"precision": 8, "dimensions": 2, "words": ["the", ",", "walk", "u.s.", "stroll", "pirouette"],
          "vectors": {"the": [1, 1, 9, 0], ",": [5, 5, 9, 1], "walk": [3, -1, 9, 2], "stroll": [2, 0, 9, 3],
                      "pirouette": [0, 4, 9, 4]}})";
  const auto json_path = folder / "wink.json";
  ml::write_file(json_path, std::string_view(json));
  const auto same = ml::select_word_vectors(json_path, {.commonest = 2, .also = {"pirouette"}});
  CHECK(same.words() == table.words());
  CHECK(std::equal(same.codes().begin(), same.codes().end(), table.codes().begin(), table.codes().end()));
}

TEST_CASE("a file that is not a table of vectors is refused with the place") {
  const TemporaryFolder folder;
  const auto path = folder / "glove.txt";
  const auto refused = [&](std::string_view text, const char* message) {
    ml::write_file(path, text);
    CHECK_ERROR(ml::select_word_vectors(path), message);
  };
  refused("walk 1 2\nrun 1\n", "line 2: 1 number for 'run', others have 2");
  refused("walk 1 2\nrun 1 x\n", "line 2: 'x' is not a number");
  refused("walk 1 inf\n", "a number of 'walk' is inf");
  refused("walk\n", "line 1: 0 numbers for 'walk'");
  refused("", "no vectors of words that are wanted");
  refused(R"({"words": ["walk"]})", "has no member 'vectors'");
  CHECK_ERROR(ml::select_word_vectors(folder / "none"), "[motionlang.io.401]");
}

TEST_CASE("vectors are written and read, alone and beside a model") {
  const TemporaryFolder folder;
  const auto table = ml::WordVectors::rounded(Words{"walk", "stroll"}, std::vector<float>{1, 0, 0.9f, 0.1f});
  const auto path = folder / "words.safetensors";
  ml::write_word_vectors(path, table, {{"license", "PDDL"}});
  const auto read = ml::read_word_vectors(path);
  CHECK(read.words() == table.words());
  CHECK(std::equal(read.codes().begin(), read.codes().end(), table.codes().begin(), table.codes().end()));
  CHECK(ml::SafetensorsFile::open(path).metadata().at("license") == "PDDL");

  const auto config = small::config();
  const auto model = ml::make_stmc<B>(config, small::tokenizer(), ml::Philox{.seed = 1}, table);
  const auto with = folder / "with.safetensors", without = folder / "without.safetensors";
  ml::save_stmc(with, model, config, {});
  const auto loaded = ml::load_stmc<B>(with);
  CHECK(loaded.text_encoder.vectors.words() == table.words());
  const Words texts{"stroll forward"};
  const auto before = model.text_encoder(texts), after = loaded.text_encoder(texts);
  for (std::size_t k = 0; k < before.span().size(); ++k)
    CHECK(after.span()[k] == doctest::Approx(before.span()[k]).epsilon(0.02));  // half precision

  const auto heard = ml::stmc_motion_model(ml::load_stmc<B>(with), {"walk", "forward"});
  CHECK(ml::unknown_word_warnings("stroll forward", heard->words()).empty());
  CHECK(ml::unknown_word_warnings("glide forward", heard->words()).size() == 1);
  CHECK(heard->length_of("stroll forward").pieces == 1 + ml::stmc_motion_model(loaded)->length_of("forward").pieces);

  ml::save_stmc(without, ml::make_stmc<B>(config, small::tokenizer(), ml::Philox{.seed = 1}), config, {});
  CHECK(ml::load_stmc<B>(without).text_encoder.vectors.empty());
  CHECK_ERROR(ml::read_word_vectors(without), "[motionlang.config.103]");
}

TEST_CASE("a table whose sizes disagree is refused") {
  const TemporaryFolder folder;
  const auto path = folder / "wrong.safetensors";
  const std::vector<std::int8_t> codes{1, 2};
  const std::vector<float> scales{1, 1};
  const std::vector<ml::TensorView> tensors{ml::tensor_view("codes", {1, 2}, std::span(codes)),
                                            ml::tensor_view("scales", {2}, std::span(scales))};
  ml::write_safetensors(path, tensors, {{"vector_words", "run\nwalk"}});
  CHECK_ERROR(ml::read_word_vectors(path), "[motionlang.io.407]");
  ml::write_safetensors(path, tensors, {{"vector_words", "walk"}});
  CHECK(ml::read_word_vectors(path).size() == 1);
}
