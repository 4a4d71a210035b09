// The Generator over one backend, for models of any denoiser and text encoder.
#pragma once

#include <motionlang/compose/handovers.hpp>
#include <motionlang/io/safetensors.hpp>

#include <motionlang/systems/stmc.hpp>

#include "../files/feature_motion.hpp"
#include "generation.hpp"

namespace program {

template <ml::Backend B, class D, class E>
class GeneratorOver final : public Generator {
 public:
  explicit GeneratorOver(ml::Stmc<B, D, E> model) : model_(std::move(model)) {}

  std::vector<ml::Motion> run(const std::vector<ml::Timeline>& timelines, const GenerationSettings& s,
                              ml::Progress progress) const override {
    if (s.sampler != "ddpm" && s.sampler != "ddim")
      ml::raise<ml::config_error>(103, "sampler '", s.sampler, "' is neither ddpm nor ddim");
    ml::StmcOptions options;
    options.overlap = ml::frame_at(s.overlap, model_.fps);
    options.guidance = s.guidance;
    options.steps = s.steps;
    options.sampling = model_.sampling;
    options.sampling->sampler =
        s.sampler == "ddim" ? ml::SamplingOptions::Sampler::ddim : ml::SamplingOptions::Sampler::ddpm;
    options.progress = progress;
    std::vector<ml::Timeline> cut = timelines;
    if (s.cut_texts) {  // stretches below half a second would be too short for the denoiser to do what the text says
      for (ml::Timeline& t : cut) t = ml::cut_at_handovers(t, ml::frame_at(0.5, model_.fps));
    }
    const auto features = s.noise_file.empty() ? model_.generate(cut, ml::Philox{.seed = s.seed}, options)
                                               : model_.generate_from(cut, noise_from(s.noise_file), options);
    std::vector<ml::Motion> motions;
    for (const auto& f : features) {
      const std::vector<double> rows(f.span().begin(), f.span().end());
      motions.push_back(finished(motion_of_features(model_.layout.name, rows, model_.layout.size, model_.fps), s));
    }
    return motions;
  }
  double fps() const override { return model_.fps; }

 private:
  static auto noise_from(const std::string& path) {
    return [file = ml::SafetensorsFile::open(path)](ml::Index draw, const ml::Shape& shape) {
      std::string digits = std::to_string(draw);
      digits.insert(0, digits.size() < 3 ? 3 - digits.size() : 0, '0');
      const auto& view = file.tensor("noise/" + digits);
      if (view.shape != shape)
        ml::raise<ml::io_error>(407, file.name(), ": ", view.name, " is ", view.shape, ", this timeline needs ", shape);
      return ml::Tensor<B, 3>::from(ml::values_of<typename B::scalar>(view), shape);
    };
  }

  ml::Stmc<B, D, E> model_;
};

template <ml::Backend B, class D, class E>
std::unique_ptr<Generator> make_generator(ml::Stmc<B, D, E> model) {
  return std::make_unique<GeneratorOver<B, D, E>>(std::move(model));
}

}  // namespace program
