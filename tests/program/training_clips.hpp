// SPDX-License-Identifier: MIT
/// A few made-up clips with captions and labels, and small trainings on them.
#pragma once

#include <numeric>
#include <sstream>

#include <motionlang/backend/eigen.hpp>
#include <motionlang/datasets/humanml3d_folder.hpp>
#include <motionlang/features/motion_features.hpp>
#include <motionlang/file/npz.hpp>
#include <motionlang/file/safetensors.hpp>
#include <motionlang/formats/bvh.hpp>
#include <motionlang/metrics/ape_ave.hpp>
#include <motionlang/weights/text_motion_model.hpp>

#include "../support/roberta_json.hpp"
#include "../support/synthetic_motion.hpp"
#include "../support/temporary_folder.hpp"
#include "process.hpp"

namespace ml = motionlang;

/// Eight short walks of two kinds, with captions and labels.
struct Clips : TemporaryFolder {
  Clips() {
    std::string captions = "# clip\tstart\tend\tparts\tcaptions\n", labels = "# clip\tstart\tend\tlabel\n";
    for (int i = 0; i < 8; ++i) {
      const bool turns = i % 2 == 1;
      const std::string name = "clip" + std::to_string(i);
      ml::write_bvh(*this / (name + ".bvh"), synthetic::walk({.frames = 40 + 2 * i, .turn = turns ? 0.8 : 0.0}));
      captions += name + "\t0\t2\tlegs\t" +
                  (turns ? "a person turns left | someone turns\n" : "a person walks ahead | someone walks\n");
      labels += name + "\t0\t2\t" + (turns ? "turn" : "walk") + "\n";
    }
    ml::write_file(*this / "captions.tsv", captions);
    ml::write_file(*this / "labels.tsv", labels);
  }

  /// Small networks, an eighth of the clips to validate with and a quarter for tests.
  Outcome train(const std::string& command, const std::string& out, std::vector<std::string> more = {},
                const std::string& interrupt_at = "") const {
    const bool texts = command == "train-tmr" || command == "train-temos";
    std::vector<std::string> arguments{command,
                                       "--data",
                                       ".",
                                       "--out",
                                       out,
                                       "--preset",
                                       "small",
                                       texts ? "--captions" : "--labels",
                                       texts ? "captions.tsv" : "labels.tsv"};
    auto set = [&](const std::string& assignment) { arguments.insert(arguments.end(), {"--set", assignment}); };
    for (const char* a :
         {"data.min_seconds=0.5", "data.test_share=0.25", "data.validation_share=0.25", "optimiser.batch=2",
          "optimiser.schedule=constant", "optimiser.epochs=4", "optimiser.lr=0.01"})
      set(a);
    if (command != "train-classifier") {
      for (const char* a : {"network.latent_dim=8", "network.ff_size=8", "network.num_layers=1", "network.num_heads=2"})
        set(a);
    } else {
      set("hidden_size=8");
    }
    if (texts) {
      for (const char* a : {"data.mirror=false", "text.width=8", "text.vocabulary=40"}) set(a);
    } else {
      set("clips.num_frames=12");
    }
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments, path, interrupt_at);
  }
  ml::SafetensorsFile checkpoint(const std::string& out) const {
    return ml::SafetensorsFile::open(*this / (out + "/checkpoint.safetensors"));
  }
  std::vector<float> losses(const std::string& out) const {
    return ml::values_of<float>(checkpoint(out).tensor("losses"));
  }
  /// The names of the terms of the loss, and their values, (steps, terms).
  std::vector<std::string> terms(const std::string& out) const {
    std::istringstream lines(checkpoint(out).metadata().at("training.terms"));
    std::vector<std::string> names;
    for (std::string line; std::getline(lines, line);) names.push_back(line);
    return names;
  }
  std::vector<float> term_values(const std::string& out) const {
    return ml::values_of<float>(checkpoint(out).tensor("loss_terms"));
  }
  std::string weights(const std::string& out) const {
    return ml::read_file(*this / (out + "/model/weights.safetensors"));
  }
};

/// Two epochs of a tiny network, into "out".
inline Outcome train_tiny(const std::string& command, const std::filesystem::path& folder,
                          const std::vector<std::string>& more) {
  std::vector<std::string> arguments{command, "--preset", "small", "--out", "out", "--fresh"};
  for (const char* a : {"optimiser.epochs=2", "optimiser.batch=2", "network.latent_dim=8", "network.ff_size=8",
                        "network.num_layers=1", "network.num_heads=2", "text.width=8"})
    arguments.insert(arguments.end(), {"--set", a});
  arguments.insert(arguments.end(), more.begin(), more.end());
  return run(arguments, folder);
}

/// A walk of so many rows, and what is said about it, in a data set.
inline void add_walk(const std::string& data_set, const std::string& id, int rows, const std::string& features,
                     const ml::HumanMl3dForm& form, synthetic::Walk walk = {}) {
  const auto& f = ml::motion_features(features);
  walk.frames = rows + 1, walk.fps = f.fps;
  const auto values = f.from_motion(synthetic::walk(walk));
  const std::vector<float> joints(static_cast<std::size_t>(rows * 3 * form.joints));
  ml::HumanMl3dClip clip{id, rows, {values.begin(), values.end()}, joints, {}};
  clip.captions.push_back({.text = "a person walks " + id, .words = {}, .start = 0, .end = 0});
  ml::write_humanml3d_clip(data_set, clip, form);
}

inline double mean(std::span<const float> x) {
  return std::accumulate(x.begin(), x.end(), 0.0) / static_cast<double>(x.size());
}

/// The weights of a BERT, RoBERTa or DistilBERT as Hugging Face has them. They begin with `prefix`.
template <class Network>
Network write_language_weights(const std::filesystem::path& folder, const std::string& prefix,
                               const ml::BertConfig& sizes) {
  ml::Philox rng{.seed = 7};
  Network network(sizes, rng);
  ml::TensorStore store;
  store.add_module(network, prefix);
  std::filesystem::create_directories(folder);
  ml::write_safetensors(folder / "model.safetensors", store.views());
  return network;
}

/// A tiny BERT or RoBERTa as Hugging Face has them.
template <class Network>
void write_language_model(const std::filesystem::path& folder, const char* type, const ml::BertConfig& sizes) {
  write_language_weights<Network>(folder, std::string(type) + ".", sizes);
  const nlohmann::json config{{"model_type", type},
                              {"hidden_size", sizes.width},
                              {"num_attention_heads", sizes.heads},
                              {"num_hidden_layers", sizes.layers},
                              {"intermediate_size", sizes.d_ff},
                              {"vocab_size", sizes.vocabulary},
                              {"max_position_embeddings", sizes.positions},
                              {"type_vocab_size", sizes.token_types},
                              {"hidden_act", "gelu"}};
  ml::write_file(folder / "config.json", config.dump());
}

/// A tiny RoBERTa with its tokenizer.
inline void write_roberta(const std::filesystem::path& folder, ml::Index layers = 1) {
  write_language_model<ml::Roberta<ml::EigenBackend<float>>>(folder, "roberta",
                                                             {.vocabulary = 262,
                                                              .width = 8,
                                                              .heads = 2,
                                                              .d_ff = 12,
                                                              .layers = layers,
                                                              .positions = 40,
                                                              .token_types = 1,
                                                              .padding = 1});
  ml::write_file(folder / "tokenizer.json", roberta_json());
}

/// A tiny DistilBERT as Hugging Face has them, which knows the words of these captions.
inline ml::DistilBert<ml::EigenBackend<float>> write_distilbert(const std::filesystem::path& folder) {
  const ml::BertConfig tiny{.vocabulary = 12, .width = 8, .heads = 2, .d_ff = 12, .layers = 2, .positions = 16};
  auto network = write_language_weights<ml::DistilBert<ml::EigenBackend<float>>>(folder, "distilbert.", tiny);
  ml::write_file(folder / "config.json",
                 std::string_view(R"({"model_type": "distilbert", "dim": 8, "n_heads": 2, "n_layers": 2,
    "hidden_dim": 12, "vocab_size": 12, "max_position_embeddings": 16, "activation": "gelu"})"));
  ml::write_file(
      folder / "vocab.txt",
      std::string_view("[PAD]\n[UNK]\n[CLS]\n[SEP]\n[MASK]\na\nperson\nsomeone\nwalks\nturns\nahead\nleft\n"));
  return network;
}
