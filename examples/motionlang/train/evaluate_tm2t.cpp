// motionlang evaluate of TM2T: compares its descriptions of motions with people's descriptions, and measures its
// motions for texts with the networks of Guo et al.
#include <algorithm>
#include <cstdio>
#include <optional>

#include <motionlang/metrics/captions.hpp>
#include <motionlang/train/bert_judge.hpp>
#include <motionlang/train/guo_evaluation.hpp>
#include <motionlang/train/text_entries.hpp>
#include <motionlang/weights/model_folder.hpp>
#include <motionlang/weights/tm2t_run.hpp>

#include "../progress_bar.hpp"
#include "evaluate.hpp"
#include "training_command.hpp"

namespace program {

namespace {

using ml::Index;
using B = ml::EigenBackend<float>;

/// The data configuration of a model trained here; the defaults for published models.
ml::DataConfig data_of(const std::filesystem::path& folder) {
  ml::DataConfig out;
  const ml::RunFolder run = ml::find_run(folder);
  if (!run.packed) return out;
  const nlohmann::json others = ml::read_model_folder(folder).others;
  if (!others.contains("training")) return out;
  read_config(out, ml::JsonView(others, (folder / "config.json").string())["training"]["data"]);
  out.mirror = false;
  return out;
}

ml::DescribedMotions read_data(const EvaluationOptions& o, Index width) {
  return read_motions_of({o.data, o.captions, {}, o.annotations, o.splits}, data_of(o.model),
                         ml::row_maker(width == 251 ? "kit" : "guoh3d"));
}

void print_scores(const char* what, const std::vector<ml::CaptionPair>& pairs, std::optional<ml::BertJudge<B>>& bert) {
  std::printf("  %-34s", what);
  for (const double b : ml::bleu(ml::corpus_counts(pairs))) std::printf("%8.2f", 100 * b);
  std::printf("%9.2f%9.2f", 100 * ml::rouge_l(pairs), 100 * ml::cider(pairs));
  if (bert) std::printf("%11.2f", 100 * (*bert)(pairs));
  std::printf("\n");
}

void evaluate_descriptions(const EvaluationOptions& o, const ml::RunFolder& found) {
  const auto run =
      ml::load_tm2t_describer<B>(found, {.tokenizer = o.tokenizer.string(), .words = o.text_encoder.string()});
  std::optional<ml::BertJudge<B>> bert;
  if (!o.bert.empty()) {
    bert.emplace(o.bert, o.bert_layer);
    std::printf("BERTScore by layer %td of %td of %s, without a baseline\n", bert->layers(), bert->all_layers(),
                o.bert.string().c_str());
  }
  const auto data = read_data(o, run.width());
  const auto& part = data.part(o.part);
  const auto entries = ml::text_entries(part, o.part);

  std::vector<ml::CaptionPair> pairs;
  {
    ProgressBar bar("describing");
    for (const ml::TextEntry& e : entries) {
      const Index length = std::min(e.frames.length / 4 * 4, ml::tm2t_longest);
      const auto rows = ml::entry_rows(e, 0, length, data.width);
      pairs.push_back(ml::entry_references(e, run.words));
      pairs.back().candidate =
          run.model.describe({ml::Tensor<B, 2>::from(rows, {length, data.width}), ml::Offsets{length}}, run.words)
              .front();
      if (!bar(std::ssize(pairs), std::ssize(entries))) throw ml::cancelled();
    }
  }
  std::printf("%s of the %s part, %zu to describe\n\n  %-34s%8s%8s%8s%8s%9s%9s%s\n",
              ml::counted(part.size(), "motion").c_str(), o.part.c_str(), pairs.size(), "", "BLEU-1", "BLEU-2",
              "BLEU-3", "BLEU-4", "ROUGE-L", "CIDEr", bert ? "  BERTScore" : "");
  print_scores("described", pairs, bert);
  auto draws = ml::Philox{.seed = o.seed}.split("chance");
  for (ml::CaptionPair& pair : pairs) {
    const auto& texts = data.training[draws.below(static_cast<std::uint32_t>(data.training.size()))].texts;
    pair.candidate = ml::lemmas(ml::words_of(texts[draws.below(static_cast<std::uint32_t>(texts.size()))], run.words));
  }
  print_scores("a random text of the training part", pairs, bert);
}

// ---- motions for texts --------------------------------------------------------------------------------------------

void evaluate_motions(const EvaluationOptions& o, const ml::RunFolder& found) {
  const auto run = ml::load_tm2t_run<B>(
      found, {.tokenizer = o.tokenizer.string(), .words = found.packed ? std::string() : o.text_encoder.string()});
  const ml::GuoJudge<B> judge({o.evaluator, o.text_encoder, o.statistics}, run.model.statistics);
  const auto data = read_data(o, run.width());
  const ml::GuoItems<B> items(data.part(o.part), o.part, data.width);
  const Index batch = items.batch, count = items.count;
  std::printf("%s of the %s part in batches of %td, drawn %s; diversity of %s, multimodality of %s\n",
              ml::counted(count, "motion").c_str(), o.part.c_str(), batch, ml::counted(o.seeds, "time").c_str(),
              ml::counted(items.pairs(), "pair").c_str(), ml::counted(items.varied(), "text").c_str());

  ProgressBar bar("generating");
  const auto figures =
      ml::guo_figures(run.model, run.words, judge, items, {.replications = o.seeds, .seed = o.seed}, bar);
  bar.finish();
  std::printf("\n%s", ml::guo_table(figures).c_str());
  if (figures.empty > 0)
    std::printf("%s no frames and counted as four of the mean pose\n",
                ml::counted(figures.empty, "motion had", "motions had").c_str());
}

}  // namespace

void evaluate_tm2t(const EvaluationOptions& o) {
  const ml::RunFolder found = ml::find_run(o.model);
  if (!o.evaluator.empty()) {
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
