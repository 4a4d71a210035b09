// STMC with a text encoder of your own: anything that turns texts into vectors.
#include <cstdio>
#include <span>
#include <string>
#include <vector>

#include <motionlang/backend/eigen.hpp>
#include <motionlang/compose/timeline_text.hpp>
#include <motionlang/systems/stmc.ipp>

namespace ml = motionlang;
using B = ml::EigenBackend<float>;

/// Counts words in 64 bins.
struct BagOfWords {
  template <ml::Backend T>
  ml::TextFeatures<T> encode(std::span<const std::string> texts) const {
    std::vector<typename T::scalar> counts(texts.size() * 64);
    for (std::size_t i = 0; i < texts.size(); ++i) {
      std::size_t bin = 0;
      for (char c : texts[i] + " ") {
        if (c != ' ') {
          bin = (bin * 31 + static_cast<unsigned char>(c)) % 64;
        } else {
          counts[i * 64 + bin] += 1;
          bin = 0;
        }
      }
    }
    return ml::TextFeatures<T>::pooled(ml::Tensor<T, 2>::from(counts, {std::ssize(texts), 64}));
  }
};
static_assert(ml::TextEncoder<BagOfWords, B>);

int main() {
  ml::Philox rng{.seed = 1};
  const ml::Stmc<B, ml::MdmSmplDenoiser<B>, BagOfWords> stmc{
      // Untrained: it shows how the parts fit together, not a motion.
      .denoiser = {{.tx_dim = 64, .latent_dim = 32, .ff_size = 64, .num_layers = 2, .num_heads = 4}, rng},
      .text_encoder = {},
      .motion_normalizer = ml::Normalizer<B>::identity(205),
      .text_normalizer = ml::Normalizer<B>::identity(64),
      .diffusion = ml::GaussianDiffusion(ml::CosineSchedule{.steps = 10})};
  const auto timeline = ml::parse_timeline("walk # 0 # 2 # legs\nwave # 0.5 # 1.5 # right arm\n");
  int steps = 0;
  auto count = [&](ml::Index, ml::Index) { return ++steps, true; };  // false would cancel
  const auto features = stmc.generate(timeline, ml::Philox{.seed = 7}, {.progress = count});
  std::printf("%td frames of %td features after %d steps\n", features.size(0), features.size(1), steps);
}
