// Text networks at their published sizes, with random weights, loaded from files of 32 and of 16 bits: the states have
// the right shape, and the program takes at most 1.15 times the memory of the weights as 32-bit numbers. One process
// writes the file of a network, another one loads it, encodes a text and looks at what that has taken.
//
// usage: systems_text_memory [all]     DistilBERT, CLIP ViT-B/32, MPNet from F32 and F16; all: ViT-L/14 and MiniLM, and
// BF16, too
#include <motionlang/backend/eigen.hpp>
#include <motionlang/weights/text_network_file.hpp>

#include "../bench/again.hpp"

namespace ml = motionlang;
using ml::Index;
using B = ml::EigenBackend<float>;

namespace {

/// f(name, whether only `all` has it, config, length of a text, width, loader of a file) for each network.
template <class F>
void each_network(F f) {
  const auto bert = [](const auto& file) {
    return ml::load_text_network<ml::DistilBert<B>>(ml::distilbert_base, file);
  };
  const auto mpnet = [](const auto& file) { return ml::load_text_network<ml::Mpnet<B>>(ml::mpnet_base, file); };
  const auto clip = [](const auto& file) { return ml::load_clip_text<B>(ml::clip_vit_b32, file); };
  const auto large = [](const auto& file) { return ml::load_clip_text<B>(ml::clip_vit_l14, file); };
  const auto minilm = [](const auto& file) { return ml::load_text_network<ml::Bert<B>>(ml::minilm_l6, file); };
  f("DistilBERT", false, ml::distilbert_base, Index{32}, Index{768}, bert);
  f("CLIP ViT-B/32", false, ml::clip_vit_b32, Index{77}, Index{512}, clip);
  f("MPNet", false, ml::mpnet_base, Index{32}, Index{768}, mpnet);
  f("CLIP ViT-L/14", true, ml::clip_vit_l14, Index{77}, Index{768}, large);
  f("MiniLM", true, ml::minilm_l6, Index{32}, Index{384}, minilm);
}

void write_weights(const std::string& wanted, const std::string& path, const std::string& type) {
  each_network([&](const char* name, bool, const auto& config, Index, Index, auto load) {
    if (name != wanted) return;
    using Network = std::invoke_result_t<decltype(load), const ml::SafetensorsFile&>;
    ml::Philox rng{.seed = 1};
    ml::TensorStore store;
    store.add_module(Network(config, rng), "", ml::parse_dtype(type).value());
    ml::write_safetensors(path, store.views());
  });
}

/// Ids all different; the last one is the largest.
ml::TokenBatch text_of(Index length) {
  ml::TokenBatch out;
  for (Index t = 0; t + 1 < length; ++t) out.ids.push_back(1000 + 7 * t);
  out.ids.push_back(30000);
  out.lengths = {length};
  return out;
}

bool good(const std::string& wanted, const std::string& path, const std::string& type) {
  constexpr double most = 1.15;
  bool result = false;
  each_network([&](const char* name, bool, const auto&, Index length, Index width, auto load) {
    if (name != wanted) return;
    const auto network = load(ml::SafetensorsFile::open(path));
    const auto states = network(text_of(length)).tokens.rows;
    const double weights = 4e-6 * static_cast<double>(ml::parameter_count(network)), memory = bench::peak_memory();
    // Embeddings of words that do not occur stay in the file; less than a third of the weights is not a measurement.
    result = states.shape() == ml::Shape{length, width} && memory <= most * weights && memory > weights / 3;
    std::printf("%s, %s: %lld parameters, states %s, %.1f MB of weights, %.1f MB of memory, ratio %.3f of %.2f: %s\n",
                name, type.c_str(), static_cast<long long>(ml::parameter_count(network)),
                to_string(states.shape()).c_str(), weights, memory, memory / weights, most, result ? "good" : "BAD");
  });
  return result;
}

}  // namespace

int main(int argc, char** argv) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  std::printf("not measured: a sanitizer needs memory of its own\n");
  return 0;
#endif
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  if (arguments.size() == 4 && arguments[0] == "write")
    return write_weights(arguments[1], arguments[2], arguments[3]), 0;
  if (arguments.size() == 4 && arguments[0] == "read") return good(arguments[1], arguments[2], arguments[3]) ? 0 : 1;
  const bool all = arguments == std::vector<std::string>{"all"};
  bool result = true;
  each_network([&](const char* name, bool only_all, const auto&...) {
    if (only_all && !all) return;
    for (const char* type : {"F32", "F16", "BF16"}) {
      if (type == std::string("BF16") && !all) continue;  // takes the way of F16
      const bench::TemporaryFile file;
      result = bench::run_again({"write", name, file.path.string(), type}) && result;
      result = bench::run_again({"read", name, file.path.string(), type}) && result;
    }
  });
  return result ? 0 : 1;
}
