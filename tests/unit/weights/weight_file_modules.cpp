// Modules filled from files of weights that are not safetensors.
#include <motionlang/backend/reference.hpp>
#include <motionlang/nn/linear.hpp>
#include <motionlang/weights/module_file.hpp>
#include <motionlang/weights/weight_file.hpp>

#include "../../support/check_error.hpp"
#include "../../support/tests_folder.hpp"

namespace ml = motionlang;
using B = ml::ReferenceBackend<float>;
using ml::DType;

namespace {

std::filesystem::path golden(const std::string& name) {
  return std::filesystem::path(tests_folder()) / "golden/cases/containers" / name;
}
ml::Linear<B> linear(ml::Index in, ml::Index out) {
  ml::Philox rng{1};
  return {in, out, rng};
}

}  // namespace

TEST_CASE("a module from a file of PyTorch, whose numbers it does not copy") {
  const std::pair<const char*, const char*> files[] = {{"state_dict.pt", "state_dict_zip.safetensors"},
                                                       {"state_dict_legacy.pt", "state_dict_legacy.safetensors"}};
  for (const auto& [name, expected] : files) {
    const auto file = ml::open_weights(golden(name));
    auto module = linear(3, 5);
    ml::load_module(module, file, "proj.");
    const auto want = ml::values_of<float>(ml::SafetensorsFile::open(golden(expected)).tensor("out/proj.weight"));
    const auto got = module.weight.span();
    CHECK(std::equal(got.begin(), got.end(), want.begin(), want.end()));
    const ml::TensorView& view = file.tensor("proj.weight");
    if (ml::direct<float>(view)) CHECK(static_cast<const void*>(got.data()) == view.bytes.data());
  }
  CHECK(ml::direct<float>(ml::open_weights(golden("state_dict.pt")).tensor("proj.weight")).has_value());
}

TEST_CASE("a module that does not fit: names of both sides, shapes") {
  auto module = linear(3, 5);
  CHECK_ERROR(ml::load_module(module, ml::open_weights(golden("lightning.ckpt")), "motionencoder."),
              "2 tensors are missing, 3 are not expected:");
  CHECK_ERROR(ml::load_module(module, ml::open_weights(golden("lightning.ckpt")), "motiondecoder.final_layer."),
              "[motionlang.io.407]");
}

TEST_CASE("a number that would become infinite is not stored; infinity is") {
  const auto stored = [](double value, DType dtype) {
    ml::TensorStore store;
    const double values[] = {1, value};
    store.add("w", {2}, std::span<const double>(values), dtype);
    return ml::values_of<double>(store.views().front()).at(1);
  };
  CHECK(stored(1e300, DType::F64) == 1e300);
  CHECK(stored(0x1.FFFFFEp127, DType::F32) == 0x1.FFFFFEp127);
  CHECK(stored(-0x1.FEp127, DType::BF16) == -0x1.FEp127);
  CHECK(stored(65519, DType::F16) == 65504);
  CHECK_ERROR(stored(1e39, DType::F32),
              "[motionlang.numeric.301] TensorStore: number 1 of 'w' is 1e+39, too large for F32");
  CHECK_ERROR(stored(-0x1.FFp127, DType::BF16), "too large for BF16");
  CHECK_ERROR(stored(0x1.FEFFFFFFFFFp127, DType::BF16), "too large for BF16");
  CHECK_ERROR(stored(65520, DType::F16), "too large for F16");
  constexpr double infinite = std::numeric_limits<double>::infinity();
  CHECK(stored(-infinite, DType::F32) == -infinite);
  CHECK(stored(infinite, DType::BF16) == infinite);
  CHECK_ERROR(stored(infinite, DType::F16), "is inf, too large for F16");
}
