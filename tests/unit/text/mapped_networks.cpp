// Text networks of mapped files: weights are packed once, their memory in the file is given back, and nothing else
// changes.
#include <doctest/doctest.h>

#include <motionlang/backend/eigen.hpp>

#include "../../support/temporary_folder.hpp"
#include "../../support/tensors.hpp"
#include "../../support/text_networks.hpp"

namespace ml = motionlang;
using B = ml::EigenBackend<float>;
using tensors::same_bits;
using namespace text_networks;

namespace {

const ml::TokenBatch texts{{2, 7, 3, 19, 5, 6, 19}, {4, 3}};

/// The network from a file on disk and from the same file in memory; `layers` are those of a network.
template <class Load, class Layers>
void check_mapped(const Numbers& numbers, Load load, Layers layers) {
  const TemporaryFolder folder;
  ml::TensorStore store;
  for (const auto& [name, t] : numbers) store.add(name, t.first, std::span<const double>(t.second), ml::DType::F32);
  ml::write_safetensors(folder.path / "weights.safetensors", store.views());
  const auto mapped = load(ml::SafetensorsFile::open(folder.path / "weights.safetensors"));
  const auto kept = load(file_of(numbers, ml::DType::F32));
  int packed = 0;
  for (std::size_t i = 0; i < layers(mapped).size(); ++i) {
    ml::zip(layers(mapped)[i], layers(kept)[i], [&](const std::string& path, const auto& a, const auto& b) {
      if constexpr (requires { a.data().attached(); }) {
        CAPTURE(path);
        const bool matrix = a.shape().rank() == 2;
        CHECK((a.data().attached() != nullptr) == matrix);
        CHECK(b.data().attached() == nullptr);
        CHECK(same_bits(a, b));  // the file is still there for whoever asks
        packed += matrix;
      }
    });
  }
  CHECK(packed >= 4);
  const auto from_panels = mapped(texts).tokens.rows, from_numbers = kept(texts).tokens.rows;
  CHECK(same_bits(from_panels, from_numbers));
}

}  // namespace

TEST_CASE("Text networks: weights of a mapped file are packed when they are loaded") {
  check_mapped(
      by_formula(bert_shapes<ml::DistilBertKeys>()),
      [](const auto& file) { return ml::load_text_network<ml::DistilBert<B>>(tiny_bert, file); },
      [](const auto& network) -> const auto& { return network.layers; });
  check_mapped(
      by_formula(clip_shapes()), [](const auto& file) { return ml::load_clip_text<B>(tiny_clip, file); },
      [](const auto& network) -> const auto& { return network.blocks; });
}

namespace {

/// All matrices in layers of a network.
template <class Layers>
std::vector<std::pair<std::string, ml::Tensor<B, 2>>> matrices(const Layers& layers) {
  std::vector<std::pair<std::string, ml::Tensor<B, 2>>> out;
  for (const auto& layer : layers) {
    ml::visit_tensors(layer, [&](const std::string& path, const auto& t) {
      if constexpr (std::is_same_v<std::remove_cvref_t<decltype(t)>, ml::Tensor<B, 2>>) out.emplace_back(path, t);
    });
  }
  return out;
}
/// Every weight is packed, and its numbers are in a file, so that they are not in memory twice.
template <class Layers>
void check_packed_once(const Layers& layers) {
  const auto found = matrices(layers);
  CHECK(found.size() >= 8);
  for (const auto& matrix : found) {
    CAPTURE(matrix.first);
    const auto& t = matrix.second;
    CHECK(t.data().attached() != nullptr);
    CHECK(ml::MappedFile::that_holds(std::as_bytes(t.span())) != nullptr);
  }
}

}  // namespace

TEST_CASE("Text networks: weights that are converted are packed when they are loaded, and are in memory once") {
  const auto numbers = by_formula(bert_shapes<ml::DistilBertKeys>());
  for (const ml::DType stored : {ml::DType::F16, ml::DType::BF16, ml::DType::F64}) {
    const auto file = file_of(numbers, stored);
    const auto network = ml::load_text_network<ml::DistilBert<B>>(tiny_bert, file);
    check_packed_once(network.layers);
    const auto& up = network.layers[1].up.weight;
    const auto wanted = ml::values_of<float>(file.tensor("transformer.layer.1.ffn.lin1.weight"));
    CHECK(std::equal(wanted.begin(), wanted.end(), up.span().begin(), up.span().end()));
  }
  check_packed_once(ml::load_clip_text<B>(tiny_clip, file_of(by_formula(clip_shapes()), ml::DType::F16)).blocks);
}

TEST_CASE("Text networks: CLIP's weights that are put together are packed when they are loaded") {
  const auto numbers = by_formula(clip_shapes());
  const auto direct = ml::load_clip_text<B>(tiny_clip, file_of(numbers, ml::DType::F32));
  for (const ml::DType stored : {ml::DType::F32, ml::DType::F16}) {
    const TemporaryFolder folder;
    ml::TensorStore store;
    for (const auto& [name, t] : hugging_face(numbers))
      store.add(name, t.first, std::span<const double>(t.second), stored);
    ml::write_safetensors(folder.path / "model.safetensors", store.views());
    const auto network = ml::load_clip_text<B>(tiny_clip, ml::SafetensorsFile::open(folder.path / "model.safetensors"));
    check_packed_once(network.blocks);
    if (stored != ml::DType::F32) continue;
    CHECK(same_bits(network.blocks[1].attn.in_proj_weight, direct.blocks[1].attn.in_proj_weight));
    CHECK(same_bits(network(texts).tokens.rows, direct(texts).tokens.rows));
  }
}

TEST_CASE("Text networks: prepare packs what is multiplied with, and leaves embeddings") {
  auto network =
      ml::load_text_network<ml::Bert<B>>(tiny_bert, file_of(by_formula(bert_shapes<ml::BertKeys>()), ml::DType::F32));
  const auto before = network(texts).tokens.rows;
  CHECK(network.layers[0].up.weight.data().attached() == nullptr);
  prepare(network);
  CHECK(network.layers[1].up.weight.data().attached() != nullptr);
  CHECK(network.words.weight.data().attached() == nullptr);
  CHECK(network.positions.weight.data().attached() == nullptr);
  CHECK(same_bits(network(texts).tokens.rows, before));
}
