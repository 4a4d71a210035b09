// The same model over several backends and scalars gives the same motion for the same noise.
#include <doctest/doctest.h>

#include <motionlang/backend/eigen.hpp>
#include <motionlang/backend/reference.hpp>
#include <motionlang/backend/xtensor.hpp>

#include "../support/lists.hpp"
#include "../support/small_model.hpp"

namespace ml = motionlang;
using lists::largest_difference;
using ml::Index;

namespace {

template <ml::Backend B>
std::vector<double> motion_of(const ml::Stmc<ml::EigenBackend<double>>& original,
                              const std::vector<ml::Timeline>& timelines) {
  auto model = ml::convert_stmc<B>(original);
  ml::prepare(model);
  auto noise = [](Index draw, const ml::Shape& shape) {
    std::vector<double> drawn(static_cast<std::size_t>(shape.count()));
    ml::Philox{.seed = 3}.split(static_cast<std::uint64_t>(draw)).normal(std::span(drawn));
    const std::vector<typename B::scalar> values(drawn.begin(), drawn.end());
    return ml::Tensor<B, 3>::from(values, shape);
  };
  std::vector<double> out;
  for (const auto& m : model.generate_from(timelines, noise)) out.insert(out.end(), m.span().begin(), m.span().end());
  return out;
}

}  // namespace

TEST_CASE("xtensor in double and Eigen in float: one motion, all hundred steps") {
  const auto model = small::model<ml::EigenBackend<double>>(small::config(100));
  const std::vector timelines{small::several_tracks(), small::one_track()};
  const auto x = motion_of<ml::XtensorBackend<double>>(model, timelines);
  const auto e = motion_of<ml::EigenBackend<float>>(model, timelines);
  CHECK(x.size() == (70 + 40) * 205);
  const double difference = largest_difference(x, e);
  CHECK(difference < 1e-4);
  CHECK(difference > 0);  // float and double: had both been the same code, this would be 0
}

TEST_CASE("the reference backend in double agrees with the kernels in double") {
  const auto model = small::model<ml::EigenBackend<double>>(small::config(5));
  const std::vector timelines{small::one_track()};
  const auto reference = motion_of<ml::ReferenceBackend<double>>(model, timelines);
  CHECK(largest_difference(reference, motion_of<ml::EigenBackend<double>>(model, timelines)) < 1e-10);
  CHECK(largest_difference(reference, motion_of<ml::XtensorBackend<float>>(model, timelines)) < 1e-4);
}
