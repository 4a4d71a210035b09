// The types that the concepts accept and refuse.
#include <doctest/doctest.h>

#include <motionlang/backend/autodiff.hpp>
#include <motionlang/backend/eigen.hpp>
#include <motionlang/backend/reference.hpp>
#include <motionlang/core/concepts.hpp>
#include <motionlang/core/rng.hpp>
#include <motionlang/nn/linear.hpp>

namespace ml = motionlang;

namespace {

using Fast = ml::EigenBackend<float>;
using Reference = ml::ReferenceBackend<double>;

/// One operation with another result than a tensor.
struct WrongSum : Reference {
  static double sum(const tensor&, int) { return 0; }
};
/// Packs, but does not say in which precision.
struct PacksOnly : Reference {
  static bool prepare(const tensor&, ml::Precision) { return true; }
};
struct NoFields {
  ml::Tensor<Fast, 2> weight;
};
struct Counter {
  std::uint64_t bits() { return 0; }
};

}  // namespace

TEST_CASE("concepts accept their models and refuse what lacks one requirement") {
  CHECK(ml::Scalar<float>);
  CHECK_FALSE(ml::Scalar<int>);
  CHECK(ml::ScalarLike<double>);
  CHECK_FALSE(ml::ScalarLike<std::string_view>);

  CHECK(ml::Backend<Fast>);
  CHECK(ml::Backend<Reference>);
  CHECK(ml::Backend<ml::Autodiff<Fast>>);
  CHECK_FALSE(ml::Backend<WrongSum>);
  CHECK_FALSE(ml::Backend<float>);

  CHECK(ml::AutodiffBackend<ml::Autodiff<Fast>>);
  CHECK_FALSE(ml::AutodiffBackend<Fast>);
  CHECK(ml::PackingBackend<Fast>);
  CHECK_FALSE(ml::PackingBackend<Reference>);
  CHECK_FALSE(ml::PackingBackend<ml::Autodiff<Fast>>);
  CHECK_FALSE(ml::PackingBackend<PacksOnly>);

  CHECK(ml::Module<ml::Linear<Fast>>);
  CHECK_FALSE(ml::Module<NoFields>);
  CHECK(ml::Rng<ml::Philox>);
  CHECK_FALSE(ml::Rng<Counter>);
}
