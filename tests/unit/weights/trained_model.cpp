#include <motionlang/weights/trained_model.hpp>
#include <motionlang/weights/word_vector_file.hpp>

#include <doctest/doctest.h>

#include "../../support/check_error.hpp"
#include "../../support/temporary_folder.hpp"

namespace ml = motionlang;

TEST_CASE("a trained model says its licence and provenance, and the rest under about") {
  const ml::ModelFolder model =
      ml::described_model("tmr", {{"license", "MIT"}, {"provenance", "drawn"}, {"data", "3 motions"}});
  CHECK(model.system == "tmr");
  CHECK(model.license == "MIT");
  CHECK(model.provenance == "drawn");
  CHECK(model.others.at("about").at("data") == "3 motions");
  CHECK_FALSE(model.others.at("about").contains("license"));
}

TEST_CASE("a model is written over an older one") {
  const TemporaryFolder folder;
  const auto write = [&](float value) {
    ml::TensorStore store;
    store.add<float>("weight", {1}, std::vector{value}, ml::DType::F32);
    ml::overwrite_model(folder / "model", ml::described_model("tmr", {{"license", "MIT"}, {"provenance", "drawn"}}),
                        store);
  };
  write(1);
  write(2);
  CHECK(ml::read_model_folder(folder / "model").license == "MIT");
  const auto file = ml::SafetensorsFile::open(folder / "model/weights.safetensors");
  CHECK(ml::values_of<float>(file.tensor("weight")) == std::vector{2.0f});
  const auto vectors = ml::WordVectors({"walk", "wave"}, {1, 2}, {0.5f});
  const ml::ModelWordVectors words{vectors, "words.vectors."};
  ml::overwrite_model(folder / "model", ml::described_model("tmr", {{"license", "MIT"}, {"provenance", "drawn"}}), {},
                      &words);
  const auto with_words = ml::SafetensorsFile::open(folder / "model/weights.safetensors");
  CHECK(ml::stored_word_vectors(with_words, "words.vectors.").checksum() == vectors.checksum());
  CHECK(with_words.metadata().at("format") == "motionlang");
  CHECK_ERROR(ml::overwrite_model(folder / "bad", ml::described_model("tmr", {{"license", "MIT"}}), {}),
              "[motionlang.config.101]");
}
