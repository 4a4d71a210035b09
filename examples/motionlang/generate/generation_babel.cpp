// TEACH and SINC behind the Generator, as their repositories leave them or with parts from elsewhere.
#include <algorithm>

#include <motionlang/backend/eigen.hpp>
#include <motionlang/features/motion_features.hpp>
#include <motionlang/text/joined_labels.hpp>
#include <motionlang/weights/vae_run.hpp>

#include "from_babel.hpp"

namespace program {

namespace {

using B = ml::EigenBackend<float>;
using ml::Index;

class TeachGenerator final : public EachAlone {
 public:
  explicit TeachGenerator(TeachLatents parts) : parts_(std::move(parts)) {}

  double fps() const override { return parts_.fps; }
  std::string system() const override { return "TEACH"; }
  bool draws_latents() const override { return true; }

 private:
  ml::Motion motion(const ml::Timeline& timeline, ml::Philox noise, const GenerationSettings& settings) const override {
    std::vector<std::string> texts;
    std::vector<Index> lengths;
    for (const ml::Interval& i : in_order(timeline)) {
      texts.push_back(i.text);
      lengths.push_back(i.end - i.start);
    }
    const auto states = parts_.tokens(texts);
    const auto parts = ml::actions_to_motion(parts_.model, states, ml::Offsets(lengths), noise, ml::teach_window,
                                             {.fact = settings.fact.value_or(1)});
    return ml::motion_of_smplvelp(ml::teach_motion(parts_.normalizer, parts, ml::teach_window), parts_.fps);
  }

  /// Throws timeline_error 509 for texts at the same time.
  static std::vector<ml::Interval> in_order(const ml::Timeline& timeline) {
    std::vector<ml::Interval> out = timeline.intervals;
    std::stable_sort(out.begin(), out.end(), [](const auto& a, const auto& b) { return a.start < b.start; });
    for (std::size_t i = 1; i < out.size(); ++i) {
      if (out[i].start < out[i - 1].end)
        ml::raise<ml::timeline_error>(509, "'", out[i - 1].text, "' and '", out[i].text,
                                      "' overlap; this model (TEACH) takes texts one after the other");
    }
    return out;
  }

  TeachLatents parts_;
};

/// All texts, at the same time, as one sentence.
ml::Interval together(const ml::Timeline& timeline) {
  std::vector<std::string> labels;
  for (const ml::Interval& i : timeline.intervals) labels.push_back(i.text);
  return {ml::join_labels(labels, ml::Conjunction::same_time), 0, timeline.end(), ml::BodyParts::all()};
}

}  // namespace

TeachLatents published_teach(const std::filesystem::path& run, const ModelSources& sources) {
  return text_latents(ml::load_teach_run<B>(ml::find_run(run),
                                            {.text_encoder = sources.text_encoder, .statistics = sources.statistics}));
}
SincLatents published_sinc(const std::filesystem::path& run, const ModelSources& sources) {
  return text_latents(ml::load_sinc_run<B>(ml::find_run(run),
                                           {.text_encoder = sources.text_encoder, .statistics = sources.statistics}));
}

std::unique_ptr<Generator> from_teach(TeachLatents parts) { return std::make_unique<TeachGenerator>(std::move(parts)); }
std::unique_ptr<Generator> from_sinc(SincLatents parts) {
  parts.wanted = together;
  return from_texts(std::move(parts));
}

std::unique_ptr<Generator> load_teach(const std::filesystem::path& run, const ModelSources& sources) {
  return from_teach(published_teach(run, sources));
}
std::unique_ptr<Generator> load_sinc(const std::filesystem::path& run, const ModelSources& sources) {
  return from_sinc(published_sinc(run, sources));
}

}  // namespace program
