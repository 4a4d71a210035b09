// Text networks of mapped files: weights are packed once, their memory in the file is given back, and nothing else changes.
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

TEST_CASE("Text networks: prepare packs what is multiplied with, and leaves embeddings") {
  auto network = ml::load_text_network<ml::Bert<B>>(tiny_bert, file_of(by_formula(bert_shapes<ml::BertKeys>())));
  const auto before = network(texts).tokens.rows;
  CHECK(network.layers[0].up.weight.data().attached() == nullptr);
  prepare(network);
  CHECK(network.layers[1].up.weight.data().attached() != nullptr);
  CHECK(network.words.weight.data().attached() == nullptr);
  CHECK(network.positions.weight.data().attached() == nullptr);
  CHECK(same_bits(network(texts).tokens.rows, before));
}
