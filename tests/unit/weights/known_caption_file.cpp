// Known captions in the files of weights.
#include <motionlang/weights/known_caption_file.hpp>

#include <doctest/doctest.h>

#include <limits>

#include <motionlang/backend/eigen.hpp>
#include <motionlang/generate/load_motion_model.hpp>
#include <motionlang/weights/caption_encoder_file.hpp>

#include "../../support/check_error.hpp"
#include "../../support/small_model.hpp"
#include "../../support/temporary_folder.hpp"
#include "../../support/word_count_encoder.hpp"

namespace ml = motionlang;
using B = ml::EigenBackend<float>;

namespace {

struct Contents {
  std::vector<ml::TensorView> tensors{};
  std::map<std::string, std::string> metadata{};
};

Contents contents(const ml::StoredCaptions& stored) {
  Contents out;
  stored.add_to(out.tensors, out.metadata);
  return out;
}

}  // namespace

TEST_CASE("what is written is read") {
  const TemporaryFolder folder;
  const auto captions = counted::captions();
  const ml::StoredCaptions stored(captions);
  const Contents c = contents(stored);
  ml::write_safetensors(folder / "captions", c.tensors, c.metadata);
  const auto read = ml::stored_known_captions(ml::SafetensorsFile::open(folder / "captions"), counted::vectors);
  CHECK(read.table().texts() == captions.table().texts());
  CHECK(read.nearness() == captions.nearness());
  REQUIRE(read.actions().size() == 3);
  for (std::size_t i = 0; i < 3; ++i) {
    CHECK(read.actions()[i].seconds == captions.actions()[i].seconds);
    CHECK(read.actions()[i].repeats == captions.actions()[i].repeats);
    CHECK(read.actions()[i].then == captions.actions()[i].then);
  }
  CHECK(read.nearest("kick", 1)[0].likeness == captions.nearest("kick", 1)[0].likeness);
  CHECK(contents(ml::StoredCaptions(ml::KnownCaptions())).tensors.empty());
}

TEST_CASE("captions of a file are replaced, with texts that were tried") {
  const TemporaryFolder folder;
  const ml::StoredCaptions stored(counted::captions());
  Contents c = contents(stored);
  const std::vector<float> weight{1, 2};
  c.tensors.push_back(ml::tensor_view("weight", {2}, std::span(weight)));
  c.metadata["license"] = "MIT";
  const auto path = folder / "weights";
  ml::write_safetensors(path, c.tensors, c.metadata);
  ml::replace_known_captions(path, counted::captions().with_tried({"walk again", "kick hard"}, {0.5, 0.25}));
  const auto file = ml::SafetensorsFile::open(path);
  CHECK(file.metadata().at("license") == "MIT");
  CHECK(ml::values_of<float>(file.tensor("weight")) == weight);
  const auto read = ml::stored_known_captions(file, counted::vectors);
  CHECK(read.done() == std::vector<double>{0.5, 0.25});
  CHECK(*read.success("kick hard") == 0.25);
  CHECK(read.actions().size() == 3);
  ml::replace_known_captions(path, {});
  CHECK(ml::stored_known_captions(ml::SafetensorsFile::open(path), counted::vectors).empty());
  CHECK(ml::SafetensorsFile::open(path).tensors().size() == 1);
}

TEST_CASE("files whose parts do not fit are refused") {
  const TemporaryFolder folder;
  const ml::StoredCaptions stored(counted::captions());
  const auto refused = [&](const char* message, auto change) {
    Contents c = contents(stored);
    change(c);
    ml::write_safetensors(folder / "wrong", c.tensors, c.metadata);
    CHECK_ERROR(ml::stored_known_captions(ml::SafetensorsFile::open(folder / "wrong"), counted::vectors), message);
  };
  refused("tensor 'captions.codes' is I8 (3, 8), not I8 (2, 8)",
          [](Contents& c) { c.metadata["captions"] = "walk\nkick"; });
  refused("metadata 'captions.then' is missing", [](Contents& c) { c.metadata.erase("captions.then"); });
  refused("caption 2 is followed by text 1 of 1", [](Contents& c) { c.metadata["captions.then"] = "stand still"; });
  refused("'captions.nearness' = 'near' is not in 0 ... 1",
          [](Contents& c) { c.metadata["captions.nearness"] = "near"; });
  refused("'captions.nearness' = '' is not in 0 ... 1", [](Contents& c) { c.metadata["captions.nearness"] = ""; });
  const std::vector<float> nan{std::numeric_limits<float>::quiet_NaN(), 2, 3}, long_time{1, 2, 1e6f}, three{1, 1, 2};
  const auto replace = [](Contents& c, const std::string& name, const std::vector<float>& values) {
    std::erase_if(c.tensors, [&](const ml::TensorView& t) { return t.name == name; });
    c.tensors.push_back(ml::tensor_view(name, {std::ssize(values)}, std::span(values)));
  };
  refused("tensor 'captions.seconds' has a nan; 0 ... 3600 are allowed",
          [&](Contents& c) { replace(c, "captions.seconds", nan); });
  refused("tensor 'captions.seconds' has a 1000000; 0 ... 3600",
          [&](Contents& c) { replace(c, "captions.seconds", long_time); });
  // All texts are tried, and none is a caption.
  refused("tensor 'captions.done' has 3 shares for 3 texts", [&](Contents& c) { replace(c, "captions.done", three); });
  const std::vector<float> mean(8, nan[0]);
  refused("tensor 'captions.mean' has a nan", [&](Contents& c) { replace(c, "captions.mean", mean); });
  const std::vector<float> share{2}, two{1, 2};
  const std::vector<std::int16_t> after{-1, 0};
  refused("tensor 'captions.done' has a 2; 0 ... 1 are allowed", [&](Contents& c) {
    replace(c, "captions.done", share);
    replace(c, "captions.seconds", two);
    std::erase_if(c.tensors, [&](const ml::TensorView& t) { return t.name == "captions.then"; });
    c.tensors.push_back(ml::tensor_view("captions.then", {2}, std::span(after)));
  });
  refused("[motionlang.io.406]", [](Contents& c) {
    std::erase_if(c.tensors, [](const ml::TensorView& t) { return t.name == "captions.seconds"; });
  });
}

TEST_CASE("texts that a file cannot hold are refused before it is written") {
  const auto with = [](const std::string& text, const std::string& then) {
    const std::vector<std::string> texts{"walk", text};
    return ml::KnownCaptions(ml::TextTable::encoded(texts, counted::vectors), {{3, true, ""}, {2, false, then}}, 0.5);
  };
  CHECK_ERROR(ml::StoredCaptions(with("kick\nagain", "stand")), "[motionlang.config.101]");
  CHECK_ERROR(ml::StoredCaptions(with("", "stand")), "'' cannot be stored");
  CHECK_ERROR(ml::StoredCaptions(with("kick", "")), "'' cannot be stored");
}

TEST_CASE("the file of a model has its captions, and every loader reads them") {
  const TemporaryFolder folder;
  const auto config = small::config();
  const auto model = ml::make_stmc<B>(config, small::tokenizer(), ml::Philox{.seed = 1});
  const std::vector<std::string> texts{"walk forward", "sit down"};
  const ml::KnownCaptions captions(ml::TextTable::encoded(texts, ml::text_vectors(model.text_encoder)),
                                   {{4, true, ""}, {2, false, "sit quietly"}}, 0.4);
  const auto with = folder / "with.safetensors", without = folder / "without.safetensors";
  ml::save_stmc(with, model, config, {{"text.words", "forward\nwalk"}}, ml::DType::F32, captions);
  ml::save_stmc(without, model, config, {}, ml::DType::F32);

  const auto loaded = ml::load_stmc<B>(ml::FilePath(with));
  const auto read = ml::load_known_captions(with, loaded.text_encoder);
  CHECK(read.nearest("sit down", 1)[0].text == "sit down");
  CHECK(read.action("walk forward")->seconds == 4);
  CHECK(ml::load_known_captions(without, loaded.text_encoder).empty());

  const auto alone = ml::load_known_captions<B>(with);  // without the denoiser
  CHECK(alone.table().texts() == texts);
  for (const std::string text : {"sit down again", "walk"})
    CHECK(alone.nearest(text, 1)[0].likeness == read.nearest(text, 1)[0].likeness);
  CHECK(ml::load_known_captions<B>(without).empty());

  const auto checkpoint = ml::load_stmc<B>(ml::FilePath(with), ml::CheckpointOptions{});
  CHECK(ml::load_known_captions<B>(ml::FilePath(with), checkpoint).table().texts() == texts);
  const auto any = ml::load_diffusion_motion_model<B>({with, ""});
  CHECK(any->captions().action("sit down")->then == "sit quietly");
  CHECK(any->words().knows("walk"));
  CHECK(ml::load_diffusion_motion_model<B>({without, ""})->captions().empty());
}
