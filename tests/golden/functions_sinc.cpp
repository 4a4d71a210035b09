// Golden functions: SINC's networks and generation.
#include <motionlang/backend/eigen.hpp>
#include <motionlang/backend/reference.hpp>
#include <motionlang/backend/xtensor.hpp>

#include "teach_sinc.hpp"

namespace {

using golden::Case, golden::Registration, golden::tensor;
namespace ml = motionlang;
using ml::Index;

template <ml::Backend B>
ml::SincTextEncoder<B> loaded_text_encoder(const Case& c) {
  const auto config = c.config();
  ml::Philox rng;
  ml::SincTextEncoder<B> m(config["text_dim"].template as<Index>(), golden::transformer_of(config),
                           golden::position_rows, rng);
  ml::load_module(m, c.file(), "weights/");
  return m;
}
template <ml::Backend B>
void out_distribution(Case& c, const ml::LatentGaussian<B>& g) {
  golden::out_rows(c, "mu", g.mu);
  golden::out_rows(c, "std", g.std());
}

template <ml::Backend B, ml::SincMode mode>
void text_encoder(Case& c) {
  const auto m = loaded_text_encoder<B>(c);
  const auto states = tensor<B, 3>(c, "in/text_hidden");
  // the sequence of the case has the tokens of padding, too
  golden::out(c, "sequence", ml::to_padded(m.alone(ml::from_equal(states), mode == ml::SincMode::separate_latents)));
  const auto valid = c.values<Index>("in/text_mask");
  std::vector<Index> mask;
  for (Index t = 0; t < states.size(0); ++t) {
    mask.insert(mask.end(), {1, 1});
    mask.insert(mask.end(), valid.begin() + t * states.size(1), valid.begin() + (t + 1) * states.size(1));
  }
  c.out("mask", {states.size(0), states.size(1) + 2}, mask);
  out_distribution(c, m({golden::packed<B>(c, "text_hidden", "text_mask")}, mode));
}

/// Sequence and mask of the case are those of the padded batch. The rows that its mask shows have to be those of the
/// library's sequence; the hidden ones are put between them.
template <ml::Backend B>
void text_encoder_ste(Case& c) {
  const auto m = loaded_text_encoder<B>(c);
  const bool legacy = c.config().value_or("legacy_ste_mask", true);
  const auto texts = golden::sinc_texts<B>(c);
  const auto states = tensor<B, 3>(c, "in/text_hidden");
  const auto of_motion = texts.per_motion();
  const Index words = states.size(1), most = of_motion.longest(), columns = 2 + most * words + most - 1,
              width = m.text.mu_token.size(0);
  const auto valid = c.values<Index>("in/text_mask");
  const auto table = ml::concat(0, m.text.beginning(), m.text.separation(), ml::Tensor<B, 2>::zeros({1, width}),
                                m.text.projected(ml::from_equal(states)).rows);
  std::vector<Index> pick, mask;
  for (Index s = 0; s < of_motion.count(); ++s) {
    pick.insert(pick.end(), {0, 1});
    mask.insert(mask.end(), {1, 1});
    for (Index k = 0; k < most; ++k) {
      const Index t = of_motion.begin(s) + k;
      const bool there = k < of_motion.length(s);
      if (k > 0) pick.push_back(2);
      if (k > 0 && !legacy) mask.push_back(there);
      for (Index i = 0; i < words; ++i) {
        pick.push_back(there ? 4 + t * words + i : 3);
        mask.push_back(there ? valid[static_cast<std::size_t>(t * words + i)] : 0);
      }
      if (k > 0 && legacy) mask.push_back(1);
    }
  }
  auto sequence = ml::gather(table, pick).to_vector();
  const auto seen = m.joined(texts, legacy);
  const auto numbers = seen.rows.to_vector();
  auto next = numbers.begin();
  for (std::size_t r = 0; r < mask.size(); ++r) {
    if (mask[r] == 0) continue;
    if (numbers.end() - next < width)
      ml::raise<ml::shape_error>(205, "the mask shows more rows than the library's sequence");
    std::copy_n(next, width, sequence.begin() + static_cast<std::ptrdiff_t>(r) * width);
    next += width;
  }
  if (next != numbers.end()) ml::raise<ml::shape_error>(205, "the mask shows fewer rows than the library's sequence");
  c.out("sequence", {of_motion.count(), columns, width}, sequence);
  c.out("mask", {of_motion.count(), columns}, mask);
  out_distribution(c, m(texts, ml::SincMode::separate_texts, legacy));
}

template <ml::Backend B>
void motion_encoder(Case& c) {
  const auto m = golden::temos_motion_encoder<B>(c);
  const auto features = tensor<B, 3>(c, "in/features");
  const auto lengths = c.values<Index>("in/lengths");
  out_distribution(c, m(ml::from_padded(features, std::span<const Index>(lengths))));
  golden::out_rows(c, "mu_no_lengths", m(ml::from_equal(features)).mu);
}

template <ml::Backend B>
void motion_decoder(Case& c) {
  const auto m = golden::sequence_decoder<B>(c);
  const auto shape = c.shape("in/z");  // (motions, slots, 1, latent)
  const auto z = ml::reshape<3>(golden::rows<B>(c, "in/z"), {shape[0], shape[1], shape[3]});
  std::vector<unsigned char> mask(static_cast<std::size_t>(shape[0] * shape[1]), 1);
  if (c.has("in/memory_mask")) mask = c.values<unsigned char>("in/memory_mask");
  const auto memory = ml::from_padded(z, std::span<const unsigned char>(mask));
  golden::out(c, "features", ml::to_padded(m(memory, golden::lengths_of(c))));
}

template <ml::Backend B>
void generation(Case& c) {
  const auto model = golden::sinc_model<B>(c);
  const auto normalizer = golden::statistics<B>(c, ml::sinc_eps);
  const auto eps = golden::all_noise<B>(c);
  const ml::Offsets length{c.config()["length"].template as<Index>()};
  if (c.config()["baseline"].template as<std::string>() != "gpt") {
    ml::SincTexts<B> texts{golden::all_texts<B>(c)};
    texts.motion.assign(static_cast<std::size_t>(texts.states.count()), 0);
    const auto features = model.generate(texts, length, eps).rows;
    c.out("features", {1, features.size(0), features.size(1)}, features.span());
    golden::out_motion(c, ml::sinc_motion(normalizer, features));
    return;
  }
  std::vector<ml::Tensor<B, 2>> features;
  std::vector<ml::SincParts> parts;
  for (Index i = 0; i < 2; ++i) {
    const std::string number = std::to_string(i + 1);
    features.push_back(model.generate({golden::one_text<B>(c, i)}, length, ml::slice(eps, 0, i, i + 1)).rows);
    golden::out_motion(c, ml::sinc_motion(normalizer, features.back()), "_" + number);
    parts.push_back(golden::part_vectors(c, "parts_" + number).at(0));
  }
  golden::out_motion(c, ml::sinc_composed(normalizer, features[0], parts[0], features[1], parts[1]));
}

template <ml::Backend B>
std::vector<Registration> over(const std::string& variant) {
  return {{"sinc text encoder", variant, text_encoder<B, ml::SincMode::single>},
          {"sinc text encoder with separate texts", variant, text_encoder_ste<B>},
          {"sinc text encoder with separate latents", variant, text_encoder<B, ml::SincMode::separate_latents>},
          {"sinc motion encoder", variant, motion_encoder<B>},
          {"sinc motion decoder", variant, motion_decoder<B>},
          {"sinc generation", variant, generation<B>}};
}
const auto reference = over<ml::ReferenceBackend<double>>("reference<double>");
const auto eigen = over<ml::EigenBackend<float>>("eigen<float>");
const auto xtensor = over<ml::XtensorBackend<float>>("xtensor<float>");

}  // namespace
