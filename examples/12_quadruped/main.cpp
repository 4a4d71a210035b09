// A quadruped of five parts: a body, features and a denoiser of your own, which STMC composes.
#include <array>
#include <cstdio>
#include <span>
#include <string>
#include <vector>

#include <motionlang/backend/eigen.hpp>
#include <motionlang/compose/body_part_lexicon.hpp>
#include <motionlang/compose/plan.hpp>
#include <motionlang/compose/timeline_text.hpp>
#include <motionlang/systems/stmc.ipp>

namespace ml = motionlang;
using B = ml::EigenBackend<float>;
using ml::Index;

/// The denoiser's knowledge of a text: the swing of each leg (rad), the height of its paw (m), and the trunk's speed
/// (m/s) and pitch (rad).
struct KnownText {
  const char* text;
  std::array<float, 10> frame;
};
constexpr std::array known{
    KnownText{"trot", {0.5f, 0.1f, 0.5f, 0.1f, 0.5f, 0.1f, 0.5f, 0.1f, 1.5f, 0}},
    KnownText{"shake hands", {0.2f, 0.4f, 0, 0, 0, 0, 0, 0, 0, 0.1f}},
    KnownText{"kick back", {0, 0, 0, 0, 0.9f, 0.5f, 0.9f, 0.5f, 0, -0.3f}},
};

/// The number 1 instead of the text, which is known.
struct Numbered {
  template <ml::Backend T>
  ml::TextFeatures<T> encode(std::span<const std::string> texts) const {
    std::vector<typename T::scalar> ones;
    for (const std::string& text : texts) {
      for (const KnownText& k : known) ones.push_back(text == k.text ? 1 : 0);
    }
    return ml::TextFeatures<T>::pooled(ml::Tensor<T, 2>::from(ones, {std::ssize(texts), std::ssize(known)}));
  }
};

/// Turns any sequence into the motion of its text on the whole body; without a text the dog stands still.
template <ml::Backend T>
struct Remembering {
  ml::Tensor<T, 2> frames;  // (texts, features)

  static constexpr auto fields() { return ml::fields("frames", &Remembering::frames); }
  ml::Sequences<T> operator()(const ml::Sequences<T>& x, std::span<const Index>,
                              const ml::TextFeatures<T>& text) const {
    return x.with(ml::repeat_for_rows(ml::matmul(text.tokens.rows, frames), x.offsets));
  }
  ml::DenoiserTraits traits() const { return {}; }
};

int main() {
  const ml::BodyPartition dog({.names = {"front left", "front right", "hind left", "hind right", "trunk"},
                               .path = "trunk",
                               .synonyms = {{"tail", "trunk"}},
                               .words = {{"dig", {"front left", "front right"}}}});
  const auto timeline = ml::parse_timeline(
      "trot        # 0 # 6\n"
      "shake hands # 1 # 3 # front left\n"
      "kick back   # 4 # 5 # hind left # hind right\n",
      {.fps = 20, .body = dog});

  for (const auto& owned : ml::plan_timeline(timeline).merged) {
    const auto& text = timeline.intervals[static_cast<std::size_t>(owned.owner)].text;
    std::printf("%-11s %3td to %3td  %s\n", dog.name(owned.part).c_str(), owned.range.start, owned.range.end,
                text.c_str());
  }

  std::vector<float> frames;
  for (const KnownText& k : known) frames.insert(frames.end(), k.frame.begin(), k.frame.end());
  const ml::Stmc<B, Remembering<B>, Numbered> stmc{
      .denoiser = {ml::Tensor<B, 2>::from(frames, {std::ssize(known), 10})},
      .text_encoder = {},
      .motion_normalizer = ml::Normalizer<B>::identity(10),
      .text_normalizer = ml::Normalizer<B>::identity(std::ssize(known)),
      .diffusion = ml::GaussianDiffusion(ml::CosineSchedule{.steps = 10}),
      .layout = ml::FeatureLayout::from_owner("dog", 10, dog, [](Index i) { return i / 2; }),  // two for each part
      .guidance = 1};
  const auto motion = stmc.generate(timeline, ml::Philox{.seed = 7});
  for (const Index frame : {10, 40, 90, 110}) {
    std::printf("%.1f s", static_cast<double>(frame) / 20);
    for (int p = 0; p < dog.size(); ++p) {
      const auto* of_part = &motion.span()[static_cast<std::size_t>(10 * frame + 2 * p)];
      std::printf("  %s %.1f %.1f", dog.names()[static_cast<std::size_t>(p)].c_str(), static_cast<double>(of_part[0]),
                  static_cast<double>(of_part[1]));
    }
    std::printf("\n");
  }

  for (const char* text : {"dig a hole", "wag the tail", "lift the hind right paw"}) {
    const ml::BodyParts parts = ml::guess_body_parts(text, dog);
    std::printf("%s:", text);
    for (int p = 0; p < dog.size(); ++p) {
      if (parts.has(ml::BodyPart{p})) std::printf(" [%s]", dog.names()[static_cast<std::size_t>(p)].c_str());
    }
    std::printf("\n");
  }
  try {
    ml::parse_timeline("wave # 0 # 2 # left arm\n", {.body = dog});
  } catch (const ml::timeline_error& e) {
    std::printf("%s\n", e.what());
  }
}
