// Files of weights as lines.
#include <doctest/doctest.h>

#include <motionlang/file/npz.hpp>
#include <motionlang/file/safetensors.hpp>
#include <motionlang/weights/describe_weights.hpp>
#include <motionlang/weights/module_file.hpp>

#include "../../support/temporary_folder.hpp"

namespace ml = motionlang;

TEST_CASE("weights are lines: what the file is, its values, its tensors") {
  const TemporaryFolder folder;
  const std::vector<float> values{1, 2, 3, 4, 5, 6};
  ml::TensorStore store;
  store.add("a.weight", {2, 3}, std::span<const float>(values), ml::DType::F32);
  ml::write_safetensors(folder / "w.safetensors", store.views(), {{"license", "MIT"}, {"config", "{\n}"}});
  const std::string path = (folder / "w.safetensors").string();
  const ml::WeightFile file = ml::open_weights(path);
  CHECK(ml::line_about_weights(file) == "1 tensor, 6 numbers, 0.0 MB, safetensors");
  CHECK(ml::lines_about_skipped(file).empty());
  const std::string text = ml::describe_weights(path);
  CHECK(text.starts_with(path + ": 1 tensor, 6 numbers, 0.0 MB, safetensors\n"));
  CHECK(text.find("\n  license                  MIT\n") != std::string::npos);
  CHECK(text.find("\n  config                   (2 lines)\n") != std::string::npos);
  CHECK(text.find("\n  a.weight                                                     F32   (2, 3)\n") !=
        std::string::npos);
}

TEST_CASE("the name of a file says that it holds weights, or its first bytes do") {
  const TemporaryFolder folder;
  ml::write_file(folder / "later.ckpt", std::string_view("any"));
  ml::write_file(folder / "notes.txt", std::string_view("walk # 0 # 1\n"));
  const std::vector<float> values{1};
  const std::vector<ml::NamedArray> arrays{{"a", ml::NpyArray::of(std::span<const float>(values), {1})}};
  ml::write_npz(folder / "arrays", arrays);
  CHECK(ml::holds_weights(folder / "later.ckpt"));
  CHECK(ml::holds_weights(folder / "arrays"));
  CHECK(ml::holds_weights(folder.path));
  CHECK(!ml::holds_weights(folder / "notes.txt"));
}
