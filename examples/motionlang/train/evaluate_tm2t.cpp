// motionlang evaluate of TM2T: compares its descriptions of motions with people's descriptions, and measures its
// motions for texts with the networks of Guo et al.
#include <cstdio>
#include <optional>

#include <motionlang/train/description_evaluation.hpp>
#include <motionlang/weights/model_folder.hpp>
#include <motionlang/weights/tm2t_run.hpp>

#include "../formatted.hpp"
#include "../progress_bar.hpp"
#include "evaluate.hpp"
#include "evaluate_guo.hpp"
#include "processes.hpp"
#include "training_command.hpp"

namespace program {

namespace {

using B = ml::EigenBackend<float>;

ml::DescribedMotions read_data(const EvaluationOptions& o, ml::Index width) {
  const ml::DataConfig config = ml::data_config_of(o.model).value_or(ml::DataConfig());
  return read_motions_of({o.data, o.captions, {}, o.annotations, o.splits}, config,
                         ml::row_maker(width == 251 ? "kit" : "guoh3d"));
}

/// The baseline of BERTScore that --bert-baseline names, in words.
std::string baseline_text(ml::BertBaseline baseline, const ml::BertScore& score) {
  if (baseline == ml::BertBaseline::tm2t) return "with TM2T's baseline, of roberta-large's layer 17";
  if (baseline == ml::BertBaseline::random) return formatted("with the baseline %.4f of random texts", score.f);
  return "without a baseline";
}

void evaluate_descriptions(const EvaluationOptions& o, const ml::RunFolder& found) {
  const auto run =
      ml::load_tm2t_describer<B>(found, {.tokenizer = o.tokenizer.string(), .words = o.text_encoder.string()});
  std::optional<ml::BertJudge<B>> bert;
  if (!o.bert.empty()) bert.emplace(o.bert, o.bert_layer);
  std::optional<ml::GuoJudge<B>> guo;
  if (!o.evaluator.empty()) {
    ml::GuoJudgeFiles files = judge_files(o);
    if (files.words.empty()) files.words = o.text_encoder;
    guo.emplace(files, run.model.statistics);
  }
  const auto data = read_data(o, run.width());
  const auto& part = data.part(o.part);
  const auto entries = ml::text_entries(part, o.part);
  const ml::BertBaseline baseline = ml::parse_bert_baseline(o.bert_baseline);
  ProgressBar bar("describing");
  const auto figures = ml::description_figures<B>(
      run, data, entries, {.bert = bert ? &*bert : nullptr, .guo = guo ? &*guo : nullptr},
      {.baseline = baseline, .made = o.made, .seed = o.seed, .progress = bar, .communicator = processes()});
  bar.finish();
  if (bert)
    std::printf("BERTScore by layer %td of %td of %s, %s\n", bert->layers(), bert->all_layers(),
                o.bert.string().c_str(), baseline_text(baseline, figures.baseline).c_str());
  if (guo) std::printf("R-precision and distance by %s (%s)\n", o.evaluator.string().c_str(), guo->fingerprint.c_str());
  std::printf("%s of the %s part, %zu to describe\n\n", ml::counted(part.size(), "motion").c_str(), o.part.c_str(),
              entries.size());
  print(ml::description_table(figures.rows));
}

// ---- motions for texts --------------------------------------------------------------------------------------------

void evaluate_motions(const EvaluationOptions& o, const ml::RunFolder& found) {
  const auto run = ml::load_tm2t_run<B>(
      found, {.tokenizer = o.tokenizer.string(), .words = found.packed ? std::string() : o.text_encoder.string()});
  ml::GuoJudgeFiles files = judge_files(o);
  if (files.words.empty()) files.words = o.text_encoder;
  if (files.statistics.empty()) files.statistics = o.statistics;
  const ml::GuoJudge<B> judge(files, run.model.statistics);
  const auto data = read_data(o, run.width());
  print_judged(o, judge, data.part(o.part), data.width, ml::tm2t_maker(run.model, run.words));
}

}  // namespace

void evaluate_tm2t(const EvaluationOptions& o) {
  const ml::RunFolder found = ml::find_run(o.model);
  if (!o.evaluator.empty() && ml::is_tm2t_generator(found)) {
    evaluate_motions(o, found);
    return;
  }
  if (ml::is_tm2t_generator(found) && !ml::is_tm2t_describer(found))
    ml::raise<ml::config_error>(102, o.model.string(),
                                ": TM2T's motions of texts are judged by the networks of Guo et al.: "
                                "--evaluator names their finest.tar");
  evaluate_descriptions(o, found);
}

}  // namespace program
