// Caches of embeddings: what is written is read, in the layout of TMR and STMC; encoders over a cache; broken files.
#include <doctest/doctest.h>

#include <motionlang/backend/reference.hpp>
#include <motionlang/file/file.hpp>
#include <motionlang/file/json.hpp>
#include <motionlang/file/npy.hpp>
#include <motionlang/weights/embedding_cache.hpp>

#include "../../support/check_error.hpp"
#include "../../support/temporary_folder.hpp"
#include "../../support/tensors.hpp"

namespace ml = motionlang;
using B = ml::ReferenceBackend<double>;
using ml::Index;

namespace {

/// A row for every letter: its place in the alphabet and the length of the text. Counts the texts that it is asked for.
struct CountingEncoder {
  Index* asked;
  template <ml::Backend C>
  ml::TextFeatures<C> encode(std::span<const std::string> texts) const {
    std::vector<typename C::scalar> values;
    std::vector<Index> lengths;
    for (const std::string& t : texts) {
      for (char c : "^" + t)
        values.insert(values.end(), {static_cast<typename C::scalar>(c), static_cast<typename C::scalar>(t.size())});
      lengths.push_back(std::ssize(t) + 1);
    }
    *asked += std::ssize(texts);
    return {{ml::Tensor<C, 2>::from(values, {ml::Offsets(lengths).rows(), 2}), ml::Offsets(lengths)}};
  }
};
static_assert(ml::TextEncoder<CountingEncoder, B> && ml::TextEncoder<ml::EmbeddingCache, B>);

const std::vector<std::string> texts{"walk", "", "Walk.", "caf\u00e9 \"quoted\"\n"};

ml::EmbeddingCache cache_of(const std::vector<std::string>& list) {
  Index asked = 0;
  ml::EmbeddingCache cache(2);
  cache.add<B>(CountingEncoder{&asked}, list);
  return cache;
}
bool same(const ml::EmbeddingCache& a, const ml::EmbeddingCache& b, const std::string& text) {
  const auto x = a.find(text), y = b.find(text);
  return std::equal(x.begin(), x.end(), y.begin(), y.end());
}

}  // namespace

TEST_CASE("written and read: tokens with slices, in a sub-folder of the model's name") {
  const TemporaryFolder folder;
  const auto cache = cache_of(texts);
  cache.write((folder / "text_embeddings").string(), "ViT-B/32");
  const auto read = ml::EmbeddingCache::read((folder / "text_embeddings").string(), "ViT-B/32");
  CHECK(read.count() == 4);
  CHECK(read.width() == 2);
  for (const std::string& t : texts) CHECK(same(read, cache, t));
  CHECK(read.find("").size() == 2);
  CHECK_FALSE(read.contains("walk."));
  CHECK_ERROR(read.find("walk."), "[motionlang.config.103]");

  const std::string base = (folder / "text_embeddings/ViT-B/32").string();
  const auto rows = ml::read_npy(base + ".npy"), slices = ml::read_npy(base + "_slice.npy");
  CHECK(rows.type() == "<f4");
  CHECK(rows.shape == std::vector<Index>{5 + 1 + 6 + 16, 2});
  CHECK(slices.type() == "<i8");
  CHECK(slices.to<Index>() == std::vector<Index>{0, 5, 5, 6, 6, 12, 12, 28});
  CHECK(ml::read_json(base + "_index.json") == nlohmann::json{{"walk", 0}, {"", 1}, {"Walk.", 2}, {texts[3], 3}});
  CHECK(std::distance(std::filesystem::directory_iterator(folder / "text_embeddings/ViT-B"), {}) ==
        3);  // nothing temporary is left
}

TEST_CASE("a cache that was read grows and replaces its files") {
  const TemporaryFolder folder;
  cache_of(texts).write(folder.path.string(), "m");
  auto read = ml::EmbeddingCache::read(folder.path.string(), "m");
  const std::vector<float> more{1, 2, 3, 4};
  read.add("more", more);
  CHECK_ERROR(read.add("more", more), "[motionlang.config.102]");
  CHECK_ERROR(read.add("odd", std::span(more).first(3)), "[motionlang.shape.204]");
  read.write(folder.path.string(), "m");
  const auto again = ml::EmbeddingCache::read(folder.path.string(), "m");
  CHECK(again.count() == 5);
  CHECK(again.find("more").size() == 4);
  for (const std::string& t : texts) CHECK(same(again, cache_of(texts), t));
}

TEST_CASE("a text that is not UTF-8 is refused before it is encoded; what is written already stays") {
  const TemporaryFolder folder;
  auto cache = cache_of(texts);
  cache.write(folder.path.string(), "m");
  const std::vector<std::string> latin1{"run", "caf\xe9"};
  CHECK_ERROR(cache.add(latin1[1], std::vector<float>{1, 2}), "[motionlang.io.403]");
  Index asked = 0;
  CHECK_ERROR(cache.add<B>(CountingEncoder{&asked}, latin1), "[motionlang.io.403]");
  CHECK(asked == 0);
  CHECK(cache.count() == 4);
  const auto read = ml::EmbeddingCache::read(folder.path.string(), "m");
  for (const std::string& t : texts) CHECK(same(read, cache, t));
}

TEST_CASE("a folder without a name is the current one, as parent_path() of a bare name has it") {
  const TemporaryFolder folder;
  const auto before = std::filesystem::current_path();
  std::filesystem::current_path(folder.path);
  cache_of(texts).write("", "sizes/m");
  const auto read = ml::EmbeddingCache::read("", "sizes/m");
  std::filesystem::current_path(before);
  CHECK(std::filesystem::exists(folder / "sizes/m.npy"));
  for (const std::string& t : texts) CHECK(same(read, cache_of(texts), t));
}

TEST_CASE("one vector for each text needs no slices; other types of numbers are converted") {
  const TemporaryFolder folder;
  ml::EmbeddingCache cache(3);
  cache.add("a", std::vector<float>{1, 2, 3});
  cache.add("b", std::vector<float>{4, 5, 6});
  cache.write(folder.path.string(), "m", /*with_slices=*/false);
  CHECK_FALSE(std::filesystem::exists(folder / "m_slice.npy"));
  CHECK(same(ml::EmbeddingCache::read(folder.path.string(), "m"), cache, "b"));
  const std::vector<double> wide{1, 2, 3, 4, 5, 6};
  ml::write_npy((folder / "m.npy").string(), ml::NpyArray::of(std::span<const double>(wide), {2, 3}));
  CHECK(same(ml::EmbeddingCache::read(folder.path.string(), "m"), cache, "b"));
  CHECK_ERROR(cache_of(texts).write(folder.path.string(), "m", false), "[motionlang.io.403]");
  cache_of({"x", "y"}).write(folder.path.string(), "m");
  cache.write(folder.path.string(), "m", /*with_slices=*/false);  // the slices of x and y go
  CHECK(same(ml::EmbeddingCache::read(folder.path.string(), "m"), cache, "b"));
}

TEST_CASE("the cache as an encoder; only unknown texts are encoded") {
  Index asked = 0;
  const CountingEncoder encoder{&asked};
  const ml::CachedEncoder<CountingEncoder> cached{cache_of({"walk", ""}), encoder};
  static_assert(ml::TextEncoder<ml::CachedEncoder<CountingEncoder>, B>);
  const std::vector<std::string> wanted{"run", "walk", "run", ""};
  const auto got = cached.encode<B>(wanted);
  CHECK(asked == 1);
  const auto want = encoder.encode<B>(wanted);
  CHECK(got.tokens.offsets == want.tokens.offsets);
  CHECK(tensors::same_bits(got.tokens.rows, want.tokens.rows));
  CHECK_ERROR(cached.cache.encode<B>(wanted), "[motionlang.config.103]");
  ml::EmbeddingCache narrow(1);  // rows of 2 are not two rows of 1
  CHECK_ERROR(narrow.add<B>(encoder, wanted), "[motionlang.shape.204]");
}

TEST_CASE("files that do not fit each other are refused") {
  const TemporaryFolder folder;
  const auto damaged = [&](auto damage) {
    cache_of(texts).write(folder.path.string(), "m");
    damage();
    return ml::EmbeddingCache::read(folder.path.string(), "m");
  };
  const auto slices = [&](std::vector<std::int64_t> bounds) {
    return [&, bounds] {
      ml::write_npy((folder / "m_slice.npy").string(),
                    ml::NpyArray::of(std::span<const std::int64_t>(bounds), {std::ssize(bounds) / 2, 2}));
    };
  };
  CHECK_ERROR(damaged(slices({0, 5, 5, 6, 6, 12, 12, 29})), "[motionlang.io.403]");
  CHECK_ERROR(damaged(slices({0, 5, 5, 6, 12, 6, 12, 28})), "[motionlang.io.403]");
  CHECK_ERROR(damaged(slices({0, 5, 5, 6})), "[motionlang.io.403]");
  CHECK_ERROR(damaged([&] { ml::write_file((folder / "m_index.json").string(), std::string_view(R"({"a": 4})")); }),
              "[motionlang.io.403]");
  CHECK_ERROR(damaged([&] { ml::write_file((folder / "m_index.json").string(), std::string_view(R"({"a": 0})")); }),
              "[motionlang.io.403]");
  const std::string_view repeated = R"({"a": 0, "b": 1, "c": 2, "d": 2})";
  CHECK_ERROR(damaged([&] { ml::write_file((folder / "m_index.json").string(), repeated); }), "which another text has");
  CHECK_ERROR(damaged([&] { std::filesystem::remove(folder / "m.npy"); }), "[motionlang.io.401]");
}
