// Training that calculates layers again: the same gradients for less memory, and steps that take nothing from the
// system.
#include <doctest/doctest.h>

#include <motionlang/backend/autodiff.hpp>
#include <motionlang/backend/eigen.hpp>
#include <motionlang/nn/recompute.hpp>
#include <motionlang/nn/sequence_vae.hpp>
#include <motionlang/optim/adamw.hpp>

#include "../../support/tensors.hpp"

namespace ml = motionlang;
using ml::Offsets;
using B = ml::EigenBackend<float>;
using A = ml::Autodiff<B>;

namespace {

constexpr ml::TransformerConfig sizes{.d_model = 32, .heads = 2, .d_ff = 64, .layers = 8};

ml::Context context(bool recompute, std::uint64_t step = 0) {
  return {.dropout = ml::Philox{.seed = 5}.split(step), .recompute = recompute};
}

/// An encoder, and a decoder that reads one row or several of what it gives.
struct Model {
  ml::TransformerEncoder<A> encoder;
  ml::SequenceDecoder<A> decoder;
  ml::Index memory_rows = 1;

  static constexpr auto fields() {
    return ml::fields("encoder", &Model::encoder, "decoder", &Model::decoder, "memory_rows", &Model::memory_rows);
  }
  Model(bool norm_first, ml::Index rows, ml::Philox rng = {.seed = 1}) : memory_rows(rows) {
    auto c = sizes;
    c.norm_first = norm_first;
    encoder = {c, rng};
    decoder = {6, sizes, 100, rng};
  }
  ml::Tensor<A, 0> loss(const ml::Sequences<A>& x, const ml::Context& c) const {
    const auto memory = encoder.layers.front().norm_first ? ml::first_rows(encoder(x, c), memory_rows)
                                                          : ml::encode_tokens(encoder, x, memory_rows, 0.1, c);
    return ml::sum(ml::square(decoder(memory, x.offsets, c).rows));
  }
};

ml::Sequences<A> input() { return {tensors::normal<A, 2>({90, 32}, 2), Offsets{40, 13, 37}}; }

}  // namespace

TEST_CASE("gradients are the same bits with and without, and so are the masks that are drawn") {
  const auto x = input();
  for (bool norm_first : {false, true}) {
    for (ml::Index rows : {1, 3}) {
      const Model model(norm_first, rows);
      for (bool dropout : {false, true}) {
        const auto plain = dropout ? context(false) : ml::Context{};
        const auto saving = dropout ? context(true) : ml::Context{.recompute = true};
        const auto a = model.loss(x, plain), b = model.loss(x, saving);
        CHECK(a.item() == b.item());
        CHECK(plain.drawn == saving.drawn);
        const auto expected = ml::backward(a), found = ml::backward(b);
        CHECK(tensors::same_bits(found[x.rows], expected[x.rows]));
        ml::Index parameters = 0;
        ml::visit_tensors(model, [&](const std::string& path, const auto& t) {
          if (expected.find(t.data()) == nullptr) return;
          ++parameters;
          CHECK_MESSAGE(tensors::same_bits(found[t], expected[t]), path);
        });
        CHECK(parameters > 16 * 12);
      }
    }
  }
}

TEST_CASE("the memory of a step: with recomputation much less, and nothing from the system after the second step") {
  const auto x = input();
  ml::Philox rng{.seed = 1};
  ml::TransformerEncoder<A> model(sizes, rng);
  model.layers.assign(24, model.layers.front());  // one set of parameters: memory is what the layers keep
  const auto step = [&](const ml::Context& c) { return ml::backward(ml::sum(ml::square(model(x, c).rows))); };
  std::int64_t buffers[2] = {};
  for (bool recompute : {false, true}) {
    ml::BufferPool::local().trim();
    const auto before = ml::BufferPool::local().system_allocations();
    step(context(recompute));
    buffers[recompute] = ml::BufferPool::local().system_allocations() - before;
  }
  CHECK(buffers[0] > 24 * 6);
  CHECK(2 * buffers[1] < buffers[0]);
}

TEST_CASE("steps of training after the second take nothing from the system") {
  const auto x = input();
  for (bool recompute : {false, true}) {
    Model model(true, 3);
    ml::AdamW<A> adam;
    std::int64_t taken[6] = {};
    for (std::uint64_t k = 0; k < 6; ++k) {
      adam.step(model, ml::backward(model.loss(x, context(recompute, k))));
      taken[k] = ml::BufferPool::local().system_allocations();
    }
    CHECK(taken[0] > 0);
    for (int k = 2; k < 6; ++k) CHECK(taken[k] == taken[1]);
  }
}
