// motionlang evaluate of TMR and TEMOS: the tables of the papers, next to what chance and simple guesses reach.
#include "evaluate.hpp"

#include <cstdio>
#include <map>

#include <motionlang/datasets/described_motions.hpp>
#include <motionlang/features/feature_rows.hpp>
#include <motionlang/file/id_list.hpp>
#include <motionlang/generate/text_latents.hpp>
#include <motionlang/train/presets.hpp>
#include <motionlang/train/retrieval_evaluation.hpp>
#include <motionlang/weights/text_motion_checkpoint.hpp>
#include <motionlang/weights/text_motion_model.hpp>
#include <motionlang/weights/text_states.hpp>
#include <motionlang/weights/vae_run.hpp>

#include "../generate/generation.hpp"
#include "film_strips.hpp"
#include "position_errors.hpp"
#include "training_command.hpp"

namespace program {

using ml::Index;
using B = EvaluationBackend;

namespace {

/// The different ones of the texts that come first.
std::vector<std::string> first_texts(const std::vector<ml::DescribedMotion>& motions) {
  std::set<std::string> out;
  for (const ml::DescribedMotion& d : motions) out.insert(d.texts.front().text);
  return {out.begin(), out.end()};
}

/// The data of a model's configuration, and the part that is measured.
struct Measured {
  ml::DescribedMotions data;
  const std::vector<ml::DescribedMotion>* part;
  std::optional<ml::EmbeddingCache> states;
  ml::EmbeddingCache sentences;

  /// encoder  of the texts, where the model has its own
  Measured(const EvaluationOptions& o, const ml::TextMotionFile& file, const ml::AnyTextEncoder<B>* encoder = nullptr)
      : data([&] {
          auto config = file.config.data;
          config.mirror = false;
          ml::RowMaker rows = ml::row_maker(file.config.features);
          rows.fps = file.fps;
          return read_motions_of({o.data, o.captions, {}, o.annotations, o.splits}, config, rows);
        }()),
        part(&data.part(o.part)),
        sentences(0) {
    if (part->empty()) ml::raise<ml::config_error>(101, "the part '", o.part, "' has no motions");
    if (encoder != nullptr)
      states = ml::states_of<B>(*encoder, first_texts(*part));
    else if (!o.text_encoder.empty() && !file.language)
      states = ml::token_states<B>(o.text_encoder, ml::all_texts(data));
    sentences = ml::sentence_vectors<B>(o.sentence_encoder, data);
    std::printf("%s of the %s part\n", ml::counted(part->size(), "motion").c_str(), o.part.c_str());
  }
  const ml::EmbeddingCache* token_cache() const { return states ? &*states : nullptr; }
};

void print_retrieval(const char* what, const ml::RetrievalTable& t) {
  auto row = [](const ml::RetrievalMetrics& m) {
    std::string out;
    char text[32];
    for (const double r : m.recall) std::snprintf(text, sizeof text, "%7.2f", r), out += text;
    std::snprintf(text, sizeof text, "%8.2f", m.median_rank);
    return out + text;
  };
  std::printf("  %-22s %s   %s\n", what, row(t.text_to_motion).c_str(), row(t.motion_to_text).c_str());
}

/// Motions for the texts of a batch, as long as its own and seen by the model: made by it, or by another.
class Synthesis {
 public:
  Synthesis(const EvaluationOptions& o, const ml::TmrModel<B>& model, const ml::TextMotionFile& file,
            const ml::EmbeddingCache* states)
      : model_(model), features_(ml::motion_features(file.config.features)), states_(states), seed_(o.seed) {
    if (o.generator.empty()) return;
    other_ = load_generator("eigen", o.generator, {.text_encoder = o.text_encoder.string()});
  }
  ml::Sequences<B> operator()(const ml::TextMotionBatch<B>& batch) {
    const ml::Offsets& lengths = batch.motions.offsets;
    const std::uint64_t seed = seed_++;
    if (!other_)
      return ml::text_to_motion(model_.system, model_.tokens(batch.texts, states_), lengths, ml::Philox{.seed = seed})
          .front();
    std::vector<ml::Timeline> timelines;
    for (Index i = 0; i < lengths.count(); ++i) {
      const double seconds = static_cast<double>(lengths.length(i)) / features_.fps;
      const Index frames = std::max<Index>(1, std::lround(seconds * other_->fps()));
      timelines.push_back({{{batch.texts[static_cast<std::size_t>(i)], 0, frames, ml::BodyParts::all()}}});
    }
    std::vector<float> values;
    std::vector<Index> frames;
    for (const ml::Motion& motion : ml::generate_motions(*other_, timelines, {.seed = seed})) {
      const auto rows = ml::rows_of_motion(features_, motion, features_.fps);
      values.insert(values.end(), rows.begin(), rows.end());
      frames.push_back(std::ssize(rows) / features_.width);
    }
    const ml::Offsets offsets(frames);
    return {model_.motion_normalizer.normalize(ml::Tensor<B, 2>::from(values, {offsets.rows(), features_.width})),
            offsets};
  }

 private:
  const ml::TmrModel<B>& model_;
  const ml::MotionFeatures& features_;
  const ml::EmbeddingCache* states_;
  std::uint64_t seed_;
  std::unique_ptr<ml::MotionModel> other_;
};

}  // namespace

void evaluate_tmr(const EvaluationOptions& o, const ml::TextMotionFile& file) {
  const Measured m(o, file);
  ml::RetrievalOptions options{.threshold = o.threshold};
  for (const ml::DescribedMotion& d : *m.part) options.ids.push_back(d.id);
  if (!o.nsim.empty()) {
    options.nsim_ids = ml::read_ids(o.nsim);
    const auto measured = [&](const std::string& id) {
      return std::ranges::find(options.ids, id) != options.ids.end();
    };
    if (std::ranges::none_of(options.nsim_ids, measured))
      ml::raise<ml::config_error>(102, "--nsim ", o.nsim.string(), " names no motion of the ", o.part, " part");
  }
  const auto model = ml::load_text_motion<ml::Tmr, B>(o.model, file);
  const auto table = ml::latents_of(model, *m.part, m.token_cache());
  std::optional<ml::LatentTable> made;
  if (o.synthesis) made = ml::latents_of(model, *m.part, m.token_cache(), Synthesis(o, model, file, m.token_cache()));
  const auto e = m.sentences.encode<B>(table.texts).tokens.rows;
  const ml::Rows sentences(e.span(), e.size(1));
  std::printf(
      "%-25s %-44s %s\n%25s    R@1    R@2    R@3    R@5   R@10    MedR       R@1    R@2    R@3    R@5   R@10    MedR\n",
      "", "text to motion", "motion to text", "");
  using enum ml::RetrievalProtocol;
  const std::map<ml::RetrievalProtocol, const char*> names{
      {normal, "all"}, {threshold, "all, texts alike"}, {nsim, "dissimilar"}, {guo, "batches of 32"}};
  for (const ml::RetrievalResult& r : ml::retrieval_results(table, made ? &*made : nullptr, sentences, options)) {
    print_retrieval(names.at(r.protocol), r.recorded);
    if (r.made) print_retrieval("  generated", *r.made);
    print_retrieval("  by chance", r.chance);
  }
}

namespace {

/// How errors are measured: MMM's 21 joints as TEMOS has it (temos/model/metrics/compute.py), Y up, KIT's units taken
/// for millimetres, seen from the heading of knees and elbows; SMPL's 22 in metres, Z up.
struct MeasuredJoints {
  bool mmm;
  ml::RifkeVariant variant;
  double unit;

  explicit MeasuredJoints(const ml::MotionFeatures& f)
      : mmm(f.joints == ml::kit21_skeleton().size()),
        variant(mmm ? ml::temos_rifke()
                    : ml::RifkeVariant{.joints = 22,
                                       .z_up = true,
                                       .across = {{{2, 1}, {17, 16}}},
                                       .floor = {7, 10, 8, 11}}),
        unit(mmm ? 0.001 : 1) {}
  Joints operator()(const ml::MotionFeatures& f, std::span<const float> rows) const {
    const std::vector<double> values(rows.begin(), rows.end());
    if (!mmm) return ml::detail::turned_up(f.joints_of(values), true);
    Joints joints = f.joints_of(values);
    for (auto& p : joints) p = ml::detail::mmm_units_per_metre * ml::Vec3<double>{-p.x, p.y, p.z};
    return joints;
  }
};
std::span<const float> rows_of(const ml::DescribedMotion& d, Index width) {
  const auto& frames = d.texts.front().frames;
  return std::span(d.rows).subspan(static_cast<std::size_t>(frames.first * width),
                                   static_cast<std::size_t>(frames.length * width));
}

void measure_temos(const EvaluationOptions& o, const ml::TextMotionFile& file, const Measured& m,
                   const ml::TemosModel<B>& model, FilmStrips& strips) {
  const auto& features = ml::motion_features(file.config.features);
  const MeasuredJoints joints_of(features);
  const JointErrors none(joints_of.variant, joints_of.unit);
  SampledErrors sampled(none, o.samples);
  JointErrors at_mean = none;
  const auto& training = m.data.training;
  BlindErrors blind(
      joints_of.variant, none, std::ssize(training),
      [&](Index i) { return joints_of(features, rows_of(training[static_cast<std::size_t>(i)], features.width)); },
      o.seed);
  ProgressBar bar("generating");
  for (std::size_t i = 0; i < m.part->size(); ++i) {
    const ml::DescribedMotion& d = (*m.part)[i];
    const auto truth = joints_of(features, rows_of(d, features.width));
    const auto frames = static_cast<std::size_t>(std::ssize(truth) / features.joints);
    const std::vector<std::string> text{d.texts.front().text};
    const auto tokens = model.tokens(text, m.token_cache());
    const ml::Offsets length{std::vector<Index>{static_cast<Index>(frames)}};
    auto made = [&](const ml::Sequences<B>& s) { return model.motion_normalizer.denormalize(s.rows).to_vector(); };
    std::vector<Joints> samples;
    const auto rng = ml::Philox{.seed = o.seed};
    for (const auto& s : ml::text_to_motion(model.system, tokens, length, rng, o.samples))
      samples.push_back(joints_of(features, made(s)));
    sampled.add(samples, truth);
    const auto mean_rows = made(ml::text_to_motion(model.system, tokens, length, rng, 1, {.mean = true}).front());
    at_mean.add(joints_of(features, mean_rows), truth);
    blind.add(truth);
    strips.add(
        text[0], [&] { return ml::motion_of_features(features, mean_rows, file.fps); },
        [&] { return ml::motion_of_features(features, rows_of(d, features.width), file.fps); });
    bar(static_cast<Index>(i) + 1, std::ssize(*m.part));
  }
  bar.finish();
  if (joints_of.mmm) std::printf("as TEMOS measures MMM's joints: 640 units per metre, which count as millimetres\n");
  print_error_heads();
  print_errors(sampled);
  print_errors("mean of the latent", at_mean.result());
  print_errors(blind);
}

}  // namespace

void evaluate_temos(const EvaluationOptions& o, const ml::TextMotionFile& file) {
  FilmStrips strips(o);
  const Measured m(o, file);
  measure_temos(o, file, m, ml::load_text_motion<ml::Temos, B>(o.model, file), strips);
}

void evaluate_published_temos(const EvaluationOptions& o) {
  FilmStrips strips(o);
  auto run = ml::load_temos_run<B>(ml::FilePath(o.model), {.text_encoder = o.text_encoder, .statistics = o.statistics});
  ml::TextMotionFile file{"temos", run.fps, ml::temos_preset("temos-published"), {}};
  file.config.features = ml::published_temos_features(run.width()).name;
  const Measured m(o, file, &run.text_encoder);
  measure_temos(o, file, m, {.system = std::move(run.model), .motion_normalizer = std::move(run.normalizer)}, strips);
}

}  // namespace program
