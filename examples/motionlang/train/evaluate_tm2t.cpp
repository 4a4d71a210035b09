// motionlang evaluate of TM2T: what it says about motions, against what people said.
#include <cstdio>

#include <motionlang/io/tm2t_run.hpp>
#include <motionlang/metrics/captions.hpp>

#include "../progress_bar.hpp"
#include "described_words.hpp"
#include "evaluate.hpp"

namespace program {

namespace {

using ml::Index;
using B = ml::EigenBackend<float>;

/// What the model was trained on, of our own training; the defaults for others.
DataConfig data_of(const std::filesystem::path& folder) {
  DataConfig out;
  const ml::RunFolder run = ml::find_run(folder);
  if (!run.packed) return out;
  const nlohmann::json others = ml::read_model_folder(folder).others;
  if (!others.contains("training")) return out;
  read_config(out, ml::JsonView(others, (folder / "config.json").string())["training"]["data"]);
  out.mirror = false;
  return out;
}

/// The texts about the same frames of a motion, the first three of them, with what is to be compared with them.
std::vector<ml::CaptionPair> references_of(const DescribedMotion& m, const ml::GloVe& words,
                                           std::vector<ml::FrameSlice>& frames) {
  std::vector<ml::CaptionPair> out;
  std::vector<ml::FrameSlice> own;
  for (const DescribedText& t : m.texts) {
    const auto same = std::find(own.begin(), own.end(), t.frames);
    if (same == own.end()) out.emplace_back();
    out[static_cast<std::size_t>(same - own.begin())].references.push_back(ml::lemmas(words_of(t, words)));
    if (same == own.end()) own.push_back(t.frames);
  }
  for (ml::CaptionPair& pair : out) pair.references = ml::three_references(pair.references);
  frames.insert(frames.end(), own.begin(), own.end());
  return out;
}

void print_scores(const char* what, const std::vector<ml::CaptionPair>& pairs) {
  std::printf("  %-34s", what);
  for (const double b : ml::bleu(ml::corpus_counts(pairs))) std::printf("%8.2f", 100 * b);
  std::printf("%9.2f%9.2f\n", 100 * ml::rouge_l(pairs), 100 * ml::cider(pairs));
}

}  // namespace

void evaluate_tm2t(const EvaluationOptions& o) {
  const auto run = ml::load_tm2t_describer<B>(ml::find_run(o.model),
                                              {.tokenizer = o.tokenizer.string(), .words = o.text_encoder.string()});
  const ml::MotionFeatures& features = ml::motion_features(run.width() == 251 ? "kit" : "guoh3d");
  const auto data = [&] {
    ProgressBar bar("reading motions");
    return read_described_motions({o.data, o.captions, {}, o.annotations, o.splits}, data_of(o.model),
                                  row_maker(std::string(features.name)), bar);
  }();
  const auto& part = data.part(o.part);
  if (part.empty()) ml::raise<ml::config_error>(101, "the part '", o.part, "' has no motions");

  std::vector<ml::CaptionPair> pairs;
  {
    ProgressBar bar("describing");
    for (std::size_t i = 0; i < part.size(); ++i) {
      std::vector<ml::FrameSlice> frames;
      auto own = references_of(part[i], run.words, frames);
      for (std::size_t k = 0; k < own.size(); ++k) {
        const Index length = std::min(frames[k].length / 4 * 4, ml::tm2t_longest);
        const auto begin = part[i].rows.begin() + frames[k].first * data.width;
        const std::vector<float> rows(begin, begin + length * data.width);
        own[k].candidate =
            run.model.describe({ml::Tensor<B, 2>::from(rows, {length, data.width}), ml::Offsets{length}}, run.words)
                .front();
        pairs.push_back(std::move(own[k]));
      }
      if (!bar(static_cast<Index>(i) + 1, std::ssize(part))) throw ml::cancelled();
    }
  }
  std::printf("%zu motions of the %s part, %zu to describe\n\n  %-34s%8s%8s%8s%8s%9s%9s\n", part.size(), o.part.c_str(),
              pairs.size(), "", "BLEU-1", "BLEU-2", "BLEU-3", "BLEU-4", "ROUGE-L", "CIDEr");
  print_scores("described", pairs);
  auto lot = ml::Philox{.seed = o.seed}.split("chance");
  for (ml::CaptionPair& pair : pairs) {
    const auto& texts = data.training[lot.below(static_cast<std::uint32_t>(data.training.size()))].texts;
    pair.candidate = ml::lemmas(words_of(texts[lot.below(static_cast<std::uint32_t>(texts.size()))], run.words));
  }
  print_scores("a text of the training part by lot", pairs);
}

}  // namespace program
