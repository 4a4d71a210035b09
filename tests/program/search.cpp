// motionlang index and search on a few clips, with a TMR of random weights: its scores mean nothing, but a clip is its
// own nearest.
#include <doctest/doctest.h>

#include <set>

#include <motionlang/backend/eigen.hpp>
#include <motionlang/datasets/humanml3d_folder.hpp>
#include <motionlang/file/id_list.hpp>
#include <motionlang/formats/amass.hpp>
#include <motionlang/formats/bvh.hpp>
#include <motionlang/formats/glb.hpp>
#include <motionlang/kinematics/motion_tools.hpp>
#include <motionlang/search/unit_rows.hpp>
#include <motionlang/search/vector_graph.hpp>
#include <motionlang/train/presets.hpp>
#include <motionlang/weights/text_motion_model.hpp>

#include "../support/official_folders.hpp"
#include "../support/synthetic_motion.hpp"
#include "../support/temporary_folder.hpp"
#include "process.hpp"

namespace ml = motionlang;
namespace fs = std::filesystem;
using B = ml::EigenBackend<float>;

namespace {

void save_model(const fs::path& folder, std::uint64_t seed, const std::string& features = "guoh3d",
                const ml::WordVectors& vectors = {}, const ml::SimilarityScale* scale = nullptr) {
  auto config = ml::tmr_preset("small");
  config.features = features;
  config.network.latent_dim = 32, config.network.ff_size = 32, config.network.num_layers = 1;
  config.text.width = 16;
  std::vector<std::string> pieces{"[CLS]", "[SEP]", "[UNK]", "a", "person", "walks", "slowly", "turns", "left"};
  const ml::MotionFeatures& rows = ml::motion_features(features);
  const auto model = ml::make_text_motion<ml::Tmr, B>(config, rows.width, ml::WordPiece(pieces, "pieces"),
                                                      ml::Philox{.seed = seed}, vectors);
  ml::save_text_motion(folder, model, config, rows.fps, {{"license", "CC0"}, {"provenance", "random numbers"}}, scale);
}

ml::Motion walk(const std::string& name, int frames, double turn, double steps = 1.8) {
  auto m = synthetic::walk({.frames = frames, .fps = 20, .steps_per_second = steps, .turn = turn});
  m.name = name;
  return m;
}

/// Six clips in four formats, one file that nobody can read, and a model.
struct Gallery : TemporaryFolder {
  Gallery() {
    save_model(path / "model", 1);
    fs::create_directories(path / "clips/sub");
    ml::write_file(path / "clips/LICENSE.txt", "\n# Free as air\nand so on\n");
    ml::write_bvh(path / "clips/straight.bvh", walk("straight", 50, 0));
    ml::write_bvh(path / "clips/left.bvh", walk("left", 120, 1));
    ml::write_bvh(path / "clips/sub/right.bvh", walk("right", 30, -1.5));
    ml::write_amass(path / "clips/slow.npz", walk("slow", 60, 0.2, 0.7));
    const std::vector<ml::Motion> two{walk("quick", 40, 0, 3), walk("spin", 40, 4)};
    ml::write_glb(path / "clips/two.glb", two);
    ml::write_file(path / "clips/broken.bvh", "HIERARCHY and nothing else");
  }
  Outcome run(std::vector<std::string> arguments) const { return ::run(arguments, path); }
  Outcome index(std::vector<std::string> more = {}) const {
    more.insert(more.begin(), {"index", "clips", "--model", "model", "-o", "moves.index"});
    return run(more);
  }
  nlohmann::json search(std::vector<std::string> more) const {
    more.insert(more.begin(), {"search", "moves.index", "--json"});
    const Outcome o = run(more);
    REQUIRE_MESSAGE(o.code == 0, o.text);
    return ml::parse_json(o.text)["hits"];
  }
};

void check_contains(const Outcome& o, int code, std::initializer_list<const char*> parts) {
  CHECK_MESSAGE(o.code == code, o.text);
  for (const std::string part : parts) CHECK_MESSAGE(contains(o.text, part), part << " in\n" << o.text);
}
std::string file_of(const nlohmann::json& hit) {
  return fs::path(hit["path"].get<std::string>()).filename().string() + hit["name"].get<std::string>();
}

}  // namespace

TEST_CASE("index and search: clips, moments, another motion, a page") {
  const Gallery g;
  check_contains(g.index(), 0,
                 {"moves.index: 6 clips", "(6 added, 0 removed, 0 renamed, 0 unchanged, 1 skipped)",
                  "broken.bvh: [motionlang.io.4"});

  const auto hits = g.search({"a person walks slowly"});
  REQUIRE(hits.size() == 6);
  for (std::size_t i = 0; i < hits.size(); ++i) {
    const double score = hits[i]["score"];
    CHECK((score >= 0 && score <= 1));
    if (i > 0) CHECK(score <= hits[i - 1]["score"].get<double>());
    CHECK(hits[i]["license"] == "Free as air");
    CHECK(hits[i]["start"] == 0.0);
  }
  CHECK(g.search({"a person walks slowly", "--top", "2"}).size() == 2);
  check_contains(g.run({"search", "moves.index", "a person walks", "--captions"}), 0,
                 {"no results: the index has 0 captions"});
  check_contains(g.run({"index", "clips", "--model", "model", "-o", "nowhere/moves.index"}), 1,
                 {"[motionlang.io.401] nowhere/moves.index: there is no folder nowhere"});
  CHECK(g.search({"a person turns left"}) != hits);
  const auto rounded = g.search({"a person walks slowly", "--precision", "bf16", "--threads", "1"});
  REQUIRE(rounded.size() == 6);
  for (const auto& a : rounded) {
    const auto b = std::find_if(hits.begin(), hits.end(), [&](const auto& h) { return file_of(h) == file_of(a); });
    REQUIRE(b != hits.end());
    CHECK(std::abs(a["score"].get<double>() - (*b)["score"].get<double>()) < 0.02);
  }

  for (const std::string file : {"straight.bvh", "left.bvh", "sub/right.bvh", "slow.npz"}) {
    const auto like = g.search({"--like", "clips/" + file, "--top", "1"})[0];
    CHECK(file_of(like) == fs::path(file).filename());
    CHECK(like["score"].get<double>() == doctest::Approx(1).epsilon(1e-5));
  }

  const auto moments = g.search({"a person walks", "--moments", "--overlap", "0.2"});
  REQUIRE(moments.size() >= 6);
  for (const auto& m : moments) {
    const double start = m["start"], end = m["end"];
    CHECK(start < end);
    CHECK(end - start <= 3.001);
    for (const auto& other : moments) {
      if (&m == &other || m["path"] != other["path"] || m["name"] != other["name"]) continue;
      const double from = other["start"], to = other["end"];
      CHECK(std::min(end, to) - std::max(start, from) <= 0.21 * (std::max(end, to) - std::min(start, from)));
    }
  }

  const Outcome page =
      g.run({"search", "moves.index", "a person walks <slowly>", "--moments", "--top", "4", "--html", "page.html"});
  check_contains(page, 0, {"  1  0.", "Open ", "page.html"});
  const std::string html = ml::read_file(g / "page.html");
  std::size_t strips = 0;
  for (std::size_t at = 0; (at = html.find("<svg", at)) != html.npos; ++at) ++strips;
  CHECK(strips == 4);
  CHECK(contains(html, "a person walks &lt;slowly&gt;"));
  CHECK(contains(html, "Free as air"));
}

TEST_CASE(
    "index and search: a folder of shards answers like one file, is updated and checked, and its damage is reported") {
  const Gallery g;
  ml::write_file(g / "captions.tsv", std::string_view("straight.bvh\ta person walks | walks\nleft\tturns left\n"));
  const std::vector<std::string> captions{"--captions", "captions.tsv", "--stride", "0.1"};
  REQUIRE(g.index(captions).code == 0);
  const auto index_shards = [&](const std::string& out) {
    std::vector<std::string> all{"index", "clips", "--model", "model", "-o", out, "--shard-mib", "0.015625"};
    all.insert(all.end(), captions.begin(), captions.end());
    return g.run(all);
  };
  check_contains(index_shards("moves"), 0,
                 {"moves: 6 clips, ", "(6 added, 0 removed, 0 renamed, 0 unchanged, 1 skipped)"});
  CHECK(fs::exists(g / "moves/shard-00001.index"));
  const auto same = [&] {
    for (const std::vector<std::string>& more :
         std::vector<std::vector<std::string>>{{"a person walks"},
                                               {"a person turns left", "--moments", "--top", "100"},
                                               {"walks", "--captions", "--json"},
                                               {"--like", "clips/left.bvh", "--moments", "--json"},
                                               {"a person", "--threads", "1"}}) {
      std::vector<std::string> file{"search", "moves.index"}, folder{"search", "moves"};
      file.insert(file.end(), more.begin(), more.end()), folder.insert(folder.end(), more.begin(), more.end());
      const Outcome one = g.run(file), all = g.run(folder);
      REQUIRE_MESSAGE(one.code == 0, one.text);
      CHECK(all.code == 0);
      CHECK(all.text == one.text);
    }
    CHECK(g.run({"index", "-o", "moves", "--list"}).text == g.run({"index", "-o", "moves.index", "--list"}).text);
  };
  same();
  check_contains(g.run({"index", "-o", "moves", "--check"}), 0, {"moves: all bytes are as they were written"});

  ml::write_bvh(g / "clips/straight.bvh", walk("straight", 55, 0.5));
  ml::write_bvh(g / "clips/new.bvh", walk("new", 35, 2));
  fs::remove(g / "clips/two.glb");
  fs::rename(g / "clips/sub/right.bvh", g / "clips/moved.bvh");
  for (const char* out : {"moves", "moves.index"})
    check_contains(g.run({"index", "clips", "-o", out, "--captions", "captions.tsv"}), 0,
                   {"5 clips", "(2 added, 3 removed, 1 renamed, 2 unchanged, 1 skipped)"});
  same();
  for (const char* out : {"moves", "moves.index"})
    check_contains(g.run({"index", "-o", out, "--remove", "clips/left.bvh"}), 0, {"1 clip removed, 4 left"});
  same();

  check_contains(g.run({"index", "clips", "-o", "moves.index", "--shard-mib", "1"}), 2,
                 {"[motionlang.config.102] moves.index is one file"});
  fs::path shard;
  for (const auto& entry : fs::directory_iterator(g / "moves")) {
    if (entry.path().extension() == ".index") shard = entry.path();
  }
  const std::string whole = ml::read_file(shard);
  ml::write_file(shard, std::string_view(whole).substr(0, 3000));
  check_contains(g.run({"search", "moves", "walks"}), 1,
                 {"[motionlang.io.402] moves/shard-", ".index: 3000 bytes, the list shards.json says "});
  std::string changed = whole;
  changed[whole.size() - 200] = static_cast<char>(whole[whole.size() - 200] ^ 1);
  ml::write_file(shard, changed);
  check_contains(g.run({"index", "-o", "moves", "--check"}), 1, {"[motionlang.io.403] moves/shard-", "damaged"});
  fs::remove(shard);
  check_contains(g.run({"search", "moves", "walks"}), 1, {"[motionlang.io.401] moves/shard-", " is missing: shard "});
  ml::write_file(shard, whole);
  save_model(g / "other", 2);
  check_contains(g.run({"search", "moves", "walks", "--model", "other"}), 1,
                 {"[motionlang.config.102] this index was made with"});
}

TEST_CASE("search: a score on the scale of the model, unknown words, no clip shows this, a table of queries") {
  const Gallery g;
  const ml::WordVectors vectors({"person", "stroll", "walks"}, {1, 2, 3, 4, 5, 6}, {0.1f, 0.2f});
  ml::SimilarityScale scale{.shares = {0, 1}, .cosines = {-1, 1}, .least = 0.9999};
  save_model(g / "model", 1, "guoh3d", vectors, &scale);
  ml::write_file(g / "captions.tsv", std::string_view("straight.bvh\ta person walks | walks\nleft\tturns left\n"));
  REQUIRE(g.index({"--captions", "captions.tsv"}).code == 0);
  check_contains(g.run({"search", "moves.index", "a person slowwly", "--top", "1"}), 0,
                 {"word 'slowwly' (did you mean 'slowly'?)", "no clip shows this; the nearest are:", "  1  0."});
  const auto json = ml::parse_json(g.run({"search", "moves.index", "a slowwly", "--json"}).text);
  CHECK(json["shown"] == false);
  CHECK(json["unknown_words"] == nlohmann::json{"slowwly"});
  const auto shares = g.search({"a person walks"});

  scale.least = -1;
  save_model(g / "model", 1, "guoh3d", vectors, &scale);
  CHECK(g.search({"a person walks"}) == shares);
  const Outcome shown = g.run({"search", "moves.index", "a person strolls"});
  CHECK_MESSAGE(!contains(shown.text, "shows this"), shown.text);
  CHECK_MESSAGE(!contains(shown.text, "the word"), shown.text);
  check_contains(g.run({"search", "moves.index", "xyz"}), 0, {"word 'xyz'", "no clip shows this"});

  ml::write_file(g / "queries.tsv", std::string_view("somebody walks\twalk | turn\nflies away\tfly\nxyz\n"));
  check_contains(g.run({"search", "moves.index", "--queries", "queries.tsv"}), 0,
                 {"the first result is right for 1 of 2 queries",
                  "no clip shows this is the answer to 1 of 1 queries that nothing shows"});
  check_contains(g.run({"search", "moves.index", "walk", "--queries", "queries.tsv"}), 2, {"a text or --queries"});
}

TEST_CASE("index: a model of KIT's features has their rate, and sees clips on their joints as they are") {
  const Gallery g;
  save_model(g / "kit", 1, "kit");
  ml::Motion on_mmm = ml::retarget(walk("mmm", 60, 0.5), ml::kit21_skeleton());
  for (const char* arm : {"LE", "RE", "LW", "RW"}) {  // longer arms than SMPL's
    auto& bone = on_mmm.skeleton.offsets[static_cast<std::size_t>(on_mmm.skeleton[arm])];
    bone = 1.5 * bone;
  }
  ml::write_bvh(g / "clips/mmm.bvh", on_mmm);
  check_contains(g.run({"index", "clips", "--model", "kit", "-o", "moves.index"}), 0, {"7 clips"});
  const auto index = ml::read_motion_index(g / "moves.index");
  CHECK(index.model().fps == 12.5);

  const auto& features = ml::motion_features("kit");
  const auto model = ml::load_text_motion<ml::Tmr, B>(g / "kit", ml::read_text_motion_config(g / "kit"));
  const auto vector_of = [&](const ml::Motion& motion) {
    const auto rows = features.from_motion(ml::resample(motion, features.fps));
    const std::vector<float> values(rows.begin(), rows.end());
    const ml::Index frames = std::ssize(values) / features.width;
    const ml::Sequences<B> seen(ml::Tensor<B, 2>::from(values, {frames, features.width}), ml::Offsets{frames});
    return ml::unit_rows(model.system.encode_motion(seen).mu.to_vector(), 32);
  };
  const auto clip = std::find_if(index.clips().begin(), index.clips().end(),
                                 [](const ml::IndexedClip& c) { return c.path.ends_with("mmm.bvh"); });
  REQUIRE(clip != index.clips().end());
  const auto found = index.clip_rows().subspan(static_cast<std::size_t>(clip - index.clips().begin()) * 32, 32);
  const auto farthest = [&](const std::vector<float>& vector) {
    float most = 0;
    for (std::size_t i = 0; i < 32; ++i) most = std::max(most, std::abs(found[i] - vector[i]));
    return most;
  };
  const ml::Motion read = ml::read_bvh_motion(g / "clips/mmm.bvh");
  CHECK(farthest(vector_of(read)) < 1e-5f);
  CHECK(farthest(vector_of(ml::retarget(read))) > 1e-3f);  // on SMPL's joints
}

TEST_CASE("index: what has not changed is not read again; what is gone, new, changed or renamed is noticed") {
  const Gallery g;
  REQUIRE(g.index().code == 0);
  const std::string first = ml::read_file(g / "moves.index");
  const auto left = g.search({"--like", "clips/left.bvh", "--top", "6"});
  check_contains(g.run({"index", "clips", "-o", "moves.index"}), 0,
                 {"6 clips", "(0 added, 0 removed, 0 renamed, 5 unchanged, 1 skipped)"});
  CHECK(ml::read_file(g / "moves.index") == first);

  fs::rename(g / "clips/left.bvh", g / "clips/sub/turned.bvh");
  check_contains(g.index(), 0, {"6 clips", "(0 added, 0 removed, 1 renamed, 4 unchanged"});
  const auto turned = g.search({"--like", "clips/sub/turned.bvh", "--top", "6"});
  CHECK(file_of(turned[0]) == "turned.bvh");
  CHECK(turned[0]["score"] == left[0]["score"]);

  ml::write_bvh(g / "clips/straight.bvh", walk("straight", 55, 0.5));
  ml::write_bvh(g / "clips/new.bvh", walk("new", 35, 2));
  fs::remove(g / "clips/two.glb");
  check_contains(g.index(), 0, {"5 clips", "(2 added, 3 removed, 0 renamed, 3 unchanged"});
  CHECK(file_of(g.search({"--like", "clips/new.bvh", "--top", "1"})[0]) == "new.bvh");
  for (const auto& hit : g.search({"a person walks"})) CHECK(!contains(hit["path"], "two.glb"));

  // The same as an index that is made at once, except the order.
  const auto updated = ml::read_motion_index(g / "moves.index");
  check_contains(g.run({"index", "clips", "--model", "model", "-o", "other.index"}), 0, {"5 clips", "(5 added"});
  const auto fresh = ml::read_motion_index(g / "other.index");
  for (ml::Index i = 0; i < updated.count(); ++i) {
    const auto& clip = updated.clips()[static_cast<std::size_t>(i)];
    const auto same = std::find(fresh.clips().begin(), fresh.clips().end(), clip);
    REQUIRE(same != fresh.clips().end());
    const auto width = static_cast<std::size_t>(fresh.model().width), a = static_cast<std::size_t>(i) * width,
               b = static_cast<std::size_t>(same - fresh.clips().begin()) * width;
    CHECK(std::ranges::equal(updated.clip_rows().subspan(a, width), fresh.clip_rows().subspan(b, width)));
  }
}

TEST_CASE("index: arrays of joints and of features as convert reads them, but not mean and deviation") {
  const Gallery g;
  ml::write_joints_npy(g / "clips/joints.npy", walk("joints", 50, 0.5));
  REQUIRE(g.run({"convert", "clips/left.bvh", "clips/rows.npy", "--features", "guoh3d"}).code == 0);
  const std::vector<float> mean(263, 1), odd(40);
  ml::write_npy(g / "clips/Mean.npy", ml::NpyArray::of(std::span<const float>(mean), {263}));
  ml::write_npy(g / "clips/odd.npy", ml::NpyArray::of(std::span<const float>(odd), {2, 20}));
  const Outcome made = g.index();
  check_contains(made, 0, {"moves.index: 8 clips", "2 skipped)", "odd.npy: [motionlang.io.407]"});
  CHECK(!contains(made.text, "Mean.npy"));
  const auto like = g.search({"--like", "clips/joints.npy", "--top", "1"})[0];
  CHECK(file_of(like) == "joints.npy");
  CHECK(like["score"].get<double>() == doctest::Approx(1).epsilon(1e-5));
  check_contains(g.run({"index", "clips", "-o", "moves.index", "--again", "--rate", "10", "--list"}), 0,
                 {"joints.npy\t0.00\t5.00\t10\t50\t", "rows.npy\t0.00\t"});
}

TEST_CASE("index: a path that is not UTF-8 is skipped, a license becomes UTF-8") {
  const Gallery g;
  fs::rename(g / "clips/broken.bvh", g / "clips/w\xE4lzer.bvh");
  ml::write_file(g / "clips/LICENSE.txt", "\xEF\xBB\xBF# \xA9 nobody\r\n");
  check_contains(g.index(), 0, {"6 clips", "1 skipped", "w?lzer.bvh: [motionlang.io.404] the path is not UTF-8"});
  check_contains(g.run({"index", "-o", "moves.index", "--list"}), 0, {"left.bvh\t0.00\t6.00\t20\t120\t\t? nobody\n"});
  check_contains(g.index(), 0, {"(0 added, 0 removed, 0 renamed, 5 unchanged, 1 skipped)"});
}

TEST_CASE("index: listing, removing, captions") {
  const Gallery g;
  ml::write_file(g / "captions.tsv",
                 "straight.bvh\t0.5\t2\tlegs\ta person walks\nleft\ta person turns left | "
                 "turns\nnobody\t0\t1\tlegs\ta person\n");
  check_contains(g.index({"--captions", "captions.tsv", "--license", "CC0 1.0", "--windows", "1", "--stride", "0.25"}),
                 0, {"6 clips", "there is no clip '", "nobody'"});
  check_contains(
      g.run({"index", "-o", "moves.index", "--list"}), 0,
      {"straight.bvh\t0.50\t2.00\t20\t30\ta person walks\tCC0 1.0\n", "two.glb#spin\t0.00\t2.00\t20\t40\t\tCC0 1.0",
       "left.bvh\t0.00\t6.00\t20\t120\ta person turns left | turns\tCC0"});
  const auto hits = g.search({"a person turns left", "--captions"});
  REQUIRE(hits.size() == 2);
  CHECK(file_of(hits[0]) == "left.bvh");
  CHECK(hits[0]["score"].get<double>() == doctest::Approx(1).epsilon(1e-5));
  CHECK(hits[0]["captions"].size() == 2);

  check_contains(g.run({"index", "-o", "moves.index", "--remove", "clips/sub", "clips/two.glb", "clips/never.bvh"}), 0,
                 {"3 clips removed, 3 left", "clips/never.bvh is not in the index"});
  CHECK(g.search({"a person walks"}).size() == 3);
  check_contains(g.run({"index", "-o", "moves.index", "--remove", "clips/never.bvh"}), 2,
                 {"[motionlang.config.103] --remove: moves.index has none of these clips"});
  check_contains(g.run({"index", "-o", "moves.index", "--list", "--remove", "clips/never.bvh"}), 0,
                 {"clips/never.bvh is not in the index", "straight.bvh\t"});
  check_contains(g.index({"--windows", "1,2"}), 2,
                 {"[motionlang.config.102] moves.index has moments of 1 other lengths"});
}

TEST_CASE("index: Ctrl-C leaves an index of what is done, and the same command goes on") {
  const Gallery g;
  fs::remove(g / "clips/broken.bvh");
  for (int i = 0; i < 90; ++i)
    ml::write_bvh(g / ("clips/more" + std::to_string(i) + ".bvh"), walk("more", 300, 0.01 * i));
  const Outcome o =
      ::run({"index", "clips", "--model", "model", "-o", "moves.index", "--threads", "1", "--stride", "0.05"}, g.path,
            "indexing");
  check_contains(o, 130, {"stopped", "moves.index: "});
  const ml::Index done = ml::read_motion_index(g / "moves.index").count();
  CHECK((done > 0 && done < 96));
  check_contains(g.run({"index", "clips", "-o", "moves.index", "--no-moments"}), 2,
                 {"they are chosen when an index is made"});
  check_contains(g.run({"index", "clips", "-o", "moves.index"}), 0,
                 {"moves.index: 96 clips", "0 removed", "0 skipped"});
}

TEST_CASE("index: captions and a license that come later, for clips that are there already") {
  const Gallery g;
  fs::remove(g / "clips/broken.bvh");
  fs::remove(g / "clips/LICENSE.txt");
  REQUIRE(g.index({"--license", "CC0"}).code == 0);
  ml::write_file(g / "captions.tsv",
                 "\xEF\xBB\xBF"
                 "left\t1\t2\tlegs\ta person turns left\nleft\t2\t4\tlegs\tturns\n");  // a byte order mark
  const std::vector<std::string> again{"index", "clips", "-o", "moves.index"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), again.begin(), again.end());
    return g.run(more);
  };
  check_contains(with({"--captions", "captions.tsv"}), 0, {"7 clips", "(2 added, 1 removed, 0 renamed, 4 unchanged"});
  check_contains(with({"--captions", "captions.tsv"}), 0, {"(0 added, 0 removed, 0 renamed, 5 unchanged"});
  check_contains(with({"--list"}), 0,
                 {"(0 added", "left.bvh\t1.00\t2.00\t20\t20\ta person turns left\tCC0\n", "\tturns\tCC0\n"});
  CHECK(file_of(g.search({"a person turns left", "--captions"})[0]) == "left.bvh");
  check_contains(with({"--license", "MIT"}), 0, {"5 unchanged", "5 files have another license now"});
  const auto licensed = ml::read_motion_index(g / "moves.index");
  for (const auto& clip : licensed.clips()) CHECK(clip.license == "MIT");

  ml::write_file(g / "captions.tsv", "left\t1\t3\tlegs\ta person turns left\n");  // one line less, one is longer
  check_contains(with({"--captions", "captions.tsv"}), 0, {"6 clips", "(1 added, 2 removed, 0 renamed, 4 unchanged"});
  fs::rename(g / "clips/left.bvh", g / "clips/turned.bvh");
  ml::write_file(g / "captions.tsv", "turned\t1\t3\tlegs\ta person turns left\n");
  const Outcome renamed = with({"--captions", "captions.tsv"});
  check_contains(renamed, 0, {"6 clips", "1 renamed"});
  CHECK(!contains(renamed.text, "there is no clip"));
}

TEST_CASE("index --captions: a clip by its extension, and by its name where that leaves no doubt") {
  const Gallery g;
  fs::remove(g / "clips/broken.bvh");
  ml::write_amass(g / "clips/left.npz", walk("left", 60, -1));
  ml::write_file(g / "captions.tsv",
                 "left.bvh\t0\t2\tlegs\ta person turns left\nleft.npz\t0\t2\tlegs\ta person walks slowly\n"
                 "two\ta person walks\nslow.npz\ta person\nmissing.bvh\ta person\n");
  const Outcome out = g.index({"--captions", "captions.tsv", "--no-moments"});
  check_contains(out, 0, {"captions.tsv: there is no clip '", "/clips/missing.bvh' below"});
  std::multiset<std::string> said;
  const auto index = ml::read_motion_index(g / "moves.index");
  for (const auto& clip : index.clips()) {
    std::string line = fs::path(clip.path).filename().string();
    for (const std::string& text : clip.captions) line += ": " + text;
    said.insert(line);
  }
  CHECK(said == std::multiset<std::string>{"left.bvh: a person turns left", "left.npz: a person walks slowly",
                                           "right.bvh", "slow.npz: a person", "straight.bvh", "two.glb: a person walks",
                                           "two.glb: a person walks"});
  ml::write_file(g / "captions.tsv", "slow\ta person\nleft\t0\t2\tlegs\ta person turns left\n");
  const Outcome doubt = g.index({"--captions", "captions.tsv", "--no-moments"});
  check_contains(doubt, 1,
                 {"[motionlang.io.403] captions.tsv:2: 'left' may be ", "clips/left.bvh or ",
                  "clips/left.npz: add its extension"});
}

TEST_CASE("index --captions: of a data set by the names of its clips, as in training") {
  const Gallery g;
  REQUIRE(g.run({"convert", "clips/left.bvh", "set", "--features", "guoh3d"}).code == 0);
  ml::write_file(g / "captions.tsv", "left\ta person turns left\n");
  const Outcome out = g.run({"index", "set", "--model", "model", "-o", "set.index", "--captions", "captions.tsv"});
  check_contains(out, 0, {"set.index: 1 clip, "});
  CHECK(!contains(out.text, "there is no clip"));
  CHECK(ml::read_motion_index(g / "set.index").clips().front().captions ==
        std::vector<std::string>{"a person turns left"});
}

TEST_CASE("index: a long line of a LICENSE is cut between two characters") {
  const Gallery g;
  ml::write_file(g / "clips/LICENSE.txt", std::string(199, 'a') + "\xC3\xA4 and more\n");
  REQUIRE(g.index().code == 0);
  CHECK(ml::read_motion_index(g / "moves.index").clips().front().license == std::string(199, 'a'));
}

TEST_CASE("index: a LICENSE file that comes, changes or goes later; --license of a call is before it") {
  const Gallery g;
  fs::remove(g / "clips/broken.bvh");
  fs::remove(g / "clips/LICENSE.txt");
  const auto licenses = [&] {
    std::set<std::string> all;
    const auto index = ml::read_motion_index(g / "moves.index");
    for (const auto& clip : index.clips()) all.insert(clip.license);
    return all;
  };
  using Licenses = std::set<std::string>;
  REQUIRE(g.index().code == 0);
  CHECK(licenses() == Licenses{""});
  ml::write_file(g / "clips/LICENSE", "CC0\n");
  check_contains(g.index(), 0, {"(0 added, 0 removed, 0 renamed, 5 unchanged", "5 files have another license now"});
  CHECK(licenses() == Licenses{"CC0"});
  CHECK(!contains(g.index().text, "another license"));
  ml::write_file(g / "clips/sub/LICENSE", "MIT\n");
  check_contains(g.index(), 0, {"5 unchanged", "1 file has another license now"});
  CHECK(licenses() == Licenses{"CC0", "MIT"});
  check_contains(g.index({"--license", "mine"}), 0, {"5 files have another license now"});
  CHECK(licenses() == Licenses{"mine"});
  fs::remove(g / "clips/LICENSE");
  check_contains(g.index(), 0, {"1 file has another license now"});
  CHECK(licenses() == Licenses{"mine", "MIT"});
}

TEST_CASE("index: another file of the same time and size is not taken for a renamed one") {
  const Gallery g;
  const auto change = [&](const char* from, const char* to, bool same) {
    const auto time = fs::last_write_time(g / from);
    std::string text = ml::read_file(g / from);
    if (!same) text.replace(text.find_last_of("123456789"), 1, "0");
    ml::write_file(g / to, text);
    fs::last_write_time(g / to, time);
    fs::remove(g / from);
  };
  REQUIRE(g.index().code == 0);
  change("clips/left.bvh", "clips/copy.bvh", true);
  check_contains(g.index(), 0, {"6 clips", "(0 added, 0 removed, 1 renamed, 4 unchanged"});
  change("clips/copy.bvh", "clips/other.bvh", false);
  check_contains(g.index(), 0, {"6 clips", "(1 added, 1 removed, 0 renamed, 4 unchanged"});
}

#if MOTIONLANG_HAS_HNSWLIB
TEST_CASE("index: a graph is made, gets what is added, and is not needed for what Ctrl-C leaves") {
  const Gallery g;
  const auto graphs = [&] {
    const auto file = ml::MotionIndexFile::open(g / "moves.index");
    return !file.extra("graph_clips").empty() && !file.extra("graph_moments").empty();
  };
  const auto index = [&](const char* graph) {
    return g.run({"index", "clips", "-o", "moves.index", "--graph", graph});
  };
  REQUIRE(g.index({"--stride", "0.05"}).code == 0);
  CHECK(!graphs());
  const auto all = g.search({"a person walks", "--moments"});
  check_contains(index("1"), 0, {"(0 added, 0 removed, 0 renamed, 5 unchanged"});
  CHECK(graphs());
  CHECK(g.search({"a person walks", "--moments"}) == all);
  ml::write_bvh(g / "clips/new.bvh", walk("new", 35, 2));
  check_contains(index("1"), 0, {"7 clips", "(1 added"});
  CHECK(graphs());
  CHECK(file_of(g.search({"--like", "clips/new.bvh", "--top", "1"})[0]) == "new.bvh");
  CHECK(g.search({"a person walks"}) == g.search({"a person walks", "--exact"}));

  for (int i = 0; i < 20; ++i)
    ml::write_bvh(g / ("clips/more" + std::to_string(i) + ".bvh"), walk("more", 300, 0.01 * i));
  const Outcome o = ::run({"index", "clips", "-o", "moves.index", "--graph", "1"}, g.path, "connecting");
  check_contains(o, 130, {"moves.index: 27 clips", "(20 added", "stopped"});
  CHECK(ml::read_motion_index(g / "moves.index").count() == 27);
  CHECK(!graphs());
  CHECK(g.search({"a person walks"}).size() == 10);
  check_contains(index("1"), 0, {"27 clips", "(0 added"});
  CHECK(graphs());
}
#endif

TEST_CASE("index and search: a TMR as its repository leaves it, with a cache of states") {
  const Gallery g;
  constexpr ml::Index states = 12;
  ml::Philox rng{.seed = 5};
  const ml::Tmr<B> tmr({.text_nfeats = states, .latent_dim = 16, .ff_size = 24, .num_layers = 2}, rng);
  const auto statistics = official::statistics(263, 6);
  const auto part = [&](const char* name, const auto& module) {
    TorchArchive archive;
    official::add_module(archive, module);
    official::write_bytes(g / "tmr/last_weights" / (std::string(name) + ".pt"), archive.finish());
  };
  part("motion_encoder", tmr.motion_encoder);
  part("text_encoder", tmr.text_encoder);
  part("motion_decoder", tmr.motion_decoder);
  official::write_bytes(g / "tmr/stats/mean.pt", TorchArchive::of_tensor(official::view_of(statistics.mean)));
  official::write_bytes(g / "tmr/stats/std.pt", TorchArchive::of_tensor(official::view_of(statistics.std)));
  official::write_text(g / "tmr/config.json", R"({"model": {"motion_encoder": {"nfeats": 263, "latent_dim": 16}}})");
  ml::EmbeddingCache cache(states);
  for (const char* text : {"a person walks", "a person turns"}) {
    std::vector<float> rows(3 * states);
    rng.normal(std::span(rows));
    cache.add(text, rows);
  }
  cache.write(g / "states", "bert");

  check_contains(g.run({"info", "tmr"}), 0,
                 {"263 numbers a frame", "latent 16, feed-forward 24, 2 layers, 4 heads", "motion_encoder.tokens"});
  check_contains(g.run({"index", "clips", "--model", "tmr", "-o", "moves.index"}), 0, {"6 clips"});
  check_contains(g.run({"search", "moves.index", "a person walks"}), 1, {"[motionlang.config.102]", "--text-encoder"});
  CHECK(g.search({"a person walks", "--text-encoder", "states/bert.npy"}).size() == 6);
  check_contains(g.run({"search", "moves.index", "a person flies", "--text-encoder", "states/bert.npy"}), 1,
                 {"[motionlang.config.103]"});
  CHECK(file_of(g.search({"--like", "clips/slow.npz", "--top", "1"})[0]) == "slow.npz");
  CHECK(g.run({"index", "clips", "-o", "moves.index", "--text-encoder", "states/bert.npy"}).code == 0);  // remembered
  CHECK(g.search({"a person walks"}).size() == 6);

  // it makes motions, and is measured on data in the form of HumanML3D
  const auto made = g.run({"generate", "--model", "tmr", "--text", "a person walks", "--seconds", "1", "--text-encoder",
                           "states/bert.npy", "--out", "made"});
  CHECK_MESSAGE(made.code == 0, made.text);
  CHECK(ml::read_bvh_motion(g / "made/a_person_walks.bvh").frames() == 20);
  check_contains(g.run({"generate", "--model", "tmr", "--text", "a person walks"}), 1,
                 {"the states of distilbert: --text-encoder names it"});

  // packed into one folder it is the same
  check_contains(g.run({"pack", "tmr", "-o", "packed", "--license", "drawn by us", "--provenance", "this test"}), 0,
                 {"license                  drawn by us", "latent 16, feed-forward 24"});
  const auto again = g.run({"generate", "--model", "packed", "--text", "a person walks", "--seconds", "1",
                            "--text-encoder", "states/bert.npy", "--out", "again"});
  CHECK_MESSAGE(again.code == 0, again.text);
  CHECK(ml::read_file(g / "again/a_person_walks.bvh") == ml::read_file(g / "made/a_person_walks.bvh"));
  check_contains(g.run({"index", "clips", "--model", "packed", "-o", "packed.index"}), 0, {"6 clips"});
  const auto found = [&](const char* index) {
    return g.run({"search", index, "a person walks", "--text-encoder", "states/bert.npy"}).text;
  };
  CHECK(found("packed.index") == found("moves.index"));
  std::vector<std::string> ids;
  for (int i = 0; i < 34; ++i) {
    ids.push_back(std::to_string(100 + i));
    ml::HumanMl3dClip clip{ids.back(), 40, std::vector<float>(40 * 263), std::vector<float>(40 * 66), {}};
    ml::Philox{.seed = static_cast<std::uint64_t>(i)}.normal(std::span(clip.features));
    clip.captions.push_back(
        {.text = i % 2 == 0 ? "a person walks" : "a person turns", .words = {}, .start = 0, .end = 0});
    ml::write_humanml3d_clip((g / "data").string(), clip);
  }
  ml::write_ids((g / "data/train.txt").string(), std::span(ids).first(1));
  ml::write_ids((g / "data/test.txt").string(), std::span(ids).last(33));
  const std::vector<std::string> evaluate{"evaluate", "tmr", "--data", "data"};
  auto with_states = evaluate;
  with_states.insert(with_states.end(), {"--text-encoder", "states/bert.npy", "--synthesis"});
  check_contains(g.run(with_states), 0, {"33 motions of the test part", "batches of 32", "  generated"});
  with_states.back() = "--moments";
  with_states.push_back("2");
  check_contains(g.run(with_states), 0, {"4 texts in 2 motions", "all lengths"});
  check_contains(g.run(evaluate), 1, {"--text-encoder names it"});
  fs::create_directories(g / "mdm");
  ml::write_file(g / "mdm/args.json", "{}");
  check_contains(g.run({"evaluate", "mdm", "--data", "data"}), 2, {"mdm: --texts is needed to measure STMC"});
  fs::remove(g / "tmr/stats/mean.pt");
  check_contains(g.run({"search", "moves.index", "a person walks", "--text-encoder", "states/bert.npy"}), 1,
                 {"[motionlang."});
}

TEST_CASE("index and search: help names every option") {
  const TemporaryFolder folder;
  for (const auto& [command, names] : std::map<std::string, std::vector<std::string>>{
           {"index",
            {"folder", "--out", "--model", "--text-encoder", "--captions", "--license", "--windows", "--stride",
             "--no-moments", "--again", "--remove", "--list", "--graph", "--scale", "--rate", "--up", "--asf",
             "--threads"}},
           {"search",
            {"index", "text", "--like", "--from", "--to", "--moments", "--captions", "--top", "--overlap", "--html",
             "--json", "--exact", "--model", "--text-encoder", "--scale", "--rate", "--up", "--asf"}}}) {
    const auto help = ::run({command, "--help"}, folder.path);
    CHECK(help.code == 0);
    CAPTURE(help.text);
    for (const std::string& name : names) CHECK_MESSAGE(contains(help.text, name), name);
  }
}

TEST_CASE("index and search: --asf is the skeleton of AMC files without one") {
  const Gallery g;
  fs::create_directories(g / "amc");
  ml::write_file(g / "amc/13_30.amc", ":FULLY-SPECIFIED\n:DEGREES\n1\nroot 0 1 0 0 0 0\n2\nroot 0 1 0 0 0 0\n");
  ml::write_file(g / "one.asf",
                 ":version 1.10\n:name n\n:units\nmass 1.0\nlength 0.45\nangle deg\n:root\naxis XYZ\n"
                 "order TX TY TZ RZ RY RX\nposition 0 0 0\norientation 0 0 0\n:bonedata\nbegin\nid 1\n"
                 "name thigh\ndirection 1 0 0\nlength 2\naxis 0 0 0 XYZ\nend\n:hierarchy\nbegin\n"
                 "root thigh\nend\n");
  const std::vector<std::string> index{"index", "amc", "--model", "model", "-o", "moves.index"},
      like{"search", "moves.index", "--like", "amc/13_30.amc"};
  const auto with_asf = [&](std::vector<std::string> command) {
    command.insert(command.end(), {"--asf", "one.asf"});
    return g.run(command);
  };
  const char *missing = "13_30.amc: there is no skeleton ", *unknown = "[motionlang.config.103]";
  check_contains(g.run(index), 0, {missing, "beside it; set --asf"});
  check_contains(with_asf(index), 0, {unknown});  // the skeleton is read, but no table knows its two joints
  check_contains(g.run(like), 1, {missing});
  check_contains(with_asf(like), 1, {unknown});
}

TEST_CASE("index and search: what is refused") {
  const Gallery g;
  check_contains(g.run({"index", "-o", "moves.index", "--list"}), 1, {"there is no moves.index yet"});
  check_contains(g.index({"--remove", "clips/left.bvh"}), 1, {"there is no moves.index yet"});
  check_contains(g.run({"index", "clips", "--model", "clips", "-o", "moves.index"}), 1, {"[motionlang."});
  CHECK(!fs::exists(g / "moves.index"));
  REQUIRE(g.index({"--no-moments"}).code == 0);
  check_contains(g.run({"index", "-o", "moves.index"}), 2, {"index: name a folder of motions"});
  check_contains(g.run({"search", "moves.index"}), 2, {"give either a text or --like"});
  check_contains(g.run({"search", "moves.index", "walk", "--moments"}), 1, {"this index has no moments"});
  check_contains(g.run({"search", "moves.index", "--like", "clips/left.bvh", "--from", "50"}), 2,
                 {"[motionlang.config.101]"});
  check_contains(g.run({"search", "clips/left.bvh", "walk"}), 1, {"[motionlang.io.40"});

  save_model(g / "other", 2);
  for (const auto& command : {std::vector<std::string>{"search", "moves.index", "walk", "--model", "other"},
                              {"index", "clips", "-o", "moves.index", "--model", "other"}})
    check_contains(g.run(command), 1,
                   {"[motionlang.config.102] this index was made with the model '", "/model'", "other'"});
  fs::rename(g / "model", g / "moved");  // the same model elsewhere
  CHECK(g.run({"search", "moves.index", "walk"}).code == 1);
  CHECK(g.run({"search", "moves.index", "walk", "--model", "moved"}).code == 0);

  std::string bytes = ml::read_file(g / "moves.index");
  bytes[bytes.size() - 5] ^= 1;
  ml::write_file(g / "moves.index", bytes);
  check_contains(g.run({"search", "moves.index", "walk", "--model", "moved"}), 1,
                 {"[motionlang.io.403] moves.index: damaged"});
  check_contains(g.run({"index", "clips", "-o", "moves.index"}), 1, {"damaged"});
  ml::write_file(g / "moves.index", bytes.substr(0, bytes.size() / 2));
  check_contains(g.run({"search", "moves.index", "walk"}), 1, {"[motionlang.io.402]"});
}
