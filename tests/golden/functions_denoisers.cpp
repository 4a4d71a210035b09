// Golden functions: one call of each published denoiser, with guidance.
#include <motionlang/backend/eigen.hpp>
#include <motionlang/backend/reference.hpp>
#include <motionlang/backend/xtensor.hpp>
#include <motionlang/diffusion/guidance.hpp>

#include "models.hpp"

namespace {

using golden::Case, golden::Registration, golden::tensor;
namespace ml = motionlang;
using ml::Index;

template <ml::Backend B>
void mdm_smpl_forward(Case& c) {
  const auto m = golden::mdm_smpl_model<B>(c).denoiser;
  const auto mask = c.values<unsigned char>("in/mask");
  const auto x = ml::from_padded(tensor<B, 3>(c, "in/x"), std::span<const unsigned char>(mask));
  const auto t = c.values<Index>("in/t");
  const auto text = golden::text_features<B>(c);
  const Index frames = c.shape("in/x")[1], tokens = c.shape("in/text")[1], width = m.skel_embedding.weight.size(0);

  const auto time_tokens = m.time_tokens(t);
  c.out("time_token", {x.count(), 1, width}, time_tokens.span());
  golden::out(c, "text_tokens", ml::to_padded(m.text_tokens(text), 0, tokens));
  if (c.wants("sequence")) {
    // [time, text ... (padded), registers, frames (padded)]: what follows a shorter text stands behind its padding.
    const Index behind = m.register_count() + frames, length = 1 + tokens + behind;
    auto out = [&](const std::string& name, const ml::Sequences<B>& s) {
      std::vector<ml::Tensor<B, 3>> rows;
      for (Index i = 0; i < s.count(); ++i) {
        const Index front = 1 + text.tokens.offsets.length(i), own = s.offsets.length(i);
        const auto padding = [&](Index n) { return ml::Tensor<B, 2>::zeros({n, width}); };
        rows.push_back(ml::reshape<3>(ml::concat(0, ml::slice(s[i], 0, 0, front), padding(1 + tokens - front),
                                                 ml::slice(s[i], 0, front, own), padding(behind - own + front)),
                                      {1, length, width}));
      }
      golden::out_if_wanted(c, name, ml::concat(std::span<const ml::Tensor<B, 3>>(rows), 0));
    };
    auto sequence = m.sequence(x, t, text);
    out("sequence", sequence);
    for (std::size_t i = 0; i < m.seqTransEncoder.layers.size(); ++i) {
      sequence.rows = m.seqTransEncoder.layers[i](sequence.rows, sequence.offsets);
      out("layer_" + std::to_string(i), sequence);
    }
  }
  const auto cond = m(x, t, text);
  golden::out(c, "output", ml::to_padded(cond, 0, frames));
  if (!c.has("in/text_null")) return;
  const auto without = m(x, t, golden::text_features<B>(c, "in/text_null", "in/text_null_mask"));
  golden::out(c, "output_null", ml::to_padded(without, 0, frames));
  golden::out(
      c, "output_guided",
      ml::to_padded(cond.with(ml::guide(cond.rows, without.rows, c.config()["guidance"].as<double>())), 0, frames));
}

template <ml::Backend B>
void mdm_forward(Case& c) {
  const auto m = golden::mdm_model<B>(c);
  const auto shape = c.shape("in/x");
  const auto t = c.values<Index>("in/t");
  const Index frames = shape[3];
  const auto all = ml::reshape<3>(golden::mdm_rows(tensor<B, 4>(c, "in/x")), {shape[0], frames, shape[1] * shape[2]});
  auto unmasked = [&](const ml::Tensor<B, 3>& padded) {
    const auto mask = c.values<unsigned char>("in/mask");
    return ml::from_padded(padded, std::span<const unsigned char>(mask));
  };
  const bool recurrent = m.config.arch == ml::MdmArch::gru;  // reads padding too
  const auto x = m.config.mask_frames && !recurrent ? unmasked(all) : ml::from_equal(all);
  const auto text = golden::mdm_condition<B>(c, m.config, x.count());
  const auto cond = m(x, t, text), null = m(x, t, golden::zero_text(text));
  auto out = [&](const std::string& name, const ml::Sequences<B>& s) {
    if (!c.wants(name)) return;
    auto padded = ml::to_padded(s, 0, frames);
    if (m.config.mask_frames && recurrent) padded = ml::to_padded(unmasked(padded), 0, frames);
    golden::out(c, name, golden::mdm_layout(ml::reshape<2>(padded, {shape[0] * frames, shape[1] * shape[2]}), shape));
  };
  out("output", cond);
  out("output_null", null);
  if (c.wants("output_guided")) {
    const auto w = tensor<B, 1>(c, "in/w");
    const auto rows = ml::repeat_for_rows(ml::reshape<2>(w, {w.size(0), 1}), x.offsets);
    out("output_guided", cond.with(ml::guide(cond.rows, null.rows, rows)));
  }
  golden::out_if_wanted(c, "time_token", m.time_tokens(t));
  if (c.wants("layer_0") && m.seqTransEncoder) {
    auto e = m.time_tokens(t);
    if (m.embed_text) e = e + (*m.embed_text)(text.tokens.rows);
    if (m.action_embedding) e = e + ml::matmul(text.tokens.rows, *m.action_embedding);
    auto sequence = ml::add_positions(
        ml::concat_tokens(ml::Sequences<B>(e, ml::Offsets::equal(x.count(), 1)), x.with(m.pose_embedding(x.rows))),
        m.positions.rows());
    for (std::size_t i = 0; i < m.seqTransEncoder->layers.size(); ++i) {
      sequence.rows = m.seqTransEncoder->layers[i](sequence.rows, sequence.offsets);
      golden::out_if_wanted(c, "layer_" + std::to_string(i), ml::to_padded(sequence, 0, 1 + frames));
    }
  }
}

template <ml::Backend B>
void motiondiffuse_forward(Case& c) {
  const auto m = golden::motiondiffuse_model<B>(c);
  const auto padded = tensor<B, 3>(c, "in/x");
  const auto lengths = c.values<Index>("in/lengths"), t = c.values<Index>("in/t");
  // Standard attention masks nothing: there padded frames are real ones. Their outputs are stored as 0 all the same.
  const auto x = m.config.no_eff ? ml::from_equal(padded) : ml::from_padded(padded, std::span<const Index>(lengths));
  auto out = [&](const std::string& name, const ml::Sequences<B>& s) {
    const auto full = ml::to_padded(s, 0, padded.size(1));
    golden::out_if_wanted(c, name,
                          ml::to_padded(ml::from_padded(full, std::span<const Index>(lengths)), 0, padded.size(1)));
  };
  const auto text = golden::clip_features<B>(c);
  const auto encoded = m.encode(text);
  golden::out(c, "xf_proj", encoded.xf_proj);
  golden::out(c, "xf_out", ml::to_padded(encoded.xf_out));
  golden::out(c, "time", m.time_embedding(t));
  const auto emb = m.time_embedding(t) + encoded.xf_proj;
  auto h = m.embed_frames(x);
  const auto& block = m.temporal_decoder_blocks.front();
  h.rows = block.sa_block(h, nullptr, emb);
  out("block0_sa_block", h);
  h.rows = block.ca_block(h, &encoded.xf_out, emb);
  out("block0_ca_block", h);
  h.rows = block.ffn(h, emb);
  out("block0_ffn", h);
  out("output", m(x, t, text));
}

template <ml::Backend B>
void normalise(Case& c) {
  auto n = ml::Normalizer<B>::identity(c.shape("weights/mean")[0]);
  n.eps = c.config()["eps"].as<double>();
  ml::load_module(n, c.file(), "weights/");
  golden::out(c, "normalised", n.normalize(tensor<B, 2>(c, "in/x")));
  golden::out(c, "denormalised", n.denormalize(tensor<B, 2>(c, "in/z")));
}

template <ml::Backend B>
void positions(Case& c) {
  const auto first = c.config()["first"].as<Index>(), length = c.config()["length"].as<Index>();
  const auto table = ml::sinusoidal_positions<B>(first + length, c.config()["latent_dim"].as<Index>());
  golden::out(c, "pe", ml::slice(table, 0, first, first + length));
}

template <ml::Backend B>
std::vector<Registration> over(const std::string& variant) {
  return {{"mdm smpl denoiser forward", variant, mdm_smpl_forward<B>},
          {"mdm denoiser forward", variant, mdm_forward<B>},
          {"motiondiffuse denoiser forward", variant, motiondiffuse_forward<B>},
          {"stmc normalise", variant, normalise<B>},
          {"sinusoidal positions", variant, positions<B>}};
}
const auto reference = over<ml::ReferenceBackend<double>>("reference<double>");
const auto eigen = over<ml::EigenBackend<float>>("eigen<float>");
const auto xtensor = over<ml::XtensorBackend<float>>("xtensor<float>");

}  // namespace
