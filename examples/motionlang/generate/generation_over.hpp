// The Generator over one backend, for models of any denoiser and text encoder.
#pragma once

#include <algorithm>
#include <cmath>

#include <motionlang/file/safetensors.hpp>
#include <motionlang/kinematics/blend.hpp>
#include <motionlang/kinematics/motion_tools.hpp>
#include <motionlang/systems/stmc_keep.hpp>
#include <motionlang/weights/stmc_record.hpp>

#include "../files/feature_motion.hpp"
#include "../files/motion_files.hpp"
#include "generation.hpp"
#include "reuse.hpp"
#include "timelines.hpp"

namespace program {

template <ml::Backend B, class D, class E>
class GeneratorOver final : public Generator {
 public:
  GeneratorOver(ml::Stmc<B, D, E> model, std::vector<std::string> words)
      : model_(std::move(model)), words_(std::move(words)) {}

  std::vector<ml::Motion> run(const std::vector<ml::Timeline>& timelines, const GenerationSettings& s,
                              ml::Progress progress) const override {
    require_steps(s, *this);
    ml::StmcOptions options;
    options.overlap = ml::frame_at(s.overlap, model_.fps);
    options.hidden = ml::HiddenTexts::ignore;  // the program names them (told_hidden_texts)
    options.guidance = s.guidance;
    options.steps = s.steps;
    options.sampling = model_.sampling;
    if (!s.sampler.empty()) options.sampling->sampler = ml::parse_sampler(s.sampler);
    options.progress = progress;
    if (s.notes != nullptr) *s.notes = {.layout = model_.layout.name};
    const Kept kept = s.keep ? on_model(*s.keep) : Kept{};
    const auto features = !s.reuse_file.empty()    ? again(timelines, s, progress)
                          : !s.record_file.empty() ? recorded(cut(timelines, s.cut_texts), s, options)
                          : s.keep                 ? around(cut(timelines, s.cut_texts), kept, s, options)
                          : s.noise_file.empty()
                              ? model_.generate(cut(timelines, s.cut_texts), ml::Philox{.seed = s.seed}, options)
                              : model_.generate_from(cut(timelines, s.cut_texts), noise_from(s.noise_file), options);
    std::vector<ml::Motion> motions;
    for (const auto& f : features) {
      const std::vector<double> rows(f.span().begin(), f.span().end());
      if (s.notes != nullptr) s.notes->features.push_back(rows);
      ml::Motion motion = motion_of_features(model_.layout.name, rows, model_.layout.size, model_.fps);
      if (s.keep) motion = in_its_place(motion, kept, s);
      motions.push_back(finished(std::move(motion), s));
      if (s.keep && s.notes != nullptr)
        s.notes->kept_moved = std::max(s.notes->kept_moved, farthest_from(kept, motions.back(), *s.keep));
    }
    return motions;
  }
  double fps() const override { return model_.fps; }
  std::string system() const override { return diffusion_model; }
  ml::Index steps() const override { return model_.diffusion.steps(); }
  std::vector<std::string> words() const override { return words_; }
  TextLength length_of(const std::string& text) const override {
    if constexpr (std::same_as<
                      E, ml::CaptionEncoder<B>>) {  // which reads as far as it has positions; two are of the frame
      const auto& encoder = model_.text_encoder;
      const auto pieces = encoder.tokenizer.encode(text, static_cast<ml::Index>(text.size()) + 2);
      return {std::ssize(pieces) - 2, encoder.positions.rows().size(0) - 2};
    } else {
      return {};
    }
  }

 private:
  using Features = std::vector<ml::Tensor<B, 2>>;

  std::vector<ml::Timeline> cut(std::vector<ml::Timeline> timelines, bool wanted) const {
    if (wanted) cut_texts(timelines, model_.fps);
    return timelines;
  }

  Features recorded(const std::vector<ml::Timeline>& timelines, const GenerationSettings& s,
                    const ml::StmcOptions& options) const {
    ml::StmcRecord<B> record;
    auto features = ml::generate_recorded<B>(model_, timelines, ml::Philox{.seed = s.seed}, options, record);
    save(record, s.record_file, s.cut_texts);
    return features;
  }

  const ml::MotionFeatures& own_features() const { return features_of_layout(model_.layout.name, model_.layout.size); }
  /// A motion to keep, on the joints and at the rate of the model.
  struct Kept {
    ml::Motion clip{};
    std::vector<typename B::scalar> rows{};  // its features
    ml::Index frames = 0;                    // that they have
  };
  Kept on_model(const KeptClip& keep) const {
    Kept out{ml::resample(on_joints_for(own_features(), keep.motion), model_.fps)};
    const auto rows = own_features().from_motion(out.clip);
    out.rows.assign(rows.begin(), rows.end());
    out.frames = std::ssize(rows) / model_.layout.size;
    return out;
  }
  /// The frames that are kept of so many in a timeline of `wanted`. Throws usage_error 101 for others.
  std::vector<ml::IndexRange> kept_frames(const KeptClip& keep, ml::Index frames, ml::Index wanted) const {
    const ml::Index common = std::min(frames, wanted);
    if (keep.seconds.empty()) return {{0, common}};
    std::vector<ml::IndexRange> out;
    for (const auto& [from, to] : keep.seconds) {
      const ml::IndexRange range{ml::frame_at(from, model_.fps), ml::frame_at(to, model_.fps)};
      if (range.begin < 0 || range.size() < 1 || range.end > common)
        ml::raise<usage_error>(101, "--keep-seconds: ", from, "-", to, " is frames ", range.begin, ":", range.end,
                               " at ", model_.fps, " per second; the motion to keep has ", frames, ", the timeline ",
                               wanted);
      out.push_back(range);
    }
    return out;
  }
  Features around(const std::vector<ml::Timeline>& timelines, const Kept& clip, const GenerationSettings& s,
                  const ml::StmcOptions& options) const {
    std::vector<ml::KeptMotion<B>> kept;
    for (const ml::Timeline& t : timelines) {
      auto& own = kept.emplace_back();
      own.features = ml::Tensor<B, 2>::from(clip.rows, {clip.frames, model_.layout.size});
      for (const ml::IndexRange& range : kept_frames(*s.keep, clip.frames, t.end()))
        own.parts.push_back({range, s.keep->parts});
    }
    return ml::generate_around<B>(model_, timelines, ml::Philox{.seed = s.seed}, options,
                                  std::span<const ml::KeptMotion<B>>(kept));
  }
  /// Without jumps where what is kept begins and ends; turned and moved over the floor to where the clip is, where its
  /// way is kept. Frames that are kept behind made ones are where these lead.
  ml::Motion in_its_place(ml::Motion motion, const Kept& kept, const GenerationSettings& s) const {
    const auto ranges = kept_frames(*s.keep, kept.frames, motion.frames());
    if (s.smooth) motion = without_jumps(std::move(motion), ranges, ml::frame_at(s.overlap, model_.fps));
    if (!s.keep->parts.has(ml::BodyPart::legs)) return motion;
    const ml::Index first = std::ranges::min(ranges, {}, &ml::IndexRange::begin).begin;
    return ml::placed(motion, ml::placement_between(motion, first, kept.clip, first));
  }
  /// Metres over the floor that the root of any kept frame is from where it was; 0 where the way is not kept.
  double farthest_from(const Kept& kept, const ml::Motion& motion, const KeptClip& keep) const {
    double out = 0;
    if (!keep.parts.has(ml::BodyPart::legs)) return out;
    for (const ml::IndexRange& r : kept_frames(keep, kept.frames, motion.frames())) {
      for (ml::Index f = r.begin; f < r.end; ++f) {
        const auto d = motion.root_at(f) - kept.clip.root_at(f);
        out = std::max(out, std::hypot(d.x, d.z));
      }
    }
    return out;
  }
  /// Made frames, at most so many beside those that are kept, lead from the ones to the others.
  static ml::Motion without_jumps(ml::Motion motion, const std::vector<ml::IndexRange>& kept, ml::Index frames) {
    const auto is_kept = [&](ml::Index f) {
      return std::ranges::any_of(kept, [f](const ml::IndexRange& r) { return r.begin <= f && f < r.end; });
    };
    for (ml::Index begin = 0, end = 0; begin < motion.frames(); begin = end) {
      for (end = begin + 1; end < motion.frames() && is_kept(end) == is_kept(begin);) ++end;
      if (is_kept(begin)) continue;
      const ml::Index reach = std::min(frames, end - begin);
      if (begin > 0) motion = ml::without_jump(motion, begin, begin + reach);
      if (end < motion.frames()) motion = ml::without_jump(motion, end - 1, end - 1 - reach);
    }
    return motion;
  }

  /// With what the record of an earlier run says about the part that was not edited.
  Features again(const std::vector<ml::Timeline>& timelines, const GenerationSettings& s, ml::Progress progress) const {
    const auto file = ml::SafetensorsFile::open(s.reuse_file);
    auto record = ml::load_stmc_record<B>(file, model_);
    const bool cut_texts = file.metadata().contains("cut_texts") && file.metadata().at("cut_texts") == "1";
    ml::RegenerateOptions how{.within = {}, .progress = progress};
    if (s.keep_beyond) how.within = ml::frame_at(*s.keep_beyond, model_.fps);
    ml::StmcReuse reuse;
    auto features = ml::regenerate<B>(model_, record, cut(timelines, cut_texts), how, &reuse);
    if (!s.record_file.empty()) save(record, s.record_file, cut_texts);
    if (s.notes != nullptr) s.notes->reuse = told(reuse, s.keep_beyond), s.notes->seed = record.rng.seed;
    return features;
  }

  void save(const ml::StmcRecord<B>& record, const std::string& path, bool cut_texts) const {
    ml::save_stmc_record(path, record, model_, {{"cut_texts", cut_texts ? "1" : "0"}});
  }

  static auto noise_from(const std::string& path) {
    return [file = ml::SafetensorsFile::open(path)](ml::Index draw, const ml::Shape& shape) {
      const auto& view = file.tensor(ml::detail::numbered_name("noise", static_cast<std::size_t>(draw)));
      if (view.shape != shape)
        ml::raise<ml::io_error>(407, file.name(), ": ", view.name, " is ", view.shape, ", this timeline needs ", shape);
      return ml::Tensor<B, 3>::from(ml::values_of<typename B::scalar>(view), shape);
    };
  }

  ml::Stmc<B, D, E> model_;
  std::vector<std::string> words_;
};

template <ml::Backend B, class D, class E>
std::unique_ptr<Generator> make_generator(ml::Stmc<B, D, E> model, std::vector<std::string> words = {}) {
  return std::make_unique<GeneratorOver<B, D, E>>(std::move(model), std::move(words));
}

}  // namespace program
