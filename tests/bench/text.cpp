// Text networks at their published sizes, with random weights: DistilBERT on 32 tokens, CLIP's ViT-B/32 tower on 77, MPNet on 32, and the
// memory that they, the tower of ViT-L/14 and MiniLM take, from files of 32 and of 16 bits.
//
// usage: bench_text [THREADS] [--bf16] [distilbert clip_text mpnet memory ...]
#include <motionlang/backend/eigen.hpp>
#include <motionlang/io/text_network_file.hpp>

#include "again.hpp"
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
/// Tokens of every 380th caption of KIT-ML, [CLS] and [SEP] included: 12.3 on average. The same numbers stand in peer_torch.py.
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

/// f(name, config, length of a text, width, loader of a file) for each network.
template <class F>
void each_network(F f) {
  const auto bert = [](const auto& file) {
    return ml::load_text_network<ml::DistilBert<B>>(ml::distilbert_base, file);
  };
  const auto mpnet = [](const auto& file) { return ml::load_text_network<ml::Mpnet<B>>(ml::mpnet_base, file); };
  const auto clip = [](const auto& file) { return ml::load_clip_text<B>(ml::clip_vit_b32, file); };
  const auto large = [](const auto& file) { return ml::load_clip_text<B>(ml::clip_vit_l14, file); };
  const auto minilm = [](const auto& file) { return ml::load_text_network<ml::Bert<B>>(ml::minilm_l6, file); };
  f("DistilBERT", ml::distilbert_base, Index{32}, Index{768}, bert);
  f("CLIP ViT-B/32", ml::clip_vit_b32, Index{77}, Index{512}, clip);
  f("CLIP ViT-L/14", ml::clip_vit_l14, Index{77}, Index{768}, large);
  f("MPNet", ml::mpnet_base, Index{32}, Index{768}, mpnet);
  f("MiniLM", ml::minilm_l6, Index{32}, Index{384}, minilm);
}

/// One program writes a file of random weights; another one loads it, encodes a text and looks at what that takes.
void write_weights(const std::string& wanted, const std::string& path, const std::string& type) {
  each_network([&](const char* name, const auto& config, Index, Index, auto load) {
    if (name != wanted) return;
    using Network = std::invoke_result_t<decltype(load), const ml::SafetensorsFile&>;
    ml::TensorStore store;
    store.add_module(random_network<Network>(config), "", ml::parse_dtype(type).value());
    ml::write_safetensors(path, store.views());
  });
}
bool memory(const std::string& wanted, const std::string& path) {
  bool good = false;
  each_network([&](const char* name, const auto&, Index length, Index width, auto load) {
    if (name != wanted) return;
    const auto network = load(ml::SafetensorsFile::open(path));
    const auto states = network(batch_of({length})).tokens.rows;
    const double weights = 4e-6 * static_cast<double>(ml::parameter_count(network)), resident = bench::peak_memory();
    good = states.shape() == ml::Shape{length, width} && resident <= 1.15 * weights;
    std::printf("%s: %lld parameters, states %s, %.1f MB of weights, %.1f MB resident, ratio %.3f: %s\n", name,
                static_cast<long long>(ml::parameter_count(network)), to_string(states.shape()).c_str(), weights,
                resident, resident / weights, good ? "good" : "BAD");
  });
  return good;
}

}  // namespace

int main(int argc, char** argv) {
  const bench::Arguments asked_for(argc, argv);
  const auto asked = [&](const char* work) { return asked_for.asked(work); };
  if (argc == 6 && std::string(argv[2]) == "write") return write_weights(argv[3], argv[4], argv[5]), 0;
  if (argc == 5 && std::string(argv[2]) == "read") return memory(argv[3], argv[4]) ? 0 : 1;
  bool good = true;
  if (asked("memory")) {
    const auto threads = std::to_string(ml::thread_count());
    each_network([&](const char* name, const auto&...) {
      for (const char* type : {"F32", "F16"}) {
        const bench::TemporaryFile file;
        good = bench::run_again({threads, "write", name, file.path.string(), type}) && good;
        good = bench::run_again({threads, "read", name, file.path.string()}) && good;
      }
    });
  }
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
  return good ? 0 : 1;
}
