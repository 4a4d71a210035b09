// motionlang evaluate --evaluator: motions of texts, judged by the networks of Guo et al.; and evaluate of these
// networks: how well they retrieve.
#include "evaluate_guo.hpp"

#include <cstdio>

#include <motionlang/generate/guo_motions.hpp>
#include <motionlang/train/guo_retrieval.hpp>
#include <motionlang/train/made_motions.hpp>
#include <motionlang/weights/text_states.hpp>

#include "../generate/generation.hpp"
#include "../progress_bar.hpp"
#include "../usage_error.hpp"
#include "processes.hpp"
#include "training_command.hpp"

namespace program {

namespace {

using ml::Index;
using B = EvaluationBackend;

ml::DescribedMotions read_data(const EvaluationOptions& o, Index width,
                               std::initializer_list<std::filesystem::path> trained) {
  ml::DataConfig config;
  for (const auto& model : trained) {
    if (const auto found = ml::data_config_of(model)) {
      config = *found;
      break;
    }
  }
  return read_motions_of({o.data, o.captions, {}, o.annotations, o.splits}, config,
                         ml::row_maker(width == 251 ? "kit" : "guoh3d"));
}

}  // namespace

ml::GuoJudgeFiles judge_files(const EvaluationOptions& o) {
  return {o.evaluator, o.evaluator_words, o.evaluator_statistics};
}

void print_judged(const EvaluationOptions& o, const ml::GuoJudge<B>& judge,
                  const std::vector<ml::DescribedMotion>& part, Index width, const ml::GuoMaker<B>& make) {
  const ml::GuoItems<B> items(part, o.part, width);
  const std::string varied = o.repeats == 0 ? "" : ", multimodality of " + ml::counted(items.varied(), "text");
  std::printf("%s of the %s part in batches of %td, drawn %s; diversity of %s%s\njudged by %s (%s)\n",
              ml::counted(items.count, "motion").c_str(), o.part.c_str(), items.batch,
              ml::counted(o.seeds, "time").c_str(), ml::counted(items.pairs(), "pair").c_str(), varied.c_str(),
              o.evaluator.string().c_str(), judge.fingerprint.c_str());
  ProgressBar bar("generating");
  const auto figures = ml::guo_figures(
      make, judge, items, {.replications = o.seeds, .repeats = o.repeats, .seed = o.seed, .communicator = processes()},
      bar);
  bar.finish();
  std::printf("\n%s", ml::guo_table(figures).c_str());
  if (figures.empty > 0)
    std::printf("%s no frames and counted as four of the mean pose\n",
                ml::counted(figures.empty, "motion had", "motions had").c_str());
  if (o.time > 0 && processes().rank() == 0)
    std::printf("generating %s took %.2f s\n", ml::counted(o.time, "motion").c_str(),
                ml::guo_seconds(make, judge, items, o.time, o.seed));
}

void evaluate_by_guo(const EvaluationOptions& o) {
  const ml::GuoJudge<B> judge(judge_files(o));
  const auto model =
      load_generator("eigen", o.model, {.text_encoder = o.text_encoder.string(), .statistics = o.statistics.string()});
  if (model->takes_actions())
    ml::raise<usage_error>(102, o.model.string(),
                           ": --evaluator judges motions of texts, and this model takes actions");
  const auto data = read_data(o, judge.width(), {o.model, ml::guo_evaluator_path(o.evaluator)});
  print_judged(o, judge, data.part(o.part), data.width,
               ml::guo_maker<B>(*model, judge.width(), {.steps = o.steps, .guidance = o.guidance}));
}

void evaluate_evaluator(const EvaluationOptions& o) {
  const ml::GuoJudge<B> judge(ml::GuoJudgeFiles{o.model, o.text_encoder, o.statistics});
  const auto data = read_data(o, judge.width(), {ml::guo_evaluator_path(o.model)});
  const auto& part = data.part(o.part);
  if (part.empty()) ml::raise<ml::config_error>(101, "the part '", o.part, "' has no motions");
  std::printf("%s of the %s part, by the nearest vectors of %s (%s)\n", ml::counted(part.size(), "motion").c_str(),
              o.part.c_str(), o.model.string().c_str(), judge.fingerprint.c_str());
  std::unique_ptr<ml::MotionModel> other;
  ml::GuoMaker<B> make;
  const ml::MadeMotions elsewhere(o.made, o.made_rate);
  if (!o.made.empty()) {
    EvaluationOptions judged = o;
    judged.evaluator = o.model;
    if (elsewhere.samples(part) < 2) judged.repeats = 0;
    make = ml::made_maker<B>(elsewhere, judge.width());
    print_judged(judged, judge, part, data.width, make);
  }
  if (o.synthesis && o.made.empty()) {
    if (o.generator.empty())
      ml::raise<usage_error>(102, "--synthesis of the evaluator needs --generator: it makes no motions itself");
    other = load_generator(
        "eigen", o.generator,
        {.text_encoder = o.generator_text_encoder.string(), .statistics = o.generator_statistics.string()});
    make = ml::guo_maker<B>(*other, judge.width(), {.communicator = processes()});
  }
  const auto table = ml::guo_latents(judge, part, data.width);
  std::optional<ml::LatentTable> made;
  if (make && o.synthesis) made = ml::guo_latents(judge, part, data.width, make, o.seed);
  print_retrieval_tables(o, part, table, made, ml::sentence_vectors<B>(o.sentence_encoder, data), /*euclidean=*/true);
}

}  // namespace program
