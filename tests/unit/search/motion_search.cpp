// Collections of clips: adding, removing, renaming; clips, moments and captions that are found, with a hand-made
// encoder.
#include <doctest/doctest.h>

#include <set>

#include <motionlang/core/rng.hpp>
#include <motionlang/metrics/retrieval.hpp>
#include <motionlang/search/motion_index.hpp>

#include "../../support/check_error.hpp"
#include "../../support/indexed_motions.hpp"

namespace ml = motionlang;
using ml::FrameSlice;
using ml::Index;
using synthetic::acted_clip;
using synthetic::action_model;
using synthetic::action_vector;

namespace {

ml::MotionIndex three_clips() {
  ml::MotionIndex index(action_model());
  index.add(acted_clip("a.bvh", {{0, 50}}, index.model(), {0}));
  index.add(acted_clip("b.bvh", {{1, 60}, {2, 30}}, index.model(), {1, 2}));
  index.add(acted_clip("c.bvh", {{3, 10}}, index.model()));
  return index;
}

std::vector<Index> clips_of(const std::vector<ml::MotionHit>& hits) {
  std::vector<Index> out;
  for (const auto& h : hits) out.push_back(h.clip);
  return out;
}

/// All tables of an index, to compare.
auto tables(const ml::MotionIndex& index) {
  const auto list = [](auto span) { return std::vector(span.begin(), span.end()); };
  return std::tuple(list(index.clips()), list(index.moments()), list(index.caption_clips()), list(index.clip_rows()),
                    list(index.moment_rows()), list(index.caption_rows()));
}

}  // namespace

TEST_CASE("indexed_moments: windows of every length, each once; those longer than the clip are the clip") {
  const auto model = action_model({20, 40}, 10);
  CHECK(ml::indexed_moments(15, model) == std::vector<FrameSlice>{{0, 15}});
  const auto windows = ml::indexed_moments(40, model);
  CHECK(std::is_sorted(windows.begin(), windows.end(),
                       [](auto a, auto b) { return std::pair(a.first, a.length) < std::pair(b.first, b.length); }));
  CHECK(std::count(windows.begin(), windows.end(), FrameSlice{0, 40}) == 1);
  CHECK(std::count(windows.begin(), windows.end(), FrameSlice{10, 20}) == 1);
  for (const FrameSlice& w : windows) CHECK((w.first >= 0 && w.length >= 1 && w.first + w.length <= 40));
  CHECK(ml::indexed_moments(40, action_model({}, 0)).empty());
}

TEST_CASE("MotionSearch: every clip is its own nearest; captions find their clips, each once") {
  const auto index = three_clips();
  const ml::MotionSearch search(index);
  for (Index c = 0; c < 3; ++c) {
    const auto row =
        index.clip_rows().subspan(static_cast<std::size_t>(c * synthetic::vector_width), synthetic::vector_width);
    const auto hits = search.clips(row, 1);
    REQUIRE(hits.size() == 1);
    CHECK(hits[0].clip == c);
    CHECK(hits[0].score == doctest::Approx(1));
    CHECK(hits[0].end == doctest::Approx(index.clips()[static_cast<std::size_t>(c)].end));
  }
  CHECK(search.clips(action_vector(1), 10).size() == 3);
  CHECK(clips_of(search.captions(action_vector(2), 10)) == std::vector<Index>{1, 0});
  CHECK(search.captions(action_vector(2), 1)[0].score == doctest::Approx(1));
}

TEST_CASE("MotionSearch: moments of a long clip are found where they are") {
  ml::Philox rng{.seed = 3};
  ml::MotionIndex index(action_model());
  std::vector<std::tuple<Index, Index, FrameSlice>> wanted;  // clip, action, where
  for (Index clip = 0; clip < 12; ++clip) {
    // Every action of four once in each clip, 25 to 64 frames long, the clips with different ones.
    std::vector<Index> order{0, 1, 2, 3};
    for (std::size_t i = 3; i > 0; --i) std::swap(order[i], order[rng.below(static_cast<std::uint32_t>(i + 1))]);
    std::vector<Index> frames;
    for (const Index action : order) {
      const Index length = 25 + rng.below(40), first = std::ssize(frames),
                  label = (action + 2 * clip) % synthetic::actions;
      frames.insert(frames.end(), static_cast<std::size_t>(length), label);
      wanted.emplace_back(clip, label, FrameSlice{first, length});
    }
    ml::EncodedClip c = acted_clip("long" + std::to_string(clip) + ".bvh", {{0, 1}}, index.model());
    c.clip.end = static_cast<double>(frames.size()) / 20;
    c.vector = synthetic::encode_actions(frames);
    c.moments = ml::indexed_moments(std::ssize(frames), index.model());
    c.moment_vectors.clear();
    for (const FrameSlice& m : c.moments) {
      const auto v = synthetic::encode_actions(
          std::span(frames).subspan(static_cast<std::size_t>(m.first), static_cast<std::size_t>(m.length)));
      c.moment_vectors.insert(c.moment_vectors.end(), v.begin(), v.end());
    }
    index.add(std::move(c));
  }
  const ml::MotionSearch search(index);
  int right = 0;
  for (const auto& [clip, action, where] : wanted) {
    for (const auto& hit : search.moments(action_vector(action), 30)) {
      if (hit.clip != clip) continue;
      const FrameSlice found{std::lround(hit.start * 20), std::lround((hit.end - hit.start) * 20)};
      CHECK(ml::temporal_iou(found, where) > 0);  // nothing of the action is elsewhere in this clip
      right += ml::temporal_iou(found, where) > 0.4 ? 1 : 0;
      break;
    }
  }
  CHECK(right == std::ssize(wanted));
}

TEST_CASE("separate_moments: who overlaps a better one of the same clip is dropped, as if all had been looked at") {
  const std::vector<ml::MotionIndex::Moment> moments{
      {0, {0, 20}}, {0, {5, 20}}, {0, {18, 20}}, {1, {0, 20}}, {0, {0, 60}}};
  const std::vector<ml::Neighbour> best{{1, 0.9f}, {0, 0.8f}, {3, 0.7f}, {2, 0.6f}, {4, 0.5f}};
  const auto kept = [&](double iou, Index k) {
    std::vector<Index> out;
    for (const auto& n : ml::separate_moments(best, moments, iou, k)) out.push_back(n.index);
    return out;
  };
  CHECK(kept(0.3, 10) == std::vector<Index>{1, 3, 2});  // 0 overlaps 1 by 15 / 25, 2 by 7 / 33, 4 by 20 / 60
  CHECK(kept(0.34, 10) == std::vector<Index>{1, 3, 2, 4});
  CHECK(kept(1, 10).size() == 5);
  CHECK(kept(0, 10) == std::vector<Index>{1, 3});
  CHECK(kept(1, 2) == std::vector<Index>{1, 0});
}

TEST_CASE("MotionSearch: moments that stand apart, of one clip with very many windows") {
  ml::MotionIndex index(action_model({20}, 1));  // 3,000 windows, all with the best score
  index.add(acted_clip("a.bvh", {{5, 3000}}, index.model()));
  const ml::MotionSearch search(index);
  const auto hits = search.moments(action_vector(5), 40, 0.0);
  REQUIRE(hits.size() == 40);
  std::set<double> starts;
  for (const auto& h : hits) starts.insert(h.start);
  double last = -1;
  for (const double s : starts) {
    if (last >= 0) CHECK(s - last > 0.45);  // the first ones are cut off: half a second
    last = s;
  }
}

TEST_CASE("MotionIndex: clips that are taken away leave nothing behind") {
  const auto all = three_clips();
  for (const std::string gone : {"a.bvh", "b.bvh", "c.bvh"}) {
    auto index = all;
    CHECK(index.remove_if([&](const ml::IndexedClip& c) { return c.path == gone; }) == 1);
    ml::MotionIndex fresh(action_model());  // as if it had never been there
    if (gone != "a.bvh") fresh.add(acted_clip("a.bvh", {{0, 50}}, fresh.model(), {0}));
    if (gone != "b.bvh") fresh.add(acted_clip("b.bvh", {{1, 60}, {2, 30}}, fresh.model(), {1, 2}));
    if (gone != "c.bvh") fresh.add(acted_clip("c.bvh", {{3, 10}}, fresh.model()));
    CHECK(tables(index) == tables(fresh));
  }
  auto none = all;
  CHECK(none.remove_if([](const auto&) { return true; }) == 3);
  CHECK(none.count() == 0);
  CHECK(ml::MotionSearch(none).clips(action_vector(0), 5).empty());
  CHECK(ml::MotionSearch(none).moments(action_vector(0), 5).empty());
  none.add(acted_clip("d.bvh", {{4, 20}}, none.model()));
  CHECK(clips_of(ml::MotionSearch(none).clips(action_vector(4), 5)) == std::vector<Index>{0});
}

TEST_CASE("MotionIndex: a file that is called otherwise now") {
  auto index = three_clips();
  const auto rows = std::vector(index.clip_rows().begin(), index.clip_rows().end());
  index.rename("b.bvh", "sub/b.bvh");
  CHECK(index.clips()[1].path == "sub/b.bvh");
  CHECK(std::equal(rows.begin(), rows.end(), index.clip_rows().begin()));
}

TEST_CASE("MotionIndex: what is refused, and changes nothing") {
  auto index = three_clips();
  const auto before = tables(index);
  auto c = acted_clip("d.bvh", {{4, 20}}, index.model());
  c.vector.pop_back();
  CHECK_ERROR(index.add(c), "[motionlang.shape.205] MotionIndex: 'd.bvh': 8 numbers for 1 vector of 9");
  c.vector.assign(9, 0);
  CHECK_ERROR(index.add(c), "[motionlang.numeric.302]");
  c = acted_clip("d.bvh", {{4, 20}}, index.model(), {1});
  c.caption_vectors.clear();
  CHECK_ERROR(index.add(c), "0 numbers for 1 vector of 9");
  for (const FrameSlice& none :
       {FrameSlice{0, 0}, FrameSlice{-1, 5}, FrameSlice{std::numeric_limits<ml::Index>::max(), 1}}) {
    ml::EncodedClip wrong = c;
    wrong.moments = {none};
    CHECK_ERROR(index.add(wrong), "[motionlang.shape.205] MotionIndex");
  }
  CHECK(tables(index) == before);
  CHECK_ERROR(index.require_model("ffff", "models/other"),
              "[motionlang.config.102] this index was made with the model 'models/actions' (0123456789abcdef), whose "
              "vectors cannot be "
              "compared with those of 'models/other' (ffff)");
  index.require_model("0123456789abcdef", "models/moved");
  CHECK_ERROR(ml::MotionIndex(ml::IndexModel{}), "[motionlang.config.101]");
  CHECK_ERROR(ml::MotionIndex(action_model({20, 0})), "[motionlang.config.101]");
  CHECK_ERROR(ml::MotionIndex(action_model({20}, 0)), "[motionlang.config.101]");
  const ml::MotionIndex whole(action_model({}, 0));
  CHECK_ERROR(ml::MotionSearch(whole).moments(action_vector(0), 1),
              "[motionlang.config.102] MotionSearch: this index has no moments");
  CHECK_ERROR(ml::MotionSearch(index).captions(action_vector(0), -1),
              "[motionlang.config.101] MotionSearch: the -1 nearest");
  CHECK_ERROR(ml::MotionSearch(index).clips(std::vector<float>(16, 1), 1),
              "[motionlang.shape.204] MotionSearch: a query of 16 numbers, the index has 9");
}
