// SPDX-License-Identifier: MIT
/// Evaluates motions of texts with the networks of Guo et al.: R-precision, distance from the texts, FID, diversity and
/// multimodality over several replications.
///
///     const GuoJudge<B> judge({.evaluator = "text_mot_match"}, run.model.statistics);
///     const GuoItems<B> items(data.test, "test", data.width);
///     const GuoFigures figures = guo_figures(tm2t_maker(run.model, run.words), judge, items, {.replications = 20});
///     figures.values.at("generated").at("FID");               // of each replication
///
/// generate/guo_motions.hpp makes the motions of every other model of texts.
///
/// Source   HumanML3D (Guo et al., CVPR 2022), section 5.2; TM2T (Guo et al., ECCV 2022), appendix C; text-to-motion
///          final_evaluations.py
#pragma once

#include <algorithm>   // rotate
#include <chrono>      // seconds of generation
#include <cstdint>     // seeds
#include <filesystem>  // files
#include <functional>  // makers
#include <map>         // figures
#include <optional>    // statistics
#include <span>        // texts
#include <string>      // texts
#include <utility>     // move
#include <vector>      // vectors

#include <motionlang/core/numpy_random.hpp>
#include <motionlang/core/progress.hpp>
#include <motionlang/core/python_random.hpp>
#include <motionlang/datasets/guo_clip.hpp>
#include <motionlang/metrics/diversity.hpp>
#include <motionlang/metrics/frechet.hpp>
#include <motionlang/metrics/guo_evaluator.hpp>
#include <motionlang/metrics/matching.hpp>
#include <motionlang/systems/tm2t.hpp>
#include <motionlang/train/feature_statistics.hpp>
#include <motionlang/train/guo_matching_training.hpp>
#include <motionlang/train/guo_model_folder.hpp>
#include <motionlang/train/shared_items.hpp>
#include <motionlang/train/text_entries.hpp>
#include <motionlang/weights/glove_file.hpp>
#include <motionlang/weights/guo_evaluator_file.hpp>
#include <motionlang/weights/tm2t_run.hpp>
#include <motionlang/weights/weight_file.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// "": word vectors in a folder above the networks, and the statistics beside them, else those of the model's motions.
struct GuoJudgeFiles {
  std::filesystem::path evaluator{};  // finest.tar, or its folder
  std::filesystem::path words{}, statistics{};
};

/// Vectors of texts or of motions in order.
template <Backend B>
struct Embedded {
  std::vector<typename B::scalar> values;
  Index width = 0;

  void add(const Tensor<B, 2>& more) {
    values.insert(values.end(), more.span().begin(), more.span().end());
    width = more.size(1);
  }
  Rows<typename B::scalar> rows() const { return {values, width}; }
};

/// The networks of Guo et al. with their data: `finest.tar` of text_mot_match, word vectors in a folder above it or in
/// GuoJudgeFiles, and statistics of the features.
template <Backend B>
struct GuoJudge {
  GuoEvaluator<B> networks;
  GloVe words;
  Normalizer<B> statistics;
  std::string fingerprint;  // of the file of the networks

  Index width() const { return statistics.mean.size(0); }

  /// usual   statistics of TM2T's motions, which the published program uses if the evaluator has none beside it
  /// Throws  io_error 401 for what is missing, 406, 407 for other networks; config_error 102 for other features, words
  explicit GuoJudge(const GuoJudgeFiles& files, const std::optional<Normalizer<B>>& usual = {})
      : GuoJudge(files, guo_evaluator_path(files.evaluator), usual) {}

  Tensor<B, 2> texts(std::span<const std::string> of) const { return networks.embed_texts(words.encode<B>(of).tokens); }
  /// Motions without a movement count as one movement of the mean pose. Frames after the 196th are cut.
  Tensor<B, 2> motions(const Sequences<B>& features) const {
    const Index width = statistics.mean.size(0);
    std::vector<typename B::scalar> values;
    std::vector<Index> frames;
    const auto normalized = statistics.normalize(features.rows);
    const auto x = normalized.span();
    std::size_t at = 0;
    for (Index i = 0; i < features.count(); ++i) {
      const Index all = features.offsets.length(i), length = std::min<Index>(all, 196),
                  seen = std::max<Index>(length, 4);
      const auto own = x.subspan(at, static_cast<std::size_t>(length * width));
      values.insert(values.end(), own.begin(), own.end());
      values.resize(values.size() + static_cast<std::size_t>((seen - length) * width));
      frames.push_back(seen);
      at += static_cast<std::size_t>(all * width);
    }
    const Offsets offsets(frames);
    return networks.embed_motions({Tensor<B, 2>::from(values, {offsets.rows(), width}), offsets});
  }

 private:
  static GloVe words_near(const std::filesystem::path& file, const std::filesystem::path& named) {
    RunFolder folder;
    folder.folder = file.parent_path();
    return read_glove(detail::tm2t_words(folder, {.words = named.string()}));
  }

  static Normalizer<B> statistics_for(const GuoJudgeFiles& files, const std::filesystem::path& file, Index width,
                                      const std::optional<Normalizer<B>>& usual) {
    if (!files.statistics.empty()) return statistics_of<B>(files.statistics, width);
    if (auto beside = guo_statistics_near<B>(file, width)) return *std::move(beside);
    if (usual) return *usual;
    raise<io_error>(401, file.string(), ": no meta/mean.npy and meta/std.npy beside it: `statistics` names a folder");
  }

  GuoJudge(const GuoJudgeFiles& files, const std::filesystem::path& file, const std::optional<Normalizer<B>>& usual)
      : words(words_near(file, files.words)), fingerprint(guo_fingerprint(file)) {
    const WeightFile weights = open_weights(file, {.path = ""});
    const GuoEvaluatorConfig sizes = guo_evaluator_config(weights);
    statistics = statistics_for(files, file, usual ? usual->mean.size(0) : sizes.features, usual);
    statistics.eps = 0;
    if (const Index width = statistics.mean.size(0); sizes.features != width)
      raise<config_error>(102, weights.name(), ": reads features of ", counted(sizes.features, "number"),
                          ", the motions have ", width);
    if (sizes.word != words.width() || sizes.pos != speech_tags)
      raise<config_error>(102, weights.name(), ": reads word vectors of ", counted(sizes.word, "number"), " and ",
                          counted(sizes.pos, "part"), " of speech, those found have ", words.width(), " and ",
                          speech_tags);
    networks = load_guo_evaluator<B>(weights);
  }
};

/// A motion that a model should make.
struct GuoWanted {
  std::string text, caption;                // as GloVe::encode reads it, and in plain words
  Index frames = 0;                         // of the recorded motion
  const DescribedMotion* motion = nullptr;  // the recorded motion
};
/// Makes a motion for each: features of the evaluator, not normalised.
template <Backend B>
using GuoMaker = std::function<Sequences<B>(std::span<const GuoWanted> wanted, const Philox& rng)>;

/// Motions of TM2T, which decides their lengths. Both must outlive the maker.
template <Backend B>
GuoMaker<B> tm2t_maker(const Tm2t<B>& model, const GloVe& words) {
  return [&](std::span<const GuoWanted> wanted, const Philox& rng) {
    std::vector<std::string> texts;
    for (const GuoWanted& w : wanted) texts.push_back(w.text);
    return model.generate(words.encode<B>(std::span<const std::string>(texts)), rng);
  };
}

/// Texts and motions of the loader, embedded.
template <Backend B>
struct DrawnItems {
  std::vector<GuoWanted> wanted;
  Embedded<B> text, motion;
};

/// The items that the loader of Guo et al. gives: a random text of every entry and a part of its motion, in random
/// batches. An incomplete last batch is left out.
template <Backend B>
class GuoItems {
 public:
  /// Throws config_error 101 unless there are two or more entries with lengths that the loader accepts.
  GuoItems(const std::vector<DescribedMotion>& part, const std::string& name, Index width)
      : entries_(text_entries(part, name)), width_(width) {
    std::vector<Index> lengths;
    for (const TextEntry& e : entries_) lengths.push_back(e.frames.length);
    const GuoClipLimits limits = guo_clip_limits(width == 251);
    kept_ = guo_kept_clips(lengths, limits);
    if (std::ssize(kept_) < 2)
      raise<config_error>(101, "the part '", name, "' has ", counted(kept_.size(), "motion"), " of ", limits.least,
                          " to ", counted(limits.below - 1, "frame"), ", of which two are needed");
    batch = std::min<Index>(32, std::ssize(kept_));
    count = std::ssize(kept_) / batch * batch;
  }

  Index batch = 0, count = 0;
  /// The number of texts for multimodality, and of pairs of motions for diversity.
  Index varied() const { return std::min<Index>(100, count); }
  Index pairs() const { return std::min<Index>(300, count - 1); }

  DrawnItems<B> draw(const GuoJudge<B>& judge, NumpyRandom& numpy, PythonRandom& python) const {
    DrawnItems<B> out;
    const auto order = numpy.permutation(std::ssize(kept_));
    for (Index at = 0; at < count; at += batch) {
      std::vector<typename B::scalar> values;
      std::vector<Index> frames;
      std::vector<std::string> texts;
      for (Index i = at; i < at + batch; ++i) {
        const TextEntry& e =
            entries_[static_cast<std::size_t>(kept_[static_cast<std::size_t>(order[static_cast<std::size_t>(i)])])];
        const DescribedText& t = *e.texts[static_cast<std::size_t>(python.randint(0, std::ssize(e.texts) - 1))];
        const FrameSlice part = guo_item(e.frames.length, numpy, python);
        out.wanted.push_back({tagged_text(t), t.text, part.length, e.motion});
        texts.push_back(out.wanted.back().text);
        const auto rows = entry_rows(e, part.first, part.length, width_);
        values.insert(values.end(), rows.begin(), rows.end());
        frames.push_back(part.length);
      }
      const Offsets offsets(frames);
      out.text.add(judge.texts(texts));
      out.motion.add(judge.motions({Tensor<B, 2>::from(values, {offsets.rows(), width_}), offsets}));
    }
    return out;
  }

 private:
  std::vector<TextEntry> entries_;
  Index width_;
  std::vector<Index> kept_;
};

/// The seconds of clock that `make` takes for this many motions, of the items' texts in turn, a batch at a time.
/// Throws   config_error 101 for less than one motion
/// Source   TM2T, section 4.4, "Inference Time Analysis", with 300 motions
template <Backend B>
double guo_seconds(const GuoMaker<B>& make, const GuoJudge<B>& judge, const GuoItems<B>& items, Index motions,
                   std::uint64_t seed) {
  if (motions < 1) raise<config_error>(101, "guo_seconds: ", motions, " motions, expected 1 or more");
  NumpyRandom numpy(static_cast<std::uint32_t>(seed));
  PythonRandom python(seed);
  const auto wanted = items.draw(judge, numpy, python).wanted;
  std::vector<GuoWanted> batch;
  const auto begin = std::chrono::steady_clock::now();
  for (Index i = 0; i < motions; ++i) {
    batch.push_back(wanted[static_cast<std::size_t>(i % std::ssize(wanted))]);
    if (std::ssize(batch) < items.batch && i + 1 < motions) continue;
    make(batch, Philox{.seed = seed}.split(static_cast<std::uint64_t>(i)));
    batch.clear();
  }
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

struct GuoFigures {
  using Row = std::map<std::string, std::vector<double>>;  // by column, of each replication
  std::map<std::string, Row> values{};                     // "recorded", "recorded, of other texts", "generated"
  Index empty = 0;  // motions without frames, which count as four of the mean pose
};
struct GuoFigureOptions {
  Index replications = 20;
  Index repeats = 30;  // motions of a text for measuring multimodality; 0: it is not measured
  std::uint64_t seed = 0;
  /// The processes that share the replications; all get the figures of all. A maker must not share its own motions
  /// then: the processes are not in the same replication.
  AnyCommunicator communicator{};
};

namespace detail {

inline constexpr Index compared_repeats = 10;  // pairs of motions of a text
/// Throws what guo_figures throws.
void require_guo_figure_options(const GuoFigureOptions& options);

}  // namespace detail

/// Columns: R@1, R@2, R@3, MM-Dist, FID, diversity, multimodality. Throws config_error 101 for 1 to 10 repeats, because
/// ten pairs of them are compared, and without a replication.
template <Backend B>
GuoFigures guo_figures(const GuoMaker<B>& make, const GuoJudge<B>& judge, const GuoItems<B>& items,
                       const GuoFigureOptions& options, Progress progress = {}) {
  detail::require_guo_figure_options(options);
  const Index repeats = options.repeats;
  const Index batch = items.batch, count = items.count, varied = items.varied(), pairs = items.pairs();
  constexpr char between = '\n';  // a row and a column
  const auto replication = [&](Index s, const Progress& of_replication) {
    std::map<std::string, double> figures;
    double& empty = figures["empty"];
    Index steps = 0;
    const auto add = [&](const std::string& row, const std::string& column, double value) {
      figures[row + between + column] = value;
    };
    const auto step = [&] { of_replication(++steps, 1 + repeats); };
    const auto seed = static_cast<std::uint32_t>(options.seed) + static_cast<std::uint32_t>(s);
    NumpyRandom numpy(seed);
    PythonRandom python(static_cast<std::uint64_t>(seed));
    const DrawnItems<B> real = items.draw(judge, numpy, python), reference = items.draw(judge, numpy, python);
    const auto made = [&](std::span<const GuoWanted> wanted, const Philox& rng) {
      Embedded<B> out;
      for (Index at = 0; at < std::ssize(wanted); at += batch) {
        const auto some = wanted.subspan(static_cast<std::size_t>(at),
                                         static_cast<std::size_t>(std::min(batch, std::ssize(wanted) - at)));
        const auto motions = make(some, rng.split(static_cast<std::uint64_t>(at)));
        for (Index i = 0; i < motions.count(); ++i) empty += motions.offsets.length(i) == 0 ? 1 : 0;
        out.add(judge.motions(motions));
      }
      step();
      return out;
    };
    const auto measure = [&](const char* row, const Embedded<B>& motions, bool own) {
      MatchingMetric matching;
      for (Index at = 0; at < count; at += batch)
        matching.add(real.text.rows().slice(at, batch), motions.rows().slice(at, batch));
      for (int k = 1; k <= 3; ++k) add(row, concat_text("R@", k), matching.r_precision(k));
      add(row, "MM-Dist", matching.matching_score());
      if (!own) return;
      add(row, "FID", frechet_distance(reference.motion.rows(), motions.rows()));
      add(row, "diversity", mean_pair_distance(motions.rows(), disjoint_draws(count, pairs, numpy)));
    };
    const auto noise = Philox{.seed = options.seed}.split("replications").split(static_cast<std::uint64_t>(s));
    measure("recorded", real.motion, true);
    Embedded<B> others = real.motion;
    std::rotate(others.values.begin(), others.values.begin() + others.width, others.values.end());
    measure("recorded, of other texts", others, false);
    measure("generated", made(real.wanted, noise.split("one")), true);

    if (repeats == 0) return named_numbers(figures);
    std::vector<Embedded<B>> of_repeat;
    for (Index k = 0; k < repeats; ++k)
      of_repeat.push_back(made(std::span<const GuoWanted>(real.wanted).first(static_cast<std::size_t>(varied)),
                               noise.split("several").split(static_cast<std::uint64_t>(k))));
    std::vector<typename B::scalar> by_text;
    for (Index i = 0; i < varied; ++i) {
      for (const Embedded<B>& e : of_repeat) {
        const auto row = e.rows()[i];
        by_text.insert(by_text.end(), row.begin(), row.end());
      }
    }
    add("generated", "multimodality",
        multimodality(Rows(std::span<const typename B::scalar>(by_text), of_repeat.front().width), repeats,
                      disjoint_draws(repeats, detail::compared_repeats, numpy)));
    return named_numbers(figures);
  };
  std::map<std::string, std::vector<double>> lists;
  for (const std::string& message : shared_items(options.communicator, options.replications, replication, progress))
    add_named_numbers(lists, message);
  GuoFigures figures;
  for (const auto& [name, list] : lists) {
    if (const std::size_t end = name.find(between); end != name.npos)
      figures.values[name.substr(0, end)][name.substr(end + 1)] = list;
    else
      for (const double motions : list) figures.empty += static_cast<Index>(motions);
  }
  return figures;
}

/// A row for each kind of motions and a column for each measure, below a header: the mean of the replications with its
/// interval (metrics/summary.hpp). "-" stands for what is not measured.
std::string guo_table(const GuoFigures& figures);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/train/guo_evaluation.ipp>
#endif
