// Packed sequences: lengths, joining and taking apart, the edge to padded tensors.
#include <motionlang/backend/eigen.hpp>
#include <motionlang/tensor/sequences.hpp>

#include "../../support/check_error.hpp"

namespace ml = motionlang;
using ml::Index, ml::Offsets;
using B = ml::EigenBackend<double>;
using Sequences = ml::Sequences<B>;
using Matrix = ml::Tensor<B, 2>;
using Values = std::vector<double>;

namespace {

/// One column with these numbers.
Sequences column(const Values& values, std::initializer_list<Index> lengths) {
  return {Matrix::from(values, {std::ssize(values), 1}), Offsets(lengths)};
}

}  // namespace

TEST_CASE("offsets know every sequence") {
  const Offsets o{2, 0, 3};
  CHECK(o.count() == 3);
  CHECK(o.rows() == 5);
  CHECK(o.begin(2) == 2);
  CHECK(o.end(2) == 5);
  CHECK(o.length(1) == 0);
  CHECK(o.longest() == 3);
  CHECK(Offsets::equal(3, 2) == Offsets{2, 2, 2});
  CHECK(Offsets().count() == 0);
  CHECK_ERROR((Offsets{1, -1}), "[motionlang.shape.207] Offsets: negative length -1");
  CHECK_ERROR(Offsets::equal(-1, 3), "[motionlang.shape.207] Offsets: -1 sequences");
}

TEST_CASE("a batch and its rows have to agree") {
  const auto x = column({1, 2, 3, 4, 5}, {2, 0, 3});
  CHECK(x[0].to_vector() == Values{1, 2});
  CHECK(x[1].shape() == ml::Shape{0, 1});
  CHECK(x[2].to_vector() == Values{3, 4, 5});
  CHECK_ERROR(column({1, 2}, {3}), "[motionlang.shape.207] Sequences: offsets for 3 rows, tensor is (2, 1)");
  CHECK_ERROR(x.with(Matrix::zeros({4, 1})), "[motionlang.shape.207]");
}

TEST_CASE("joining goes sequence by sequence, and the parts can be taken off again") {
  const auto a = column({1, 2}, {1, 1}), b = column({10, 11, 12}, {1, 2}), c = column({20}, {0, 1});
  const auto joined = ml::concat_tokens(a, b, c);
  CHECK(joined.rows.to_vector() == Values{1, 10, 2, 11, 12, 20});
  CHECK(joined.offsets == Offsets{2, 4});
  CHECK(ml::drop_tokens(joined, 1).rows.to_vector() == Values{10, 11, 12, 20});
  CHECK(ml::last_rows(joined, c.offsets).rows.to_vector() == Values{20});
  CHECK_ERROR(ml::concat_tokens(a, column({1}, {1})), "[motionlang.shape.204] concat_tokens: 2 sequences and 1");
  CHECK_ERROR(ml::concat_tokens(ml::Sequences<B>(Matrix::zeros({0, 1}), Offsets{}), a),
              "[motionlang.shape.204] concat_tokens: 0 sequences and 2");
  CHECK_ERROR(ml::repeat_for_rows(a.rows, Offsets{3}),
              "[motionlang.shape.204] repeat_for_rows: 2 rows for 1 sequences");
  CHECK_ERROR(ml::last_rows(joined, Offsets{3, 1}), "[motionlang.shape.207] last_rows: 3 of 2 rows of sequence 0");
  CHECK_ERROR(ml::last_rows(joined, Offsets{1}), "[motionlang.shape.204]");
  CHECK_ERROR(ml::drop_tokens(joined, 3), "[motionlang.shape.207]");
}

TEST_CASE("rows are repeated for sequences, and sequences for a batch") {
  const auto per_sequence = Matrix::from({1, 2}, {2, 1});
  CHECK(ml::repeat_for_rows(per_sequence, Offsets{3, 1}).to_vector() == Values{1, 1, 1, 2});
  const auto twice = ml::repeat_sequence(per_sequence, 2);
  CHECK(twice.rows.to_vector() == Values{1, 2, 1, 2});
  CHECK(twice.offsets == Offsets{2, 2});
}

TEST_CASE("padded tensors: there and back, padding anywhere") {
  const auto x = column({1, 2, 3}, {1, 2});
  const auto padded = ml::to_padded(x, -1, 3);
  CHECK(padded.shape() == ml::Shape{2, 3, 1});
  CHECK(padded.to_vector() == Values{1, -1, -1, 2, 3, -1});
  CHECK(ml::to_padded(x).shape() == ml::Shape{2, 2, 1});
  const std::vector<Index> lengths{1, 2};
  const auto mask = ml::lengths_to_mask(lengths);
  CHECK(mask == std::vector<unsigned char>{1, 0, 1, 1});
  const auto back = ml::from_padded(ml::to_padded(x), std::span<const unsigned char>(mask));
  CHECK(back.rows.to_vector() == x.rows.to_vector());
  CHECK(back.offsets == x.offsets);
  CHECK(ml::from_padded(padded, std::span<const Index>(lengths)).rows.to_vector() == Values{1, 2, 3});
  const std::vector<unsigned char> holes{0, 1, 0, 1, 0, 1};
  CHECK(ml::from_padded(padded, std::span<const unsigned char>(holes)).rows.to_vector() == Values{-1, 2, -1});
  CHECK(ml::from_equal(padded).offsets == Offsets{3, 3});

  CHECK_ERROR(ml::from_padded(padded, std::span<const unsigned char>(mask)), "[motionlang.shape.205] from_padded");
  CHECK_ERROR(ml::from_padded(padded, std::span(lengths).first(1)), "[motionlang.shape.204] from_padded");
  for (Index wrong : {Index{4}, Index{-1}}) {
    const std::vector<Index> outside{1, wrong};
    CHECK_ERROR(ml::from_padded(padded, std::span<const Index>(outside)), "[motionlang.shape.205] from_padded: length");
  }
  CHECK_ERROR(ml::to_padded(x, 0, 1), "[motionlang.shape.205] to_padded: 1 frames for a sequence of 2");
}
