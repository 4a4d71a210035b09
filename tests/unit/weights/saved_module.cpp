// A module of a user's in a file: written and read in one call each.
#include <motionlang/backend/autodiff.hpp>
#include <motionlang/backend/eigen.hpp>
#include <motionlang/nn/transformer_encoder.hpp>
#include <motionlang/weights/module_file.hpp>

#include "../../support/check_error.hpp"
#include "../../support/temporary_folder.hpp"
#include "../../support/tensors.hpp"

namespace ml = motionlang;
using B = ml::EigenBackend<float>;

namespace {

template <ml::Backend C>
ml::TransformerEncoder<C> encoder(std::uint64_t seed, ml::Index width = 8) {
  ml::Philox rng{.seed = seed};
  return {{.d_model = width, .heads = 2, .d_ff = 16, .layers = 2}, rng};
}
template <ml::Backend C>
bool same(const ml::TransformerEncoder<C>& a, const ml::TransformerEncoder<C>& b) {
  bool all = true;
  ml::zip_tensors(a, b, [&](const auto& x, const auto& y) {
    const auto p = x.span(), q = y.span();
    all = all && std::equal(p.begin(), p.end(), q.begin(), q.end());
  });
  return all;
}
/// Written with seed 1, read into a model of seed 2.
template <ml::Backend C>
void check_round_trip() {
  const TemporaryFolder folder;
  const auto model = encoder<C>(1);
  auto other = encoder<C>(2);
  ml::save_module(folder / "model.safetensors", model);
  CHECK_FALSE(same(other, model));
  ml::load_module(other, folder / "model.safetensors");
  CHECK(same(other, model));
}

}  // namespace

TEST_CASE("a module comes back with the bits of its numbers") {
  check_round_trip<B>();
  check_round_trip<ml::EigenBackend<double>>();
  check_round_trip<ml::Autodiff<B>>();
}

TEST_CASE("a module in half the space, for inference, and with metadata") {
  const TemporaryFolder folder;
  const auto path = folder / "model.safetensors";
  const auto model = encoder<B>(1);
  ml::save_module(path, model, ml::DType::F16, {{"data", "mine"}});
  const auto file = ml::SafetensorsFile::open(path);
  CHECK(file.tensor("layers.0.linear1.weight").dtype == ml::DType::F16);
  CHECK(file.metadata().at("data") == "mine");
  auto other = encoder<B>(2);
  ml::load_module(other, path, ml::LoadFor::inference);
  const ml::Sequences<B> x(tensors::normal<B, 2>({5, 8}, 3), ml::Offsets{2, 3});
  CHECK(tensors::distance(other(x).rows, model(x).rows) < 0.01);
}

TEST_CASE("a variable that is loaded is still the variable") {
  using A = ml::Autodiff<B>;
  const TemporaryFolder folder;
  ml::save_module(folder / "model.safetensors", encoder<A>(1));
  auto model = encoder<A>(2);
  ml::load_module(model, folder / "model.safetensors");
  const auto& weight = model.layers[0].linear1.weight;
  CHECK(ml::backward(ml::sum(ml::square(weight)))[weight].at(0, 0) == doctest::Approx(2 * weight.at(0, 0)));
}

TEST_CASE("a file that does not fit the module, or is not there") {
  const TemporaryFolder folder;
  const auto path = folder / "model.safetensors";
  ml::save_module(path, encoder<B>(1));
  auto wider = encoder<B>(2, 12);
  CHECK_ERROR(ml::load_module(wider, path), "[motionlang.io.407]");
  auto more = encoder<B>(2);
  more.layers.pop_back();
  CHECK_ERROR(ml::load_module(more, path), "[motionlang.io.406]");
  CHECK_ERROR(ml::load_module(more, folder / "none.safetensors"), "[motionlang.io.401]");
  CHECK_ERROR(ml::save_module(folder / "no folder" / "model.safetensors", more), "[motionlang.io.401]");
}
