// Golden functions: sequences that TM2T's models write, with given uniform numbers.
#include <motionlang/backend/eigen.hpp>
#include <motionlang/backend/reference.hpp>
#include <motionlang/backend/xtensor.hpp>
#include <motionlang/nn/decoding.hpp>
#include <motionlang/nn/seq2seq_writer.hpp>

#include "tm2t_models.hpp"

namespace {

using golden::Case, golden::Registration, golden::tensor;
namespace ml = motionlang;
using ml::Index;

/// Rows of ids as a tensor of the case.
void out_ids(Case& c, const std::string& name, const std::vector<std::vector<Index>>& lists) {
  const auto all = ml::IdSequences::from(lists);
  c.out(name, {all.count(), all.offsets.longest()}, all.ids);
}
void out_decoded(Case& c, const std::string& name, const ml::Decoded& d) {
  out_ids(c, name, d.ids);
  c.out(name + "_len", {std::ssize(d.lengths), 1}, d.lengths);
}
/// Uniform numbers (steps, rows) in the order of their use. The case may hold fewer steps than could be asked for.
auto uniforms(const Case& c, const std::string& name) {
  return [values = c.values<double>(name), rows = c.shape(name)[1]](Index step, Index row) {
    return values.at(static_cast<std::size_t>(step * rows + row));
  };
}

template <ml::Backend B>
void transformer_sampling(Case& c) {
  const auto config = c.config();
  const auto kind = config["kind"].as<std::string>();
  const auto m = golden::seq2seq_transformer<B>(c, config);
  const auto memory = [&] {
    if (kind == "t2m") {
      const auto lengths = c.values<Index>("in/text_lengths");
      return m.encode(ml::from_padded(tensor<B, 3>(c, "in/word_emb"), std::span<const Index>(lengths)));
    }
    if (kind == "t2m_v2") return m.encode(golden::ids(c, "in/word_ids", config["text_words"].as<Index>()));
    return m.encode(golden::ids(c, "in/motion_ids", config["codebook"].as<Index>() + 2));
  }();
  const ml::Sequences<B> first(memory[0], ml::Offsets{memory.offsets.length(0)});
  ml::Seq2SeqWriter<B> writer(m, memory);
  auto next_of_first = [&](const ml::IdSequences& written) { return m.next_logits(written, first); };
  const ml::DecodingOptions all{.begin = config["sos"].as<Index>(),
                                .end = config["eos"].as<Index>(),
                                .pad = config["pad"].as<Index>(),
                                .max_steps = config["max_steps"].as<Index>(),
                                .redraw_pad = kind == "t2m"};
  auto filtered = all;
  filtered.top_k = config["top_k"].as<Index>();
  out_ids(c, "greedy", {ml::decode_one(next_of_first, all)});
  out_ids(c, "greedy_top_k", {ml::decode_one(next_of_first, filtered)});
  const auto single = c.values<double>("noise/uniforms_single");
  std::size_t drawn = 0;
  out_ids(c, "sampled", {ml::decode_one(next_of_first, filtered, [&] { return single.at(drawn++); })});
  out_decoded(c, "batch_greedy", ml::decode_batch(writer, memory.count(), filtered));
  out_decoded(c, "batch_sampled",
              ml::decode_batch(writer, memory.count(), filtered, uniforms(c, "noise/uniforms_batch")));
}

template <ml::Backend B>
void beam_search(Case& c) {
  const auto config = c.config();
  const auto m = golden::seq2seq_transformer<B>(c, config);
  const ml::BeamOptions options{.begin = config["sos"].as<Index>(),
                                .end = config["eos"].as<Index>(),
                                .pad = config["pad"].as<Index>(),
                                .beams = config["beam"].as<Index>(),
                                .max_length = config["max_length"].as<Index>(),
                                .alpha = config["alpha"].as<double>()};
  const auto sources = golden::ids(c, "in/motion_ids", config["codebook"].as<Index>() + 2);
  for (Index i = 0; i < sources.count(); ++i) {
    ml::Seq2SeqWriter<B> writer(m, m.encode(ml::IdSequences::one(sources[i])));
    const auto found = ml::beam_search(writer, options);
    const auto n = std::to_string(i);
    c.out("ids" + n, found.ids);
    out_ids(c, "beams" + n, found.beams);
    c.out("scores" + n, found.scores);
    c.out("lengths" + n, found.lengths);
  }
}

template <ml::Backend B>
void gru_sampling(Case& c) {
  const auto m = golden::seq2seq_gru<B>(c);
  const ml::MotionVocabulary ids{c.config()["codebook"].as<Index>()};
  const auto lengths = c.values<Index>("in/text_lengths");
  auto state = m.start(ml::from_padded(tensor<B, 3>(c, "in/word_emb"), std::span<const Index>(lengths)));
  const auto decoded = ml::decode_batch(m.next(state), std::ssize(lengths),
                                        {.begin = ids.begin(),
                                         .end = ids.end(),
                                         .pad = ids.pad(),
                                         .max_steps = c.config()["max_steps"].as<Index>(),
                                         .top_k = c.config()["top_k"].as<Index>()},
                                        uniforms(c, "noise/uniforms"));
  out_ids(c, "ids", decoded.ids);
  c.out("lengths", {std::ssize(decoded.lengths), 1}, decoded.lengths);
}

template <ml::Backend B>
std::vector<Registration> over(const std::string& variant) {
  return {{"tm2t motion2text transformer sampling", variant, transformer_sampling<B>},
          {"tm2t text2motion transformer sampling", variant, transformer_sampling<B>},
          {"tm2t beam search", variant, beam_search<B>},
          {"tm2t text2motion gru sampling", variant, gru_sampling<B>}};
}
const auto reference = over<ml::ReferenceBackend<double>>("reference<double>");
const auto eigen = over<ml::EigenBackend<float>>("eigen<float>");
const auto xtensor = over<ml::XtensorBackend<float>>("xtensor<float>");

}  // namespace
