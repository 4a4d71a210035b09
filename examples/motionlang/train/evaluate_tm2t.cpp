// motionlang evaluate of TM2T: compares its descriptions of motions with people's descriptions, and measures its
// motions for texts with the networks of Guo et al.
#include <algorithm>
#include <cstdio>
#include <optional>

#include <motionlang/metrics/captions.hpp>
#include <motionlang/train/bert_judge.hpp>
#include <motionlang/train/description_evaluation.hpp>
#include <motionlang/train/text_entries.hpp>
#include <motionlang/weights/model_folder.hpp>
#include <motionlang/weights/tm2t_run.hpp>

#include "../progress_bar.hpp"
#include "evaluate.hpp"
#include "evaluate_guo.hpp"
#include "training_command.hpp"

namespace program {

namespace {

using ml::Index;
using B = ml::EigenBackend<float>;

ml::DescribedMotions read_data(const EvaluationOptions& o, Index width) {
  const ml::DataConfig config = ml::data_config_of(o.model).value_or(ml::DataConfig());
  return read_motions_of({o.data, o.captions, {}, o.annotations, o.splits}, config,
                         ml::row_maker(width == 251 ? "kit" : "guoh3d"));
}

/// The judges of descriptions.
struct DescriptionJudges {
  std::optional<ml::BertJudge<B>> bert{};
  ml::BertScore baseline{};
  std::optional<ml::GuoJudge<B>> guo{};
  std::span<const ml::TextEntry> entries{};
  Index width = 0;
  std::uint64_t seed = 0;
};

/// tagged: the candidates, as Guo's networks read them; empty: they do not judge the row
void print_scores(const char* what, const std::vector<ml::CaptionPair>& pairs, std::span<const std::string> tagged,
                  DescriptionJudges& judges) {
  std::printf("  %-34s", what);
  if (judges.guo) {
    const auto m = ml::description_match(*judges.guo, judges.entries, tagged, judges.width,
                                         ml::Philox{.seed = judges.seed}.split("batches"));
    for (int k = 1; k <= 3; ++k) std::printf("%8.3f", m.r_precision(k));
    std::printf("%9.3f", m.matching_score());
  }
  for (const double b : ml::bleu(ml::corpus_counts(pairs))) std::printf("%8.2f", 100 * b);
  std::printf("%9.2f%9.2f", 100 * ml::rouge_l(pairs), 100 * ml::cider(pairs));
  if (judges.bert) std::printf("%11.2f", 100 * (*judges.bert)(pairs, judges.baseline));
  std::printf("\n");
}

void evaluate_descriptions(const EvaluationOptions& o, const ml::RunFolder& found) {
  const auto run =
      ml::load_tm2t_describer<B>(found, {.tokenizer = o.tokenizer.string(), .words = o.text_encoder.string()});
  DescriptionJudges judges{.width = run.width(), .seed = o.seed};
  if (!o.bert.empty()) judges.bert.emplace(o.bert, o.bert_layer);
  if (!o.evaluator.empty()) {
    ml::GuoJudgeFiles files = judge_files(o);
    if (files.words.empty()) files.words = o.text_encoder;
    judges.guo.emplace(files, run.model.statistics);
  }
  const auto data = read_data(o, run.width());
  const auto& part = data.part(o.part);
  const auto entries = ml::text_entries(part, o.part);
  judges.entries = entries;
  auto draws = ml::Philox{.seed = o.seed}.split("chance");
  const auto random_text = [&]() -> const ml::DescribedText& {
    const auto& texts = data.training[draws.below(static_cast<std::uint32_t>(data.training.size()))].texts;
    return texts[draws.below(static_cast<std::uint32_t>(texts.size()))];
  };

  std::vector<ml::CaptionPair> pairs;
  std::vector<std::string> said;
  {
    ProgressBar bar("describing");
    for (const ml::TextEntry& e : entries) {
      const Index length = std::min(e.frames.length / 4 * 4, ml::tm2t_longest);
      const auto rows = ml::entry_rows(e, 0, length, data.width);
      pairs.push_back(ml::entry_references(e, run.words));
      pairs.back().candidate =
          run.model.describe({ml::Tensor<B, 2>::from(rows, {length, data.width}), ml::Offsets{length}}, run.words)
              .front();
      said.push_back(pairs.back().candidate);
      if (!bar(std::ssize(pairs), std::ssize(entries))) throw ml::cancelled();
    }
  }
  auto by_chance = pairs;
  std::vector<std::string> chance_texts, own_texts;
  for (ml::CaptionPair& pair : by_chance) {
    const ml::DescribedText& t = random_text();
    pair.candidate = ml::lemmas(ml::words_of(t, run.words));
    chance_texts.push_back(ml::tagged_text(t));
  }
  auto by_people = pairs;  // one text of people against the others
  for (std::size_t i = 0; i < by_people.size(); ++i) {
    const auto& texts = entries[i].texts;
    by_people[i].candidate = ml::lemmas(ml::words_of(*texts.front(), run.words));
    own_texts.push_back(ml::tagged_text(*texts.front()));
  }
  if (judges.bert) {
    std::string baseline = "without a baseline";
    if (o.bert_baseline == "tm2t") {
      judges.baseline = ml::tm2t_bert_baseline;
      baseline = "with TM2T's baseline, of roberta-large's layer 17";
    } else if (o.bert_baseline == "random") {
      judges.baseline = judges.bert->mean(by_chance);
      char text[64];
      std::snprintf(text, sizeof text, "with the baseline %.4f of random texts", judges.baseline.f);
      baseline = text;
    }
    std::printf("BERTScore by layer %td of %td of %s, %s\n", judges.bert->layers(), judges.bert->all_layers(),
                o.bert.string().c_str(), baseline.c_str());
  }
  if (judges.guo)
    std::printf("R-precision and distance by %s (%s)\n", o.evaluator.string().c_str(), judges.guo->fingerprint.c_str());
  std::printf("%s of the %s part, %zu to describe\n\n  %-34s%s%8s%8s%8s%8s%9s%9s%s\n",
              ml::counted(part.size(), "motion").c_str(), o.part.c_str(), pairs.size(), "",
              judges.guo ? "     R@1     R@2     R@3  MM-Dist" : "", "BLEU-1", "BLEU-2", "BLEU-3", "BLEU-4", "ROUGE-L",
              "CIDEr", judges.bert ? "  BERTScore" : "");
  const ml::CommonTags tags(data.training);
  print_scores("described", pairs, tags.tagged(said), judges);
  print_scores("a random text of the training part", by_chance, chance_texts, judges);
  if (judges.guo) print_scores("the first text of people", by_people, own_texts, judges);
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
