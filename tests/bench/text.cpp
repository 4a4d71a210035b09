// Text networks at their published sizes, with random weights: DistilBERT on 32 tokens, CLIP's ViT-B/32 tower on 77,
// MPNet on 32. The memory that they take is a test, tests/systems/text_memory.cpp.
//
// usage: bench_text [THREADS] [--bf16] [distilbert clip_text mpnet ...]
#include <motionlang/backend/eigen.hpp>
#include <motionlang/weights/text_network_file.hpp>

#include "bench.hpp"

namespace ml = motionlang;
using ml::Index;
using B = ml::EigenBackend<float>;

namespace {

/// Ids all different; the last one of a text is the largest.
ml::TokenBatch batch_of(const std::vector<Index>& lengths) {
  ml::TokenBatch out;
  for (std::size_t i = 0; i < lengths.size(); ++i) {
    for (Index t = 0; t + 1 < lengths[i]; ++t) out.ids.push_back(1000 + 7 * t + static_cast<Index>(i));
    out.ids.push_back(30000);
  }
  out.lengths = lengths;
  return out;
}
/// Tokens of every 380th caption of KIT-ML, [CLS] and [SEP] included: 12.3 on average. The same numbers stand in
/// peer_torch.py.
const std::vector<Index> caption_lengths{8,  8,  10, 14, 8,  10, 10, 29, 9,  10, 12, 9, 11, 16, 8,  13,
                                         19, 11, 16, 23, 10, 12, 7,  16, 14, 17, 13, 6, 9,  7,  12, 17};

template <class Network, class Config>
Network random_network(const Config& config) {
  ml::Philox rng{.seed = 1};
  return Network(config, rng);
}

/// As it is behind a loader.
template <class Network, class Config>
Network ready_network(const Config& config) {
  auto network = random_network<Network>(config);
  prepare(network);
  return network;
}

struct Sizes {
  double d, ff, layers;
};
template <class Network>
void speed(const std::string& work, const std::string& config, const Network& network,
           const std::vector<Index>& lengths, const Sizes& s) {
  const auto batch = batch_of(lengths);
  double gflop = 0;
  for (const Index n : lengths) gflop += bench::encoder_gflop(static_cast<double>(n), s.d, s.ff, s.layers);
  bench::report(work, config, gflop, [&] { network(batch); });
}

}  // namespace

int main(int argc, char** argv) {
  const bench::Arguments asked_for(argc, argv);
  const auto asked = [&](const char* work) { return asked_for.asked(work); };
  const auto equal = [](Index count, Index length) {
    return std::vector<Index>(static_cast<std::size_t>(count), length);
  };
  if (asked("distilbert")) {
    const auto network = ready_network<ml::DistilBert<B>>(ml::distilbert_base);
    const Sizes sizes{768, 3072, 6};
    for (Index b : {1, 32}) speed("distilbert", "B=" + std::to_string(b) + " T=32", network, equal(b, 32), sizes);
    for (const char* padding : {"to 29", "to 32"})  // of the peer; here there is none
      speed("distilbert", std::string("32 captions (mean 12 tokens), peer padded ") + padding, network, caption_lengths,
            sizes);
  }
  if (asked("clip_text")) {
    const auto network = ready_network<ml::ClipText<B>>(ml::clip_vit_b32);
    for (Index b : {1, 8})
      speed("clip_text", "B=" + std::to_string(b) + " T=77", network, equal(b, 77), {512, 2048, 12});
  }
  if (asked("mpnet")) {
    const auto network = ready_network<ml::Mpnet<B>>(ml::mpnet_base);
    for (Index b : {1, 32}) speed("mpnet", "B=" + std::to_string(b) + " T=32", network, equal(b, 32), {768, 3072, 12});
  }
}
