// SPDX-License-Identifier: MIT
/// ACTOR and TEMOS from the folders in which their repositories leave them.
///
///     const auto actor = load_actor_run<B>("exps/humanact12");                  // opt.yaml, checkpoint_5000.pth.tar
///     const auto temos = load_temos_run<B>("kit-amass-xyz/5xp9647f", {.text_encoder = "distilbert-base-uncased",
///                                                                     .statistics = "deps/.../kit-amass-xyz"});
///
/// Sizes    from the shapes of the tensors; options that state them have to agree. Heads and representation from the options
/// ACTOR    all networks of its repository (io/actor_file.hpp)
/// TEMOS    with DistilBERT inside of the checkpoint; tokenizer and statistics are in no run folder
/// Source   spec actor.md 3, 8; temos.md 3, 4.4
/// Throws   io_error 401 for a file that is missing, naming it; 404 for variants that are not supported; 406, 407 for tensors;
///          config_error 101, 102 where options and tensors differ, 103, 107
#pragma once

#include <motionlang/io/actor_file.hpp>
#include <motionlang/io/text_encoder_folder.hpp>
#include <motionlang/io/text_motion_file.hpp>

namespace motionlang::inline MOTIONLANG_ABI {

/// HumanAct12's classes, in the order of their numbers; spec actor.md 8.1.
inline constexpr std::string_view humanact12_actions[] = {"warm_up", "walk", "run", "jump", "drink", "lift_dumbbell", "sit",
                                                          "eat", "turn steering wheel", "phone", "boxing", "throw"};

template <Backend B>
struct ActorRun {
  Actor<B> model;
  ActorFeatureOptions features{};
  bool camera = true;               // the figure stands on its head: Y down, as cameras have it
  std::vector<std::string> labels;  // of the classes; empty if they are numbers
};

template <Backend B>
struct TemosRun {
  Temos<B> model;
  Normalizer<B> normalizer;
  AnyTextEncoder<B> text_encoder;
  double fps = 12.5;

  Index width() const { return normalizer.mean.count(); }
};

struct TemosRunOptions {
  FilePath text_encoder = "";  // folder of distilbert-base-uncased, or one with its tokenizer; looked for beside the model unless given
  FilePath statistics = "";    // folder with jfeats_mean.pt and jfeats_std.pt (rfeats_ of SMPL models)
};

namespace detail {

inline void require_checkpoint(const RunFolder& run, const char* system, const char* wanted) {
  if (run.system != system)
    raise<io_error>(404, run.folder.string(), ": ", run.system.empty() ? "of no system that is known" : "of " + run.system,
                    ", expected ", system);
  if (run.weights.empty()) raise<io_error>(401, run.folder.string(), ": no ", wanted);
}

/// DistilBERT of the checkpoint with a tokenizer from elsewhere, or the whole encoder from elsewhere.
template <Backend B>
AnyTextEncoder<B> temos_text_encoder(const RunFolder& run, const TensorSet& weights, const TemosRunOptions& options) {
  const bool inside = weights.find("textencoder.text_model.embeddings.word_embeddings.weight") != nullptr;
  std::filesystem::path folder = options.text_encoder.string();
  for (const auto& near : {run.folder, run.folder.parent_path()}) {
    for (const char* name : {"", "text_encoder", "distilbert-base-uncased"}) {
      const bool found = file_exists(near / name / "tokenizer.json") || file_exists(near / name / "vocab.txt");
      if (folder.empty() && found) folder = near / name;
    }
  }
  if (folder.empty())
    raise<io_error>(401, run.folder.string(), ": no tokenizer of DistilBERT: put vocab.txt or tokenizer.json of "
                    "distilbert-base-uncased there, or name its folder");
  if (!inside) return load_text_encoder<B>(folder);
  AnyTokenizer tokenizer = tokenizer_of(folder, {}, false);
  AnyTextNetwork<B> network{load_text_network<DistilBert<B>>(distilbert_config(weights), weights)};
  check_vocabulary(tokenizer, network, folder.string());
  return {std::move(tokenizer), std::move(network), {}};
}

}  // namespace detail

template <Backend B>
ActorRun<B> load_actor_run(const RunFolder& run) {
  detail::require_checkpoint(run, "actor", "checkpoint_0000.pth.tar");
  const WeightFile weights = open_weights(run.weights);
  const detail::RunReader r(run, weights, "");
  ActorRun<B> out;
  out.model = load_actor<B>(weights, run);
  out.features = actor_point_options(run, weights).features;
  const Index joints = 23 + (out.features.global ? 1 : 0) + (out.features.translation ? 1 : 0);
  if (out.model.config.njoints != joints)
    raise<config_error>(102, run.options_file.string(), ": glob and translation make ", joints, " rows a frame, ",
                        weights.name(), " has ", out.model.config.njoints);
  if (r.text("dataset", "") == "humanact12" && out.model.config.num_classes == std::ssize(humanact12_actions))
    out.labels.assign(std::begin(humanact12_actions), std::end(humanact12_actions));
  prepare(out.model);
  return out;
}
template <Backend B>
ActorRun<B> load_actor_run(const FilePath& folder) {
  return load_actor_run<B>(find_run(folder));
}

template <Backend B>
TemosRun<B> load_temos_run(const RunFolder& run, const TemosRunOptions& options = {}) {
  detail::require_checkpoint(run, "temos", "checkpoints/last.ckpt");
  const WeightFile weights = open_weights(run.weights);
  for (const char* name : {"textencoder.seperation_token", "textencoder.separation_token"}) {
    if (weights.find(name) != nullptr)
      raise<io_error>(404, weights.name(), ": of TEACH or SINC (it has '", name, "'), expected TEMOS");
  }
  const detail::RunReader r(run, weights, "");
  const TemosConfig config = detail::temos_config(r);
  const RunFolder statistics = options.statistics.string().empty() ? run : find_run(options.statistics);
  auto normalizer = statistics.parts.empty() ? std::nullopt
                                             : detail::find_normalizer<B>(detail::statistics_of(statistics), config.nfeats,
                                                                          {"", "stats.", "motion_stats."});
  if (!normalizer)
    raise<io_error>(401, statistics.folder.string(), ": no statistics of the motions: put ",
                    config.nfeats == 135 ? "rfeats_mean.pt and rfeats_std.pt" : "jfeats_mean.pt and jfeats_std.pt",
                    " (deps/transforms/... of TEMOS) there, or name their folder");
  normalizer->eps = 0;
  TemosRun<B> out{.model = load_temos<B>(weights, run),
                  .normalizer = std::move(*normalizer),
                  .text_encoder = detail::temos_text_encoder<B>(run, weights, options),
                  .fps = r.real("data/framerate", 12.5)};
  prepare(out.model);
  return out;
}
template <Backend B>
TemosRun<B> load_temos_run(const FilePath& folder, const TemosRunOptions& options = {}) {
  return load_temos_run<B>(find_run(folder), options);
}

}  // namespace motionlang::inline MOTIONLANG_ABI
