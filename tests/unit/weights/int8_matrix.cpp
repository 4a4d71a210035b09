// Matrices of weights in whole numbers of 8 bits.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include <motionlang/backend/autodiff.hpp>
#include <motionlang/backend/eigen.hpp>
#include <motionlang/nn/transformer_encoder.hpp>
#include <motionlang/weights/int8_matrix.hpp>
#include <motionlang/weights/module_file.hpp>
#include <motionlang/weights/safetensors_copy.hpp>

#include "../../support/check_error.hpp"
#include "../../support/temporary_folder.hpp"

namespace ml = motionlang;
using B = ml::EigenBackend<float>;

namespace {

/// Rows of 70 columns, so that the second group has six; each row is ten times smaller than the one before.
std::vector<float> numbers(ml::Index rows) {
  std::vector<float> out;
  for (ml::Index row = 0; row < rows; ++row) {
    for (int column = 0; column < 70; ++column)
      out.push_back(std::pow(10.0f, static_cast<float>(-row)) * std::sin(static_cast<float>(column * column + row)));
  }
  return out;
}
template <ml::Backend C>
ml::TransformerEncoder<C> encoder(std::uint64_t seed) {
  ml::Philox rng{.seed = seed};
  return {{.d_model = 72, .heads = 2, .d_ff = 96, .layers = 1}, rng};
}
template <ml::Backend C>
std::vector<float> all_values(const ml::TransformerEncoder<C>& model) {
  std::vector<float> out;
  for (const auto& t : ml::tensors_of(model))
    for (const auto x : t.span()) out.push_back(static_cast<float>(x));
  return out;
}
template <ml::Backend C>
std::vector<float> loaded(const std::string& file) {
  auto model = encoder<C>(2);
  ml::load_module(model, ml::FilePath(file));
  return all_values(model);
}

}  // namespace

TEST_CASE("a value is at most half a scale from its original, or 2^-15, and zeros stay") {
  const ml::Index rows = 6;
  auto values = numbers(rows + 1);
  std::fill(values.end() - 70, values.end(), 0.0f);
  const ml::Int8Matrix m = ml::int8_matrix(values, rows + 1, 70, "w");
  REQUIRE(m.codes.size() == values.size());
  REQUIRE(m.scales.size() == 14);
  bool near = true, full = false;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const float scale = ml::half_to_float(m.scales[i / 70 * 2 + i % 70 / 64]);
    near = near && std::abs(static_cast<float>(m.codes[i]) * scale - values[i]) <= 0.5001f * std::max(scale, 0x1p-14f);
    full = full || std::abs(m.codes[i]) == 127;
  }
  CHECK(near);
  CHECK(full);
  CHECK(m.scales.back() == 0);
  CHECK(m.codes.back() == 0);
  CHECK_ERROR(ml::int8_matrix(values, 2, 2, "w"), "[motionlang.shape.205]");
  values[3] = std::nanf("");
  CHECK_ERROR(ml::int8_matrix(values, rows + 1, 70, "w"), "'w' has nan in row 0");
  values[3] = 1e7f;
  CHECK_ERROR(ml::int8_matrix(values, rows + 1, 70, "w"), "[motionlang.numeric.301]");
}

TEST_CASE("a module is loaded from such a file like from any other") {
  const TemporaryFolder folder;
  const std::string wide = folder / "wide.safetensors", packed = folder / "packed.safetensors",
                    again = folder / "again.safetensors";
  const auto model = encoder<B>(1);
  ml::save_module(wide, model, ml::DType::F16);
  ml::write_safetensors_copy(packed, ml::open_weights(wide), ml::DType::I8);
  const auto file = ml::SafetensorsFile::open(packed);
  const std::string first = "layers.0.linear1.weight";
  CHECK(file.tensor(first).dtype == ml::DType::I8);
  CHECK(file.tensor(first + ".scales").shape == ml::FileShape{96, 2});
  CHECK(file.tensor("layers.0.linear1.bias").dtype == ml::DType::F16);
  CHECK(std::filesystem::file_size(packed) < 0.65 * static_cast<double>(std::filesystem::file_size(wide)));

  const auto original = all_values(model), values = loaded<B>(packed);
  REQUIRE(values.size() == original.size());
  double wrong = 0, size = 0;
  for (std::size_t i = 0; i < values.size(); ++i)
    wrong += std::pow(values[i] - original[i], 2), size += std::pow(original[i], 2);
  CHECK(std::sqrt(wrong / size) > 1e-5);
  CHECK(std::sqrt(wrong / size) < 0.006);
  CHECK(loaded<ml::EigenBackend<double>>(packed) == values);
  CHECK(loaded<ml::Autodiff<B>>(packed) == values);

  auto ready = encoder<B>(2);
  ml::load_module(ready, file, "", ml::LoadFor::inference);
  CHECK(all_values(ready) == values);

  // A copy in wide numbers has the same values, and packed again it has the same bits.
  ml::save_module(wide, ready);
  ml::write_safetensors_copy(again, ml::open_weights(wide), ml::DType::I8);
  CHECK(loaded<B>(again) == values);
}

TEST_CASE("scales that do not fit are refused") {
  const TemporaryFolder folder;
  const std::vector<std::int8_t> codes(4);
  const std::vector<float> wide(2);
  const std::vector<ml::TensorView> tensors{ml::tensor_view("w", {2, 2}, std::span<const std::int8_t>(codes)),
                                            ml::tensor_view("w.scales", {2, 1}, std::span<const float>(wide))};
  ml::write_safetensors(folder / "w.safetensors", tensors);
  const auto file = ml::SafetensorsFile::open(folder / "w.safetensors");
  CHECK_ERROR(ml::int8_scales_of(file, file.tensor("w")), "the scales of 'w' are F16 (2, 1)");
  CHECK(ml::int8_scales_of(file, file.tensor("w.scales")) == nullptr);
}
