// SPDX-License-Identifier: MIT
/// Text networks from the files of Hugging Face and OpenAI.
///
///     const auto document = read_json("distilbert/config.json");
///     const JsonView config(document, "config.json");
///     const auto network = load_text_network<DistilBert<B>>(config, open_weights("model.safetensors"));
///     const auto clip = load_clip_text<B>(open_weights("ViT-B-32.pt"));
///
/// Prefix   the text before the name of the word embedding ("embeddings.word_embeddings.weight",
///          "token_embedding.weight") is before all names of the network: "distilbert.", "bert.",
///          "textencoder.text_model." (TEMOS, TEACH, SINC), "clip_model." (MDM) ... Tensors with other names are not
///          read
/// Ignored  position_ids, poolers, heads of the pre-training (vocab_*, cls.*, lm_head.*); CLIP: logit_scale and the
///          image tower
/// Aliases  LayerNorm.gamma and .beta for .weight and .bias; CLIP in the form of Hugging Face, whose projections of
///          query, key and value are stacked and whose text_projection is transposed
/// Memory   tensors of 32-bit numbers are views of the file. Weights of layers are packed for the kernels (prepare) and
///          their memory in the file is released, so that no weight is in memory twice. Converted or combined weights
///          go to temporary files. If there is no place for such files, they are packed each time they are used
/// Throws   config_error 103 for another model_type, activation or position_embedding_type, 101 for impossible sizes,
///          102 for sizes far above those of the file; io_error 406, 407 if names or shapes do not match
/// Source   huggingface/transformers, modeling_distilbert.py, modeling_bert.py, modeling_roberta.py, modeling_mpnet.py,
///          modeling_clip.py; openai/CLIP clip/model.py
#pragma once

#include <deque>  // stacked tensors

#include <motionlang/text/bert.hpp>
#include <motionlang/text/clip_text.hpp>
#include <motionlang/weights/module_file.hpp>

MOTIONLANG_NAMESPACE_BEGIN

class JsonView;

namespace detail {

/// The tensors of a file under other names, some of them combined.
class RenamedTensors : public TensorSet {
 public:
  explicit RenamedTensors(const TensorSet& file);
  void add(TensorView view, std::string name);
  /// Adds a new tensor. Matrices are moved to a temporary file, so that they can be packed like those of the file.
  void add(TensorView view, std::string name, std::vector<std::byte> bytes);
  void sort();

 private:
  struct Memory {
    std::shared_ptr<const void> file;
    std::vector<std::shared_ptr<const MappedFile>> aside;
    std::deque<std::vector<std::byte>> made;
  };
  std::shared_ptr<Memory> memory_ = std::make_shared<Memory>();
};

/// The prefix of the only tensor whose name is `name` after a dot or at the start. Nothing if there is none; throws
/// io_error 406 if there are two.
std::optional<std::string> prefix_of(const TensorSet& file, std::string_view name);

inline bool begins_with_any(std::string_view name, std::initializer_list<std::string_view> beginnings) {
  return std::any_of(beginnings.begin(), beginnings.end(), [&](std::string_view b) { return name.starts_with(b); });
}

RenamedTensors bert_tensors(const TensorSet& file);

/// The tensors of the text tower under OpenAI's names.
RenamedTensors clip_tensors(const TensorSet& file);

template <class Layer>
void pack_layers(std::vector<Layer>& layers) {
  for (Layer& layer : layers) {
    for (const auto& t : tensors_of(layer)) prepare_loaded_once(t);
  }
}

/// The room for a network that is to be made and filled from these weights.
ParameterRoom room_of(const TensorSet& weights);

}  // namespace detail

/// The sizes in the config.json of a member of the BERT family; `model_type` names the expected member.
BertConfig bert_config(const JsonView& config, std::string_view model_type);

/// Fills a network of the BERT family.
template <class Network>
Network load_text_network(const BertConfig& config, const TensorSet& weights) {
  const auto room = detail::room_of(weights);
  NoInit zeros;
  Network network(config, zeros);
  load_module(network, detail::bert_tensors(weights));
  detail::pack_layers(network.layers);
  return network;
}
/// Network is DistilBert<B>, Bert<B>, Roberta<B> or Mpnet<B>.
template <class Network>
Network load_text_network(const JsonView& config, const TensorSet& weights) {
  return load_text_network<Network>(bert_config(config, Network::keys::model_type), weights);
}

/// The sizes of a DistilBERT from the shapes of its tensors, with 64 numbers a head: inside checkpoints of TEMOS, TEACH
/// and SINC. Throws io_error 406, 407.
BertConfig distilbert_config(const TensorSet& file);

/// The sizes in the config.json of a CLIP model, or of its text tower alone. Missing values (newer files leave out the
/// defaults) are as in ViT-B/32.
ClipTextConfig clip_text_config(const JsonView& config);

/// The sizes of a text tower from the shapes of its tensors, with 64 numbers a head. Throws io_error 406, 407.
ClipTextConfig clip_text_config(const TensorSet& file);

template <Backend B>
ClipText<B> load_clip_text(const ClipTextConfig& config, const TensorSet& weights) {
  const auto room = detail::room_of(weights);
  NoInit zeros;
  ClipText<B> network(config, zeros);
  load_module(network, detail::clip_tensors(weights));
  detail::pack_layers(network.blocks);
  return network;
}
template <Backend B>
ClipText<B> load_clip_text(const JsonView& config, const TensorSet& weights) {
  return load_clip_text<B>(clip_text_config(config), weights);
}
template <Backend B>
ClipText<B> load_clip_text(const TensorSet& weights) {
  const auto tensors = detail::clip_tensors(weights);  // combined once
  return load_clip_text<B>(clip_text_config(tensors), tensors);
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/weights/text_network_file.ipp>
#endif
