// Embeddings of many texts, batch by batch.
#include <doctest/doctest.h>

#include <motionlang/backend/reference.hpp>
#include <motionlang/file/file.hpp>
#include <motionlang/weights/embed_texts.hpp>

#include "../../support/check_error.hpp"
#include "../../support/temporary_folder.hpp"

namespace ml = motionlang;
using B = ml::ReferenceBackend<float>;

namespace {

/// A row for each text: its length and its first letter.
struct LengthEncoder {
  int* calls;

  template <ml::Backend>
  ml::TextFeatures<B> encode(std::span<const std::string> texts) const {
    ++*calls;
    std::vector<float> values;
    for (const std::string& t : texts) {
      values.push_back(static_cast<float>(t.size()));
      values.push_back(t.empty() ? 0 : static_cast<float>(t.front()));
    }
    const ml::Index n = std::ssize(texts);
    return {{ml::Tensor<B, 2>::from(values, {n, 2}), ml::Offsets::equal(n, 1)}};
  }
};

}  // namespace

TEST_CASE("each different text is embedded once, whatever the batch is") {
  int calls = 0;
  const std::vector<std::string> texts{"", "walk", "sit", "walk", "jump up"};
  ml::Index last = 0;
  const auto progress = [&](ml::Index done, ml::Index total) {
    last = done;
    return total == 5;
  };
  const auto cache = ml::embed_texts<B>(LengthEncoder{&calls}, texts, 2, progress);
  CHECK(calls == 4);  // for the width, and three batches
  CHECK(last == 5);
  CHECK(cache.count() == 4);
  CHECK(cache.width() == 2);
  CHECK(cache.find("walk")[0] == 4);
  CHECK(cache.find("jump up")[1] == 'j');
  CHECK(ml::embed_texts<B>(LengthEncoder{&calls}, {}).count() == 0);
  const auto stop = [](ml::Index, ml::Index) { return false; };
  CHECK_THROWS_AS(ml::embed_texts<B>(LengthEncoder{&calls}, texts, 2, stop), ml::cancelled);
}

TEST_CASE("texts are those of an annotation file, or lines") {
  const TemporaryFolder folder;
  ml::write_file(folder / "lines.txt", std::string_view("walk forward\n  \n\nsit down"));
  CHECK(ml::texts_to_embed(folder / "lines.txt") == std::vector<std::string>{"walk forward", "sit down"});
  ml::write_file(folder / "annotations.json",
                 std::string_view(R"({"000001": {"path": "a", "duration": 2, "annotations": [
      {"seg_id": "0", "text": "wave", "start": 0, "end": 2}, {"seg_id": "1", "text": "turn", "start": 0, "end": 1}]}})"));
  CHECK(ml::texts_to_embed(folder / "annotations.json") == std::vector<std::string>{"wave", "turn"});
  CHECK_ERROR(ml::texts_to_embed(folder / "nowhere.txt"), "[motionlang.io.401]");
}
