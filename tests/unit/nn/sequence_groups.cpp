// Sequences in groups: who gets which, and that every row of the result comes from its sequence.
#include <algorithm>
#include <array>
#include <mutex>
#include <numeric>

#include <motionlang/backend/autodiff.hpp>
#include <motionlang/backend/eigen.hpp>
#include <motionlang/backend/reference.hpp>
#include <motionlang/nn/sequence_groups.hpp>
#include <motionlang/nn/sequence_vae.hpp>
#include <motionlang/nn/transformer_decoder.hpp>
#include <motionlang/nn/transformer_encoder.hpp>

#include "../../support/check_error.hpp"
#include "../../support/kernel_sets.hpp"
#include "../../support/tensors.hpp"
#include "../../support/threads.hpp"

namespace ml = motionlang;
using ml::Index, ml::Offsets;
using B = ml::EigenBackend<double>;
using Lengths = std::vector<Index>;

namespace {

Lengths all_of(const Offsets& offsets) {
  Lengths out(static_cast<std::size_t>(offsets.count()));
  std::iota(out.begin(), out.end(), 0);
  return out;
}

/// The thread of each of the sequences that are shared, the longest first.
std::vector<Index> shares(const Lengths& lengths, Index threads) {
  const Offsets offsets(lengths);
  const auto out = ml::detail::share_sequences(offsets, all_of(offsets), threads);
  return {out.begin(), out.end()};
}

/// Numbers of sequences, each as often as it has rows.
template <ml::Backend C>
ml::Tensor<C, 2> numbers(const Offsets& offsets, std::span<const Index> which) {
  std::vector<typename C::scalar> out;
  for (Index s : which)
    out.insert(out.end(), static_cast<std::size_t>(2 * offsets.length(s)), static_cast<typename C::scalar>(s));
  return ml::Tensor<C, 2>::from(out, {std::ssize(out) / 2, 2});
}

}  // namespace

TEST_CASE("threads share as many sequences as make equal shares") {
  CHECK(shares({200, 200}, 2) == Lengths{0, 1});
  CHECK(shares({200, 200, 200}, 2) == Lengths{0, 1});
  CHECK(shares({200, 200, 200}, 3) == Lengths{0, 1, 2});
  CHECK(shares({400, 200, 200}, 2) == Lengths{0, 1, 1});
  CHECK(shares({200, 163, 139, 120, 97, 71, 52, 44}, 2) == Lengths{0, 1, 1, 0, 1, 0, 0, 1});
  CHECK(shares({200, 200, 163, 163, 139, 139, 44, 44}, 2) == Lengths{0, 1, 0, 1, 0, 1, 0, 1});
  CHECK(shares({200, 200}, 1).empty());
  CHECK(shares({200, 200}, 3).empty());  // one for each thread at least
  CHECK(shares({127, 127}, 2).empty());  // too few rows
  CHECK(shares({128, 128}, 2) == Lengths{0, 1});
  CHECK(shares({200, 170}, 2).empty());  // one would wait for the other
  CHECK(shares({600, 2, 2}, 2).empty());
  CHECK(shares({}, 2).empty());
  CHECK(shares(Lengths(1000, 32), 7).size() == 1000);
}

TEST_CASE("each sequence once, in groups that fit, in its place") {
  for (const Index threads : {1, 2, 3}) {
    const Threads set(static_cast<int>(threads));
    const Index at_once = B::rows_in_cache(), own = at_once / threads;
    for (const Lengths& pattern : {Lengths{200}, {1, 70, 130, 40}, {600, 2}, {300, 0}, {900}}) {
      Lengths lengths;
      for (Index total = 0; total < 5 * at_once / 2; total += lengths.back())
        lengths.push_back(pattern[lengths.size() % pattern.size()]);
      const Offsets offsets(lengths), two = Offsets::equal(offsets.count(), 2);
      const Lengths all = all_of(offsets);
      for (const Offsets& results : {offsets, two}) {
        std::mutex mutex;
        std::vector<Index> calls(lengths.size(), 0);
        Index groups = 0;
        bool shared = false;
        const auto result = ml::detail::in_groups<B>(offsets, results, 2, {}, [&](std::span<const Index> which) {
          const std::scoped_lock lock(mutex);
          for (Index s : which) ++calls[static_cast<std::size_t>(s)];
          const bool alone = ml::parallel_width() < threads;
          shared = shared || alone;
          ++groups;
          const Index rows = ml::detail::some_sequences(offsets, which).rows();
          CHECK((which.size() == 1 || rows <= (alone ? own : at_once)));
          return numbers<B>(results, which);
        });
        CHECK(calls == std::vector<Index>(lengths.size(), 1));
        CHECK(groups <= 2 * offsets.rows() / own + threads);  // two that follow each other would not fit into one
        CHECK(shared == !shares(lengths, threads).empty());
        CHECK(tensors::same_bits(result, numbers<B>(results, all)));
      }
      const auto fails = [&](std::span<const Index> which) -> ml::Tensor<B, 2> {
        if (std::ranges::find(which, offsets.count() - 1) != which.end())
          ml::raise<ml::shape_error>(204, "the last one");
        return numbers<B>(offsets, which);
      };
      CHECK_ERROR(ml::detail::in_groups<B>(offsets, offsets, 2, {}, fails), "[motionlang.shape.204] the last one");

      const auto fails_inside = [&](std::span<const Index> which) {
        const ml::ModuleScope layer("layers.", 1);
        return fails(which);
      };
      const ml::ModuleScope model("model");
#ifdef MOTIONLANG_DIAGNOSTICS
      CHECK_ERROR(ml::detail::in_groups<B>(offsets, offsets, 2, {}, fails_inside), "; at model.layers.1");
#else
      CHECK_ERROR(ml::detail::in_groups<B>(offsets, offsets, 2, {}, fails_inside), "[motionlang.shape.204]");
#endif

      // All at once with dropout, with gradients, and where the backend says nothing.
      const auto at_once_only = [&](auto backend, const ml::Context& context) {
        using C = decltype(backend);
        return ml::detail::in_groups<C>(offsets, offsets, 2, context, [&](std::span<const Index> which) {
          CHECK(Lengths(which.begin(), which.end()) == all);
          return numbers<C>(offsets, which);
        });
      };
      at_once_only(B{}, {.dropout = ml::Philox{}});
      at_once_only(ml::Autodiff<B>{}, {});
      at_once_only(ml::ReferenceBackend<double>{}, {});
    }
  }
}

TEST_CASE("sequences that end alike: the same bits as one by one, on any number of threads") {
  for (const bool norm_first : {false, true}) {
    ml::Philox rng{.seed = 1};
    const ml::TransformerEncoder<B> encoder(
        {.d_model = 8, .heads = 2, .d_ff = 12, .layers = 2, .norm_first = norm_first}, rng);
    const Offsets heads{3, 1, 2, 0, 4, 1}, tails{150, 160, 0, 150}, uses{2, 1, 1, 2};
    const ml::Sequences<B> head(tensors::normal<B, 2>({heads.rows(), 8}, 2), heads),
        tail(tensors::normal<B, 2>({tails.rows(), 8}, 3), tails);
    const auto whole = encoder(ml::concat_tokens(head, ml::repeat_sequences(tail, uses)));
    for (const int threads : {1, 2, 3}) {
      const Threads set(threads);
      const auto y = encoder.with_tails(head, tail, uses);
      CHECK(y.offsets == whole.offsets);
      CHECK(tensors::same_bits(y.rows, whole.rows));
    }
    CHECK_ERROR(encoder.with_tails(head, tail, Offsets{2, 1, 1}), "[motionlang.shape.204] repeat_lengths");
    CHECK_ERROR(encoder.with_tails(tail, tail, uses), "[motionlang.shape.204] with_tails");
  }
  const ml::Sequences<B> x(tensors::normal<B, 2>({3, 2}, 4), Offsets{2, 1});
  CHECK(ml::repeat_sequences(x, Offsets{1, 2}).offsets == Offsets{2, 1, 1});
  CHECK(tensors::same_bits(ml::repeat_sequences(x, Offsets{0, 2})[1], x[1]));
  CHECK_ERROR(ml::repeat_sequences(x, Offsets{1}), "[motionlang.shape.204] repeat_lengths");
}

TEST_CASE("bf16x3: whether a product is worth tiles does not depend on how many threads share the rows") {
  using F = ml::EigenBackend<float>;
  const kernel_sets::InPrecision precision(ml::Precision::bf16x3);
  ml::Philox rng{.seed = 1};
  const ml::TransformerConfig config{.d_model = 256, .heads = 4, .d_ff = 512, .layers = 1};
  const ml::TransformerEncoder<F> encoder(config, rng);
  const ml::TransformerDecoder<F> decoder(config, rng);
  const auto sequences = [](Index length, std::uint64_t seed) {
    return ml::Sequences<F>(tensors::normal<F, 2>({20 * length, 256}, seed), Offsets::equal(20, length));
  };
  const auto x = sequences(70, 1), memory = sequences(5, 2), one = sequences(1, 3);
  const auto all = [&] {
    return std::array{encoder(x).rows, ml::encode_tokens(encoder, x, 2, 0.0).rows, decoder(x, memory).rows,
                      decoder(x, one).rows};
  };
  const Threads single(1);
  const auto expected = all();
  for (int threads : {2, 3, 16}) {
    const Threads set(threads);
    const auto got = all();
    for (std::size_t i = 0; i < got.size(); ++i) CHECK(tensors::same_bits(got[i], expected[i]));
  }
}
