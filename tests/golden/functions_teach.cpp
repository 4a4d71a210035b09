// Golden functions: TEACH's networks and sequences of actions.
#include <motionlang/backend/eigen.hpp>
#include <motionlang/backend/reference.hpp>
#include <motionlang/backend/xtensor.hpp>

#include "teach_sinc.hpp"

namespace {

using golden::Case, golden::Registration, golden::tensor;
namespace ml = motionlang;
using ml::Index;

template <ml::Backend B>
void text_encoder(Case& c) {
  const auto config = c.config();
  ml::Philox rng;
  ml::TeachTextEncoder<B> m(config["text_dim"].template as<Index>(), config["nfeats"].template as<Index>(),
                            config["hist_frames"].template as<Index>(), false, golden::transformer_of(config),
                            golden::position_rows, rng);
  ml::load_module(m, c.file(), "weights/");
  const auto text = golden::packed<B>(c, "text_hidden", "text_mask");
  const auto padded = tensor<B, 3>(c, "in/text_hidden");  // the case has the tokens of padding, too
  golden::out(c, "text_tokens", ml::to_padded(m.text_tokens(ml::from_equal(padded))));
  const auto frames = ml::from_equal(tensor<B, 3>(c, "in/past"));
  golden::out(c, "past_encoded", ml::to_padded(m.encode_past(frames)));
  const auto z = tensor<B, 2>(c, "in/z");
  auto encode = [&](const std::string& suffix, const ml::TeachPast<B>& past) {
    const auto g = m(text, past);
    golden::out(c, "mu" + suffix, g.mu);
    golden::out(c, "std" + suffix, g.std());
  };
  encode("", {});
  encode("_past", {.frames = frames});
  encode("_past_z", {.frames = frames, .z = z});
  encode("_z", {.z = z});
}

template <ml::Backend B>
void motion_encoder(Case& c) {
  const auto m = golden::temos_motion_encoder<B>(c);
  const auto features = tensor<B, 3>(c, "in/features");
  const auto lengths = c.values<Index>("in/lengths");
  auto encode = [&](const std::string& suffix, const ml::Sequences<B>& x) {
    const auto g = m(x);
    golden::out(c, "mu" + suffix, g.mu);
    golden::out(c, "std" + suffix, g.std());
  };
  encode("", ml::from_padded(features, std::span<const Index>(lengths)));
  encode("_no_lengths", ml::from_equal(features));
}

template <ml::Backend B>
void motion_decoder(Case& c) {
  const auto m = golden::sequence_decoder<B>(c);
  golden::out(c, "features", ml::to_padded(m(tensor<B, 2>(c, "in/z"), golden::lengths_of(c))));
}

template <ml::Backend B>
void sequence_generation(Case& c) {
  const auto config = c.config();
  const auto model = golden::teach_model<B>(c);
  const auto window = config.value_or("slerp_window", Index{0});  // null: none
  const auto parts = model.generate(golden::all_texts<B>(c), golden::lengths_of(c), golden::all_noise<B>(c), window);
  golden::out(c, "features", parts.rows);
  const auto align =
      config["align"].template as<std::string>() == "full" ? ml::Alignment::full : ml::Alignment::translation;
  golden::out_motion(c, ml::teach_motion(golden::statistics<B>(c, 0), parts, window, align));
}

template <ml::Backend B>
std::vector<Registration> over(const std::string& variant) {
  return {{"teach text encoder", variant, text_encoder<B>},
          {"teach motion encoder", variant, motion_encoder<B>},
          {"teach motion decoder", variant, motion_decoder<B>},
          {"teach sequence generation", variant, sequence_generation<B>}};
}
const auto reference = over<ml::ReferenceBackend<double>>("reference<double>");
const auto eigen = over<ml::EigenBackend<float>>("eigen<float>");
const auto xtensor = over<ml::XtensorBackend<float>>("xtensor<float>");

}  // namespace
