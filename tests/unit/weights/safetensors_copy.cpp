// Weights of whatever format as one safetensors file.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <optional>

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

TEST_CASE("matrices of 8 bits become floating-point numbers again, without their scales, or stay as they are") {
  const TemporaryFolder folder;
  std::vector<float> values(64 * 80);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = 1e-3F * static_cast<float>(i % 37) - 0.01F;
  for (std::size_t i = 0; i < 64; ++i) values[i] *= 1e-3F;  // a group with a small scale
  const std::vector<ml::NamedArray> arrays{{"w", ml::NpyArray::of(std::span<const float>(values), {64, 80})}};
  ml::write_npz(folder / "w.npz", arrays);
  ml::write_safetensors_copy(folder / "small", ml::open_weights(folder / "w.npz"), ml::DType::I8);
  const auto small = ml::open_weights(folder / "small");
  REQUIRE(small.tensor("w").dtype == ml::DType::I8);

  for (const ml::DType type : {ml::DType::F32, ml::DType::F16, ml::DType::BF16}) {
    ml::write_safetensors_copy(folder / "wide", small, type);
    const auto wide = ml::open_weights(folder / "wide");
    CHECK(wide.tensors().size() == 1);
    CHECK(wide.tensor("w").dtype == type);
    const auto read = ml::values_of<float>(wide.tensor("w"));
    double most = 0;
    for (std::size_t i = 0; i < read.size(); ++i)
      most = std::max(most, std::abs(static_cast<double>(read[i]) - static_cast<double>(values[i])));
    CHECK(most < (type == ml::DType::BF16 ? 3e-4 : 2e-4));
    if (type != ml::DType::F32) continue;
    ml::write_safetensors_copy(folder / "again", wide, ml::DType::I8);  // the same bits
    CHECK(ml::tensors_checksum(ml::open_weights(folder / "again").tensors()) == ml::tensors_checksum(small.tensors()));
  }
  for (const std::optional<ml::DType> type : {std::optional<ml::DType>(), std::optional(ml::DType::I8)}) {
    ml::write_safetensors_copy(folder / "copy", small, type);
    CHECK(ml::tensors_checksum(ml::open_weights(folder / "copy").tensors()) == ml::tensors_checksum(small.tensors()));
  }
}
