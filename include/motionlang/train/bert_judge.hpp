// SPDX-License-Identifier: MIT
/// BERTScore (metrics/bert_score.hpp) of descriptions, with a language model from a folder.
///
///     BertJudge<B> judge("distilbert-base-uncased", 0);
///     const double f = judge(pairs);
#pragma once

#include <filesystem>  // folders
#include <map>         // states of texts
#include <span>        // references
#include <string>      // texts
#include <utility>     // move
#include <variant>     // networks
#include <vector>      // texts

#include <motionlang/core/text_lines.hpp>
#include <motionlang/metrics/bert_score.hpp>
#include <motionlang/metrics/captions.hpp>
#include <motionlang/train/shared_items.hpp>
#include <motionlang/weights/text_encoder_folder.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// BERTScore by a language model of the BERT family: the mean over the descriptions.
template <Backend B>
class BertJudge {
 public:
  /// layers  to keep; 0: all
  /// Throws  config_error 102 for CLIP, 101 for more layers than the model has, and what load_text_encoder throws
  BertJudge(const std::filesystem::path& folder, Index layers) : encoder_(load_text_encoder<B>(folder)) {
    std::visit(
        [&](auto& network) {
          if constexpr (requires { network.words; }) {
            const Index all = std::ssize(network.layers);
            if (layers > all)
              raise<config_error>(101, "`layers` ", layers, ": ", folder.string(), " has ", counted(all, "layer"));
            if (layers > 0) network.layers.resize(static_cast<std::size_t>(layers));
            layers_ = std::ssize(network.layers), all_layers_ = all;
          } else {
            raise<config_error>(102, folder.string(), " is CLIP; BERTScore needs one of the BERT family");
          }
        },
        encoder_.network.network);
  }

  /// The number of layers in use, and that of the model.
  Index layers() const { return layers_; }
  Index all_layers() const { return all_layers_; }

  /// The mean of F, rescaled by a baseline: tm2t_bert_baseline, or what `mean` finds for random pairs.
  /// all  processes that share the pairs; all get the mean
  double operator()(const std::vector<CaptionPair>& pairs, const BertScore& baseline = {},
                    const AnyCommunicator& all = {}) {
    return mean(pairs, baseline, all).f;
  }
  BertScore mean(const std::vector<CaptionPair>& pairs, const BertScore& baseline = {},
                 const AnyCommunicator& all = {}) {
    BertWeights weights;
    for (const CaptionPair& pair : pairs) {
      for (const std::string& r : pair.references) weights.add(tokens_of(r).ids);
    }
    const auto score = [&](Index i, const Progress&) {
      const CaptionPair& pair = pairs[static_cast<std::size_t>(i)];
      std::vector<BertSentence<typename B::scalar>> references;
      for (const std::string& r : pair.references) references.push_back(encoded(r).sentence());
      MessageWriter out;
      out.value(bert_score(encoded(pair.candidate).sentence(),
                           std::span<const BertSentence<typename B::scalar>>(references), weights, baseline));
      return out.bytes();
    };
    BertScore sum;
    for (const std::string& message : shared_items(all, std::ssize(pairs), score)) {
      const auto s = MessageReader(message).template value<BertScore>();
      sum = {sum.precision + s.precision, sum.recall + s.recall, sum.f + s.f};
    }
    const auto count = static_cast<double>(pairs.size());
    return {sum.precision / count, sum.recall / count, sum.f / count};
  }

 private:
  struct Encoded {
    std::vector<Index> ids;
    Tensor<B, 2> states;
    BertSentence<typename B::scalar> sentence() const { return {ids, {states.span(), states.size(1)}}; }
  };
  /// Stripped and after a blank, as in the published program.
  auto tokens_of(const std::string& text) const {
    const std::vector<std::string> sentence{" " + std::string(detail::trim(text))};
    return tokenize(encoder_.tokenizer, std::span(sentence));
  }
  const Encoded& encoded(const std::string& text) {
    auto found = known_.find(text);
    if (found == known_.end()) {
      auto batch = tokens_of(text);
      auto states = encoder_.network(batch).tokens.rows;
      found = known_.emplace(text, Encoded{std::move(batch.ids), std::move(states)}).first;
    }
    return found->second;
  }

  AnyTextEncoder<B> encoder_;
  Index layers_ = 0, all_layers_ = 0;
  std::map<std::string, Encoded> known_;
};

MOTIONLANG_NAMESPACE_END
