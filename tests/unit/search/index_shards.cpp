// Folders of shards: the answers are those of one index, also after updates and from parts. Shards that are missing,
// cut off, changed or of another model are refused.
#include <doctest/doctest.h>

#include <map>

#include <motionlang/core/rng.hpp>
#include <motionlang/search/index_shards.hpp>
#include <motionlang/search/index_tables.hpp>

#include "../../support/check_error.hpp"
#include "../../support/indexed_motions.hpp"
#include "../../support/temporary_folder.hpp"
#include "../../support/threads.hpp"

namespace ml = motionlang;
namespace fs = std::filesystem;
using ml::Index;

namespace {

constexpr Index width = 40, shard_bytes = Index{64} << 10;

ml::IndexModel model() {
  return {.id = "0123456789abcdef", .path = "models/m", .width = width, .fps = 20, .windows = {20}, .stride = 5};
}

/// Clips of random vectors, every third of them with the vectors of the one before.
std::vector<ml::EncodedClip> random_clips(Index count, std::uint64_t seed = 1) {
  ml::Philox rng{.seed = seed};
  std::vector<ml::EncodedClip> out;
  for (Index i = 0; i < count; ++i) {
    ml::EncodedClip c{.clip = {.path = "/clips/" + std::to_string(seed) + "-" + std::to_string(i / 2) + ".bvh",
                               .name = i % 2 == 1 ? "second \"ä\"" : "",
                               .start = 0.5,
                               .end = 12,
                               .fps = 30,
                               .frames = 345,
                               .license = "CC0"},
                      .vector = std::vector<float>(static_cast<std::size_t>(width))};
    rng.normal(std::span(c.vector));
    for (Index m = 0; m < i % 9; ++m) c.moments.push_back({5 * m, 20});
    c.moment_vectors.resize(c.moments.size() * static_cast<std::size_t>(width));
    rng.normal(std::span(c.moment_vectors));
    for (Index n = 0; n < i % 4; ++n) c.clip.captions.push_back("caption " + std::to_string(n));
    c.caption_vectors.resize(c.clip.captions.size() * static_cast<std::size_t>(width));
    rng.normal(std::span(c.caption_vectors));
    if (i % 3 == 2) {
      const auto clip = c.clip;
      c = out.back(), c.clip = clip, c.clip.captions = out.back().clip.captions;
    }
    out.push_back(std::move(c));
  }
  return out;
}

ml::MotionIndex flat_index(const std::vector<ml::EncodedClip>& clips) {
  ml::MotionIndex out(model());
  for (const auto& c : clips) out.add(c);
  return out;
}

void check_same(const ml::MotionIndex& a, const ml::MotionIndex& b) {
  CHECK(a.model() == b.model());
  CHECK(std::ranges::equal(a.clips(), b.clips()));
  CHECK(std::ranges::equal(a.moments(), b.moments()));
  CHECK(std::ranges::equal(a.caption_clips(), b.caption_clips()));
  CHECK(std::ranges::equal(a.clip_rows(), b.clip_rows()));
  CHECK(std::ranges::equal(a.moment_rows(), b.moment_rows()));
  CHECK(std::ranges::equal(a.caption_rows(), b.caption_rows()));
}

/// The folder has what the index has, and finds what it finds.
void check_as(const fs::path& folder, const ml::MotionIndex& flat) {
  const auto shards = ml::IndexShards::open(folder);
  check_same(shards->whole(), flat);
  shards->check();
  const ml::TablesOfIndex tables(flat);
  REQUIRE(shards->clip_count() == tables.clip_count());
  REQUIRE(shards->moment_count() == tables.moment_count());
  REQUIRE(shards->caption_count() == tables.caption_count());
  for (Index i = 0; i < tables.clip_count(); ++i) CHECK(shards->clip(i) == tables.clip(i));
  for (Index i = 0; i < tables.moment_count(); ++i) CHECK(shards->moment(i) == tables.moment(i));
  for (Index i = 0; i < tables.caption_count(); ++i) CHECK(shards->clip_of_caption(i) == tables.clip_of_caption(i));

  std::vector<float> queries(static_cast<std::size_t>(20 * width));
  ml::Philox{.seed = 9}.normal(std::span(queries));
  const std::map<ml::SearchFor, std::span<const float>> rows{{ml::SearchFor::clips, flat.clip_rows()},
                                                             {ml::SearchFor::moments, flat.moment_rows()},
                                                             {ml::SearchFor::captions, flat.caption_rows()}};
  for (const auto& [what, vectors] : rows) {
    const ml::VectorScan scan(vectors, width);
    const auto whole = shards->vectors(what);
    CHECK(whole->count() == scan.count());
    CHECK(whole->width() == width);
    for (const Index k : {0, 1, 10, 300, 100'000}) {
      const auto right = scan.search(queries, k);
      for (const int threads : {1, 3}) {
        const Threads set(threads);
        CHECK(whole->search(queries, k) == right);
        CHECK(whole->search(std::span(queries).first(width), k)[0] == right[0]);
      }
      for (const Index parts : {2, 3, 50}) {  // merged as processes merge them
        ml::NearestK best(k);
        for (Index part = 0; part < parts && k > 0; ++part) {
          const auto of_part = shards->vectors(what, part, parts)->search(std::span(queries).first(width), k);
          for (const auto& n : of_part[0]) best.offer(n);
        }
        CHECK(best.take() == right[0]);
      }
    }
  }
  const auto search = ml::open_motion_search(shards);
  const ml::MotionSearch wanted(flat);
  for (const Index k : {1, 10, 100}) {
    const auto q = std::span(queries).first(width);
    CHECK(search.clips(q, k) == wanted.clips(q, k));
    CHECK(search.moments(q, k) == wanted.moments(q, k));
    CHECK(search.captions(q, k) == wanted.captions(q, k));
  }
}

/// A folder of shards.
struct Shards : TemporaryFolder {
  std::vector<ml::EncodedClip> clips = random_clips(400);
  fs::path folder = path / "moves.shards";

  Shards() {
    ml::ShardStore store(folder, model(), shard_bytes);
    for (const auto& c : clips) store.add(c);
    store.write();
  }
  fs::path shard(int number) const { return folder / ("shard-0000" + std::to_string(number) + ".index"); }
  /// Replaces a text of a file by another one of the same length, at every place.
  static void patch(const fs::path& file, const std::string& from, const std::string& to) {
    std::string bytes = ml::read_file(file);
    REQUIRE(from.size() == to.size());
    REQUIRE(bytes.find(from) != bytes.npos);
    for (std::size_t at = 0; (at = bytes.find(from, at)) != bytes.npos; at += to.size())
      bytes.replace(at, to.size(), to);
    ml::write_file(file, bytes);
  }
  /// The values of a tensor of a shard.
  template <class T>
  static std::vector<T> peek(const fs::path& file, const std::string& tensor) {
    return ml::values_of<T>(ml::SafetensorsFile::open(file).tensor(tensor));
  }
  /// Gives a changed shard the right checksum, in the list, too.
  void reseal(const fs::path& file) const {
    const auto [before, now] = [&] {
      const auto opened = ml::SafetensorsFile::open(file);
      return std::pair(opened.metadata().at("checksum"), ml::tensors_checksum(opened.tensors()));
    }();
    REQUIRE(before != now);
    patch(file, before, now), patch(folder / "shards.json", before, now);
  }
  /// Writes into a tensor of a shard.
  template <class T>
  static void poke(const fs::path& file, const std::string& tensor, std::size_t at, T value) {
    std::string bytes = ml::read_file(file);
    const auto opened = ml::SafetensorsFile::from_bytes(std::as_bytes(std::span(bytes)));
    const auto place = opened.tensor(tensor).bytes.data() - std::as_bytes(std::span(bytes)).data();
    std::memcpy(bytes.data() + place + static_cast<std::ptrdiff_t>(at * sizeof(T)), &value, sizeof(T));
    ml::write_file(file, bytes);
  }
};

}  // namespace

TEST_CASE("shards: several files of the stated size, each an index, together what one index is and finds") {
  const Shards s;
  CHECK(ml::is_shard_folder(s.folder));
  CHECK_FALSE(ml::is_shard_folder(s.path));
  const auto list = ml::read_shard_list(s.folder);
  CHECK(list.shards.size() > 5);
  Index clips = 0;
  for (const auto& e : list.shards) {
    CHECK(e.bytes <= shard_bytes);
    if (&e != &list.shards.back()) CHECK(e.bytes > shard_bytes / 2);
    clips += ml::read_motion_index(s.folder / e.file).count();
  }
  CHECK(clips == 400);
  check_as(s.folder, flat_index(s.clips));
}

TEST_CASE("shards: what is removed, renamed, relicensed and added is as in one index; other shards keep their files") {
  const Shards s;
  auto flat = flat_index(s.clips);
  const auto before = ml::read_shard_list(s.folder);
  const auto more = random_clips(90, 2);
  {
    ml::ShardStore store(s.folder, model(), shard_bytes);
    const auto change = [&](auto& index) {
      index.rename("/clips/1-3.bvh", "/clips/moved.bvh");
      index.set_license("/clips/1-5.bvh", "public domain");
      index.remove_if(
          [](const ml::IndexedClip& c) { return c.path == "/clips/1-4.bvh" || c.path == "/clips/1-199.bvh"; });
      for (const auto& c : more) index.add(c);
    };
    change(store), change(flat);
    CHECK(std::ranges::equal(store.clips(), flat.clips()));
    CHECK(store.moment_count() == std::ssize(flat.moments()));
    CHECK(ml::read_shard_list(s.folder).shards == before.shards);  // until it is written
    store.write();
  }
  check_as(s.folder, flat);
  const auto after = ml::read_shard_list(s.folder);
  CHECK(after.shards[0].file != before.shards[0].file);
  CHECK(after.shards[1] == before.shards[1]);
  CHECK(std::distance(fs::directory_iterator(s.folder), fs::directory_iterator()) == std::ssize(after.shards) + 1);

  {  // in several steps, and with nothing left
    ml::ShardStore store(s.folder);
    for (const auto& c : random_clips(30, 3)) store.add(c), flat.add(c);
    const auto half = [](const ml::IndexedClip& c) {
      return c.path.starts_with("/clips/3-1") || c.path.starts_with("/clips/1-1");
    };
    CHECK(store.remove_if(half) == flat.remove_if(half));
    for (const auto& c : random_clips(3, 4)) store.add(c), flat.add(c);
    store.write();
    check_as(s.folder, flat);
    store.remove_if([](const ml::IndexedClip&) { return true; });
    store.write();
  }
  check_as(s.folder, ml::MotionIndex(model()));
}

TEST_CASE("shards: what is missing, cut off, or of another model is reported") {
  const auto refused = [](auto damage, const char* message) {
    const Shards s;
    damage(s);
    CHECK_ERROR(ml::IndexShards::open(s.folder), message);
  };
  refused([](const Shards& s) { fs::remove(s.shard(1)); }, "shard-00001.index is missing: shard 2 of ");
  refused([](const Shards& s) { fs::resize_file(s.shard(2), 5000); },
          "shard-00002.index: 5000 bytes, the list shards.json says ");
  refused([](const Shards& s) { fs::resize_file(s.shard(2), 100'000); }, "[motionlang.io.403]");
  refused([](const Shards& s) { Shards::patch(s.shard(1), "0123456789abcdef", "f123456789abcdef"); },
          "[motionlang.config.102] ");
  refused([](const Shards& s) { Shards::patch(s.shard(1), "0123456789abcdef", "f123456789abcdef"); },
          "shard-00001.index: made with the model 'models/m' (f123456789abcdef), the other shards with 'models/m' "
          "(0123456789abcdef)");
  refused([](const Shards& s) { Shards::patch(s.shard(0), "\\\"stride\\\":5", "\\\"stride\\\":6"); },
          "\"stride\":6}, the list shards.json says ");
  refused([](const Shards& s) { Shards::patch(s.shard(0), "\"clips_codes\"", "\"clips_coded\""); },
          "[motionlang.io.406]");
  refused([](const Shards& s) { Shards::patch(s.shard(0), "motionlang.index", "motionlang.indox"); },
          "shard-00000.index: not an index of motionlang");
  refused([](const Shards& s) { fs::copy_file(s.shard(1), s.shard(0), fs::copy_options::overwrite_existing); },
          "the list shards.json says ");

  const auto list = [&](const std::string& from, const std::string& to, const char* message) {
    const Shards s;
    std::string text = ml::read_file(s.folder / "shards.json");
    const auto at = text.find(from);
    REQUIRE(at != text.npos);
    ml::write_file(s.folder / "shards.json", text.replace(at, from.size(), to));
    CHECK_ERROR(ml::IndexShards::open(s.folder), message);
  };
  list("shard-00000.index", "../shard-00000.index",
       "shards.json: shards[0]: '../shard-00000.index' does not name a file");
  list("shard-00000.index", "C:shard-00000.index", "'C:shard-00000.index' does not name a file");
  list("shard-00000.index", "a\\\\shard-00000.index", "does not name a file");
  list("shard-00000.index", "shard-00000.index\\u0000", "[motionlang.io.403] ");
  list("\"shard_bytes\": 65536", "\"shard_bytes\": 16383", "[motionlang.io.403] ");
  list("\"shard_bytes\": 65536", "\"shard_bytes\": -1", "shards.json: shards of -1 bytes; at least 16384");
  list("\"clips\": ", "\"clips\": 1", "the list of shards wants ");
  list("\"moments\": ", "\"moments\": -", "[motionlang.io.403] ");
  list("\"version\": 1", "\"version\": 2", "version 2 of a list of shards, expected 1");
  list("motionlang.shards", "motionlang.sherds", "not a list of shards");
  list("{", "", "[motionlang.io.403] ");
}

TEST_CASE("shards: damage inside is found when it is met, and by a check of all bytes") {
  const auto first_moment = [](const Shards& s) { return ml::IndexShards::open(s.folder)->moment(0); };
  {
    const Shards s;
    Shards::poke<std::int64_t>(s.shard(0), "moment_frames", 0, 1'000'000);
    CHECK_ERROR(first_moment(s), "of clip 1000000 among ");
    CHECK_ERROR(ml::IndexShards::open(s.folder)->check(), "[motionlang.io.403]");
  }
  {
    const Shards s;
    Shards::poke<std::int64_t>(s.shard(0), "clip_places", 1, std::int64_t{1} << 60);
    CHECK_ERROR(ml::IndexShards::open(s.folder)->clip(0), "shard-00000.index: clip 0: its text is from byte ");
  }
  {
    const Shards s;
    Shards::poke<std::int64_t>(s.shard(0), "clip_places", 1, 40);
    CHECK_ERROR(ml::IndexShards::open(s.folder)->clip(0), "[motionlang.io.403]");
  }
  {
    const Shards s;
    Shards::poke<std::int64_t>(s.shard(0), "caption_clips", 0, -1);
    CHECK_ERROR(ml::IndexShards::open(s.folder)->clip_of_caption(0), "caption 0 is of clip -1 among ");
  }
  const Shards s;
  const auto clip = flat_index({s.clips[0]});
  Shards::poke<float>(s.shard(0), "clips", 3, 50.0f);
  std::vector<float> query(clip.clip_rows().begin(), clip.clip_rows().end());
  query[3] = 10;
  CHECK_ERROR(ml::IndexShards::open(s.folder)->vectors(ml::SearchFor::clips)->search(query, 1000),
              "shard-00000.index: 'clips': damaged: a cosine of ");
  const Shards codes;
  Shards::poke<std::int8_t>(codes.shard(1), "moments_codes", 7, 99);
  CHECK_ERROR(ml::IndexShards::open(codes.folder)->check(), "shard-00001.index: damaged: its checksum is ");
}

TEST_CASE("shards: a check finds bounds and places that do not hold, under right checksums") {
  {
    const Shards s;
    const auto bounds = Shards::peek<float>(s.shard(1), "moments_bounds");
    for (std::size_t i = 1; i < bounds.size(); i += 2)
      Shards::poke<float>(s.shard(1), "moments_bounds", i, 0.5f * bounds[i]);
    s.reseal(s.shard(1));
    CHECK_ERROR(ml::IndexShards::open(s.folder)->check(), "shard-00001.index: 'moments': the codes of vector ");
    CHECK_ERROR(ml::IndexShards::open(s.folder)->check(), " are off by ");
  }
  {
    const Shards s;
    const auto clips = Shards::peek<std::int64_t>(s.shard(0), "caption_clips");
    REQUIRE(clips[0] != clips[1]);
    Shards::poke<std::int64_t>(s.shard(0), "caption_clips", 0, clips[1]);
    Shards::poke<std::int64_t>(s.shard(0), "caption_clips", 1, clips[0]);
    s.reseal(s.shard(0));
    CHECK_ERROR(ml::IndexShards::open(s.folder)->check(), "shard-00000.index: 'caption_clips' does not fit the clips");
  }
  const Shards s;
  const auto places = Shards::peek<std::int64_t>(s.shard(0), "clip_places");
  for (const std::size_t i : {0u, 1u, 2u, 3u})
    Shards::poke<std::int64_t>(s.shard(0), "clip_places", i, places[(i + 2) % 4]);
  s.reseal(s.shard(0));
  CHECK(ml::IndexShards::open(s.folder)->clip(0) == s.clips[1].clip);
  CHECK_ERROR(ml::IndexShards::open(s.folder)->check(), "shard-00000.index: 'clip_places' does not fit the clips");
}

TEST_CASE("shards: a write that fails can be tried again, and nothing is lost") {
  {  // the list cannot be written
    const TemporaryFolder made;
    const fs::path folder = made / "new";
    ml::ShardStore store(folder, model(), shard_bytes);
    auto flat = flat_index({});
    const auto add = [&](Index count, std::uint64_t seed) {
      for (const auto& c : random_clips(count, seed)) store.add(c), flat.add(c);
    };
    add(150, 1);
    fs::create_directories(folder / "shards.json/in the way");
    CHECK_ERROR(store.write(), "[motionlang.io.401]");
    CHECK_ERROR(store.write(), "[motionlang.io.401]");
    add(20, 2);
    fs::remove_all(folder / "shards.json");
    store.write();
    check_as(folder, flat);
    CHECK(std::distance(fs::directory_iterator(folder), fs::directory_iterator()) ==
          std::ssize(ml::read_shard_list(folder).shards) + 1);
  }
  // A shard that changes cannot be read, behind another one that is written already.
  const Shards s;
  auto flat = flat_index(s.clips);
  ml::ShardStore store(s.folder);
  const auto count = std::ssize(ml::read_shard_list(s.folder).shards);
  for (const auto& c : random_clips(150, 2)) store.add(c), flat.add(c);
  const std::string in_third = ml::IndexShards::open(s.folder)->list().shards[2].file;
  const std::string third = ml::read_motion_index(s.shard(2)).clips()[0].path;
  for (const std::string& path : {std::string("/clips/1-1.bvh"), third})
    store.rename(path, path + " moved"), flat.rename(path, path + " moved");
  fs::rename(s.shard(2), s / "aside");
  CHECK_ERROR(store.write(), in_third.c_str());
  fs::rename(s / "aside", s.shard(2));
  check_as(s.folder, flat_index(s.clips));  // still
  store.write();
  check_as(s.folder, flat);
  const auto now = std::ssize(ml::read_shard_list(s.folder).shards);
  CHECK(now > count);
  CHECK(std::distance(fs::directory_iterator(s.folder), fs::directory_iterator()) == now + 1);
}

TEST_CASE("shards: of two programs that change a folder, the second is refused, and the first loses nothing") {
  const Shards s;
  ml::write_file(s.folder / "shard-00099.index", std::string_view("of nobody's list"));
  auto flat = flat_index(s.clips);
  {
    ml::ShardStore first(s.folder), second(s.folder);
    for (const auto& c : random_clips(150, 3)) second.add(c);
    for (const auto& c : random_clips(150, 2)) first.add(c), flat.add(c);
    first.write();
    CHECK_ERROR(second.write(), "[motionlang.io.403]");
    CHECK_ERROR(second.write(), "shards.json: another program has written this index meanwhile");
    check_as(s.folder, flat);
    for (const auto& c : random_clips(10, 4)) first.add(c), flat.add(c);
    first.write();  // the list is its own
  }
  check_as(s.folder, flat);
  CHECK(ml::read_file(s.folder / "shard-00099.index") == "of nobody's list");
  ml::ShardStore first(s / "new", model(), shard_bytes), second(s / "new", model(), shard_bytes);
  first.write();
  CHECK_ERROR(second.write(), "another program has written this index meanwhile");
}

TEST_CASE("shards: files of one shard take each other's names, with licences of their own") {
  const Shards s;
  auto flat = flat_index(s.clips);
  ml::ShardStore store(s.folder);
  const auto change = [](auto& index) {
    index.rename("/clips/1-4.bvh", "/clips/c.bvh");
    index.rename("/clips/1-3.bvh", "/clips/1-4.bvh");
    index.rename("/clips/1-2.bvh", "/clips/1-3.bvh");
    index.set_license("/clips/1-5.bvh", "mine");
    index.rename("/clips/1-5.bvh", "/clips/1-6.bvh");  // which has another licence
  };
  change(store), change(flat);
  store.write();
  const auto first = ml::read_motion_index(s.folder / ml::read_shard_list(s.folder).shards[0].file);
  REQUIRE(first.count() > 14);
  CHECK(first.clips()[4].path == "/clips/1-3.bvh");
  CHECK(first.clips()[6].path == "/clips/1-4.bvh");
  CHECK(first.clips()[8].path == "/clips/c.bvh");
  CHECK(first.clips()[10].license == "mine");
  CHECK(first.clips()[12].license == "CC0");
  check_as(s.folder, flat);
}

TEST_CASE("shards: a number in a file name may be larger than any integer") {
  const Shards s;
  auto flat = flat_index(s.clips);
  const std::string large = "shard-99999999999999999999999.index";
  fs::rename(s.shard(0), s.folder / large);
  std::string text = ml::read_file(s.folder / "shards.json");
  ml::write_file(s.folder / "shards.json", text.replace(text.find("shard-00000.index"), 17, large));
  ml::ShardStore store(s.folder);
  for (const auto& c : random_clips(50, 2)) store.add(c), flat.add(c);
  store.write();
  check_as(s.folder, flat);
  const auto list = ml::read_shard_list(s.folder);
  CHECK(list.shards[0].file == large);
  for (std::size_t i = 1; i < list.shards.size(); ++i) CHECK(list.shards[i].file.size() == 17);
}

TEST_CASE("shards: a reader tries again if the list changed while it opened the files") {
  const Shards s;
  ml::ShardStore store(s.folder);
  int tries = 0, changes = 1;
  const auto open = [&](const ml::ShardList& list) {
    if (++tries <= changes) {  // another program writes now
      store.rename(std::string(store.clips()[0].path), "/clips/moved " + std::to_string(tries) + ".bvh");
      store.write();
    }
    for (const auto& e : list.shards) ml::read_motion_index(s.folder / e.file);
  };
  ml::detail::with_current_list(s.folder, open);
  CHECK(tries == 2);
  tries = 0, changes = 100;
  CHECK_ERROR(ml::detail::with_current_list(s.folder, open), "[motionlang.io.401]");
  CHECK(tries == 3);
  tries = 0, changes = 0;
  fs::remove(s.shard(1));
  CHECK_ERROR(ml::detail::with_current_list(s.folder, open), "shard-00001.index");
  CHECK(tries == 1);
}

TEST_CASE("shards: folders and sizes that are refused") {
  const Shards s;
  CHECK_ERROR(ml::ShardStore(s.path, model(), shard_bytes), "has other files, and no shards.json");
  CHECK_ERROR(ml::ShardStore(s / "new", model(), 1000), "[motionlang.config.102] ");
  auto other = model();
  other.id = "other";
  CHECK_ERROR(ml::ShardStore(s.folder, other, shard_bytes), "[motionlang.config.102]");
  CHECK_ERROR(ml::IndexShards::open(s / "nowhere"), "[motionlang.io.401]");
  CHECK_ERROR(
      ml::IndexShards::open(s.folder)->vectors(ml::SearchFor::clips)->search(std::vector<float>(width, 1.0f), -1),
      "[motionlang.config.101] IndexShards: the -1 nearest");
}
