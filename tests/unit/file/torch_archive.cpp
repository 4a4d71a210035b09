// Our reader of PyTorch's files finds the contents that our writer was given.
#include <motionlang/file/torch_archive.hpp>
#include <motionlang/file/torch_file.hpp>
#include <motionlang/file/zip.hpp>
#include <motionlang/weights/weight_file.hpp>

#include "../../support/check_error.hpp"

namespace ml = motionlang;

namespace {

const std::vector<float> numbers{1, -2, 0.5f, 4, 5, 6};

ml::TensorView view(const char* name, ml::DType type, ml::FileShape shape, std::span<const std::byte> bytes) {
  return {name, type, shape, bytes};
}

}  // namespace

TEST_CASE("dictionaries, numbers, texts and tensors come back by their keys") {
  ml::TorchArchive archive;
  archive.begin("encoder");
  archive.tensor("weight", view("weight", ml::DType::F32, {2, 3}, std::as_bytes(std::span(numbers))));
  archive.tensor("bias", view("bias", ml::DType::F32, {6}, std::as_bytes(std::span(numbers))));
  archive.end();
  archive.number("epoch", 300);
  archive.number("before", -7);
  archive.text("license", "MIT");
  const auto bytes = archive.finish();
  const auto file = ml::WeightFile::from_bytes(bytes, "a.tar", {}, {.path = ""});
  CHECK(file.format() == "torch zip");
  REQUIRE(file.tensors().size() == 2);
  CHECK(file.tensor("encoder.weight").shape == ml::FileShape{2, 3});
  CHECK(ml::values_of<float>(file.tensor("encoder.weight")) == numbers);
  CHECK(ml::values_of<float>(file.tensor("encoder.bias")) == numbers);
  for (const auto& [key, value] : {std::pair("epoch", "300"), {"before", "-7"}, {"license", "MIT"}}) {
    REQUIRE(file.value(key) != nullptr);
    CHECK(ml::to_string(*file.value(key)) == value);
  }
  CHECK(file.skipped().empty());
}

TEST_CASE("a tensor can be the whole file; other types are refused") {
  const auto bytes = ml::TorchArchive::of_tensor(view("mean", ml::DType::F32, {6}, std::as_bytes(std::span(numbers))));
  const auto file = ml::WeightFile::from_bytes(bytes, "mean.pt");
  CHECK(ml::values_of<float>(file.tensor("array")) == numbers);
  ml::TorchArchive archive;
  CHECK_ERROR(archive.tensor("ids", view("ids", ml::DType::I64, {3}, std::as_bytes(std::span(numbers)))),
              "[motionlang.config.101] TorchArchive: 'ids' of type I64");
  for (const auto& [shape, size] :
       {std::pair(ml::FileShape{2, 1 << 30}, "2147483648"), {ml::FileShape{0, ml::Index{3} << 32}, "12884901888"}})
    CHECK_ERROR(
        archive.tensor("huge", view("huge", ml::DType::F32, shape, {})),
        ml::concat_text("[motionlang.config.101] TorchArchive: 'huge' has the size ", size, ", above 2147483647")
            .c_str());
}
