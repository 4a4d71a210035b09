// Text networks at their published sizes, with random weights: DistilBERT on 32 tokens, CLIP's ViT-B/32 tower on 77, MPNet on 32, and the
// memory that they take. Peer: peer_torch.py; run.py compares.
//
// usage: bench_text [THREADS] [distilbert clip_text mpnet memory ...]
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <set>

#include <motionlang/backend/eigen.hpp>
#include <motionlang/io/text_network_file.hpp>

#include "bench.hpp"

namespace ml = motionlang;
using ml::Index;
using B = ml::EigenBackend<float>;

namespace {

/// Ids all different; the last one of a text is the largest.
ml::TokenBatch batch_of(Index texts, Index length) {
  ml::TokenBatch out;
  for (Index i = 0; i < texts; ++i) {
    for (Index t = 0; t + 1 < length; ++t) out.ids.push_back(1000 + 7 * t + i);
    out.ids.push_back(30000);
    out.lengths.push_back(length);
  }
  return out;
}

template <class Network, class Config>
Network random_network(const Config& config) {
  ml::Philox rng{.seed = 1};
  return Network(config, rng);
}

template <class Network>
void speed(const std::string& work, const Network& network, Index length, std::vector<Index> batches, double d,
           double ff, double layers) {
  for (Index b : batches) {
    const auto batch = batch_of(b, length);
    bench::report(work, "B=" + std::to_string(b) + " T=" + std::to_string(length), "motionlang",
                  static_cast<double>(b) * bench::encoder_gflop(static_cast<double>(length), d, ff, layers),
                  [&] { network(batch); });
  }
}

/// A file of random weights is made by a process of its own; this one loads it, encodes 32 tokens and looks at what it takes.
template <class Network, class Config, class Load>
bool memory(const std::string& work, const Config& config, Index length, Index width, Load load) {
  const auto path =
      std::filesystem::temp_directory_path() / ("bench_text_" + std::to_string(::getpid()) + ".safetensors");
  const pid_t writer = ::fork();
  if (writer == 0) {
    ml::TensorStore store;
    store.add_module(random_network<Network>(config));
    ml::write_safetensors(path.string(), store.views());
    ::_exit(0);
  }
  int status = 1;
  ::waitpid(writer, &status, 0);
  if (status != 0) return false;
  const pid_t reader = ::fork();
  if (reader == 0) {
    const Network network = load(config, ml::SafetensorsFile::open(path.string()));
    const auto states = network(batch_of(1, length)).tokens.rows;
    rusage used{};
    ::getrusage(RUSAGE_SELF, &used);
    const double weights = 4.0 * static_cast<double>(ml::parameter_count(network)),
                 resident = 1024.0 * static_cast<double>(used.ru_maxrss);
    const bool good = states.shape() == ml::Shape{length, width} && resident <= 1.15 * weights;
    std::printf("%s: %lld parameters, states %s, %.1f MB of weights, %.1f MB resident, ratio %.3f: %s\n", work.c_str(),
                static_cast<long long>(ml::parameter_count(network)), to_string(states.shape()).c_str(), weights * 1e-6,
                resident * 1e-6, resident / weights, good ? "good" : "BAD");
    std::fflush(stdout);
    ::_exit(good ? 0 : 1);
  }
  ::waitpid(reader, &status, 0);
  std::filesystem::remove(path);
  return status == 0;
}

}  // namespace

int main(int argc, char** argv) {
  const std::set<std::string> wanted(argv + std::min(argc, 2), argv + argc);
  auto asked = [&](const char* name) { return wanted.empty() || wanted.contains(name); };
  bool good = true;
  if (asked("memory")) {  // first: before this process has threads and memory of its own
    const auto bert = [](const auto& config, const auto& file) {
      return ml::load_text_network<ml::DistilBert<B>>(config, file);
    };
    const auto mpnet = [](const auto& config, const auto& file) {
      return ml::load_text_network<ml::Mpnet<B>>(config, file);
    };
    const auto clip = [](const auto& config, const auto& file) { return ml::load_clip_text<B>(config, file); };
    good = memory<ml::DistilBert<B>>("DistilBERT", ml::distilbert_base, 32, 768, bert) && good;
    good = memory<ml::ClipText<B>>("CLIP ViT-B/32", ml::clip_vit_b32, 77, 512, clip) && good;
    good = memory<ml::Mpnet<B>>("MPNet", ml::mpnet_base, 32, 768, mpnet) && good;
  }
  if (argc > 1) ml::set_thread_count(std::atoi(argv[1]));
  if (asked("distilbert"))
    speed("distilbert", random_network<ml::DistilBert<B>>(ml::distilbert_base), 32, {1, 32}, 768, 3072, 6);
  if (asked("clip_text"))
    speed("clip_text", random_network<ml::ClipText<B>>(ml::clip_vit_b32), 77, {1, 8}, 512, 2048, 12);
  if (asked("mpnet")) speed("mpnet", random_network<ml::Mpnet<B>>(ml::mpnet_base), 32, {1, 32}, 768, 3072, 12);
  return good ? 0 : 1;
}
