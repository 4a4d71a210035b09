// The motions that a model remembers, in the file of its weights.
#include <motionlang/weights/motion_memory_file.hpp>

#include <doctest/doctest.h>

#include <filesystem>  // files that are not there
#include <limits>      // NaN

#include <motionlang/backend/eigen.hpp>
#include <motionlang/geometry/so3.hpp>
#include <motionlang/weights/safetensors_copy.hpp>

#include "../../support/check_error.hpp"
#include "../../support/small_model.hpp"
#include "../../support/synthetic_motion.hpp"
#include "../../support/temporary_folder.hpp"
#include "../../support/word_count_encoder.hpp"

namespace ml = motionlang;
using B = ml::EigenBackend<float>;
using Tensors = std::vector<ml::TensorView>;

namespace {

ml::MotionMemory memory() {
  return {counted::captions(),
          {synthetic::walk({.frames = 12, .fps = 20}), synthetic::walk({.frames = 9, .fps = 20, .turn = 1})},
          {{0, 1}, {2, 0}, {2, 1}}};
}
void save(const ml::FilePath& path) {
  const auto config = small::config();
  ml::save_stmc(path, small::model<B>(config), config, {{"license", "MIT"}});
}
auto stored(const ml::FilePath& path) {
  const auto file = ml::SafetensorsFile::open(path);
  return ml::stored_motion_memory(file, ml::stored_known_captions(file, counted::vectors), 20);
}

}  // namespace

TEST_CASE("what is written is read, to a ten thousandth of a radian") {
  const TemporaryFolder folder;
  save(folder / "a");
  CHECK(stored(folder / "a") == nullptr);
  ml::write_motion_memory(folder / "a", folder / "b", memory());
  const auto read = stored(folder / "b");
  REQUIRE(read != nullptr);
  CHECK(read->remembered() == memory().remembered());
  REQUIRE(read->motions().size() == 2);
  for (std::size_t m = 0; m < 2; ++m) {
    const ml::Motion &is = read->motions()[m], was = memory().motions()[m];
    REQUIRE(is.frames() == was.frames());
    for (std::size_t i = 0; i < is.local.size(); ++i)
      if (i % 24 < 22) CHECK(ml::distance(is.local[i], was.local[i]) < 1e-4);
    for (std::size_t f = 0; f < is.root.size(); ++f) CHECK(ml::norm(is.root[f] - was.root[f]) < 1e-6);
  }
  // The weights and their metadata stay, and a second memory replaces the first.
  ml::write_motion_memory(folder / "b", folder / "b", ml::MotionMemory(counted::captions(), {}, {}));
  CHECK(stored(folder / "b") == nullptr);
  CHECK(ml::SafetensorsFile::open(folder / "b").metadata().at("license") == "MIT");
  CHECK(ml::SafetensorsFile::open(folder / "b").tensors().size() ==
        ml::SafetensorsFile::open(folder / "a").tensors().size() + 4);
}

TEST_CASE("load_stmc has the memory, also from a copy of the weights in another type") {
  const TemporaryFolder folder;
  save(folder / "a");
  CHECK(ml::load_stmc<B>(folder / "a").memory == nullptr);
  ml::write_motion_memory(folder / "a", folder / "b", memory());
  const auto stmc = ml::load_stmc<B>(folder / "b");
  REQUIRE(stmc.memory != nullptr);
  for (const ml::DType type : {ml::DType::BF16, ml::DType::F32, ml::DType::I8}) {
    ml::write_safetensors_copy(folder / "c", ml::open_weights(folder / "b"), type);
    CHECK(ml::load_stmc<B>(folder / "c").memory->fingerprint() == stmc.memory->fingerprint());
  }
}

TEST_CASE("motions at another frame rate, and other captions for motions, are refused") {
  const TemporaryFolder folder;
  save(folder / "a");
  const ml::MotionMemory fast(counted::captions(), {synthetic::walk({.frames = 12, .fps = 30})}, {{0, 0}});
  CHECK_ERROR(ml::write_motion_memory(folder / "a", folder / "b", fast),
              "the model has 20 frames per second, the motions to remember 30");
  CHECK_FALSE(std::filesystem::exists(folder / "b"));
  ml::write_motion_memory(folder / "a", folder / "b", memory());
  const ml::KnownCaptions known = memory().captions();
  ml::replace_known_captions(folder / "b", known.with_tried({"walk far"}, {0.5}));
  CHECK(stored(folder / "b")->remembered() == memory().remembered());
  CHECK_ERROR(ml::replace_known_captions(folder / "b", known.with_captions({"run"}, {{1, true, ""}})),
              "[motionlang.config.102]");
}

TEST_CASE("a file whose memory does not fit is refused") {
  const TemporaryFolder folder;
  save(folder / "a");
  ml::write_motion_memory(folder / "a", folder / "b", memory());
  const auto file = ml::SafetensorsFile::open(folder / "b");
  const auto broken = [&](const std::string& name, const ml::TensorView* other) {
    Tensors tensors;
    for (const auto& t : file.tensors()) {
      if (t.name != "memory." + name)
        tensors.push_back(t);
      else if (other != nullptr)
        tensors.push_back(*other);
    }
    ml::write_safetensors(folder / "c", tensors, file.metadata());
    return stored(folder / "c");
  };
  CHECK_ERROR(broken("root", nullptr), "[motionlang.io.406]");
  CHECK_ERROR(broken("captions", nullptr), "[motionlang.io.406]");
  const std::vector<std::int32_t> early{12, 5}, late{12, 22};
  for (const auto* ends : {&early, &late}) {
    const auto view = ml::tensor_view("memory.ends", {2}, std::span<const std::int32_t>(*ends));
    CHECK_ERROR(broken("ends", &view), "a motion ends before frame");
  }
  const std::vector<float> root(42);
  const auto shorter = ml::tensor_view("memory.root", {14, 3}, std::span<const float>(root));
  CHECK_ERROR(broken("root", &shorter), "tensor 'memory.poses' is I16 (66, 21), not I16 (66, 14)");
  const auto narrow = ml::tensor_view("memory.root", {21, 2}, std::span<const float>(root));
  CHECK_ERROR(broken("root", &narrow), "tensor 'memory.root' is F32 (21, 2), not F32 (21, 3)");
  CHECK_ERROR(broken("poses", nullptr), "[motionlang.io.406]");
  std::vector<float> far(63);
  for (const float x : {std::numeric_limits<float>::quiet_NaN(), 1e38F}) {
    far[7] = x;
    const auto view = ml::tensor_view("memory.root", {21, 3}, std::span<const float>(far));
    CHECK_ERROR(broken("root", &view), "[motionlang.config.107]");
  }
  const std::vector<std::int32_t> few{12, 20};
  const auto left = ml::tensor_view("memory.ends", {2}, std::span<const std::int32_t>(few));
  CHECK_ERROR(broken("ends", &left), "the motions have 20 frames, 'memory.poses' has 21");
  const auto named = ml::tensor_view("memory.other", {2}, std::span<const std::int32_t>(few));
  CHECK_ERROR(broken("ends", &named), "[motionlang.io.406]");
  const std::vector<std::int16_t> of{0, 7};
  const auto missing = ml::tensor_view("memory.captions", {1, 2}, std::span<const std::int16_t>(of));
  CHECK_ERROR(broken("captions", &missing), "caption 0 has motion 7 of 2");
}
