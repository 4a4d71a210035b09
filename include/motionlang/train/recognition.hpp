// SPDX-License-Identifier: MIT
/// Evaluates ACTOR: a classifier of actions judges generated motions beside recorded ones, with several seeds.
///
///     const ActorModel<B> model("run/model");
///     ActionJudge<B> judge("classifier/model");
///     judge.numbers = numbers_of(model.file.labels, judge.file.labels);
///     const auto results = recognition_results(model, judge, data.test, {.seeds = 20});
///     results.at("accuracy_gen");                            // of each seed
///
/// Source   ACTOR (Petrovich, Black, Varol, ICCV 2021), tables of its evaluation; thesis 3.3.1 and 3.3.4, table 3.8
#pragma once

#include <algorithm>    // min
#include <cstdint>      // seeds
#include <filesystem>   // files
#include <map>          // results
#include <memory>       // points of a body
#include <span>         // classes
#include <string>       // labels
#include <string_view>  // names of measures
#include <utility>      // names
#include <vector>       // features

#include <motionlang/core/numpy_random.hpp>
#include <motionlang/core/progress.hpp>
#include <motionlang/metrics/accuracy.hpp>
#include <motionlang/metrics/diversity.hpp>
#include <motionlang/metrics/frechet.hpp>
#include <motionlang/train/action_batch.hpp>
#include <motionlang/train/body_points.hpp>
#include <motionlang/train/shared_items.hpp>
#include <motionlang/weights/classifier_model.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The answers of the classifier to a set of motions.
struct JudgedMotions {
  std::vector<float> features;
  Index width = 0;
  double accuracy = 0;
  Rows<float> rows() const { return {features, width}; }
};

/// A classifier with the clips that it reads.
template <Backend B>
struct ActionJudge {
  ActionModelFile<ClassifierConfig> file;
  Classifier<B> classifier;
  std::vector<Index> numbers{};  // of the classes of the motions in the classifier

  /// A classifier of train-classifier.
  explicit ActionJudge(const std::filesystem::path& folder)
      : file(read_action_config<ClassifierConfig>(folder, "classifier")) {
    const auto weights = open_action_weights(folder);
    const auto room = detail::room_of(weights);
    classifier = Classifier<B>(file.config, std::ssize(file.labels), Philox{});
    load_action_weights(classifier, weights);
  }
  /// The file of a published one: ST-GCN, or a GRU that reads the 24 joints of SMPL with the path of the root, or the
  /// 18 points of NTU-13 without it. It sees motions at the rate and with the heading of the model, in the world of a
  /// camera.
  /// body, regressor  of the user (body_points.hpp); without them a GRU gets the joints of our own skeleton
  /// Throws  io_error 404 for another file, 407 for other joints, config_error 102 for a body that is missing or not
  ///         needed
  ActionJudge(const std::filesystem::path& path, const ActorClipsConfig& clips, const std::filesystem::path& body,
              const std::filesystem::path& regressor) {
    const WeightFile weights = open_weights(path);
    Index classes = 0, read = 0, wanted = 0;  // values per frame
    if (const TensorView* const gates = weights.find("recurrent.weight_ih_l0")) {
      classifier.gru = load_gru_classifier<B>(weights);
      classifier.drawn_state = true;
      classes = classifier.gru->linear2.out(), read = gates->shape[1], wanted = 24 * 3;
      if (read == 18 * 3) {
        if (body.empty())
          raise<config_error>(102, path.string(),
                              " reads 18 points of a body: `body` SMPL, `regressor` J_regressor_extra.npy");
        wanted = 18 * 3;
      }
      if (!body.empty()) read_body_points(wanted == 18 * 3 ? "a2m" : "smpl", body, regressor);
    } else if (const TensorView* const norm = weights.find("data_bn.weight")) {
      classifier.stgcn = load_stgcn<B>(weights);
      classes = classifier.stgcn->fcn.out(), read = norm->shape[0], wanted = 24 * 6;
    } else {
      raise<io_error>(404, path.string(), ": neither the GRU of Action2Motion nor ST-GCN");
    }
    if (read != wanted)
      raise<io_error>(407, path.string(), ": a classifier of ", counted(read, "number"), " a frame, expected ", wanted,
                      ": SMPL's 24 joints");
    if (!classifier.points && !(body.empty() && regressor.empty()))
      raise<config_error>(102, path.string(), " has no use for `body` '", body.string(), "', `regressor` '",
                          regressor.string(), "'");
    prepare(classifier);
    file.config.clips = clips;
    file.config.clips.pose = "rot6d", file.config.clips.camera = true;
    file.config.clips.translation = classifier.gru.has_value();
    file.labels = class_names("humanact12", classes);
  }

 private:
  /// One motion at a time, because a surface is large.
  void read_body_points(const char* name, const std::filesystem::path& body, const std::filesystem::path& regressor) {
    const auto points = std::make_shared<const BodyPoints<B>>(name, body, regressor);
    const bool translate = points->points == ActorPoints::smpl;
    classifier.points = [points, translate](const Sequences<B>& x, const ActorClipsConfig& clips) {
      std::vector<typename B::scalar> values;
      for (Index s = 0; s < x.count(); ++s) {
        const auto one = (*points)({x[s], Offsets{x.offsets.length(s)}}, clips, translate).rows;
        values.insert(values.end(), one.span().begin(), one.span().end());
      }
      const Index frames = x.offsets.rows();
      return x.with(Tensor<B, 2>::from(values, {frames, std::ssize(values) / std::max<Index>(1, frames)}));
    };
  }
};

/// Classifies motions in batches: batch(numbers) returns them with their classes.
template <Backend B, class Batch>
JudgedMotions judge_motions(const ActionJudge<B>& who, Index motions, const Philox& rng, Batch batch) {
  JudgedMotions out;
  constexpr Index at_once = 64;
  double right = 0;
  for (Index at = 0; at < motions; at += at_once) {
    std::vector<Index> which;
    for (Index i = at; i < std::min(at + at_once, motions); ++i) which.push_back(i);
    ActionBatch<B> b = batch(which);
    for (Index& y : b.classes) y = who.numbers[static_cast<std::size_t>(y)];
    const auto said = who.classifier(b.x, who.file.config.clips, rng.split(static_cast<std::uint64_t>(at)));
    const auto confusion =
        confusion_matrix(Rows(said.logits.span(), said.logits.size(1)), std::span<const Index>(b.classes));
    right += accuracy(confusion) * static_cast<double>(which.size());
    out.features.insert(out.features.end(), said.features.span().begin(), said.features.span().end());
    out.width = said.features.size(1);
  }
  out.accuracy = right / static_cast<double>(motions);
  return out;
}

/// Numbers the classes that have motions, and so pairs. Also returns how many there are.
std::pair<std::vector<Index>, Index> present_classes(std::span<const Index> classes, Index kinds);

struct RecognitionOptions {
  Index seeds = 20;
  std::uint64_t seed = 0;                              // the first seed
  const std::vector<DescribedMotion>* made = nullptr;  // by another program, with labels of the model (MadeMotions)
  AnyCommunicator communicator{};                      // processes that share the seeds; all get the results of all
};
/// accuracy_X, diversity_X, multimodality_X and fid_X of every seed. X: gt, recorded motions; gt2, other windows of
/// these (their FID is against gt); gen, generated; denoised; between, between two motions of an action; made: others.
/// part     motions with one label each. Throws config_error 103 for a label that is not a class of the model.
template <Backend B>
std::map<std::string, std::vector<double>> recognition_results(const ActorModel<B>& model, const ActionJudge<B>& who,
                                                               const std::vector<DescribedMotion>& part,
                                                               const RecognitionOptions& options,
                                                               Progress progress = {}) {
  const ActorClipsConfig &clips = model.file.config.clips, &seen = who.file.config.clips;
  const std::vector<Index> classes = classes_of(part, model.file.labels);
  const auto present = present_classes(classes, std::ssize(model.file.labels));
  const RecognitionSets<B> motions{model, part, classes, clips, seen};
  std::vector<Index> made_classes;
  if (options.made != nullptr) made_classes = classes_of(*options.made, model.file.labels);
  const auto made_present = present_classes(made_classes, std::ssize(model.file.labels));
  const auto of_seed = [&](Index s, const Progress&) {
    std::map<std::string, double> results;
    const auto seed = Philox{.seed = options.seed + static_cast<std::uint64_t>(s)};
    const auto first = seed.split("gt"), second = seed.split("gt2");
    const auto of_batch = [&](const char* name, std::span<const Index> which) {
      return seed.split(name).split(static_cast<std::uint64_t>(which.front()));
    };
    const auto judged = [&](const char* name, auto batch) {
      return std::pair(std::string(name), judge_motions(who, std::ssize(part), seed.split("judge").split(name), batch));
    };
    std::map<std::string, JudgedMotions> sets{
        judged("gt", [&](auto which) { return motions.recorded(which, first); }),
        judged("gt2", [&](auto which) { return motions.recorded(which, second); }),
        judged("gen",
               [&](auto which) {
                 return motions.sampled(which, first, of_batch("noise", which));  // with the lengths of "gt"
               }),
        judged("denoised", [&](auto which) { return motions.denoised(which, first); })};
    if (!model.actor.frames)  // a line between two motions needs one latent for each
      sets.insert(judged("between", [&](auto which) {
        return motions.interpolated(which, first, seed.split("others"), of_batch("between", which));
      }));
    if (options.made != nullptr) {
      const RecognitionSets<B> others{model, *options.made, made_classes, clips, seen};
      sets.emplace("made", judge_motions(who, std::ssize(*options.made), seed.split("judge").split("made"),
                                         [&](auto which) { return others.recorded(which, first); }));
    }
    for (const auto& [name, set] : sets) {
      const auto& kinds = name == "made" ? made_present : present;
      NumpyRandom random(static_cast<std::uint32_t>(options.seed) + static_cast<std::uint32_t>(s));
      results["accuracy_" + name] = set.accuracy;
      results["diversity_" + name] = mean_pair_distance(set.rows(), random_pairs(set.rows().size(), 200, random));
      results["multimodality_" + name] =
          mean_pair_distance(set.rows(), pairs_within_classes(kinds.first, kinds.second, 20, random));
      if (name != "gt") results["fid_" + name] = frechet_distance(sets.at("gt").rows(), set.rows());
    }
    return named_numbers(results);
  };
  std::map<std::string, std::vector<double>> results;
  for (const std::string& message : shared_items(options.communicator, options.seeds, of_seed, progress))
    add_named_numbers(results, message);
  return results;
}

/// Motions of one length, judged with every seed.
struct DurationResult {
  Index frames = 0;
  std::vector<double> accuracy{}, fid{};  // of the seeds; FID against recorded motions of the model's own length
};
/// Motions of other lengths than those of the training: one for each motion of the part, with its action.
/// durations  frames
/// Source     ACTOR (Petrovich, Black, Varol, ICCV 2021), section 4.3; thesis figure 3.4
/// Throws     config_error 103 for a label that is not a class of the model; 101 for a length that it cannot make
template <Backend B>
std::vector<DurationResult> duration_results(const ActorModel<B>& model, const ActionJudge<B>& who,
                                             const std::vector<DescribedMotion>& part, std::span<const Index> durations,
                                             const RecognitionOptions& options, Progress progress = {}) {
  const ActorClipsConfig &clips = model.file.config.clips, &seen = who.file.config.clips;
  const std::vector<Index> classes = classes_of(part, model.file.labels);
  const RecognitionSets<B> motions{model, part, classes, clips, seen};
  std::vector<DurationResult> out;
  for (const Index frames : durations) out.push_back({.frames = frames});
  const auto of_seed = [&](Index s, const Progress&) {
    std::vector<double> results;
    const auto seed = Philox{.seed = options.seed + static_cast<std::uint64_t>(s)};
    const auto judged = [&](const Philox& rng, auto batch) { return judge_motions(who, std::ssize(part), rng, batch); };
    const auto recorded =
        judged(seed.split("judge").split("gt"), [&](auto which) { return motions.recorded(which, seed.split("gt")); });
    for (const DurationResult& of : out) {
      const auto own = static_cast<std::uint64_t>(of.frames);
      const auto made = judged(seed.split("judge").split(own), [&](std::span<const Index> which) {
        ActionBatch<B> batch;
        for (const Index i : which) batch.classes.push_back(classes[static_cast<std::size_t>(i)]);
        auto noise = seed.split("durations").split(own).split(static_cast<std::uint64_t>(which.front()));
        const std::vector<Index> lengths(which.size(), of.frames);
        batch.x = model.seen_by(generate(model.actor, batch.classes, lengths, noise), seen);
        return batch;
      });
      results.insert(results.end(), {made.accuracy, frechet_distance(recorded.rows(), made.rows())});
    }
    MessageWriter message;
    message.list(std::span<const double>(results));
    return message.bytes();
  };
  for (const std::string& message : shared_items(options.communicator, options.seeds, of_seed, progress)) {
    const auto results = MessageReader(message).template list<double>();
    for (std::size_t k = 0; k < out.size(); ++k)
      out[k].accuracy.push_back(results[2 * k]), out[k].fid.push_back(results[2 * k + 1]);
  }
  return out;
}
/// Means over the seeds as two panels of curves, which parse_curves (view/loss_curves.hpp) reads.
std::string duration_table(std::span<const DurationResult> results);

/// The accuracy of a classifier on recorded motions with labels of its own, for every seed: other windows of them.
/// communicator  processes that share the seeds; all get the accuracies of all
template <Backend B>
std::vector<double> recorded_accuracies(ActionJudge<B> who, const std::vector<DescribedMotion>& part, Index seeds,
                                        std::uint64_t first_seed, const AnyCommunicator& communicator = {}) {
  const std::vector<Index> classes = classes_of(part, who.file.labels);
  who.numbers = numbers_of(who.file.labels, who.file.labels);
  const auto of_seed = [&](Index s, const Progress&) {
    const auto seed = Philox{.seed = first_seed + static_cast<std::uint64_t>(s)};
    const auto judged = judge_motions(who, std::ssize(part), seed.split("judge"), [&](std::span<const Index> which) {
      return action_batch<B>(part, classes, which, who.file.config.clips, seed.split("gt"));
    });
    MessageWriter out;
    out.value(judged.accuracy);
    return out.bytes();
  };
  std::vector<double> out;
  for (const std::string& message : shared_items(communicator, seeds, of_seed))
    out.push_back(MessageReader(message).value<double>());
  return out;
}

/// One generated motion of each of the first `count` actions, with the label as its name.
template <Backend B>
std::vector<Motion> action_examples(const ActorModel<B>& model, Index count, std::uint64_t seed) {
  const ActorClipsConfig& clips = model.file.config.clips;
  std::vector<Motion> out;
  for (Index k = 0; k < std::min(std::ssize(model.file.labels), count); ++k) {
    auto noise = Philox{.seed = seed}.split("strips").split(static_cast<std::uint64_t>(k));
    const std::vector<Index> action{k}, length{clips.num_frames > 0 ? clips.num_frames : clips.min_len};
    out.push_back(actor_motion(generate(model.actor, action, length, noise).rows.to_vector(), clips));
    out.back().name = model.file.labels[static_cast<std::size_t>(k)];
  }
  return out;
}

/// A figure of all seeds as ACTOR's tables have it: "92.30 +-0.05". The name is one of recognition_results.
std::string recognition_cell(std::string_view name, std::span<const double> of_seeds);
/// A row for each kind of motions and a column for each measure, below a header. "-" stands for what is not measured.
std::string recognition_table(const std::map<std::string, std::vector<double>>& results);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/train/recognition.ipp>
#endif
