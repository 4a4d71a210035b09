// Weights of whatever format as one safetensors file.
#include <doctest/doctest.h>

#include <motionlang/file/npz.hpp>
#include <motionlang/file/tensor_set.hpp>
#include <motionlang/weights/safetensors_copy.hpp>

#include "../../support/check_error.hpp"
#include "../../support/temporary_folder.hpp"

namespace ml = motionlang;

TEST_CASE("a copy has the tensors, rounded only if asked to, and integers as they are") {
  const TemporaryFolder folder;
  const std::vector<float> values{1, 0.1f};
  const std::vector<std::int64_t> numbers{7};
  const std::vector<ml::NamedArray> arrays{{"a", ml::NpyArray::of(std::span<const float>(values), {2})},
                                           {"n", ml::NpyArray::of(std::span<const std::int64_t>(numbers), {1})}};
  ml::write_npz(folder / "w.npz", arrays);
  const auto file = ml::open_weights(folder / "w.npz");
  ml::write_safetensors_copy(folder / "same.safetensors", file);
  const auto same = ml::open_weights(folder / "same.safetensors");
  CHECK(ml::tensors_checksum(same.tensors()) == ml::tensors_checksum(file.tensors()));
  CHECK(ml::values_of<float>(same.tensor("a")) == values);

  ml::write_safetensors_copy(folder / "half.safetensors", file, ml::DType::F16);
  const auto half = ml::open_weights(folder / "half.safetensors");
  CHECK(half.tensor("a").dtype == ml::DType::F16);
  CHECK(half.tensor("n").dtype == ml::DType::I64);
  CHECK(ml::values_of<float>(half.tensor("a"))[1] == doctest::Approx(0.1).epsilon(1e-3));
  CHECK(ml::tensors_checksum(half.tensors()) != ml::tensors_checksum(file.tensors()));
  CHECK_ERROR(ml::write_safetensors_copy("/nowhere/w.safetensors", file), "[motionlang.io.401]");
}
