// motionlang evaluate of TM2T: what it says about motions, against what people said; what the networks of Guo et al.
// say about the motions that it makes of texts.
#include <algorithm>
#include <array>
#include <cstdio>
#include <map>
#include <optional>

#include <motionlang/core/text_lines.hpp>
#include <motionlang/datasets/guo_clip.hpp>
#include <motionlang/metrics/bert_score.hpp>
#include <motionlang/metrics/captions.hpp>
#include <motionlang/metrics/diversity.hpp>
#include <motionlang/metrics/frechet.hpp>
#include <motionlang/metrics/matching.hpp>
#include <motionlang/metrics/summary.hpp>
#include <motionlang/weights/guo_evaluator_file.hpp>
#include <motionlang/weights/text_encoder_folder.hpp>
#include <motionlang/weights/tm2t_run.hpp>

#include "../progress_bar.hpp"
#include "described_words.hpp"
#include "evaluate.hpp"
#include "feature_statistics.hpp"

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

DescribedMotions read_data(const EvaluationOptions& o, Index width) {
  ProgressBar bar("reading motions");
  return read_described_motions({o.data, o.captions, {}, o.annotations, o.splits}, data_of(o.model),
                                row_maker(width == 251 ? "kit" : "guoh3d"), bar);
}

/// Frames of a motion, and the texts about them.
struct Entry {
  const DescribedMotion* motion;
  ml::FrameSlice frames;
  std::vector<const DescribedText*> texts{};
};
/// Throws config_error 101 if there are none.
std::vector<Entry> entries_of(const std::vector<DescribedMotion>& part, const std::string& name) {
  std::vector<Entry> out;
  for (const DescribedMotion& m : part) {
    const auto first = std::ssize(out);
    for (const DescribedText& t : m.texts) {
      auto same = std::find_if(out.begin() + first, out.end(), [&](const Entry& e) { return e.frames == t.frames; });
      if (same == out.end()) same = out.insert(same, {&m, t.frames});
      same->texts.push_back(&t);
    }
  }
  if (out.empty()) ml::raise<ml::config_error>(101, "the part '", name, "' has no motions");
  return out;
}
/// `length` frames of an entry from one on.
std::span<const float> rows_of(const Entry& e, Index first, Index length, Index width) {
  return std::span(e.motion->rows)
      .subspan(static_cast<std::size_t>((e.frames.first + first) * width), static_cast<std::size_t>(length * width));
}

/// Three of its texts, with what is to be compared with them.
ml::CaptionPair references_of(const Entry& e, const ml::GloVe& words) {
  ml::CaptionPair out;
  for (const DescribedText* t : e.texts) out.references.push_back(ml::lemmas(words_of(*t, words)));
  out.references = ml::three_references(out.references);
  return out;
}

/// BERTScore by a language model of the BERT family: the mean of F over the descriptions, without a baseline.
class BertJudge {
 public:
  /// layers  that the model keeps; 0: all
  /// Throws  config_error 102 for CLIP, 101 for more layers than the model has, and what load_text_encoder throws
  BertJudge(const std::filesystem::path& folder, Index layers) : encoder_(ml::load_text_encoder<B>(folder)) {
    std::visit(
        [&](auto& network) {
          if constexpr (requires { network.words; }) {
            const Index all = std::ssize(network.layers);
            if (layers > all)
              ml::raise<ml::config_error>(101, "--bert-layer ", layers, ": ", folder.string(), " has ",
                                          ml::counted(all, "layer"));
            if (layers > 0) network.layers.resize(static_cast<std::size_t>(layers));
            std::printf("BERTScore by layer %td of %td of %s, without a baseline\n", std::ssize(network.layers), all,
                        folder.string().c_str());
          } else {
            ml::raise<ml::config_error>(102, "--bert ", folder.string(),
                                        " is CLIP; BERTScore needs one of the BERT family");
          }
        },
        encoder_.network.network);
  }

  double operator()(const std::vector<ml::CaptionPair>& pairs) {
    ml::BertWeights weights;
    for (const ml::CaptionPair& pair : pairs) {
      for (const std::string& r : pair.references) weights.add(encoded(r).ids);
    }
    double sum = 0;
    for (const ml::CaptionPair& pair : pairs) {
      std::vector<ml::BertSentence<float>> references;
      for (const std::string& r : pair.references) references.push_back(encoded(r).sentence());
      sum += ml::bert_score(encoded(pair.candidate).sentence(), std::span<const ml::BertSentence<float>>(references),
                            weights)
                 .f;
    }
    return sum / static_cast<double>(pairs.size());
  }

 private:
  struct Encoded {
    std::vector<Index> ids;
    ml::Tensor<B, 2> states;
    ml::BertSentence<float> sentence() const { return {ids, {states.span(), states.size(1)}}; }
  };
  /// Stripped and behind a blank, as the published program has sentences.
  const Encoded& encoded(const std::string& text) {
    auto found = known_.find(text);
    if (found == known_.end()) {
      const std::vector<std::string> sentence{" " + std::string(ml::detail::trim(text))};
      auto batch = ml::tokenize(encoder_.tokenizer, std::span(sentence));
      auto states = encoder_.network(batch).tokens.rows;
      found = known_.emplace(text, Encoded{std::move(batch.ids), std::move(states)}).first;
    }
    return found->second;
  }

  ml::AnyTextEncoder<B> encoder_;
  std::map<std::string, Encoded> known_;
};

void print_scores(const char* what, const std::vector<ml::CaptionPair>& pairs, std::optional<BertJudge>& bert) {
  std::printf("  %-34s", what);
  for (const double b : ml::bleu(ml::corpus_counts(pairs))) std::printf("%8.2f", 100 * b);
  std::printf("%9.2f%9.2f", 100 * ml::rouge_l(pairs), 100 * ml::cider(pairs));
  if (bert) std::printf("%11.2f", 100 * (*bert)(pairs));
  std::printf("\n");
}

void evaluate_descriptions(const EvaluationOptions& o, const ml::RunFolder& found) {
  const auto run =
      ml::load_tm2t_describer<B>(found, {.tokenizer = o.tokenizer.string(), .words = o.text_encoder.string()});
  std::optional<BertJudge> bert;
  if (!o.bert.empty()) bert.emplace(o.bert, o.bert_layer);
  const auto data = read_data(o, run.width());
  const auto& part = data.part(o.part);
  const auto entries = entries_of(part, o.part);

  std::vector<ml::CaptionPair> pairs;
  {
    ProgressBar bar("describing");
    for (const Entry& e : entries) {
      const Index length = std::min(e.frames.length / 4 * 4, ml::tm2t_longest);
      const auto rows = rows_of(e, 0, length, data.width);
      pairs.push_back(references_of(e, run.words));
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
  auto lot = ml::Philox{.seed = o.seed}.split("chance");
  for (ml::CaptionPair& pair : pairs) {
    const auto& texts = data.training[lot.below(static_cast<std::uint32_t>(data.training.size()))].texts;
    pair.candidate = ml::lemmas(words_of(texts[lot.below(static_cast<std::uint32_t>(texts.size()))], run.words));
  }
  print_scores("a random text of the training part", pairs, bert);
}

// ---- motions of texts ---------------------------------------------------------------------------------------------

/// Vectors of texts or of motions, one behind the other.
struct Embedded {
  std::vector<float> values;
  Index width = 0;

  void add(const ml::Tensor<B, 2>& more) {
    values.insert(values.end(), more.span().begin(), more.span().end());
    width = more.size(1);
  }
  ml::Rows<float> rows() const { return {values, width}; }
};

/// The networks of Guo et al. with what they need: `finest.tar` of text_mot_match, word vectors in a folder above it or
/// where --text-encoder says, statistics of the features.
struct Evaluator {
  ml::GuoEvaluator<B> networks;
  ml::GloVe words;
  ml::Normalizer<B> statistics;

  /// usual   statistics that the motions of the model have, which the published program takes for its own, too
  /// Throws  io_error 401 for what is missing, 406, 407 for other networks; config_error 102 for other features, words
  Evaluator(const EvaluationOptions& o, ml::Normalizer<B> usual)
      : Evaluator(o, file_of(o.evaluator), std::move(usual)) {}

  ml::Tensor<B, 2> texts(std::span<const std::string> of) const {
    return networks.embed_texts(words.encode<B>(of).tokens);
  }
  /// Motions without a movement count as one of the mean pose.
  ml::Tensor<B, 2> motions(const ml::Sequences<B>& features) const {
    const Index width = statistics.mean.size(0);
    std::vector<float> values;
    std::vector<Index> frames;
    const auto normalized = statistics.normalize(features.rows);
    const auto x = normalized.span();
    std::size_t at = 0;
    for (Index i = 0; i < features.count(); ++i) {
      const Index length = features.offsets.length(i), seen = std::max<Index>(length, 4);
      const auto own = x.subspan(at, static_cast<std::size_t>(length * width));
      values.insert(values.end(), own.begin(), own.end());
      values.resize(values.size() + static_cast<std::size_t>((seen - length) * width));
      frames.push_back(seen);
      at += own.size();
    }
    const ml::Offsets offsets(frames);
    return networks.embed_motions({ml::Tensor<B, 2>::from(values, {offsets.rows(), width}), offsets});
  }

 private:
  static std::filesystem::path file_of(const std::filesystem::path& given) {
    if (!std::filesystem::is_directory(given)) return given;
    for (const char* name : {"finest.tar", "model/finest.tar"}) {
      if (std::filesystem::exists(given / name)) return given / name;
    }
    ml::raise<ml::io_error>(401, "--evaluator ", given.string(), ": no finest.tar and no model/finest.tar");
  }
  static ml::GloVe words_near(const std::filesystem::path& file, const std::filesystem::path& named) {
    ml::RunFolder folder;
    folder.folder = file.parent_path();
    return ml::read_glove(ml::detail::tm2t_words(folder, {.words = named.string()}));
  }

  Evaluator(const EvaluationOptions& o, const std::filesystem::path& file, ml::Normalizer<B> usual)
      : words(words_near(file, o.text_encoder)),
        statistics(o.statistics.empty() ? std::move(usual) : statistics_of(o.statistics, usual.mean.size(0))) {
    statistics.eps = 0;
    const ml::WeightFile weights = ml::open_weights(file, {.path = ""});
    const ml::GuoEvaluatorConfig sizes = ml::guo_evaluator_config(weights);
    if (const Index width = statistics.mean.size(0); sizes.features != width)
      ml::raise<ml::config_error>(102, weights.name(), ": reads features of ", ml::counted(sizes.features, "number"),
                                  ", the motions have ", width);
    if (sizes.word != words.width() || sizes.pos != ml::speech_tags)
      ml::raise<ml::config_error>(102, weights.name(), ": reads word vectors of ", ml::counted(sizes.word, "number"),
                                  " and ", ml::counted(sizes.pos, "part"), " of speech, those found have ",
                                  words.width(), " and ", ml::speech_tags);
    networks = ml::load_guo_evaluator<B>(weights);
  }
};

/// Texts as GloVe::encode reads them, with motions.
struct Drawn {
  std::vector<std::string> texts;
  Embedded text, motion;
};

/// What the loader of Guo et al. hands out: a random text of every entry and a part of its motion, in random batches.
/// The last batch is left out unless it is whole.
class GuoItems {
 public:
  /// Throws config_error 101 unless there are two or more entries of the lengths that the loader takes.
  GuoItems(const std::vector<DescribedMotion>& part, const std::string& name, Index width)
      : entries_(entries_of(part, name)), width_(width) {
    std::vector<Index> lengths;
    for (const Entry& e : entries_) lengths.push_back(e.frames.length);
    const ml::GuoClipLimits limits = ml::guo_clip_limits(width == 251);
    kept_ = ml::guo_kept_clips(lengths, limits);
    if (std::ssize(kept_) < 2)
      ml::raise<ml::config_error>(101, "the part '", name, "' has ", ml::counted(kept_.size(), "motion"), " of ",
                                  limits.least, " to ", ml::counted(limits.below - 1, "frame"),
                                  ", of which two are needed");
    batch = std::min<Index>(32, std::ssize(kept_));
    count = std::ssize(kept_) / batch * batch;
  }

  Index batch = 0, count = 0;

  Drawn draw(const Evaluator& evaluator, ml::NumpyRandom& numpy, ml::PythonRandom& python) const {
    Drawn out;
    const auto order = numpy.permutation(std::ssize(kept_));
    for (Index at = 0; at < count; at += batch) {
      std::vector<float> values;
      std::vector<Index> frames;
      for (Index i = at; i < at + batch; ++i) {
        const Entry& e =
            entries_[static_cast<std::size_t>(kept_[static_cast<std::size_t>(order[static_cast<std::size_t>(i)])])];
        const DescribedText& t = *e.texts[static_cast<std::size_t>(python.randint(0, std::ssize(e.texts) - 1))];
        out.texts.push_back(tagged(t));
        const ml::FrameSlice part = ml::guo_item(e.frames.length, numpy, python);
        const auto rows = rows_of(e, part.first, part.length, width_);
        values.insert(values.end(), rows.begin(), rows.end());
        frames.push_back(part.length);
      }
      const ml::Offsets offsets(frames);
      out.text.add(evaluator.texts(std::span(out.texts).last(static_cast<std::size_t>(batch))));
      out.motion.add(evaluator.motions({ml::Tensor<B, 2>::from(values, {offsets.rows(), width_}), offsets}));
    }
    return out;
  }

 private:
  static std::string tagged(const DescribedText& t) {
    std::string out;
    for (const ml::TaggedWord& w : t.words) out += (out.empty() ? "" : " ") + w.word + "/" + w.tag;
    return out.empty() ? t.text : out;
  }

  std::vector<Entry> entries_;
  Index width_;
  std::vector<Index> kept_;
};

/// Figures of several replications: a row for each kind of motions.
class Figures {
 public:
  void add(const std::string& row, const std::string& column, double value) { values_[row][column].push_back(value); }

  void print() const {
    constexpr std::array columns{"R@1", "R@2", "R@3", "FID", "MM-Dist", "diversity", "multimodality"};
    std::printf("\n  %-24s", "");
    for (const char* column : columns) std::printf(" %-17s", column);
    for (const char* row : {"recorded", "recorded, of other texts", "generated"}) {
      std::printf("\n  %-24s", row);
      for (const char* column : columns) std::printf(" %-17s", text(values_.at(row), column).c_str());
    }
    std::printf("\n");
  }

 private:
  using Row = std::map<std::string, std::vector<double>>;
  static std::string text(const Row& row, const char* column) {
    const auto found = row.find(column);
    if (found == row.end()) return "-";
    const auto r = ml::replication_interval(found->second);
    char out[48];
    std::snprintf(out, sizeof out, "%.3f +-%.3f", r.mean, r.half_width);
    return out;
  }
  std::map<std::string, Row> values_;
};

void evaluate_motions(const EvaluationOptions& o, const ml::RunFolder& found) {
  const auto run = ml::load_tm2t_run<B>(
      found, {.tokenizer = o.tokenizer.string(), .words = found.packed ? std::string() : o.text_encoder.string()});
  const Evaluator evaluator(o, run.model.statistics);
  const auto data = read_data(o, run.width());
  const GuoItems items(data.part(o.part), o.part, data.width);
  const Index batch = items.batch, count = items.count;
  constexpr Index repeats = 30, compared = 10;  // motions of a text, and pairs of them
  const Index varied = std::min<Index>(100, count), pairs = std::min<Index>(300, count - 1);
  std::printf("%s of the %s part in batches of %td, drawn %s; diversity of %s, multimodality of %s\n",
              ml::counted(count, "motion").c_str(), o.part.c_str(), batch, ml::counted(o.seeds, "time").c_str(),
              ml::counted(pairs, "pair").c_str(), ml::counted(varied, "text").c_str());

  Figures figures;
  Index empty = 0, steps = 0;
  ProgressBar bar("generating");
  const auto step = [&] {
    if (!bar(++steps, o.seeds * (1 + repeats))) throw ml::cancelled();
  };
  for (Index s = 0; s < o.seeds; ++s) {
    const auto seed = static_cast<std::uint32_t>(o.seed) + static_cast<std::uint32_t>(s);
    ml::NumpyRandom numpy(seed);
    ml::PythonRandom python(static_cast<std::uint64_t>(seed));
    const Drawn real = items.draw(evaluator, numpy, python), reference = items.draw(evaluator, numpy, python);
    const auto made = [&](std::span<const std::string> texts, const ml::Philox& rng) {
      Embedded out;
      for (Index at = 0; at < std::ssize(texts); at += batch) {
        const auto some = texts.subspan(static_cast<std::size_t>(at),
                                        static_cast<std::size_t>(std::min(batch, std::ssize(texts) - at)));
        const auto motions = run.model.generate(run.words.encode<B>(some), rng.split(static_cast<std::uint64_t>(at)));
        for (Index i = 0; i < motions.count(); ++i) empty += motions.offsets.length(i) == 0 ? 1 : 0;
        out.add(evaluator.motions(motions));
      }
      step();
      return out;
    };
    const auto measure = [&](const char* row, const Embedded& motions, bool own) {
      ml::MatchingMetric matching;
      for (Index at = 0; at < count; at += batch)
        matching.add(real.text.rows().slice(at, batch), motions.rows().slice(at, batch));
      for (int k = 1; k <= 3; ++k) figures.add(row, ml::concat_text("R@", k), matching.r_precision(k));
      figures.add(row, "MM-Dist", matching.matching_score());
      if (!own) return;
      figures.add(row, "FID", ml::frechet_distance(reference.motion.rows(), motions.rows()));
      figures.add(row, "diversity", ml::mean_pair_distance(motions.rows(), ml::disjoint_draws(count, pairs, numpy)));
    };
    const auto noise = ml::Philox{.seed = o.seed}.split("replications").split(static_cast<std::uint64_t>(s));
    measure("recorded", real.motion, true);
    Embedded others = real.motion;
    std::rotate(others.values.begin(), others.values.begin() + others.width, others.values.end());
    measure("recorded, of other texts", others, false);
    measure("generated", made(real.texts, noise.split("one")), true);

    std::vector<Embedded> of_repeat;
    for (Index k = 0; k < repeats; ++k)
      of_repeat.push_back(made(std::span(real.texts).first(static_cast<std::size_t>(varied)),
                               noise.split("several").split(static_cast<std::uint64_t>(k))));
    std::vector<float> by_text;
    for (Index i = 0; i < varied; ++i) {
      for (const Embedded& e : of_repeat) {
        const auto row = e.rows()[i];
        by_text.insert(by_text.end(), row.begin(), row.end());
      }
    }
    figures.add("generated", "multimodality",
                ml::multimodality(ml::Rows(std::span<const float>(by_text), of_repeat.front().width), repeats,
                                  ml::disjoint_draws(repeats, compared, numpy)));
  }
  bar.finish();
  figures.print();
  if (empty > 0)
    std::printf("%s no frames and counted as four of the mean pose\n",
                ml::counted(empty, "motion had", "motions had").c_str());
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
