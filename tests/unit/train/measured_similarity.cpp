// The meaning of the cosines of a TMR: the pairs that are measured, and as which kind.
#include <doctest/doctest.h>

#include <motionlang/backend/eigen.hpp>
#include <motionlang/train/measured_similarity.hpp>
#include <motionlang/train/presets.hpp>
#include <motionlang/weights/text_states.hpp>

namespace ml = motionlang;
using B = ml::EigenBackend<float>;

TEST_CASE("numbers are spread evenly") {
  CHECK(ml::detail::spread_numbers(3, 10) == std::vector<ml::Index>{0, 1, 2});
  CHECK(ml::detail::spread_numbers(10, 3) == std::vector<ml::Index>{0, 3, 6});
  CHECK(ml::detail::spread_numbers(10, -1).empty());
  CHECK(ml::detail::spread_numbers(0, 3).empty());
}

TEST_CASE("pairs of one clip and of like texts are not unlike; strangers count with their nearest motion") {
  // three motions of two clips; the texts "walk" and "stroll" say the same
  const std::vector<float> motions{1, 0, 0.6f, 0.8f, 0, 1}, texts{1, 0, 0, 1}, strange{-1, 0, 0.8f, 0.6f};
  ml::EmbeddingCache sentences(2);
  sentences.add("walk", std::vector<float>{1, 0});
  sentences.add("stroll", std::vector<float>{1, 0});
  sentences.add("sit", std::vector<float>{0, 1});
  const auto measured = [&](const std::vector<std::string>& motion_texts, const std::vector<std::string>& clips) {
    return ml::detail::scale_of_latents({{"walk", "sit"}, {0, 2}}, texts, motions, strange, 2, clips, motion_texts,
                                        sentences, 0.5);
  };
  const auto all = measured({"walk", "sit", "sit"}, {"a", "b", "c"});
  CHECK(all.pairs == 3);  // walk with 1 and 2, sit with 0: its pair with 1 has the same sentence
  CHECK(all.texts == 2);
  CHECK(all.strangers == 2);
  CHECK(all.cosines.front() == 0);                    // walk with 2, and sit with 0
  CHECK(all.cosines.back() == doctest::Approx(0.6));  // walk with 1
  CHECK(measured({"walk", "stroll", "sit"}, {"a", "b", "c"}).pairs == 3);
  CHECK(measured({"walk", "sit", "sit"}, {"a", "a", "c"}).pairs == 2);  // 1 is of the clip of walk
  CHECK(all.least == doctest::Approx(1));                               // both texts are at their motions
  CHECK(all.missed == 0);
  CHECK(all.fooled == 0);  // the nearest are 0 and 0.96
  CHECK(measured({"walk", "sit", "sit"}, {"a", "a", "a"}).empty());
}

TEST_CASE("a model is measured with the texts of the validation part, or of the training part without one") {
  auto config = ml::tmr_preset("small");
  config.network.latent_dim = 16, config.network.ff_size = 16, config.network.num_layers = 1, config.text.width = 8;
  const std::vector<std::string> captions{"a person walks", "someone sits down", "jump up and down"};
  const auto model =
      ml::make_text_motion<ml::Tmr, B>(config, 5, ml::WordPiece::learn(captions, 60), ml::Philox{.seed = 1});
  ml::DescribedMotions data;
  data.width = 5, data.fps = 20;
  for (std::size_t i = 0; i < 6; ++i) {
    std::vector<float> rows(50);
    for (std::size_t k = 0; k < rows.size(); ++k) rows[k] = static_cast<float>((k * (i + 3)) % 7) - 3;
    auto& part = i < 4 ? data.training : data.validation;
    part.push_back(
        {std::to_string(i), std::to_string(i), rows, {{captions[i % 3], {0, 10}}, {captions[i % 3], {0, 10}}}});
  }
  const auto sentences = ml::sentence_vectors<B>("", data);
  const ml::StrangerTexts strangers(model.words->tokenizer);
  const auto scale = ml::measured_similarity(model, data, nullptr, sentences, &strangers, {.strangers = 7});
  CHECK(scale.texts == 4);      // two of each held-out motion
  CHECK(scale.pairs == 4 * 4);  // with the motions of other texts
  CHECK(scale.strangers == 7);
  CHECK(scale == ml::measured_similarity(model, data, nullptr, sentences, &strangers, {.strangers = 7}));
  CHECK(ml::measured_similarity(model, data, nullptr, sentences, nullptr).least == -1);
  CHECK(ml::measured_similarity(model, data, nullptr, sentences, &strangers, {.texts = 2, .motions = 4}).texts == 2);
  data.training.insert(data.training.end(), data.validation.begin(), data.validation.end());
  data.validation.clear();
  CHECK(ml::measured_similarity(model, data, nullptr, sentences, &strangers).texts == 12);
}
