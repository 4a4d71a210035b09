// Finds motions by words: the search model that comes with motionlang makes an index of a folder, and answers.
//   usage: 13_search [folder of motions [words]]
#include <cstdio>
#include <filesystem>

#include <motionlang/backend/eigen.hpp>
#include <motionlang/generate/generate_motion.hpp>
#include <motionlang/search/index_folder.hpp>
#include <motionlang/search/text_answer.hpp>
#include <motionlang/search/tmr_search_encoder.hpp>
#include <motionlang/stmc.hpp>

namespace ml = motionlang;
using B = ml::EigenBackend<float>;

/// A few clips, for readers without a folder of their own.
static std::string made_clips() {
  const auto stmc = ml::load_stmc<B>(MOTIONLANG_DEFAULT_MODEL);
  std::filesystem::create_directories("clips");
  for (const char* text : {"walk forward", "raise both arms", "sit down"})
    ml::write_motion(ml::concat_text("clips/", text, ".bvh"),
                     ml::generate_motion(stmc, ml::parse_timeline(ml::concat_text(text, " # 0 # 4\n"))));
  return "clips";
}

int main(int argc, char** argv) {
  const std::string folder = argc > 1 ? argv[1] : made_clips(), words = argc > 2 ? argv[2] : "a person sits down";
  const auto models = std::filesystem::path(MOTIONLANG_DEFAULT_MODEL).parent_path();

  const ml::TmrSearchEncoder<B> tmr(ml::load_tmr<B>(models / "tmr_free"));
  ml::MotionIndex index(ml::index_model(tmr));
  const ml::IndexReport report = ml::update_index(index, folder, tmr);
  ml::write_motion_index("moves.index", index);  // opens again with MotionIndexFile::open("moves.index")

  std::printf("%td clips, %zu left out; \"%s\":\n", index.count(), report.skipped.size(), words.c_str());
  const ml::TextAnswer answer = ml::answer_text(ml::MotionSearch(index), tmr, words, {.top = 3});
  for (const ml::UnknownWord& word : answer.unheard) std::printf("  the model does not know '%s'\n", word.word.c_str());
  if (!answer.shown) std::printf("  no clip shows this; the nearest:\n");
  for (const ml::MotionHit& hit : answer.hits)
    std::printf("  %s\n", std::filesystem::path(ml::clip_of(index, hit).path).filename().string().c_str());
}
