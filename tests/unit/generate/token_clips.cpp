// Motion tokens as clips and pages.
#include <motionlang/backend/eigen.hpp>
#include <motionlang/generate/token_clips.hpp>

#include "../../support/check_error.hpp"
#include "../../support/synthetic_motion.hpp"

namespace ml = motionlang;
using ml::Index;
using B = ml::EigenBackend<float>;

TEST_CASE("codes are counted, the commonest first; each is a clip of four frames on the page") {
  const std::vector<std::vector<Index>> motions{{5, 2, 2}, {7, 5, 2}};
  const std::vector<std::pair<Index, Index>> counts{{2, 3}, {5, 2}, {7, 1}};
  CHECK(ml::counted_codes(motions) == counts);

  using Shown = std::vector<std::pair<Index, Index>>;
  CHECK(ml::codes_to_show({}, motions, 2, 6) == Shown{{2, 3}, {5, 2}});
  CHECK(ml::codes_to_show(std::vector<Index>{7, 0}, motions, 1, 6) == Shown{{7, 1}, {0, 0}});
  CHECK(ml::codes_to_show({}, {}, 9, 2) == Shown{{0, 0}, {1, 0}});

  ml::Philox rng{.seed = 4};
  ml::Tm2t<B> model;
  model.tokenizer =
      ml::MotionTokenizer<B>({.features = 263, .channels = {8, 8}, .codes = 6, .residual_blocks = 1}, rng);
  model.statistics = ml::Normalizer<B>::identity(263);
  const auto codes = ml::tokens_of(model, synthetic::walk({.frames = 42}));
  CHECK(codes.size() == 10);  // 41 rows
  const std::vector<Index> some{3, 0};
  auto clips = ml::token_clips(model, some);
  REQUIRE(clips.size() == 2);
  CHECK(clips[0].code == 3);
  CHECK(clips[0].motion.frames() == 4);
  const Shown counted{{3, 2}};
  clips[0] = ml::token_clips(model, std::span(counted)).front();
  const std::string page = ml::token_page(clips, "tokens <1>");
  CHECK(page.find("<title>tokens &lt;1&gt;</title>") != page.npos);
  CHECK(page.find("code 3, 2 times") != page.npos);
  CHECK(page.find("<svg") != page.npos);
  const std::vector<Index> wrong{6};
  CHECK_ERROR(ml::token_clips(model, wrong), "[motionlang.shape.203] token_clips: code 6 of 6");
}
