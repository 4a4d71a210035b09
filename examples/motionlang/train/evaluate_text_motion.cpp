// motionlang evaluate of TMR and TEMOS: the tables of the papers, compared with chance and simple guesses.
#include "evaluate.hpp"

#include <cstdio>

#include <motionlang/datasets/described_motions.hpp>
#include <motionlang/features/feature_rows.hpp>
#include <motionlang/file/id_list.hpp>
#include <motionlang/generate/finish_motion.hpp>
#include <motionlang/generate/synthesized_batch.hpp>
#include <motionlang/train/filtered_negatives.hpp>
#include <motionlang/train/made_motions.hpp>
#include <motionlang/train/presets.hpp>
#include <motionlang/train/ranked_queries.hpp>
#include <motionlang/train/retrieval_evaluation.hpp>
#include <motionlang/train/temos_evaluation.hpp>
#include <motionlang/view/film_strip.hpp>
#include <motionlang/weights/model_system.hpp>
#include <motionlang/weights/text_motion_checkpoint.hpp>
#include <motionlang/weights/text_motion_model.hpp>
#include <motionlang/weights/text_states.hpp>
#include <motionlang/weights/vae_run.hpp>

#include "../formatted.hpp"
#include "../generate/generation.hpp"
#include "../usage_error.hpp"
#include "evaluate_guo.hpp"
#include "film_strips.hpp"
#include "processes.hpp"
#include "training_command.hpp"

namespace program {

using ml::Index;
using B = EvaluationBackend;

namespace {

/// The first texts without duplicates.
std::vector<std::string> first_texts(const std::vector<ml::DescribedMotion>& motions) {
  std::set<std::string> out;
  for (const ml::DescribedMotion& d : motions) out.insert(d.texts.front().text);
  return {out.begin(), out.end()};
}

/// The data of a model's configuration, and the part to measure.
struct Measured {
  ml::DataSources sources;
  ml::DataConfig config;
  ml::DescribedMotions data;
  const std::vector<ml::DescribedMotion>* part;
  std::optional<ml::EmbeddingCache> states;
  ml::EmbeddingCache sentences;

  /// encoder  for the texts, if the model has its own
  Measured(const EvaluationOptions& o, const ml::TextMotionFile& file, const ml::AnyTextEncoder<B>* encoder = nullptr)
      : sources{o.data, o.captions, {}, o.annotations, o.splits},
        config(file.config.data),
        data([&] {
          config.mirror = false;
          ml::RowMaker rows = ml::row_maker(file.config.features);
          rows.fps = file.fps;
          return read_motions_of(sources, config, rows);
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

/// Figures 5.3 to 5.7.
void write_galleries(const EvaluationOptions& o, const Measured& m, const ml::LatentTable& table,
                     const ml::TextMotionFile& file) {
  const auto e = m.sentences.encode<B>(table.texts).tokens.rows;
  const auto queries =
      ml::ranked_queries(table, ml::Rows(e.span(), e.size(1)), *m.part, {.queries = o.count, .motions = 5});
  const auto& features = ml::motion_features(file.config.features);
  const std::string title = ml::concat_text("Nearest of ", ml::counted(m.part->size(), "motion"));
  ml::write_file(o.html, ml::retrieval_page(queries, title, [&](const ml::RankedMotion& found) {
                   const auto rows =
                       ml::first_text_rows((*m.part)[static_cast<std::size_t>(found.number)], features.width);
                   const auto motion = ml::motion_of_features(features, rows, file.fps);
                   return ml::film_strip_svg(motion, {}, {.poses = 6, .width = 480, .title = " "});
                 }));
  std::printf("%s in %s\n", ml::counted(queries.size(), "gallery", "galleries").c_str(), o.html.string().c_str());
}

}  // namespace

void print_retrieval_tables(const EvaluationOptions& o, const std::vector<ml::DescribedMotion>& part,
                            const ml::LatentTable& table, const std::optional<ml::LatentTable>& made,
                            const ml::EmbeddingCache& sentences, bool euclidean) {
  ml::RetrievalOptions options{.threshold = o.threshold, .ids = {}, .nsim_ids = {}, .euclidean = euclidean};
  for (const ml::DescribedMotion& d : part) options.ids.push_back(d.id);
  if (!o.nsim.empty()) {
    options.nsim_ids = ml::read_ids(o.nsim);
    const auto measured = [&](const std::string& id) {
      return std::ranges::find(options.ids, id) != options.ids.end();
    };
    if (std::ranges::none_of(options.nsim_ids, measured))
      ml::raise<ml::config_error>(102, "--nsim ", o.nsim.string(), " names no motion of the ", o.part, " part");
  }
  const auto e = sentences.encode<B>(table.texts).tokens.rows;
  const ml::Rows rows(e.span(), e.size(1));
  const auto alike = ml::similar_pairs(rows, o.threshold);
  std::printf("%td of %td pairs of texts (%.2f %%) are more similar than %.2f\n", alike.similar, alike.all,
              alike.percent(), o.threshold);
  print(ml::retrieval_results_table(ml::retrieval_results(table, made ? &*made : nullptr, rows, options)));
}

void evaluate_tmr(const EvaluationOptions& o) {
  if (o.moments > 0 || !o.babel.empty()) return evaluate_moments(o);
  const ml::TextMotionFile file = ml::read_text_motion_config(o.model);
  const Measured m(o, file);
  const auto model = ml::load_text_motion<ml::Tmr, B>(o.model, file);
  const auto table = ml::latents_of(model, *m.part, m.token_cache());
  std::optional<ml::LatentTable> made;
  if (o.synthesis) {
    std::unique_ptr<ml::MotionModel> other;
    const ml::MadeMotions elsewhere(o.made, o.made_rate);
    if (!o.made.empty()) elsewhere.samples(*m.part);
    std::size_t next = 0;  // motions come in their order
    if (!o.generator.empty()) {
      const auto& text_encoder = o.generator_text_encoder.empty() ? o.text_encoder : o.generator_text_encoder;
      other = load_generator("eigen", o.generator,
                             {.text_encoder = text_encoder.string(), .statistics = o.generator_statistics.string()});
    }
    std::uint64_t seed = o.seed;  // of the next batch
    made = ml::latents_of(model, *m.part, m.token_cache(), [&](const ml::TextMotionBatch<B>& batch) {
      const std::uint64_t own = seed++;
      if (!o.made.empty()) {
        const auto& features = ml::motion_features(file.config.features);
        ml::MotionBatch<B> rows(model.motion_normalizer);
        for (std::size_t i = 0; i < batch.texts.size(); ++i) {
          const auto read = elsewhere.rows(elsewhere.files((*m.part)[next++]).front(), features, features.fps).rows;
          rows.add(read, {0, std::ssize(read) / features.width});
        }
        return rows.normalized();
      }
      if (other != nullptr)
        return ml::synthesized_batch(*other, batch, ml::motion_features(file.config.features), model.motion_normalizer,
                                     own, processes());
      return ml::text_to_motion(model.system, model.tokens(batch.texts, m.token_cache()), batch.motions.offsets,
                                ml::Philox{.seed = own})
          .front();
    });
  }
  print_retrieval_tables(o, *m.part, table, made, m.sentences, /*euclidean=*/false);
  if (o.filtered) print(ml::filtered_negatives_table(ml::filtered_shares<B>(m.data.training, m.sentences)));
  if (!o.html.empty() && processes().rank() == 0) write_galleries(o, m, table, file);
}

namespace {

void measure_temos(const EvaluationOptions& o, const ml::TextMotionFile& file, const Measured& m,
                   const ml::TemosModel<B>& model, FilmStrips& strips) {
  const auto& features = ml::motion_features(file.config.features);
  const ml::TemosJoints joints =
      o.joints.empty() ? ml::TemosJoints(features) : ml::mmm_joints<B>(features, o.joints, o.body);
  const double rate = o.rate > 0 ? o.rate : ml::rate_of_errors(m.data.fps);
  std::vector<ml::DescribedMotion> at_rate;
  if (rate != m.data.fps) {
    ProgressBar bar("reading motions again");
    at_rate = ml::recorded_at(m.sources, m.config, features, o.part, rate, bar);
  }
  ProgressBar bar("generating");
  std::string best;  // by the number of samples
  ml::TemosMeasures<B> how{
      .tokens = [&](std::span<const std::string> texts) { return model.tokens(texts, m.token_cache()); },
      .sampled = [&](const ml::SampledErrors& e) { best = ml::best_of_table(e); },
      .samples = o.samples,
      .seed = o.seed,
      .joints = joints,
      .rate = rate,
      .recorded = at_rate,
      .communicator = processes()};
  if (strips.wanted()) {
    how.shows = [&](const std::string& text) { return strips.shows(text); };
    how.made = [&](const std::string& text, std::span<const float> mean, std::span<const float> recorded) {
      strips.add(
          text, [&] { return ml::motion_of_features(features, mean, file.fps); },
          [&] { return ml::motion_of_features(features, recorded, file.fps); });
    };
  }
  auto errors = ml::temos_errors<B>(model.system, model.motion_normalizer, features, m.data, *m.part, how, bar);
  bar.finish();
  if (!o.joints.empty())
    std::printf("MMM's joints of %s\n", o.body.empty() ? "our own skeleton, whose ankles replace the heels; --body "
                                                         "SMPLH_NEUTRAL takes those of SMPL-H as published"
                                                       : "SMPL-H");
  if (joints.unit != 1)
    std::printf("as TEMOS measures MMM's joints: 640 units per metre, which count as millimetres\n");
  const char* which = at_rate.empty() ? "all" : "generated ones";
  if (rate != m.data.fps)
    std::printf("joints at %g frames per second; %s are interpolated from %g\n", rate, which, m.data.fps);
  if (!o.made.empty()) {
    const ml::MadeMotions made(o.made, o.made_rate);
    errors.push_back(ml::made_errors(made, features, m.data, *m.part, joints, rate, at_rate));
  }
  print(ml::errors_table(errors));
  if (o.samples > 1) print(best);
}

}  // namespace

void evaluate_temos(const EvaluationOptions& o) {
  if (o.joints.empty() && !o.body.empty())
    ml::raise<usage_error>(102, "--body of TEMOS is for --joints mmm or mmmns, which select joints of it");
  FilmStrips strips(o);
  if (ml::model_system(ml::FilePath(o.model)).ours) {
    const ml::TextMotionFile file = ml::read_text_motion_config(o.model);
    const Measured m(o, file);
    return measure_temos(o, file, m, ml::load_text_motion<ml::Temos, B>(o.model, file), strips);
  }
  auto run = ml::load_temos_run<B>(ml::FilePath(o.model), {.text_encoder = o.text_encoder, .statistics = o.statistics});
  ml::TextMotionFile file{"temos", run.fps, ml::temos_preset("temos-published"), {}};
  file.config.features = ml::published_temos_features(run.width()).name;
  const Measured m(o, file, &run.text_encoder);
  measure_temos(o, file, m, {.system = std::move(run.model), .motion_normalizer = std::move(run.normalizer)}, strips);
}

}  // namespace program
